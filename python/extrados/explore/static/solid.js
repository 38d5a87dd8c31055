// A building in space: rotated by the user; limit analysis of solids gives its capacity on request.
import { h, number, quantity, s, set } from "./dom.js";
import { carried, space } from "./space.js";
import { tr } from "./words.js";

const OF = {
  solids: tr`Blocks in space. Drag the drawing, or use the arrow keys, to turn it. The capacity takes longer than the other results: a button starts its calculation.`,
  walls: tr`Walls and floors of a building, with the elements of a pushover. Drag the drawing, or use the arrow keys, to turn it. A run gives the capacity and the cracks: see Results.`,
  elements: tr`The finite elements of the wall. A run gives the cracks and the capacity curve: see Results.`,
};

const CHOSEN = 2; // of the tones of space.js

export function solidPanel(app, stageBox) {
  const view = space(stageBox), it = { view, push: null, page, mechanismAt, mechanism };
  app.space = view;
  let body = null, swing = null, chosen = null;
  view.onpick = (block) => choose(block === chosen ? null : block);
  app.on("scene", (opened) => {
    const seen = app.scene?.seen?.sort === "space" ? app.scene.seen : null;
    if (opened || !seen) { it.push = null; stop(); }
    if (opened || !(chosen < (seen?.blocks ?? 0))) chosen = null;
    if (!seen) { body = null; view.show(null); return; }
    body = { ...app.arrays, both: seen.of === "walls" };
    view.label = `${app.deck.title || app.name}.`;
    mark();
    view.show(body, !opened);
    if (!opened && it.push) { it.push = null; app.say(tr`The sizes have changed: calculate again.`); }
  });
  app.on("theme", () => view.redraw());
  app.on("tab", (name) => { if (name !== "structure") stop(); });
  app.on("push", (told, arrays) => {
    it.push = { ...told, arrays };
    body.push = told.numbers.load_direction_deg;
    app.say("");
    app.tellDetail();
    if (arrays.mechanism_pose) mechanism();
  });

  /** A block that is clicked, or none: it is coloured, and the text beside the drawing has its numbers. */
  function choose(block) { chosen = block; mark(); view.redraw(); app.tellDetail(); }
  function mark() {
    if (body?.face_body) body.face_tone = chosen === null ? null : Uint8Array.from(body.face_body, (b) => (b === chosen ? CHOSEN : 0));
  }
  /** Name, mass and contacts of the block that is clicked. */
  function about(seen) {
    if (seen.of !== "solids" || !seen.names) return null;
    if (chosen === null) return h("p", { class: "remark" }, tr`Click a block for its name, mass and contacts.`);
    const rows = seen.contacts.map((name, j) => [name, j]).filter(([, j]) => body.contact_body[2 * j] === chosen || body.contact_body[2 * j + 1] === chosen);
    return h("div", { "data-block": chosen }, h("h3", {}, seen.names[chosen]), h("table", { class: "numbers" }, h("tbody", {},
      h("tr", {}, h("th", { scope: "row" }, tr`Mass`), h("td", {}, quantity(body.body_mass[chosen], "kg"))),
      rows.map(([name, j]) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, quantity(body.contact_area[j], "m²")))))));
  }

  /** The text beside the drawing. */
  function page(seen, why) {
    const row = (label, value) => h("tr", {}, h("th", { scope: "row" }, label), h("td", {}, value));
    const [x, y, z] = seen.size_m, rows = [];
    if (seen.blocks) rows.push(row(tr`Stones, contacts`, `${seen.blocks}, ${seen.joints}`));
    if (seen.walls) rows.push(row(tr`Walls, floors`, `${seen.walls}, ${seen.floors}`));
    if (seen.elements) rows.push(row(tr`Elements`, String(seen.elements)));
    if (seen.weight_N) rows.push(row(tr`Weight`, quantity(seen.weight_N, "N")));
    rows.push(row(tr`Size`, z === undefined ? `${number(x, 3)} by ${number(y, 3)} m` : `${number(x, 3)} by ${number(y, 3)} by ${number(z, 3)} m`));
    for (const [key, value] of Object.entries(seen.measures ?? {})) rows.push(row(key.replace(/_m$/, "").replaceAll("_", " "), quantity(value, key.endsWith("_m") ? "m" : "")));
    const parts = [h("p", { class: "verdict" }, OF[seen.of]), h("table", { class: "numbers" }, h("tbody", {}, rows)), h("p", { class: "remark" }, tr`No line of thrust is drawn: ${why}.`)];
    for (const text of seen.warnings ?? []) parts.push(h("p", { class: "remark" }, text));
    parts.push(about(seen));
    if (seen.of === "walls") parts.push(h("div", { class: "row" }, h("button", { class: "first", "data-plan": true, onclick: () => app.plan.begin() }, tr`✎ Draw the plan`)));
    if (seen.of === "solids") {
      parts.push(h("div", { class: "row" }, h("button", { class: "first", onclick: () => { app.say(tr`calculating the capacity …`); app.ask({ do: "push" }); } }, tr`Calculate capacity`), it.push ? h("button", { onclick: () => mechanism() }, tr`▶ Mechanism`) : null));
      if (it.push) parts.push(h("p", { class: "verdict good", "data-number": "push" }, it.push.answer), ...it.push.warnings.map((text) => h("p", { class: "remark" }, text)), rose());
    }
    return parts.filter(Boolean);
  }
  /** Capacity over the direction of the acceleration, from above. */
  function rose() {
    const { rose_direction: angle, rose_capacity: capacity } = it.push.arrays;
    if (!(angle?.length > 2)) return null;
    const most = Math.max(...capacity.filter(Number.isFinite)), c = 110, r = 84, at = (k, share) => { const t = (angle[k % angle.length] * Math.PI) / 180; return [c + r * share * Math.cos(t), c - r * share * Math.sin(t)]; };
    const share = (k) => Math.min(1, capacity[k % angle.length] / most);
    const d = `M${Array.from(angle, (_, k) => at(k, share(k)).map((v) => v.toFixed(1)).join(" ")).join("L")}Z`;
    return h("div", { class: "rose" }, h("h3", {}, tr`Capacity over the direction of the acceleration [g]`), s("svg", { viewBox: "0 0 220 224", width: 220, height: 224, class: "chart", role: "img", "aria-label": tr`Capacity over direction: at most ${number(most, 3)} g.` },
      [0.5, 1].map((v) => s("circle", { class: "grid", cx: c, cy: c, r: r * v, fill: "none" })), [0.5, 1].map((v) => s("text", { x: c + 3, y: c - r * v - 3, text: `${number(v * most, 3)} g` })),
      s("line", { class: "grid", x1: c - r, x2: c + r, y1: c, y2: c }), s("line", { class: "grid", x1: c, x2: c, y1: c - r, y2: c + r }), s("text", { x: c + r + 6, y: c + 4, text: "x" }), s("text", { x: c - 3, y: c - r - 16, text: "y" }),
      s("path", { class: "line", d, fill: "none", stroke: "var(--c0)" })));
  }
  function stop() { if (swing) cancelAnimationFrame(swing); swing = null; }
  /** The mechanism at a share of its way; null brings it back. */
  function mechanismAt(share) {
    if (!it.push?.arrays.mechanism_pose) return false;
    if (share !== undefined) view.move(share === null ? null : carried(body, it.push.arrays.mechanism_pose, share));
    return true;
  }
  function mechanism() {
    if (swing) { stop(); mechanismAt(null); return; }
    const begin = performance.now();
    const step = (now) => {
      mechanismAt(0.5 - 0.5 * Math.cos((now - begin) / 900));
      swing = requestAnimationFrame(step);
    };
    swing = requestAnimationFrame(step);
  }
  it.stop = stop;
  return it;
}
