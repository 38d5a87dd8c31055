// Five exercises: a deck to begin with, a question, and a check of what the hand has found.
import { h, number } from "./dom.js";

const arch = (more, analysis = 'kind = "tilt"') => `title = "${more.title}"\n\n[structure]\n${more.structure}\n${more.motion ? `\n[motion]\n${more.motion}\n` : ""}\n[[analysis]]\n${analysis}\n`;
const ring = (radius, thickness, embrace, voussoirs) => `kind = "arch"\nradius = ${radius}\nthickness = ${thickness}\nembrace = ${embrace}\nvoussoirs = ${voussoirs}`;
const value = (app, key) => app.forms.find((f) => `${f.section}.${f.key}` === key)?.value;
const near = (x, y, share) => Math.abs(x - y) <= share * Math.abs(y);

export const EXERCISES = [
  {
    title: "The least thickness", tab: "structure",
    task: "Make this semicircular arch as thin as it can be and still stand under its own weight. Drag the handle at the crown, or press the arrow keys on it.",
    question: "Which ratio of thickness to radius of the centre line does it need at least, and where are its hinges then?",
    deck: arch({ title: "The least thickness", structure: ring(5.0, 0.9, 180.0, 60) }),
    check(app) {
      const ratio = value(app, "structure.thickness") / value(app, "structure.radius");
      if (!near(value(app, "structure.embrace"), 180, 1e-3)) return [false, "Let it be a semicircle: embrace 180°."];
      if (!app.scene.stands) return [false, `At ${number(ratio, 4)} no thrust line stays within the stones: it is too thin.`];
      if (ratio > 0.112) return [false, `It stands at ${number(ratio, 4)}; it can be thinner. Watch the lines of least and greatest thrust come together.`];
      return [true, `Right: about ${number(ratio, 3)}. Milankovitch (1907) found 0.1075 for radial joints. Least and greatest thrust are one and the same line there: it touches the extrados at crown and springings and the intrados at the haunches, where the hinges open.`];
    },
  },
  {
    title: "Oppenheim's arch", tab: "structure",
    task: "Tilt the ground by the handle at its right end until this arch of seven stones comes down. Then untilt it, and let the mechanism move.",
    question: "At which acceleration to the side does the arch come down, and how many hinges does it need?",
    deck: arch({ title: "Oppenheim's arch", structure: ring(10.0, 1.5, 157.5, 7) }),
    check(app) {
      const { plus_g: plus } = app.scene.capacity ?? {};
      if (!near(value(app, "structure.thickness"), 1.5, 1e-3) || !near(value(app, "structure.embrace"), 157.5, 1e-3)) return [false, "The sizes have changed: begin again."];
      if (!near(Math.abs(app.scene.gamma), plus, 0.03)) return [false, `You tilted the ground as ${number(app.scene.gamma, 3)} g; find the tilt at which it just comes down, within 3 %.`];
      return [true, `Right: ${number(plus, 3)} g, a tilt of ${number((Math.atan(plus) * 180) / Math.PI, 4)}°. Four hinges make a chain of three links: one more than a statically determinate arch has.`];
    },
  },
  {
    title: "A buttress", tab: "structure",
    task: "This vault stands on buttresses. Change their width, and see what the vault bears to the side.",
    question: "How wide must the buttresses be for a capacity of 0.10 g, to within 2 %?",
    deck: arch({ title: "A buttress", structure: 'kind = "vault"\nradius = 5.0\nthickness = 0.6\nembrace = 120.0\nface = 4.2\nbuttress_width = 1.6\nheight = 9.0' }),
    check(app) {
      const c = app.scene.capacity ? Math.min(app.scene.capacity.plus_g, app.scene.capacity.minus_g) : -1, width = value(app, "structure.buttress_width");
      if (!near(value(app, "structure.height"), 9, 1e-3)) return [false, "Leave the height as it was: 9 m."];
      if (c < 0.098) return [false, `With ${number(width, 3)} m it bears ${number(c, 3)} g: too little.`];
      if (c > 0.102) return [false, `With ${number(width, 3)} m it bears ${number(c, 3)} g: more than asked.`];
      return [true, `Right: about ${number(width, 3)} m. The capacity grows nearly as the width over the height, since the leeward buttress turns about its outer toe; a wide one would rather crack, which a deck asks for by the key "fracture".`];
    },
  },
  {
    title: "Two pulses", tab: "motion",
    task: "Both pulses, one of 1.0 g for 0.20 s and one of 0.6 g for 0.45 s, rock Oppenheim's arch. Set the first, press Keep, then set the second.",
    question: "The static capacity is 0.37 g. Which of the two pulses brings it down? Leave that one set.",
    deck: arch({ title: "Two pulses", structure: ring(10.0, 1.5, 157.5, 7), motion: 'kind = "step-pulse"\namplitude = "0.5 g"\nduration = 0.10' }, 'kind = "rocking"'),
    check(app) {
      const pulse = app.deck.motion?.pulse;
      if (!pulse) return [false, "Set a step pulse."];
      const first = near(pulse.amplitude_g, 1.0, 0.02) && near(pulse.duration_s, 0.2, 0.03), second = near(pulse.amplitude_g, 0.6, 0.02) && near(pulse.duration_s, 0.45, 0.03);
      if (!first && !second) return [false, "Set one of the two pulses: 1.0 g for 0.20 s, or 0.6 g for 0.45 s."];
      const falls = app.motion.words?.outcome === "collapse";
      if (!falls) return [false, `This one (${number(pulse.amplitude_g, 3)} g for ${number(pulse.duration_s, 3)} s) rocks it, and it recovers. Look at the map: where does the other lie?`];
      return [true, "Right: it comes down. An acceleration above the static capacity only begins to rock it; whether it falls depends on how long the pulse lasts: on the map, amplitude and duration together."];
    },
  },
  {
    title: "The falling block", tab: "motion",
    task: "A block 1 m wide and 4 m high stands on the ground under one sine. Make the block larger at the same proportions, 2 m and 8 m, and look again. Then find its own limit.",
    question: "Which amplitude of a sine of 1 s just overturns the block of 2 m and 8 m? Leave an amplitude set that overturns it, at most 5 % above the least that does.",
    deck: arch({ title: "The falling block", structure: 'kind = "block"\nwidth = 1.0\nheight = 4.0', motion: 'kind = "sine-pulse"\namplitude = "0.45 g"\nperiod = 1.0' }, 'kind = "rocking"'),
    check(app) {
      const pulse = app.deck.motion?.pulse, map = app.motion.map;
      if (!near(value(app, "structure.width"), 2, 0.01) || !near(value(app, "structure.height"), 8, 0.01)) return [false, "The block is to be 2 m wide and 8 m high."];
      if (!pulse || !near(pulse.duration_s, 1, 0.02)) return [false, "The sine is to have a period of 1 s."];
      if (app.motion.words?.outcome !== "collapse") return [false, `${number(pulse.amplitude_g, 3)} g does not overturn it.`];
      return ["ask", pulse.amplitude_g, map];
    },
    verify(app, amplitude, told) {
      // the same motion at 5 % less must leave it standing
      const motion = app.deck.motion, less = `${(amplitude * 0.95 * Math.sign(motion.amplitude)).toPrecision(5)} g`, now = `${(amplitude * Math.sign(motion.amplitude)).toPrecision(5)} g`;
      app.ask({ do: "set", changes: { "motion.amplitude": less } });
      app.ask({ do: "rocking", still: true }, { reply: (words) => {
        const falls = words.rocking?.outcome === "collapse";
        app.ask({ do: "set", changes: { "motion.amplitude": now } });
        if (falls) told(false, `It overturns at ${less} as well: look lower.`);
        else told(true, `Right: about ${number(amplitude, 3)} g. Twice the size needs more: of two blocks of the same proportions the larger is the safer, which the static limit of ${number(app.motion.words.uplift_g, 3)} g, equal for both, does not tell (Housner 1963).`);
      } });
    },
  },
];

