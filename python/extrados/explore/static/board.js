// A board to draw on in metres: its picture, its bar of tools, places on the screen and zoom. The sheet and the plan are boards.
import { h, s, set } from "./dom.js";

/** A path through points on the screen (px). */
export const line = (points, close = "Z") => points.length ? `M${points.map((p) => p.map((v) => v.toFixed(1)).join(" ")).join("L")}${close}` : "";

/** labels: of the picture, of the tools and of their options, for those who hear the page. resized: called with a new size, and
 *  with whether it is the first. */
export function drawingBoard(frame, box, kind, labels, layers, resized) {
  const view = { k: 60, cx: 0, cy: 0, w: 0, h: 0 };
  const words = s("text", { class: "sheet-words", x: 12, y: 20 });
  const svg = s("svg", { class: kind, tabindex: "0", role: "application", "aria-label": labels.picture }, ...layers, words);
  svg.toggleAttribute("hidden", true);
  box.append(svg);
  const tools = h("div", { class: "layers", role: "group", "aria-label": labels.tools });
  const options = h("div", { class: "layers options", role: "group", "aria-label": labels.options });
  const bar = h("div", { class: "sheet-bar", hidden: true }, tools, options);
  frame.prepend(bar);
  new ResizeObserver(() => {
    const { clientWidth: w, clientHeight: hgt } = box;
    if (svg.hasAttribute("hidden") || !w || !hgt) return;
    const first = !view.w;
    view.w = w; view.h = hgt;
    set(svg, { viewBox: `0 0 ${w} ${hgt}`, width: w, height: hgt });
    resized(first);
  }).observe(box);
  return {
    view, words, svg, tools, options, bar,
    press: (label, act, more = {}) => h("button", { class: "layer", onclick: act, ...more }, label),
    /** From metres to the screen (px), and back. */
    X: ([x, y]) => [view.cx + view.k * x, view.cy - view.k * y],
    M: (px, py) => [(px - view.cx) / view.k, (view.cy - py) / view.k],
    /** Larger by a factor about a place of the screen, which moves by dx, dy (px). */
    enlarge(by, x, y, dx, dy) {
      view.k *= by;
      view.cx = x + by * (view.cx + dx - x); view.cy = y + by * (view.cy + dy - y);
    },
  };
}
