// A small chart in SVG: lines, bands, points, bars, a map of codes behind them, a cursor; it can be taken out as it is.
import { h, number, s, set } from "./dom.js";

const MARGIN = { left: 58, right: 14, top: 24, bottom: 36 };

function nice(low, high, count) {
  const span = high - low || 1, rough = span / Math.max(count, 1), power = 10 ** Math.floor(Math.log10(rough));
  const wide = [1, 2, 5, 10].findIndex((f) => f * power >= rough * 0.999), found = [];
  let step = 0;
  for (let k = wide < 0 ? 3 : wide; k >= 0 && found.length < 2; k -= 1) { // one number tells no scale
    step = [1, 2, 5, 10][k] * power;
    found.length = 0;
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * span; i += 1) found.push(i * step === 0 ? 0 : i * step);
  }
  return { found, step };
}
const tick = (value, step) => {
  if (Math.abs(value) >= 1e5 || (value !== 0 && step < 1e-4)) return number(value, 2);
  return value.toFixed(Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9)))).replace("-", "−");
};

/** least and greatest of finite numbers, times a factor */
function range(data, factor = 1, seen = [Infinity, -Infinity]) {
  for (let i = 0; i < data.length; i += 1) {
    const v = data[i] * factor;
    if (!Number.isFinite(v)) continue;
    if (v < seen[0]) seen[0] = v;
    if (v > seen[1]) seen[1] = v;
  }
  return seen;
}

/** Line of many points: of those within one pixel the least and the greatest are drawn. */
function path(x, y, X, Y, fx, fy) {
  let d = "", pen = false;
  const n = Math.min(x.length, y.length);
  if (n > 2400) {
    let column = null, low = 0, high = 0, last = 0;
    for (let i = 0; i < n; i += 1) {
      const v = y[i] * fy;
      if (!Number.isFinite(v)) { pen = false; continue; }
      const px = Math.round(X(x[i] * fx));
      if (px !== column) {
        if (column !== null) d += `${pen ? "L" : "M"}${column} ${Y(low).toFixed(1)}L${column} ${Y(high).toFixed(1)}L${column} ${Y(last).toFixed(1)}`;
        pen = column !== null; column = px; low = high = v;
      }
      low = Math.min(low, v); high = Math.max(high, v); last = v;
    }
    return d;
  }
  for (let i = 0; i < n; i += 1) {
    const v = y[i] * fy;
    if (!Number.isFinite(v) || !Number.isFinite(x[i])) { pen = false; continue; }
    d += `${pen ? "L" : "M"}${X(x[i] * fx).toFixed(1)} ${Y(v).toFixed(1)}`;
    pen = true;
  }
  return d;
}

/**
 * A chart in `box`. `draw(spec, arrays)`: spec has title, x {array, label, unit, factor}, y {label, unit}, series
 * [{array, label, x, factor, sort, lower, dashed, faint, data}], optional heat {codes, x, y, stride}, least, most, marks.
 */
