// A class: the teacher sees the drawings of all pupils small, sends a deck to all, freezes, shows one; a pupil has no files.
import { h, number, s, set } from "./dom.js";
import { tr } from "./words.js";

const EVERY = 1000; // ms between two looks at the class

export function classPanel(app, tabs, box) {
  const grid = h("div", { class: "pupils" }), count = h("span", { role: "status" });
  const freeze = h("button", { "aria-pressed": "false", onclick: () => app.ask({ do: "pause", frozen: freeze.getAttribute("aria-pressed") !== "true" }, { reply: frozen }) }, tr`Freeze`);
  const send = h("button", { class: "first", onclick: () => app.ask({ do: "send" }, { reply: (words) => app.say(tr`The deck is open on ${words.sent} pages.`) }) }, tr`Send my deck to all`);
  box.append(h("div", { class: "row wrap" }, send, freeze, count), grid);
  const cards = new Map();
  let timer = null, since = -1;
  const frozen = (words) => { freeze.setAttribute("aria-pressed", String(words.frozen)); freeze.textContent = words.frozen ? tr`Let the pupils continue` : tr`Freeze`; };

  app.on("welcome", (words) => {
    if (words.pupil) pupil(words);
    if (!words.class || root("class")) return;
    tabs.append(h("button", { role: "tab", id: "tab-class", "data-tab": "class", onclick: () => app.setTab("class") }, tr`Class`));
    app.setTab(app.tab);
  });
  const root = (name) => tabs.querySelector(`[data-tab=${name}]`);
  app.on("tab", (name) => { clearInterval(timer); if (name === "class") { look(); timer = setInterval(look, EVERY); } });
  function look() { app.ask({ do: "class", since, lane: "class" }, { reply: show }); }
  function show(words) {
    const room = words.class;
    if (!room) return;
    since = room.change;
    frozen(room);
    count.textContent = tr`${room.pupils.length} of at most ${room.most} pupils`;
    for (const [n, card] of cards) if (!room.pupils.some((p) => p.number === n)) { card.remove(); cards.delete(n); }
    for (const p of room.pupils) {
      let card = cards.get(p.number);
      if (!card) {
        card = h("button", { class: "pupil", onclick: () => peek(p.number) }, s("svg", {}, s("path", { class: "stones" })), h("b", {}, tr`Pupil ${p.number}`), h("span", {}));
        cards.set(p.number, card);
        grid.append(card);
      }
      if (p.change === undefined) continue;
      const [svg, , about] = card.children;
      svg.firstChild.setAttribute("d", p.path ?? "");
      if (p.box) set(svg, { viewBox: `-60 -60 ${p.box[0] + 120} ${p.box[1] + 120}` });
      set(svg.firstChild, { transform: p.box && p.gamma ? `rotate(${(Math.atan(p.gamma) * 180) / Math.PI} ${p.box[0] / 2} ${p.box[1]})` : null });
      card.classList.toggle("bad", Boolean(p.falls));
      about.textContent = p.falls ? (p.falls === "weight" ? tr`cannot stand` : "collapses") : p.capacity ? tr`capacity ${number(Math.min(p.capacity.plus_g, p.capacity.minus_g), 3)} g` : p.title;
    }
  }
  /** Open the deck of a pupil on the teacher's own page. */
  function peek(n) {
    app.ask({ do: "peek", number: n }, { reply: (words) => { if (words.peeked) { app.open({ text: words.peeked, name: `pupil-${n}.toml` }); app.setTab("structure"); } } });
  }
  /** The page of a pupil: no files, no runs, a number. */
  function pupil(words) {
    app.root.dataset.role = "pupil";
    app.root.querySelector(".brand").textContent = tr`pupil ${words.pupil}`;
    pause(words.frozen);
  }
  const pause = (on) => { for (const part of app.root.querySelectorAll(".stage-frame, .side, .lower, .top")) part.inert = on; app.root.classList.toggle("frozen", on); };
  app.on("frozen", (on) => { if (app.root.dataset.role === "pupil") pause(on); });
}
