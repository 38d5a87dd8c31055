// Below the drawing of a structure: its force polygon, and its thrust between the least and the greatest.
import { h, number, quantity, s, set, shapes } from "./dom.js";
import { tr } from "./words.js";

export function structurePanel(app, lower) {
  const svg = s("svg", { class: "polygon", role: "img" });
  const polygonBox = h("div", { class: "card" }, h("h2", {}, tr`Force polygon`), h("div", { class: "fill" }, svg));
  const bar = s("svg", { class: "gauge", role: "group" });
  const gaugeBox = h("div", { class: "card" }, h("h2", {}, tr`Tilt and thrust`), h("div", { class: "fill" }, bar));
  const panel = h("div", { class: "cards", "data-for": "structure" }, polygonBox, gaugeBox);
  lower.append(panel);
  const room = { w: 0, h: 0 }; // of the drawings in their cards, which are of one size
  new ResizeObserver(([entry]) => { room.w = Math.floor(entry.contentRect.width); room.h = Math.floor(entry.contentRect.height); draw(); }).observe(bar.parentElement);
  app.on("tab", (name) => { panel.hidden = name !== "structure"; });
  app.on("beside", draw);

  function draw() {
    if (panel.hidden || !app.scene) return;
    polygon();
    gauge();
  }
  function polygon() {
    const rays = app.arrays.polygon, { w, h: hgt } = room;
    set(svg, { viewBox: `0 0 ${w} ${hgt}`, width: w, height: hgt });
    if (!rays?.length || !w) { shapes(svg, w && app.scene.falls ? [{ tag: "text", x: w / 2, y: 30, "text-anchor": "middle", text: tr`no equilibrium, no force polygon` }] : []); set(svg, { "aria-label": tr`There is no force polygon.` }); return; }
    let x1 = 0, y0 = 0, y1 = 0, x0 = 0;
    for (let i = 0; i < rays.length; i += 2) { x1 = Math.max(x1, rays[i]); x0 = Math.min(x0, rays[i]); y0 = Math.min(y0, rays[i + 1]); y1 = Math.max(y1, rays[i + 1]); }
    const k = Math.min((w - 40) / Math.max(x1 - x0, 1e-9), (hgt - 36) / Math.max(y1 - y0, 1e-9));
    const X = (v) => 20 + (v - x0) * k + Math.max(0, (w - 40 - (x1 - x0) * k) / 2), Y = (v) => 12 + (y1 - v) * k;
    let d = "", load = "";
    for (let i = 0; i < rays.length; i += 2) {
      d += `M${X(0).toFixed(1)} ${Y(0).toFixed(1)}L${X(rays[i]).toFixed(1)} ${Y(rays[i + 1]).toFixed(1)}`;
      load += `${i ? "L" : "M"}${X(rays[i]).toFixed(1)} ${Y(rays[i + 1]).toFixed(1)}`;
    }
    const wish = 70 / k, power = 10 ** Math.floor(Math.log10(wish)), step = [1, 2, 5].map((m) => m * power).filter((v) => v <= wish).pop() ?? power;
    shapes(svg, [
      { tag: "path", class: "rays", d }, { tag: "path", class: "loadline", d: load }, { tag: "circle", class: "pole", cx: X(0), cy: Y(0), r: 3.5, title: "pole" },
      { tag: "path", class: "scale", d: `M10 ${hgt - 12}V${hgt - 8}H${10 + step * k}V${hgt - 12}` }, { tag: "text", x: 16 + step * k, y: hgt - 7, text: quantity(step, "N", 1) }]);
    set(svg, { "aria-label": tr`Force polygon of the ${app.scene.chain}: horizontal thrust ${quantity(rays[0], "N", 3)}.` });
  }
  // The bars of tilt and thrust; the thrust that the chosen line has is a handle
  const knob = s("g", { class: "knob pulse", role: "slider", tabindex: "0", "data-handle": "thrust", "aria-label": tr`Thrust of the chosen line`, onkeydown: keys, onpointerdown: grab, ondblclick: type },
    s("circle", { class: "hit", r: 14 }), s("path", { class: "arrows", d: "M-9 0L-4 -5V5ZM9 0L4 -5V5Z" }), s("circle", { class: "dot", r: 4.5 }));
  const bars = s("g");
  bar.append(bars);
  let span = null; // what the bar of thrust shows
  /** Words by a place of a bar, pulled in where they would be cut off. */
  function label(x, y, text, w) {
    const half = 3.3 * text.length;
    return { tag: "text", x: Math.min(Math.max(x, half + 4), w - half - 4), y, "text-anchor": "middle", text };
  }
  function gauge() {
    const scene = app.scene, { w, h: hgt } = room;
    set(bar, { viewBox: `0 0 ${w} ${hgt}`, width: w, height: hgt });
    span = null;
    if (!scene.capacity || !w) { shapes(bars, w && scene.falls ? [label(w / 2, 30, tr`no capacity: the structure cannot stand`, w)] : []); knob.remove(); return; }
    const { plus_g: plus, minus_g: minus } = scene.capacity, far = 1.15 * Math.max(plus, minus, Math.abs(scene.gamma), 1e-6);
    const X = (g) => 16 + ((g + far) / (2 * far)) * (w - 32);
    const y = 34, parts = [
      { tag: "line", class: "track", x1: X(-far), x2: X(far), y1: y, y2: y },
      { tag: "line", class: "safe", x1: X(-minus), x2: X(plus), y1: y, y2: y },
      { tag: "line", class: "end", x1: X(plus), x2: X(plus), y1: y - 8, y2: y + 8 }, { tag: "line", class: "end", x1: X(-minus), x2: X(-minus), y1: y - 8, y2: y + 8 },
      label(X(plus), y - 13, `${number(plus, 3)} g`, w), label(X(-minus), y - 13, `${number(-minus, 3)} g`, w),
      { tag: "circle", class: scene.within ? "now" : "now bad", cx: X(scene.gamma), cy: y, r: 6 },
      label(X(scene.gamma), y + 22, scene.gamma ? tr`now ${number(scene.gamma, 3)} g` : tr`upright`, w)];
    const { least_N: least, most_N: most } = scene;
    if (least !== undefined && hgt > 110) {
      const low = Math.min(0, least), high = Math.max(1.15 * Math.max(most, least, 1e-9), most + 0.1 * (most - least)), T = (v) => 16 + ((v - low) / (high - low)) * (w - 32), t = 92;
      span = { least, most, low, high, w, now: scene.chosen?.thrust_N ?? scene.through?.thrust_N ?? null };
      parts.push({ tag: "line", class: "track", x1: T(low), x2: T(high), y1: t, y2: t }, { tag: "line", class: "safe", x1: T(least), x2: T(most), y1: t, y2: t },
        { tag: "line", class: "end least", x1: T(least), x2: T(least), y1: t - 8, y2: t + 8 }, { tag: "line", class: "end most", x1: T(most), x2: T(most), y1: t - 8, y2: t + 8 },
        label(T(least), t - 13, tr`least ${quantity(least, "N", 3)}`, w), label(T(most), t + 24, tr`greatest ${quantity(most, "N", 3)}`, w));
      const text = span.now === null ? tr`none is chosen` : quantity(span.now, "N", 4);
      set(knob, { transform: `translate(${T(Math.min(Math.max(span.now ?? least, low), high))} ${t})`, "aria-valuenow": span.now ?? least, "aria-valuemin": least, "aria-valuemax": most, "aria-valuetext": tr`${text}; from ${quantity(least, "N", 4)} to ${quantity(most, "N", 4)}` });
    }
    if (span && most > least) { if (!knob.isConnected) bar.append(knob); } else knob.remove();
    shapes(bars, parts);
    set(bar, { "aria-label": tr`Capacity from ${number(-minus, 3)} to ${number(plus, 3)} g; now ${number(scene.gamma, 3)} g.` });
  }
  function keys(e) {
    if (!span) return;
    const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[e.key], now = span.now ?? span.least;
    if (e.key === "Enter") type();
    else if (e.key === "Home") app.choose(span.least);
    else if (e.key === "End") app.choose(span.most);
    else if (step) app.choose(Math.min(Math.max(now + 0.01 * step * (e.shiftKey ? 10 : 1) * (span.most - span.least), span.least), span.most));
    else return;
    e.preventDefault();
  }
  function type() {
    if (!span) return;
    const field = h("input", { type: "text", value: quantity(span.now ?? span.least, "N", 5), "aria-label": tr`Thrust of the chosen line` });
    const box = app.dialog(tr`Thrust of the chosen line`, h("form", { onsubmit: (e) => { e.preventDefault(); app.choose(field.value); box.close(); } },
      h("p", {}, tr`Between ${quantity(span.least, "N", 4)} and ${quantity(span.most, "N", 4)}: a number in newtons, or with its unit, such as 20 kN.`), field, h("div", { class: "row" }, h("button", { type: "submit", class: "first" }, tr`Set`))));
    field.select();
  }
  function grab(event) {
    if (event.button !== 0 || !span) return;
    event.preventDefault();
    knob.focus({ preventScroll: true });
    knob.setPointerCapture(event.pointerId);
    const edge = bar.getBoundingClientRect();
    const move = (e) => { if (span) app.choose(Math.min(Math.max(span.low + ((e.clientX - edge.left - 16) / (span.w - 32)) * (span.high - span.low), span.least), span.most), e.timeStamp); };
    knob.addEventListener("pointermove", move);
    const end = () => knob.removeEventListener("pointermove", move);
    knob.addEventListener("pointerup", end, { once: true });
    knob.addEventListener("pointercancel", end, { once: true });
  }
}