export function chart(box, options = {}) {
  const svg = s("svg", { class: "chart", role: options.ondraw ? "group" : "img" });
  const title = s("text", { class: "chart-title" });
  const back = s("g"), grid = s("g", { class: "grid" }), body = s("g"), axes = s("g", { class: "axes" });
  const cursor = s("line", { class: "cursor", visibility: "hidden" });
  const front = s("g");
  const id = `clip-${Math.random().toString(36).slice(2)}`;
  const clip = s("rect");
  const canvas = document.createElement("canvas");
  svg.append(s("defs", {}, s("clipPath", { id }, clip)), back, grid, s("g", { "clip-path": `url(#${id})` }, body, cursor), axes, title, front);
  const legend = h("div", { class: "legend" });
  box.append(svg, legend);
  const it = { svg, front, X: null, Y: null, box, draw, at, spec: null, place };
  let width = 0, height = 0, limits = null, plot = null, arrays = null;

  new ResizeObserver(() => { if (it.spec) draw(it.spec, arrays); }).observe(box);
  svg.addEventListener("pointerdown", (event) => pick(event, "down"));
  svg.addEventListener("pointermove", (event) => { if (event.buttons & 1) pick(event, "move"); });
  svg.addEventListener("pointerup", (event) => pick(event, "up"));
  function pick(event, how) {
    if (!options.onpick || !it.invert) return;
    if (how === "down") svg.setPointerCapture(event.pointerId);
    const edge = svg.getBoundingClientRect();
    options.onpick(...it.invert(event.clientX - edge.left, event.clientY - edge.top), how);
  }

  function draw(spec, given) {
    it.spec = spec; arrays = given;
    width = box.clientWidth; height = Math.max(60, box.clientHeight - (legend.childElementCount ? legend.offsetHeight : 0));
    if (width < 40) return;
    const inner = { w: Math.max(20, width - MARGIN.left - MARGIN.right), h: Math.max(20, height - MARGIN.top - MARGIN.bottom) };
    set(svg, { viewBox: `0 0 ${width} ${height}`, width, height, "aria-label": words(spec) });
    const fx = spec.x.factor ?? 1, rows = spec.series.filter((r) => get(r.array)?.length);
    const xs = [Infinity, -Infinity], ys = [Infinity, -Infinity];
    for (const row of rows) {
      if (row.aside) continue;
      range(get(row.x ?? spec.x.array), fx, xs);
      range(get(row.array), row.factor ?? 1, ys);
      if (row.lower) range(get(row.lower), row.factor ?? 1, ys);
    }
    if (spec.heat) { range(get(spec.heat.x), fx, xs); range(get(spec.heat.y), 1, ys); xs[0] = 0; ys[0] = 0; }
    if (rows.some((r) => r.sort === "points" || r.sort === "bars") && !spec.heat) { const room = 0.03 * (xs[1] - xs[0]); xs[0] -= room; xs[1] += room; }
    if (spec.span) { xs[0] = spec.span[0]; xs[1] = spec.span[1]; }
    if (spec.least !== undefined) ys[0] = Math.min(ys[0], spec.least);
    if (spec.most !== undefined) ys[1] = Math.max(ys[1], spec.most);
    for (const range of [xs, ys]) {
      if (!(range[1] >= range[0])) { range[0] = 0; range[1] = 1; }
      if (range[1] === range[0]) { range[1] += Math.abs(range[1]) * 0.1 || 1; }
    }
    if (spec.limits) ({ 0: ys[0], 1: ys[1] } = spec.limits);
    else if (!spec.heat) {
      const room = 0.06 * (ys[1] - ys[0]);
      if (spec.least === undefined || ys[0] < spec.least) ys[0] -= room;
      if (spec.most === undefined) ys[1] += room;
    }
    if (spec.symmetric) { const m = Math.max(Math.abs(ys[0]), Math.abs(ys[1])); ys[0] = -m; ys[1] = m; }
    limits = { xs, ys }; plot = inner;
    it.X = (v) => MARGIN.left + ((v - xs[0]) / (xs[1] - xs[0])) * inner.w;
    it.Y = (v) => MARGIN.top + (1 - (v - ys[0]) / (ys[1] - ys[0])) * inner.h;
    it.invert = (px, py) => [xs[0] + ((px - MARGIN.left) / inner.w) * (xs[1] - xs[0]), ys[0] + (1 - (py - MARGIN.top) / inner.h) * (ys[1] - ys[0])];
    set(clip, { x: MARGIN.left, y: MARGIN.top, width: inner.w, height: inner.h });
    scales(spec, inner);
    heat(spec);
    body.replaceChildren(...rows.flatMap((row, k) => lines(spec, row, k, fx)));
    if (spec.marks && get(spec.marks)) {
      for (const t of get(spec.marks)) body.append(s("line", { class: "mark", x1: it.X(t * fx), x2: it.X(t * fx), y1: MARGIN.top, y2: MARGIN.top + 8 }));
    }
    const named = rows.filter((r) => r.label && rows.length > 1 && !r.unnamed);
    legend.replaceChildren(...named.map((r) => h("span", { class: `key c${colour(r, rows)}${r.dashed ? " dashed" : ""}` }, h("i"), r.label)));
    title.textContent = spec.title;
    set(title, { x: Math.max(4, Math.min(MARGIN.left, width - 7.2 * spec.title.length)), y: 15 });
    const legendHeight = named.length ? legend.offsetHeight : 0;
    if (Math.abs(box.clientHeight - legendHeight - height) > 2 && box.clientHeight - legendHeight >= 60) { height = box.clientHeight - legendHeight; if (!it.again) { it.again = true; draw(spec, given); it.again = false; } }
    options.ondraw?.(it);
  }
  const get = (name) => (typeof name === "string" ? arrays[name] : name);
  const colour = (row, rows) => row.colour ?? (row.faint ? 5 : null) ?? rows.filter((r) => !r.faint && !r.colour).indexOf(row) % 6;
  function words(spec) {
    const ys = spec.series.filter((r) => get(r.array)?.length).map((r) => {
      const [low, high] = range(get(r.array), r.factor ?? 1);
      return `${r.label}: ${number(low, 3)} to ${number(high, 3)} ${spec.y.unit}`;
    });
    return `${spec.title}. ${spec.x.label} in ${spec.x.unit || "numbers"}. ${ys.slice(0, 6).join("; ")}`;
  }
  function scales(spec, inner) {
    const { xs, ys } = limits, parts = [], under = [];
    const xt = nice(xs[0], xs[1], Math.min(8, inner.w / 70)), yt = nice(ys[0], ys[1], Math.min(6, inner.h / 34));
    const bottom = MARGIN.top + inner.h;
    for (const v of xt.found) {
      under.push(s("line", { x1: it.X(v), x2: it.X(v), y1: MARGIN.top, y2: bottom }));
      parts.push(s("text", { x: it.X(v), y: bottom + 14, "text-anchor": "middle", text: tick(v, xt.step) }));
    }
    for (const v of yt.found) {
      under.push(s("line", { x1: MARGIN.left, x2: MARGIN.left + inner.w, y1: it.Y(v), y2: it.Y(v), class: v === 0 ? "zero" : "" }));
      parts.push(s("text", { x: MARGIN.left - 6, y: it.Y(v) + 3.5, "text-anchor": "end", text: tick(v, yt.step) }));
    }
    const unit = (u) => (u ? ` [${u}]` : "");
    parts.push(s("text", { class: "label", x: MARGIN.left + inner.w / 2, y: height - 5, "text-anchor": "middle", text: spec.x.label + unit(spec.x.unit) }));
    parts.push(s("text", { class: "label", transform: `translate(13 ${MARGIN.top + inner.h / 2}) rotate(-90)`, "text-anchor": "middle", text: (spec.y.label ?? "") + unit(spec.y.unit) }));
    grid.replaceChildren(...under);
    axes.replaceChildren(...parts, s("path", { class: "frame", d: `M${MARGIN.left} ${MARGIN.top}V${bottom}H${MARGIN.left + inner.w}` }));
  }
  function heat(spec) {
    back.replaceChildren();
    if (!spec.heat) return;
    const codes = get(spec.heat.codes), xs = get(spec.heat.x), ys = get(spec.heat.y), [nx, ny] = codes.shape;
    const style = getComputedStyle(box);
    const shades = [0, 1, 2, 3].map((k) => rgb(style.getPropertyValue(`--map-${k}`)));
    canvas.width = nx; canvas.height = ny;
    const context = canvas.getContext("2d"), image = context.createImageData(nx, ny), stride = spec.heat.stride ?? 1;
    const middle = Math.floor(stride / 2);
    for (let i = 0; i < nx; i += 1) for (let k = 0; k < ny; k += 1) {
      let code = codes[i * ny + k];
      if (code === 255) {
        const a = Math.min(Math.floor(i / stride) * stride + middle, nx - 1), b = Math.min(Math.floor(k / stride) * stride + middle, ny - 1);
        code = codes[a * ny + b];
      }
      const shade = shades[code] ?? [0, 0, 0, 0], at = ((ny - 1 - k) * nx + i) * 4;
      image.data.set(shade, at);
    }
    context.putImageData(image, 0, 0);
    const half = (a) => (a.length > 1 ? (a[1] - a[0]) / 2 : a[0] / 2);
    const x0 = it.X(xs[0] - half(xs)), x1 = it.X(xs[nx - 1] + half(xs)), y0 = it.Y(ys[ny - 1] + half(ys)), y1 = it.Y(ys[0] - half(ys));
    back.append(s("image", { href: canvas.toDataURL(), x: x0, y: y0, width: x1 - x0, height: y1 - y0, preserveAspectRatio: "none", class: "pixels", "clip-path": `url(#${id})` }));
  }
  function rgb(text) {
    const hex = text.trim().replace("#", "");
    return [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16)).concat(255);
  }
  function lines(spec, row, k, fx) {
    const x = get(row.x ?? spec.x.array), y = get(row.array), fy = row.factor ?? 1;
    const rows = spec.series.filter((r) => get(r.array)?.length);
    const name = `c${colour(row, rows)}${row.dashed ? " dashed" : ""}${row.faint ? " faint" : ""}`;
    if (row.sort === "band") {
      const low = get(row.lower);
      let d = "";
      for (let i = 0; i < x.length; i += 1) if (Number.isFinite(y[i])) d += `${d ? "L" : "M"}${it.X(x[i] * fx).toFixed(1)} ${it.Y(y[i] * fy).toFixed(1)}`;
      for (let i = x.length - 1; i >= 0; i -= 1) if (Number.isFinite(low[i])) d += `L${it.X(x[i] * fx).toFixed(1)} ${it.Y(low[i] * fy).toFixed(1)}`;
      return [s("path", { class: `band ${name}`, d: d && `${d}Z` })];
    }
    if (row.sort === "bars") {
      const w = Math.max(1, Math.abs(it.X(x[1] * fx) - it.X(x[0] * fx)) - 1), zero = it.Y(0);
      return Array.from(y, (v, i) => s("rect", { class: `bar ${name}`, x: it.X(x[i] * fx) - w / 2, y: Math.min(it.Y(v * fy), zero), width: w, height: Math.abs(zero - it.Y(v * fy)) }));
    }
    const found = [];
    if (row.sort !== "points") found.push(s("path", { class: `line ${name}`, d: path(x, y, it.X, it.Y, fx, fy) }));
    if (row.sort === "points" || row.sort === "both") {
      let d = "";
      for (let i = 0; i < x.length; i += 1) {
        if (!Number.isFinite(y[i]) || !Number.isFinite(x[i])) continue;
        d += `M${(it.X(x[i] * fx) - 2.5).toFixed(1)} ${it.Y(y[i] * fy).toFixed(1)}a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0`;
      }
      found.push(s("path", { class: `dots ${name}`, d }));
    }
    return found;
  }
  /** The cursor at a value of x; null hides it. */
  function at(value) {
    if (value === null || !it.X) { set(cursor, { visibility: "hidden" }); return; }
    const x = it.X(value);
    set(cursor, { visibility: "visible", x1: x, x2: x, y1: MARGIN.top, y2: MARGIN.top + plot.h });
  }
  function place() { return { ...MARGIN, w: plot?.w, h: plot?.h }; }
  return it;
}