export function teachPanel(app, box) {
  const list = h("ol", { class: "exercises" });
  const text = h("div", { class: "exercise", "aria-live": "polite" });
  box.append(h("p", {}, "Five questions about masonry, each with a structure to try things on."), list, text);
  const done = new Set(JSON.parse(read("extrados-exercises") ?? "[]"));
  let current = null;
  function read(key) { try { return localStorage.getItem(key); } catch { return null; } }
  function items() {
    list.replaceChildren(...EXERCISES.map((x, k) => h("li", {}, h("button", { "aria-current": current === k ? "true" : null, onclick: () => begin(k) }, x.title, done.has(k) ? h("span", { class: "tick", role: "img", "aria-label": "done" }, " ✓") : null))));
  }
  function begin(k) {
    current = k;
    const x = EXERCISES[k];
    app.open({ text: x.deck, name: `exercise-${k + 1}.toml` });
    app.setTab(x.tab);
    const told = h("p", { class: "told", role: "status" });
    const say = (good, words) => {
      told.className = `told ${good ? "good" : "bad"}`;
      told.textContent = words;
      if (!good) return;
      done.add(k);
      try { localStorage.setItem("extrados-exercises", JSON.stringify([...done])); } catch { /* a browser without storage */ }
      items();
    };
    const check = () => {
      if (!app.scene || app.scene.empty) return;
      const found = x.check(app);
      if (found[0] === "ask") x.verify(app, found[1], say); else say(...found);
    };
    text.replaceChildren(h("h3", {}, x.title), h("p", {}, x.task), h("p", { class: "question" }, x.question), h("div", { class: "row" }, h("button", { class: "first", onclick: check }, "Check"), h("button", { onclick: () => begin(k) }, "Begin again")), told);
    items();
  }
  items();
}
