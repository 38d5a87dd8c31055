// Bodies in space: parallel projection, hidden parts by a depth buffer as in show/scene.py, turned by hand or by keys.
import { h, quantity, s, set } from "./dom.js";
import { tr } from "./words.js";

const LIGHT = unit([-0.35, -0.75, 1]), DARKEST = 0.55, FINE = 2, STILL = 4; // px that a click may move
const TONES = ["--stone", "--support", "--c4", "--c1", "--c3", "--bad"]; // walls, floors, and cracks from fine to wide

function unit(v) { const size = Math.hypot(...v); return v.map((x) => x / size); }
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Unit vectors to the right, up and towards the eye; angles in degrees, of azimuth in plan and height over the level. */
export function axes(azimuth, elevation) {
  const a = (azimuth * Math.PI) / 180, e = (elevation * Math.PI) / 180;
  const eye = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)], right = [-Math.sin(a), Math.cos(a), 0];
  return [right, cross(eye, right), eye];
}

/** Vertices of bodies carried to a share of a pose: pose (bodies x 6) of shifts and rotation vectors. */
export function carried(body, pose, share) {
  const { vertex, face, face_start: start, face_body: owner, body_centre: centre } = body, out = Float32Array.from(vertex);
  const done = new Uint8Array(vertex.length / 3), turns = new Map();
  const turn = (b) => {
    if (!turns.has(b)) {
      const v = [0, 1, 2].map((k) => share * pose[6 * b + 3 + k]), angle = Math.hypot(...v), n = angle ? v.map((x) => x / angle) : [0, 0, 1];
      turns.set(b, [n, Math.cos(angle), Math.sin(angle)]);
    }
    return turns.get(b);
  };
  for (let f = 0; f + 1 < start.length; f += 1) for (let i = start[f]; i < start[f + 1]; i += 1) {
    const v = face[i], b = owner[f];
    if (done[v]) continue;
    done[v] = 1;
    const arm = [0, 1, 2].map((k) => vertex[3 * v + k] - centre[3 * b + k]), [n, c, t] = turn(b), across = cross(n, arm);
    const along = (1 - c) * (n[0] * arm[0] + n[1] * arm[1] + n[2] * arm[2]);
    for (let k = 0; k < 3; k += 1) out[3 * v + k] = centre[3 * b + k] + share * pose[6 * b + k] + c * arm[k] + t * across[k] + along * n[k];
  }
  return out;
}

/** A view of bodies in a box of the page. show(body): {vertex, face, face_start, face_tone, bar, both}, both: faces have two
 *  sides; its arrays as bodies.py tells them. */
