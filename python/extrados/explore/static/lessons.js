// Ten lessons: a deck to begin with, a prediction, a question, a check of what the hand has found, and a word of history.
import { number, quantity } from "./dom.js";
import { tr } from "./words.js";

const arch = (more, analysis = 'kind = "tilt"') => `title = "${more.title}"\n\n[structure]\n${more.structure}\n${more.motion ? `\n[motion]\n${more.motion}\n` : ""}\n[[analysis]]\n${analysis}\n`;
const ring = (radius, thickness, embrace, voussoirs) => `kind = "arch"\nradius = ${radius}\nthickness = ${thickness}\nembrace = ${embrace}\nvoussoirs = ${voussoirs}`;
const value = (app, key) => app.forms.find((f) => `${f.section}.${f.key}` === key)?.value;
const near = (x, y, share) => Math.abs(x - y) <= share * Math.abs(y);

export const LESSONS = [
  {
    title: tr`The least thickness`, tab: "structure",
    task: tr`Make this semicircular arch as thin as possible, so that it still carries its own weight. Drag the handle at the crown, or press the arrow keys on it.`,
    question: tr`What is the least ratio of thickness to radius of the centre line, and where are the hinges of the thinnest arch?`,
    choices: [tr`about a fifth of the radius`, tr`about a tenth of the radius`, tr`about a thirtieth of the radius`], right: 1,
    history: tr`Couplet (1730) assumed hinges halfway up the haunches and found 0.101. Milankovitch (1907) calculated the places of the hinges and found 0.1075. Neither number depends on the size of the arch.`,
    deck: arch({ title: tr`The least thickness`, structure: ring(5.0, 0.9, 180.0, 60) }),
    check(app) {
      const ratio = value(app, "structure.thickness") / value(app, "structure.radius");
      if (!near(value(app, "structure.embrace"), 180, 1e-3)) return [false, tr`Keep the arch a semicircle: set the embrace to 180°.`];
      if (!app.scene.stands) return [false, tr`At ${number(ratio, 4)} no thrust line stays within the blocks: the arch is too thin.`];
      if (ratio > 0.112) return [false, tr`The arch stands at ${number(ratio, 4)} and can still be thinner. Watch the lines of least and greatest thrust approach each other.`];
      return [true, tr`Right: about ${number(ratio, 3)}. Milankovitch (1907) found 0.1075 for radial joints. In the thinnest arch the lines of least and greatest thrust coincide. The line touches the extrados at crown and springings, and the intrados at the haunches. The hinges open at these points.`];
    },
  },
  {
    title: tr`Oppenheim's arch`, tab: "structure",
    task: tr`Tilt the ground by the handle at its right end until this arch of seven voussoirs collapses. Then level the ground again, and animate the mechanism.`,
    question: tr`At which horizontal acceleration does the arch collapse, and with how many hinges? Set the ground to this tilt again.`,
    choices: [tr`three hinges`, tr`four hinges`, tr`seven hinges`], right: 1,
    history: tr`Oppenheim (1992) studied this arch as a linkage of three bars with four hinges, and asked which ground motions the arch survives.`,
    deck: arch({ title: tr`Oppenheim's arch`, structure: ring(10.0, 1.5, 157.5, 7) }),
    check(app) {
      const { plus_g: plus } = app.scene.capacity ?? {};
      if (!near(value(app, "structure.thickness"), 1.5, 1e-3) || !near(value(app, "structure.embrace"), 157.5, 1e-3)) return [false, tr`You have changed the sizes: begin the lesson again.`];
      if (!near(Math.abs(app.scene.gamma), plus, 0.03)) return [false, tr`The ground is tilted by ${number(app.scene.gamma, 3)} g; find the tilt at which the arch just collapses, within 3 %.`];
      return [true, tr`Right: ${number(plus, 3)} g, a tilt of ${number((Math.atan(plus) * 180) / Math.PI, 4)}°. Four hinges make a chain of three links. A statically determinate arch has only three hinges.`];
    },
  },
  {
    title: tr`A buttress`, tab: "structure",
    task: tr`This vault has buttresses. Change their width, and watch the horizontal acceleration that the vault resists.`,
    question: tr`How wide must the buttresses be for a capacity of 0.10 g, to within 2 %?`,
    choices: [tr`The capacity is proportional to the width.`, tr`The capacity is proportional to the weight of the vault.`, tr`Width has no influence.`], right: 0,
    history: tr`Builders sized buttresses by rules of proportion for centuries. La Hire (1712) compared the resistance of a pier to overturning with the thrust of the vault.`,
    deck: arch({ title: tr`A buttress`, structure: 'kind = "vault"\nradius = 5.0\nthickness = 0.6\nembrace = 120.0\nface = 4.2\nbuttress_width = 1.6\nheight = 9.0' }),
    check(app) {
      const c = app.scene.capacity ? Math.min(app.scene.capacity.plus_g, app.scene.capacity.minus_g) : -1, width = value(app, "structure.buttress_width");
      if (!near(value(app, "structure.height"), 9, 1e-3)) return [false, tr`Keep the original height of 9 m.`];
      if (c < 0.098) return [false, tr`With ${number(width, 3)} m the capacity is ${number(c, 3)} g: too little.`];
      if (c > 0.102) return [false, tr`With ${number(width, 3)} m the capacity is ${number(c, 3)} g: more than required.`];
      return [true, tr`Right: about ${number(width, 3)} m. The capacity is nearly proportional to the width over the height, since the leeward buttress rotates about its outer toe. A wide buttress would crack instead; a deck considers this by the key "fracture".`];
    },
  },
  {
    title: tr`Two pulses`, tab: "motion",
    task: tr`Two pulses cause Oppenheim's arch to rock: 1.0 g for 0.20 s, and 0.6 g for 0.45 s. Set the first, press Keep, then set the second.`,
    question: tr`The static capacity is 0.37 g. Which of the two pulses causes collapse? Leave the motion set to that pulse.`,
    choices: [tr`the stronger and shorter one`, tr`the weaker and longer one`, tr`both`], right: 1,
    history: tr`An impulse is not a static load: a structure may survive a short acceleration far above its static capacity.`,
    deck: arch({ title: tr`Two pulses`, structure: ring(10.0, 1.5, 157.5, 7), motion: 'kind = "step-pulse"\namplitude = "0.5 g"\nduration = 0.10' }, 'kind = "rocking"'),
    check(app) {
      const pulse = app.deck.motion?.pulse;
      if (!pulse) return [false, tr`Set a step pulse.`];
      const first = near(pulse.amplitude_g, 1.0, 0.02) && near(pulse.duration_s, 0.2, 0.03), second = near(pulse.amplitude_g, 0.6, 0.02) && near(pulse.duration_s, 0.45, 0.03);
      if (!first && !second) return [false, tr`Set one of the two pulses: 1.0 g for 0.20 s, or 0.6 g for 0.45 s.`];
      const falls = app.motion.words?.outcome === "collapse";
      if (!falls) return [false, tr`Under this pulse (${number(pulse.amplitude_g, 3)} g for ${number(pulse.duration_s, 3)} s) the arch rocks and recovers. Find the other pulse on the map.`];
      return [true, tr`Right: the arch collapses. An acceleration above the static capacity only starts rocking. Collapse depends on amplitude and duration together, as the map shows.`];
    },
  },
  {
    title: tr`The overturning block`, tab: "motion",
    task: tr`A block 1 m wide and 4 m high rests on ground that moves by one sine. Enlarge the block to 2 m by 8 m, the same proportions, and compare. Then find the amplitude that overturns the larger block.`,
    question: tr`Which amplitude of a sine of 1 s just overturns the block of 2 m by 8 m? Set an amplitude that overturns the block and exceeds the least such amplitude by at most 5 %.`,
    choices: [tr`the same amplitude`, tr`a larger amplitude`, tr`a smaller amplitude`], right: 1,
    history: tr`After the earthquakes of Chile in 1960, tall water tanks had survived beside lower tanks that had not. Housner (1963) explained this by the rocking of blocks.`,
    deck: arch({ title: tr`The overturning block`, structure: 'kind = "block"\nwidth = 1.0\nheight = 4.0', motion: 'kind = "sine-pulse"\namplitude = "0.45 g"\nperiod = 1.0' }, 'kind = "rocking"'),
    check(app) {
      const pulse = app.deck.motion?.pulse, map = app.motion.map;
      if (!near(value(app, "structure.width"), 2, 0.01) || !near(value(app, "structure.height"), 8, 0.01)) return [false, tr`Make the block 2 m wide and 8 m high.`];
      if (!pulse || !near(pulse.duration_s, 1, 0.02)) return [false, tr`Give the sine a period of 1 s.`];
      if (app.motion.words?.outcome !== "collapse") return [false, tr`${number(pulse.amplitude_g, 3)} g does not overturn the block.`];
      return ["ask", pulse.amplitude_g, map];
    },
    verify(app, amplitude, told) {
      // the same motion at 5 % less must leave it standing
      const motion = app.deck.motion, less = `${(amplitude * 0.95 * Math.sign(motion.amplitude)).toPrecision(5)} g`, now = `${(amplitude * Math.sign(motion.amplitude)).toPrecision(5)} g`;
      app.ask({ do: "set", changes: { "motion.amplitude": less } });
      app.ask({ do: "rocking", still: true }, { reply: (words) => {
        const falls = words.rocking?.outcome === "collapse";
        app.ask({ do: "set", changes: { "motion.amplitude": now } });
        if (falls) told(false, tr`The block also overturns at ${less}: try a smaller amplitude.`);
        else told(true, tr`Right: about ${number(amplitude, 3)} g. Of two blocks of the same proportions the larger is safer. The static limit of ${number(app.motion.words.uplift_g, 3)} g does not show this, since it is the same for both (Housner 1963).`);
      } });
    },
  },
  {
    title: tr`Hooke's chain`, tab: "structure",
    task: tr`A hanging chain carries its weight by tension alone. Turned upside down, the chain is a line of thrust. Many lines of thrust fit into this arch. Click into the blocks to draw the line through the chosen point.`,
    question: tr`Draw the line of thrust that passes through the middle of the joint at the crown.`,
    choices: [tr`exactly one line of thrust fits into this arch`, tr`many lines of thrust fit`, tr`no line of thrust fits`], right: 1,
    history: tr`Hooke (1675) hid his answer in an anagram: as hangs the flexible line, so but inverted will stand the rigid arch. Poleni (1748) hung a loaded chain to judge the cracked dome of St Peter's.`,
    deck: arch({ title: tr`Hooke's chain`, structure: ring(5.0, 0.8, 150.0, 40) }),
    check(app) {
      const t = app.scene.through;
      if (!t) return [false, tr`Click into the blocks at the crown.`];
      if (Math.abs(t.at[0]) > 0.25) return [false, tr`The line passes through a joint ${number(Math.abs(t.at[0]), 3)} m beside the crown: click nearer to the crown.`];
      if (t.reached < 0.42 || t.reached > 0.58) return [false, tr`The line crosses the joint at the crown at ${number(t.reached, 2)} of its length: aim at the middle, 0.5.`];
      return [true, tr`Right: this line has a thrust of ${quantity(t.thrust_N, "N", 3)}. Every line inside the blocks is a possible state of the same arch. The actual line depends on movements too small to see.`];
    },
  },
  {
    title: tr`A factor of safety`, tab: "structure",
    task: tr`The geometric factor of safety is the thickness of the arch divided by the least thickness that contains a line of thrust. The panel Answer shows this factor as Geometric safety.`,
    question: tr`Change the thickness until the geometric safety is 2, to within 2 %.`,
    choices: [tr`0.27 m, since the strength is doubled`, tr`0.54 m, twice the least thickness`, tr`1.0 m, a fifth of the radius`], right: 1,
    history: tr`Heyman (1966) brought plastic theory to masonry: stresses are low, so safety is a question of geometry. He advised a factor of 2 for arches.`,
    deck: arch({ title: tr`A factor of safety`, structure: ring(5.0, 0.4, 150.0, 40) }),
    check(app) {
      const safety = app.detail?.safety;
      if (!near(value(app, "structure.radius"), 5, 1e-3) || !near(value(app, "structure.embrace"), 150, 1e-3)) return [false, tr`Keep the original radius of 5 m and embrace of 150°.`];
      if (!safety) return [false, tr`No line of thrust fits: the arch is too thin.`];
      if (!near(safety, 2, 0.02)) return [false, tr`The geometric safety is ${number(safety, 3)}.`];
      return [true, tr`Right: ${number(value(app, "structure.thickness"), 3)} m. The middle half of the arch then contains a line of thrust.`];
    },
  },
  {
    title: tr`Flat arches push`, tab: "structure",
    task: tr`This arch has a span of 8.66 m and a rise of 2.5 m. Lower the rise with the handle under the crown. The span does not change.`,
    question: tr`At which rise is the least thrust 52.9 kN, 1.5 times the thrust of the first arch, to within 2 %?`,
    choices: [tr`half of the rise gives half of the thrust`, tr`half of the rise gives the same thrust`, tr`half of the rise gives more thrust`], right: 2,
    history: tr`A flat arch pushes harder on its abutments. Perronet built the arches of Neuilly so flat, on piers so thin, that each pier needed its neighbours: the centrings of all arches were removed together (1772).`,
    deck: arch({ title: tr`Flat arches push`, structure: ring(5.0, 0.6, 120.0, 40) }),
    check(app) {
      const r = value(app, "structure.radius"), half = (value(app, "structure.embrace") * Math.PI) / 360, span = 2 * r * Math.sin(half), rise = r * (1 - Math.cos(half));
      if (!near(span, 8.66, 5e-3)) return [false, tr`The span is now ${number(span, 4)} m: set the span back to 8.66 m.`];
      if (!near(app.scene.least_N ?? 0, 52890, 0.02)) return [false, tr`At a rise of ${number(rise, 3)} m the least thrust is ${quantity(app.scene.least_N, "N", 3)}.`];
      return [true, tr`Right: ${number(rise, 3)} m. The thrust is nearly inversely proportional to the rise of the thrust line, which differs from the rise of the arch by a part of the thickness.`];
    },
  },
  {
    title: tr`A cart on the bridge`, tab: "structure",
    task: tr`Add a load with the button in the panel Answer. Drag the load to a quarter of the span, 2.4 m from the crown, and make it heavier with the handle of its arrow.`,
    question: tr`Bring the arch close to collapse: the arch must stand, and its capacity to the weaker side must be below 0.05 g.`,
    choices: [tr`a load at the crown is the most dangerous`, tr`a load at the quarter of the span is the most dangerous`, tr`the place has no influence`], right: 1,
    history: tr`Barlow (1846) built model arches with slips of wood in the joints. He removed the slips one by one and showed several lines of thrust in the same arch. Bridges are still assessed for the axle at the quarter point.`,
    deck: arch({ title: tr`A cart on the bridge`, structure: ring(5.0, 0.6, 150.0, 40) }),
    check(app) {
      const [load] = app.scene.loads ?? [], c = app.scene.capacity;
      if (!load) return [false, tr`Add a load first.`];
      if (Math.abs(Math.abs(load.at[0]) - 2.4) > 0.35) return [false, tr`The load is ${number(Math.abs(load.at[0]), 3)} m from the crown: drag it to 2.4 m.`];
      if (!app.scene.stands) return [false, tr`A load of ${quantity(load.force_N, "N", 3)} is too heavy: no line of thrust fits.`];
      const left = Math.min(c.plus_g, c.minus_g);
      if (left > 0.05) return [false, tr`The capacity is still ${number(left, 3)} g: the load can be heavier.`];
      return [true, tr`Right: a load of about ${quantity(load.force_N, "N", 3)} on a self-weight of ${quantity(app.scene.weight_N, "N", 3)}. The line of thrust almost touches both faces of the arch at four points: four hinges are about to form.`];
    },
  },
  {
    title: tr`The gravestone`, tab: "structure",
    task: tr`A gravestone is 1 m wide and 4 m high. The ground has a constant horizontal acceleration.`,
    question: tr`Leave the height at 4 m. Which width gives a capacity of 0.35 g, to within 1 %?`,
    choices: [tr`A block of twice the size has twice the capacity.`, tr`A block of twice the size has the same capacity.`, tr`A block of twice the size has half the capacity.`], right: 1,
    history: tr`Milne (1885) estimated the shaking in Japan from overturned columns, by a formula of West: the least acceleration in g that overturns a column is its width over its height. For short motions the formula is too severe, as the lesson on the overturning block shows.`,
    deck: arch({ title: tr`The gravestone`, structure: 'kind = "block"\nwidth = 1.0\nheight = 4.0' }),
    check(app) {
      const c = app.scene.capacity?.plus_g ?? 0;
      if (!near(value(app, "structure.height"), 4, 1e-3)) return [false, tr`Leave the height at 4 m.`];
      if (!near(c, 0.35, 0.01)) return [false, tr`With a width of ${number(value(app, "structure.width"), 3)} m the capacity is ${number(c, 3)} g.`];
      return [true, tr`Right: ${number(value(app, "structure.width"), 3)} m, 0.35 of the height. Neither weight nor size has an influence.`];
    },
  },
];
