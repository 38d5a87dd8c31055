// Below the drawing of a structure: its force polygon, and where its thrust lies between least and greatest.
import { h, number, quantity, s, set } from "./dom.js";

export function structurePanel(app, lower) {
  const svg = s("svg", { class: "polygon", role: "img" });
  const polygonBox = h("div", { class: "card" }, h("h2", {}, "Force polygon"), h("div", { class: "fill" }, svg));
  const bar = s("svg", { class: "gauge", role: "img" });
  const gaugeBox = h("div", { class: "card" }, h("h2", {}, "Tilt and thrust"), h("div", { class: "fill" }, bar));
  const panel = h("div", { class: "cards", "data-for": "structure" }, polygonBox, gaugeBox);
  lower.append(panel);
  new ResizeObserver(draw).observe(panel);
  app.on("tab", (name) => { panel.hidden = name !== "structure"; });
  app.on("scene", draw);

  function draw() {
    if (panel.hidden || !app.scene) return;
    polygon();
    gauge();
  }
  function polygon() {
    const rays = app.arrays.polygon, box = svg.parentElement, w = box.clientWidth, hgt = box.clientHeight;
    set(svg, { viewBox: `0 0 ${w} ${hgt}`, width: w, height: hgt });
    if (!rays?.length || !w) { svg.replaceChildren(); set(svg, { "aria-label": "There is no force polygon." }); return; }
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
    svg.replaceChildren(
      s("path", { class: "rays", d }), s("path", { class: "loadline", d: load }), s("circle", { class: "pole", cx: X(0), cy: Y(0), r: 3.5 }, s("title", { text: "pole" })),
      s("path", { class: "scale", d: `M10 ${hgt - 12}V${hgt - 8}H${10 + step * k}V${hgt - 12}` }), s("text", { x: 16 + step * k, y: hgt - 7, text: quantity(step, "N", 1) }));
    set(svg, { "aria-label": `Force polygon of the ${app.scene.chain}: horizontal thrust ${quantity(rays[0], "N", 3)}.` });
  }
  function gauge() {
    const scene = app.scene, box = bar.parentElement, w = box.clientWidth, hgt = box.clientHeight;
    set(bar, { viewBox: `0 0 ${w} ${hgt}`, width: w, height: hgt });
    if (!scene.capacity || !w) { bar.replaceChildren(); return; }
    const { plus_g: plus, minus_g: minus } = scene.capacity, far = 1.15 * Math.max(plus, minus, Math.abs(scene.gamma), 1e-6);
    const X = (g) => 16 + ((g + far) / (2 * far)) * (w - 32);
    const y = 34, parts = [
      s("line", { class: "track", x1: X(-far), x2: X(far), y1: y, y2: y }),
      s("line", { class: "safe", x1: X(-minus), x2: X(plus), y1: y, y2: y }),
      s("line", { class: "end", x1: X(plus), x2: X(plus), y1: y - 8, y2: y + 8 }), s("line", { class: "end", x1: X(-minus), x2: X(-minus), y1: y - 8, y2: y + 8 }),
      s("text", { x: X(plus), y: y - 13, "text-anchor": "middle", text: `${number(plus, 3)} g` }), s("text", { x: X(-minus), y: y - 13, "text-anchor": "middle", text: `${number(-minus, 3)} g` }),
      s("circle", { class: scene.within ? "now" : "now bad", cx: X(scene.gamma), cy: y, r: 6 }),
      s("text", { x: X(scene.gamma), y: y + 22, "text-anchor": "middle", text: scene.gamma ? `now ${number(scene.gamma, 3)} g` : "upright" })];
    if (scene.least_N !== undefined && hgt > 110) {
      const low = Math.min(0, scene.least_N), high = 1.15 * Math.max(scene.most_N, scene.least_N, 1e-9), T = (v) => 16 + ((v - low) / (high - low)) * (w - 32), t = 92;
      parts.push(s("line", { class: "track", x1: T(low), x2: T(high), y1: t, y2: t }), s("line", { class: "safe", x1: T(scene.least_N), x2: T(scene.most_N), y1: t, y2: t }),
        s("line", { class: "end least", x1: T(scene.least_N), x2: T(scene.least_N), y1: t - 8, y2: t + 8 }), s("line", { class: "end most", x1: T(scene.most_N), x2: T(scene.most_N), y1: t - 8, y2: t + 8 }),
        s("text", { x: T(scene.least_N), y: t - 13, "text-anchor": "middle", text: `least ${quantity(scene.least_N, "N", 3)}` }), s("text", { x: T(scene.most_N), y: t + 24, "text-anchor": "middle", text: `greatest ${quantity(scene.most_N, "N", 3)}` }));
      if (scene.through) parts.push(s("circle", { class: "now through", cx: T(scene.through.thrust_N), cy: t, r: 5 }));
    }
    bar.replaceChildren(...parts);
    set(bar, { "aria-label": `It bears from ${number(-minus, 3)} to ${number(plus, 3)} g; now ${number(scene.gamma, 3)} g.` });
  }
}