export function space(box) {
  const canvas = h("canvas", { class: "space-canvas" });
  const svg = s("svg", { class: "space", role: "img", tabindex: "0" });
  const frame = h("div", { class: "space-box", hidden: true }, canvas, svg);
  box.append(frame);
  const it = { svg, frame, show, move, redraw, pick, onpick: null, label: "", azimuth: -60, elevation: 25, zoom: 1 };
  svg.backdrop = canvas;
  let body = null, vertex = null, bounds = null, rest = null, drawing = null, seen = null;

  /** Show other bodies, or none; keep: from where they are looked at now. */
  function show(next, keep = false) {
    body = next;
    frame.hidden = !next;
    if (!next) return;
    vertex = next.vertex;
    if (!keep || !bounds) { bounds = around(next.reach ?? next.vertex); it.zoom = 1; }
    redraw();
  }
  /** Other places of the same vertices. */
  function move(places, tone = null) { if (!body) return; vertex = places ?? body.vertex; if (tone) body.face_tone = tone; lively(); }
  function around(points) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < points.length; i += 1) { const k = i % 3; low[k] = Math.min(low[k], points[i]); high[k] = Math.max(high[k], points[i]); }
    return { low, high };
  }
  new ResizeObserver(() => redraw()).observe(frame);
  function lively() {
    clearTimeout(rest);
    if (!drawing) drawing = requestAnimationFrame(() => { drawing = null; paint(1); });
    rest = setTimeout(() => paint(FINE), 160);
  }
  function redraw() { if (body && !frame.hidden) paint(FINE); }

  function projection() {
    const w = frame.clientWidth, hgt = frame.clientHeight, [right, up, eye] = axes(it.azimuth, it.elevation);
    const { low, high } = bounds, corners = [];
    for (const x of [low[0], high[0]]) for (const y of [low[1], high[1]]) for (const z of [low[2], high[2]]) corners.push([x, y, z]);
    const on = (axis) => corners.map((c) => c[0] * axis[0] + c[1] * axis[1] + c[2] * axis[2]);
    const xs = on(right), ys = on(up), x0 = Math.min(...xs), x1 = Math.max(...xs), y0 = Math.min(...ys), y1 = Math.max(...ys);
    const k = it.zoom * Math.min((w - 60) / Math.max(x1 - x0, 1e-9), (hgt - 90) / Math.max(y1 - y0, 1e-9));
    return { w, hgt, right, up, eye, k, left: w / 2 - (k * (x0 + x1)) / 2, base: (hgt - 30) / 2 + (k * (y0 + y1)) / 2 };
  }
  function paint(fine) {
    if (!body || frame.hidden || !frame.clientWidth || !frame.clientHeight) return;
    const p = projection(), width = Math.round(p.w * fine), height = Math.round(p.hgt * fine), k = p.k * fine;
    const { face, face_start: start, face_tone: tone } = body, n = vertex.length / 3;
    const px = new Float32Array(n), py = new Float32Array(n), pz = new Float32Array(n);
    for (let i = 0; i < n; i += 1) {
      const x = vertex[3 * i], y = vertex[3 * i + 1], z = vertex[3 * i + 2];
      px[i] = fine * p.left + k * (p.right[0] * x + p.right[1] * y + p.right[2] * z);
      py[i] = fine * p.base - k * (p.up[0] * x + p.up[1] * y + p.up[2] * z);
      pz[i] = k * (p.eye[0] * x + p.eye[1] * y + p.eye[2] * z);
    }
    const depth = new Float32Array(width * height).fill(-Infinity), number = new Int32Array(width * height).fill(-1);
    const style = getComputedStyle(frame), colours = TONES.map((name) => rgb(style.getPropertyValue(name)));
    const edge = rgb(style.getPropertyValue("--stone-edge")), ground = rgb(style.getPropertyValue("--earth"));
    const shade = new Uint8ClampedArray(3 * (start.length + 1));
    for (let f = 0; f + 1 < start.length; f += 1) {
      const corners = Array.from(face.subarray(start[f], start[f + 1]));
      if (!fill(f, corners.map((c) => px[c]), corners.map((c) => py[c]), corners.map((c) => pz[c]), body.both)) continue;
      const light = lit(corners, body.both), colour = colours[tone ? tone[f] : 0];
      for (let c = 0; c < 3; c += 1) shade[3 * f + c] = colour[c] * light;
    }
    // the ground, a sheet somewhat larger than the plan
    const sheet = start.length, room = 0.06 * Math.max(...[0, 1, 2].map((i) => bounds.high[i] - bounds.low[i])), z = bounds.low[2] - 1e-4 * room;
    const [x0, y0, x1, y1] = [bounds.low[0] - room, bounds.low[1] - room, bounds.high[0] + room, bounds.high[1] + room];
    const plan = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(([x, y]) => [
      fine * p.left + k * (p.right[0] * x + p.right[1] * y), fine * p.base - k * (p.up[0] * x + p.up[1] * y + p.up[2] * z), k * (p.eye[0] * x + p.eye[1] * y + p.eye[2] * z)]);
    fill(sheet, plan.map((c) => c[0]), plan.map((c) => c[1]), plan.map((c) => c[2]), true);
    for (let c = 0; c < 3; c += 1) shade[3 * sheet + c] = ground[c];
    canvas.width = width; canvas.height = height;
    const context = canvas.getContext("2d"), image = context.createImageData(width, height), data = image.data;
    const soft = body.both ? 0.35 : 1;
    for (let i = 0; i < number.length; i += 1) {
      const f = number[i];
      if (f < 0) continue;
      const line = f !== sheet && ((i % width && number[i - 1] !== f) || (i >= width && number[i - width] !== f)) ? soft : 0;
      for (let c = 0; c < 3; c += 1) data[4 * i + c] = line * edge[c] + (1 - line) * shade[3 * f + c];
      data[4 * i + 3] = f === sheet ? 130 : 255;
    }
    context.putImageData(image, 0, 0);
    seen = { number, width, height, fine, sheet };
    overlay(p);

    /** A convex face where it is nearest to the eye; false where it looks away. */
    function fill(f, x, y, depths, both) {
      const m = x.length;
      let nx = 0, ny = 0, nz = 0;
      for (let i = 0; i < m; i += 1) {
        const j = (i + 1) % m;
        nx += (y[i] - y[j]) * (depths[i] + depths[j]); ny += (depths[i] - depths[j]) * (x[i] + x[j]); nz += (x[i] - x[j]) * (y[i] + y[j]);
      }
      if (Math.abs(nz) < 1e-9 || (!both && nz > 0)) return false; // y of the picture points down, which turns the sense
      let low = Infinity, high = -Infinity;
      for (const v of y) { low = Math.min(low, v); high = Math.max(high, v); }
      for (let row = Math.max(0, Math.ceil(low)); row <= Math.min(height - 1, Math.floor(high)); row += 1) {
        let from = Infinity, to = -Infinity;
        for (let i = 0; i < m; i += 1) {
          const j = (i + 1) % m, a = y[i], b = y[j];
          if ((row < a) === (row < b) && row !== a && row !== b) continue;
          if (a === b) { from = Math.min(from, x[i], x[j]); to = Math.max(to, x[i], x[j]); continue; }
          const at = x[i] + ((row - a) / (b - a)) * (x[j] - x[i]);
          from = Math.min(from, at); to = Math.max(to, at);
        }
        const first = Math.max(0, Math.ceil(from)), last = Math.min(width - 1, Math.floor(to));
        let d = depths[0] - (nx * (first - x[0]) + ny * (row - y[0])) / nz;
        for (let i = row * width + first; i <= row * width + last; i += 1, d -= nx / nz) if (d > depth[i]) { depth[i] = d; number[i] = f; }
      }
      return true;
    }
  }
  /** The body that is drawn at a place of the page [px]; null for the ground and beside all. */
  function pick(x, y) {
    const edge = frame.getBoundingClientRect(), [column, row] = [x - edge.left, y - edge.top].map((v) => Math.floor(v * (seen?.fine ?? 1)));
    if (!seen || !body?.face_body || column < 0 || row < 0 || column >= seen.width || row >= seen.height) return null;
    const f = seen.number[row * seen.width + column];
    return f < 0 || f === seen.sheet ? null : body.face_body[f];
  }
  /** How bright a face is; one of two sides is lit on that which is seen. */
  function lit(corners, both) {
    const at = (i, k) => vertex[3 * corners[i] + k];
    const normal = [0, 0, 0];
    for (let i = 1; i + 1 < corners.length; i += 1) {
      const add = cross([0, 1, 2].map((k) => at(i, k) - at(0, k)), [0, 1, 2].map((k) => at(i + 1, k) - at(0, k)));
      for (let k = 0; k < 3; k += 1) normal[k] += add[k];
    }
    const size = Math.hypot(...normal) || 1;
    let on = (normal[0] * LIGHT[0] + normal[1] * LIGHT[1] + normal[2] * LIGHT[2]) / size;
    if (both) { const eye = axes(it.azimuth, it.elevation)[2]; if (normal[0] * eye[0] + normal[1] * eye[1] + normal[2] * eye[2] < 0) on = -on; }
    return DARKEST + (1 - DARKEST) * Math.max(0, on);
  }
  function rgb(text) {
    const t = text.trim(), wide = t.length === 4 ? [1, 2, 3].map((i) => t[i] + t[i]) : [1, 3, 5].map((i) => t.slice(i, i + 2));
    return wide.map((part) => Number.parseInt(part, 16));
  }

  /** Axes, scale, bars, and where it is pushed. */
  function overlay(p) {
    const { w, hgt, right, up } = p, parts = [], place = (x, y, z) => [p.left + p.k * (right[0] * x + right[1] * y + right[2] * z), p.base - p.k * (up[0] * x + up[1] * y + up[2] * z)];
    set(svg, { viewBox: `0 0 ${w} ${hgt}`, width: w, height: hgt, "aria-label": tr`${it.label} Seen from ${Math.round(it.azimuth)} degrees in plan and ${Math.round(it.elevation)} above; arrow keys turn it.` });
    for (let i = 0; body.bar && i < body.bar.length; i += 6) {
      const [a, b] = [place(...body.bar.subarray(i, i + 3)), place(...body.bar.subarray(i + 3, i + 6))];
      parts.push(s("line", { class: "tie", x1: a[0], y1: a[1], x2: b[0], y2: b[1] }));
    }
    const [ox, oy] = [w - 60, hgt - 44];
    ["x", "y", "z"].forEach((name, k) => {
      const [dx, dy] = [34 * right[k], -34 * up[k]];
      parts.push(s("line", { class: "axis", x1: ox, y1: oy, x2: ox + dx, y2: oy + dy }), s("text", { x: ox + 1.3 * dx, y: oy + 1.3 * dy + 4, "text-anchor": "middle", text: name }));
    });
    const wish = 100 / p.k, power = 10 ** Math.floor(Math.log10(wish)), step = [1, 2, 5].map((m) => m * power).filter((v) => v <= wish).pop() ?? power;
    parts.push(s("path", { class: "scale", d: `M14 ${hgt - 18}V${hgt - 14}H${14 + step * p.k}V${hgt - 18}` }), s("text", { x: 20 + step * p.k, y: hgt - 13, text: quantity(step, "m", 1) }));
    if (body.push !== undefined) {
      const turn = (body.push * Math.PI) / 180, way = [Math.cos(turn), Math.sin(turn), 0], dx = 60 * (right[0] * way[0] + right[1] * way[1]), dy = -60 * (up[0] * way[0] + up[1] * way[1]);
      const size = Math.hypot(dx, dy) || 1, [ux, uy] = [dx / size, dy / size], [ax, ay] = [w / 2, hgt - 40];
      parts.push(s("path", { class: "push", d: `M${ax} ${ay}L${ax + dx} ${ay + dy}M${ax + dx - 9 * ux - 5 * uy} ${ay + dy - 9 * uy + 5 * ux}L${ax + dx} ${ay + dy}L${ax + dx - 9 * ux + 5 * uy} ${ay + dy - 9 * uy - 5 * ux}` }), s("text", { x: ax, y: ay + 30, "text-anchor": "middle", text: tr`load along ${body.push}°` }));
    }
    svg.replaceChildren(...parts);
  }

  function turn(dx, dy) {
    it.azimuth = ((it.azimuth - dx + 540) % 360) - 180;
    it.elevation = Math.min(88, Math.max(3, it.elevation + dy));
    lively();
  }
  svg.addEventListener("pointerdown", (e) => {
    if (e.button !== 0) return;
    svg.setPointerCapture(e.pointerId);
    let [x, y] = [e.clientX, e.clientY];
    const begin = [x, y];
    const go = (m) => { turn(0.4 * (m.clientX - x), 0.4 * (m.clientY - y)); [x, y] = [m.clientX, m.clientY]; };
    const end = (u) => {
      svg.removeEventListener("pointermove", go);
      if (u.type === "pointerup" && Math.hypot(u.clientX - begin[0], u.clientY - begin[1]) < STILL) it.onpick?.(pick(u.clientX, u.clientY));
    };
    svg.addEventListener("pointermove", go);
    svg.addEventListener("pointerup", end, { once: true });
    svg.addEventListener("pointercancel", end, { once: true });
  });
  svg.addEventListener("wheel", (e) => { e.preventDefault(); it.zoom = Math.min(8, Math.max(0.5, it.zoom * Math.exp(-0.0015 * e.deltaY))); lively(); }, { passive: false });
  svg.addEventListener("keydown", (e) => {
    const step = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] }[e.key];
    if (step) turn(...step);
    else if (e.key === "+" || e.key === "-") { it.zoom = Math.min(8, Math.max(0.5, it.zoom * (e.key === "+" ? 1.15 : 1 / 1.15))); lively(); }
    else return;
    e.preventDefault();
  });
  return it;
}
