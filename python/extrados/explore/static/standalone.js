// A page without a server: results calculated in advance for values of a dimension and of the tilt of the ground.
import { capital, degrees, h, number, quantity } from "./dom.js";
import { stage } from "./stage.js";
import { unpack } from "./transport.js";
import { tr } from "./words.js";

/** The replies of a file, from compressed bytes: each of a length (4 bytes, 4 more are empty) and a frame. */
async function frames(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const whole = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
  const found = [], view = new DataView(whole);
  for (let at = 0; at < whole.byteLength;) { const n = view.getUint32(at, true); found.push(unpack(whole.slice(at + 8, at + 8 + n))); at += 8 + n; }
  return found;
}

export async function start(root, data) {
  const cells = await frames(data.frames), columns = data.tilts.length;
  const it = { size: Math.floor(data.sizes.length / 2), tilt: data.tilts.findIndex((v) => Math.abs(v) < 1e-9), scene: null };
  root.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  const box = h("div", { class: "stage-box" }), words = h("p", { class: "verdict", role: "status" }), rows = h("table", { class: "numbers" });
  const slider = (label, count, now, act) => h("input", { type: "range", min: 0, max: count - 1, step: 1, value: now, "aria-label": label, oninput: (e) => { act(Number(e.target.value)); show(); } });
  const sizeWords = h("output"), tiltWords = h("output");
  const sizes = slider(data.label, data.sizes.length, it.size, (k) => { it.size = k; }), tilts = slider(tr`Tilt of the ground`, columns, it.tilt, (k) => { it.tilt = k; });
  const legend = h("p", { class: "hint" }, tr`Dashed: least thrust. Dotted: greatest thrust. With circles: collapse and its hinges. Drag the handle at the end of the ground, or the sliders.`);
  root.replaceChildren(h("header", { class: "top" }, h("span", { class: "brand" }, "extrados"), h("h1", { class: "title" }, data.title)),
    h("div", { class: "body alone" }, h("main", { class: "main" }, h("section", { class: "stage-frame" }, box)), h("aside", { class: "side" }, h("div", { class: "page" }, words,
      data.label ? h("label", { class: "slide" }, `${data.label} `, sizeWords, sizes) : null, h("label", { class: "slide" }, tr`Tilt of the ground `, tiltWords, tilts), rows, legend))));
  const nearest = (gamma) => data.tilts.reduce((best, v, k) => (Math.abs(v - gamma) < Math.abs(data.tilts[best] - gamma) ? k : best), 0);
  const drawing = stage(box, { begin: () => false, type: () => {}, through: () => {}, drag: () => {}, tilt: (gamma) => { it.tilt = nearest(gamma); show(); }, step: (_, dx, dy) => { it.tilt = Math.min(Math.max(it.tilt + Math.sign(dx - dy), 0), columns - 1); show(); } });
  drawing.layers = { least: true, most: true, plus: true, minus: true, reactions: true, joints: true };
  /** Of the two collapses that to the side of the tilt is drawn. */
  drawing.drawn = (name) => (["plus", "minus"].includes(name) ? name === (it.scene.gamma < 0 ? "minus" : "plus") : true);
  let first = true;
  function show() {
    const { words: { scene }, arrays } = cells[it.size * columns + it.tilt];
    it.scene = scene;
    tilts.value = it.tilt;
    sizeWords.textContent = data.sizes[it.size];
    tiltWords.textContent = `${number(data.tilts[it.tilt], 3)} g, ${number(degrees(data.tilts[it.tilt]), 3)}°`;
    drawing.setTheta(Math.atan(scene.gamma));
    drawing.show(scene, arrays, [], first);
    first = false;
    words.className = `verdict ${scene.falls ? "bad" : "good"}`;
    words.replaceChildren(h("b", {}, scene.falls === "weight" ? tr`Cannot stand. ` : scene.falls ? tr`Collapses towards ${scene.falls === "plus" ? "+x" : "−x"}. ` : tr`Stands. `), scene.why ? capital(scene.why) : scene.unknown ?? "");
    const c = scene.capacity, row = (label, value) => h("tr", {}, h("th", { scope: "row" }, label), h("td", {}, value));
    rows.replaceChildren(h("tbody", {}, c ? [row(tr`Capacity to +x`, `${number(c.plus_g, 4)} g`), row(tr`Capacity to −x`, `${number(c.minus_g, 4)} g`)] : null,
      scene.least_N === undefined ? null : [row(tr`Least thrust`, quantity(scene.least_N, "N")), row(tr`Greatest thrust`, quantity(scene.most_N, "N"))], row(tr`Weight`, quantity(scene.weight_N, "N"))));
  }
  show();
  window.extrados = { ...it, it, data, show, drawing };
}
