// The drawing of a structure: blocks, lines of thrust, hinges, loads, reactions, and handles.
import { degrees, number, quantity, s, set, shapes } from "./dom.js";
import { pinch } from "./gestures.js";
import { said } from "./said.js";
import { tr } from "./words.js";

const LINES = [
  ["least", tr`least thrust`], ["most", tr`greatest thrust`], ["through", tr`thrust through the point`],
  ["plus", tr`collapse, load to +x`], ["minus", tr`collapse, load to −x`], ["central", tr`most central`],
];
const CLOSE = { fine: 26, coarse: 44 }; // px between the centres of handles, by the finger or the mouse
const MANY = 24; // handles beyond which they stay where they are, and the nearest one is taken
const LOUPE = 58; // px, its radius

/** Places (px) moved apart until no two are nearer than `reach`; the one numbered `fixed` stays. All stay within w x h. */
export function spread(places, reach, fixed, w, h) {
  const out = places.map((p) => [...p]), edge = reach / 2;
  for (let round = 0; round < 80; round += 1) {
    let moved = false;
    for (let i = 0; i < out.length; i += 1) for (let k = i + 1; k < out.length; k += 1) {
      let dx = out[k][0] - out[i][0], dy = out[k][1] - out[i][1], apart = Math.hypot(dx, dy);
      if (apart >= reach - 0.5) continue;
      if (apart < 1e-6) { dx = 1; dy = 0; apart = 1; }
      moved = true;
      const push = (reach - Math.hypot(out[k][0] - out[i][0], out[k][1] - out[i][1])) / apart, share = i === fixed ? 0 : k === fixed ? 1 : 0.5;
      out[i] = [out[i][0] - share * push * dx, out[i][1] - share * push * dy];
      out[k] = [out[k][0] + (1 - share) * push * dx, out[k][1] + (1 - share) * push * dy];
    }
    for (const [i, p] of out.entries()) if (i !== fixed) { p[0] = Math.min(Math.max(p[0], edge), w - edge); p[1] = Math.min(Math.max(p[1], edge), h - edge); }
    if (!moved) break;
  }
  return out;
}
const f = (v) => (Math.round(v * 1e4) / 1e4).toString();

/** Outlines as one path; pose (blocks x 3) moves each stone from its centroid: a array of x, y, rotation. */
export function stonesPath(outline, start, centroid = null, pose = null) {
  let d = "";
  for (let b = 0; b + 1 < start.length; b += 1) {
    let c = 1, si = 0, gx = 0, gy = 0, px = 0, py = 0;
    if (pose) {
      const at = 3 * b, turn = pose[at + 2];
      c = Math.cos(turn); si = Math.sin(turn); gx = centroid[2 * b]; gy = centroid[2 * b + 1]; px = pose[at]; py = pose[at + 1];
    }
    for (let i = start[b]; i < start[b + 1]; i += 1) {
      let x = outline[2 * i], y = outline[2 * i + 1];
      if (pose) { const dx = x - gx, dy = y - gy; x = px + c * dx - si * dy; y = py + si * dx + c * dy; }
      d += `${i === start[b] ? "M" : "L"}${f(x)} ${f(y)}`;
    }
    d += "Z";
  }
  return d;
}
export function piecesPath(line, start) {
  let d = "";
  for (let k = 0; k + 1 < start.length; k += 1) {
    let pen = false;
    for (let i = start[k]; i < start[k + 1]; i += 1) {
      const x = line[2 * i], y = line[2 * i + 1];
      if (!Number.isFinite(x + y)) { pen = false; continue; }
      d += `${pen ? "L" : "M"}${f(x)} ${f(y)}`;
      pen = true;
    }
  }
  return d;
}

/** The stage. `hands`: {drag(name, place, ends), step(name, dx, dy), type(name), through(place), tilt(gamma, ends)} */
export function stage(box, hands) {
  const svg = s("svg", { class: "stage", role: "group", "aria-label": tr`Drawing of the structure` });
  const world = s("g"), screen = s("g"), overlay = s("g");
  const ground = s("path", { class: "ground" }), earth = s("path", { class: "earth" });
  const ties = s("path", { class: "tie" }), dampers = s("path", { class: "tie damper" }), mass = s("path", { class: "mass" }), stones = s("path", { class: "stones" }), ghost = s("path", { class: "ghost" });
  const joints = s("path", { class: "joints" }), supports = s("path", { class: "supports" });
  const lines = Object.fromEntries(LINES.map(([name]) => [name, s("path", { class: `thrust ${name}` })]));
  const dynamic = s("path", { class: "thrust dynamic" });
  const marks = s("g", { class: "marks" }), loads = s("g"), knobs = s("g", { class: "knobs" }), ruler = s("g", { class: "ruler" });
  world.append(earth, supports, ghost, stones, mass, joints, ties, dampers, ...Object.values(lines), dynamic);
  for (const part of world.children) part.setAttribute("vector-effect", "non-scaling-stroke"); // in the loupe too
  svg.append(ground, world, screen, overlay);
  screen.append(ruler, loads, marks, knobs);
  const mark = Math.random().toString(36).slice(2);
  world.id = `world-${mark}`; marks.id = `marks-${mark}`;
  const inside = s("g", {}, s("use", { href: `#${world.id}` }), s("use", { href: `#${marks.id}` }));
  const loupe = s("g", { class: "loupe", visibility: "hidden", "aria-hidden": "true" }, s("defs", {}, s("clipPath", { id: `clip-${mark}` }, s("circle", { r: LOUPE }))),
    s("g", { "clip-path": `url(#clip-${mark})` }, s("circle", { class: "paper", r: LOUPE }), inside, s("path", { class: "cross", d: "M-9 0H9M0 -9V9" })), s("circle", { class: "rim", r: LOUPE }));
  overlay.append(loupe);
  box.append(svg);
  const coarse = matchMedia("(pointer: coarse)");
  const it = { svg, show, fit, pose, moving, held, clear, lines, screenOf, modelOf, layers: null, bounds: null, scene: null, redraw, tip: null, setTheta, zoom, drawn: () => true };
  const view = { k: 50, cx: 0, cy: 0, theta: 0, w: 800, h: 500, free: false };
  const knob = new Map();
  let dragging = null, shownPose = null, last = null, fresh = true;

  new ResizeObserver(() => {
    const { clientWidth: w, clientHeight: h } = box;
    if (!w || !h) return;
    view.w = w; view.h = h;
    set(svg, { viewBox: `0 0 ${w} ${h}`, width: w, height: h });
    if (it.bounds) { fit(); redraw(); }
  }).observe(box);

  /** Screen places of model ones, and back; the ground turns by theta, clockwise, about the origin. */
  function screenOf(x, y) {
    const c = Math.cos(view.theta), n = Math.sin(view.theta);
    return [view.cx + view.k * (c * x + n * y), view.cy - view.k * (c * y - n * x)];
  }
  function modelOf(px, py, theta = view.theta) {
    const u = (px - view.cx) / view.k, v = (view.cy - py) / view.k, c = Math.cos(theta), n = Math.sin(theta);
    return [c * u - n * v, n * u + c * v];
  }
  function setTheta(theta) { view.theta = theta; }

  /** Fit what is there, with room for handles around it. */
  function fit(anew = false) {
    if (!it.bounds || (view.free && !anew)) return;
    view.free = false;
    const [a0, b0, a1, b1] = it.bounds, size = Math.max(a1 - a0, b1 - b0, 1e-9);
    const room = { left: 40, right: 46, top: 50, bottom: 44 };
    // what the ground's turn makes of the building and the ground beside it
    const c = Math.cos(view.theta), n = Math.sin(view.theta), reach = 0.12 * (a1 - a0);
    const turned = [[a0, b1], [a1, b1], [a0, b0], [a1, b0], [a0 - reach, 0], [a1 + reach, 0]].map(([x, y]) => [c * x + n * y, c * y - n * x]);
    const xs = turned.map((p) => p[0]), ys = turned.map((p) => p[1]);
    const x0 = Math.min(...xs), x1 = Math.max(...xs), y0 = Math.min(...ys), y1 = Math.max(...ys, y0 + 0.2 * size);
    if (view.h < 3 * (room.top + room.bottom)) { room.top = view.h / 6; room.bottom = view.h / 6; } // a phone held sideways
    const k = Math.min((view.w - room.left - room.right) / (x1 - x0), (view.h - room.top - room.bottom) / (y1 - y0));
    view.k = Math.max(k, 1e-6);
    view.cx = room.left + (view.w - room.left - room.right) / 2 - (view.k * (x0 + x1)) / 2;
    view.cy = room.top + (view.h - room.top - room.bottom) / 2 + (view.k * (y0 + y1)) / 2;
  }
  function boundsOf(outline) {
    let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
    for (let i = 0; i < outline.length; i += 2) {
      const x = outline[i], y = outline[i + 1];
      if (x < x0) x0 = x; if (x > x1) x1 = x; if (y < y0) y0 = y; if (y > y1) y1 = y;
    }
    return [x0, y0, x1, y1];
  }
  function outside() {
    const [x0, y0, x1, y1] = it.bounds;
    const corners = [[x0, y0], [x1, y1], [x0, y1], [x1, y0]].map(([x, y]) => screenOf(x, y));
    const px = corners.map((c) => c[0]), py = corners.map((c) => c[1]);
    const far = Math.min(...px) < 18 || Math.max(...px) > view.w - 18 || Math.min(...py) < 30 || Math.max(...py) > view.h - 18;
    return far || Math.max((Math.max(...px) - Math.min(...px)) / view.w, (Math.max(...py) - Math.min(...py)) / view.h) < 0.3;
  }

  /** A scene of the session. */
  function show(scene, arrays, handles, opened = false) {
    it.scene = { scene, arrays, handles };
    last = arrays;
    if (!arrays.outline) { clear(); return; }
    it.bounds = boundsOf(arrays.outline);
    if (opened || fresh) { shownPose = null; fit(true); fresh = false; }
    else if (!dragging && outside()) fit();
    redraw();
  }
  /** Enlarge the drawing about a place on the screen; null fits it into the stage again. */
  function zoom(by, x = view.w / 2, y = view.h / 2) {
    if (by === null) fit(true);
    else {
      view.free = true;
      view.k *= by; view.cx = x + by * (view.cx - x); view.cy = y + by * (view.cy - y);
    }
    redraw();
  }
  svg.addEventListener("wheel", (event) => {
    event.preventDefault();
    const edge = svg.getBoundingClientRect();
    zoom(1.0015 ** -event.deltaY, event.clientX - edge.left, event.clientY - edge.top);
  }, { passive: false });
  pinch(svg, {
    begin: () => { dragging = null; set(loupe, { visibility: "hidden" }); },
    zoom: (by, x, y, dx, dy) => { view.cx += dx; view.cy += dy; zoom(by, x, y); },
  });
  function clear() {
    it.bounds = null; shownPose = null;
    for (const part of [stones, ties, dampers, mass, ghost, joints, supports, earth, dynamic, ground, ...Object.values(lines)]) set(part, { d: "" });
    marks.replaceChildren(); loads.replaceChildren(); ruler.replaceChildren();
    for (const element of knob.values()) element.remove();
    knob.clear();
  }
  function redraw() {
    if (!it.scene || !it.scene.arrays.outline) return;
    const { scene, arrays, handles } = it.scene, layers = it.layers ?? {};
    const c = view.k * Math.cos(view.theta), n = view.k * Math.sin(view.theta);
    set(world, { transform: `matrix(${c} ${n} ${n} ${-c} ${view.cx} ${view.cy})` });
    if (!shownPose) {
      set(stones, { d: stonesPath(arrays.outline, arrays.outline_start) });
      set(ghost, { d: "" });
    } else drawPose();
    stones.classList.toggle("elements", Boolean(scene.seen));
    let d = "";
    if (layers.joints !== false && !shownPose) for (let j = 0; j < arrays.joint_p.length; j += 2) d += `M${f(arrays.joint_p[j])} ${f(arrays.joint_p[j + 1])}L${f(arrays.joint_q[j])} ${f(arrays.joint_q[j + 1])}`;
    set(joints, { d });
    set(earth, { d: arrays.earth ? `M${Array.from({ length: arrays.earth.length / 2 }, (_, i) => `${f(arrays.earth[2 * i])} ${f(arrays.earth[2 * i + 1])}`).join("L")}Z` : "" });
    for (const [path, ends] of [[ties, arrays.ties], [dampers, arrays.dampers]]) {
      d = "";
      if (ends && !shownPose) for (let i = 0; i < ends.length; i += 4) d += `M${f(ends[i])} ${f(ends[i + 1])}L${f(ends[i + 2])} ${f(ends[i + 3])}`;
      set(path, { d });
    }
    const [x0, , x1, top] = it.bounds, r = 0.05 * (top - it.bounds[1]), middle = (x0 + x1) / 2;
    set(mass, { d: scene.head_mass_kg && !shownPose ? `M${f(middle - r)} ${f(top)}a${f(r)} ${f(r)} 0 1 0 ${f(2 * r)} 0a${f(r)} ${f(r)} 0 1 0 ${f(-2 * r)} 0Z` : "" });
    for (const [name, path] of Object.entries(lines)) {
      const drawn = it.drawn(name) && !shownPose && arrays[`${name}_line`];
      set(path, { d: drawn ? piecesPath(arrays[`${name}_line`], arrays[`${name}_start`]) : "" });
    }
    supported(arrays, scene.abutting_wall);
    drawGround(scene);
    drawMarks(scene, layers);
    drawLoads(scene);
    drawKnobs(handles ?? [], scene);
  }
  function supported(arrays, wall) {
    let d = "";
    const size = 0.02 * Math.max(it.bounds[2] - it.bounds[0], it.bounds[3] - it.bounds[1]);
    for (let j = 0; j < arrays.joint_p.length / 2; j += 1) {
      if (arrays.joint_block[2 * j] !== -1 && arrays.joint_block[2 * j + 1] !== -1) continue;
      const b = arrays.joint_block[2 * j] === -1 ? arrays.joint_block[2 * j + 1] : arrays.joint_block[2 * j];
      const px = arrays.joint_p[2 * j], py = arrays.joint_p[2 * j + 1], qx = arrays.joint_q[2 * j], qy = arrays.joint_q[2 * j + 1];
      let nx = -(qy - py), ny = qx - px;
      const length = Math.hypot(nx, ny) || 1;
      nx /= length; ny /= length;
      const side = (arrays.centroid[2 * b] - px) * nx + (arrays.centroid[2 * b + 1] - py) * ny > 0 ? -1 : 1;
      d += `M${f(px)} ${f(py)}L${f(qx)} ${f(qy)}L${f(qx + side * nx * size)} ${f(qy + side * ny * size)}L${f(px + side * nx * size)} ${f(py + side * ny * size)}Z`;
    }
    for (let i = 0; arrays.held && i < arrays.held.length; i += 2) {
      const [x, y] = [arrays.held[i], arrays.held[i + 1]];
      d += `M${f(x)} ${f(y)}l${f(-0.3 * size)} ${f(-0.6 * size)}h${f(0.6 * size)}Z`;
    }
    if (wall) {
      const [x0, y0, x1, y1] = it.bounds;
      d += `M${f(wall === "left" ? x0 : x1)} ${f(y0)}V${f(y1)}h${f(wall === "left" ? -size : size)}V${f(y0)}Z`;
    }
    set(supports, { d });
  }
  function drawGround(scene) {
    const [x0, , x1] = it.bounds, size = x1 - x0, level = 0;
    const a = screenOf(x0 - 0.12 * size, level), b = screenOf(x1 + 0.12 * size, level);
    set(ground, { d: `M${a[0]} ${a[1]}L${b[0]} ${b[1]}` });
    // a scale, round in metres
    const wish = 90 / view.k, power = 10 ** Math.floor(Math.log10(wish)), step = [1, 2, 5].map((m) => m * power).filter((v) => v <= wish).pop() ?? power;
    const x = 14, y = view.h - 14;
    shapes(ruler, [
      { tag: "path", d: `M${x} ${y - 4}V${y}H${x + step * view.k}V${y - 4}` },
      { tag: "text", x: x + step * view.k + 6, y: y + 1, text: quantity(step, "m", 1) },
      ...(view.theta ? [{ tag: "text", x: view.w - 14, y: 18, "text-anchor": "end", text: tr`ground tilted by ${number(degrees(scene.gamma), 3)}°, equivalent to ${number(scene.gamma, 3)} g horizontally` }] : []),
    ]);
  }
  function drawMarks(scene, layers) {
    const parts = [];
    const hinge = (h, name) => {
      const [x, y] = screenOf(...h.at);
      parts.push({ tag: "circle", class: `hinge ${name}`, cx: x, cy: y, r: 5.5, title: `${h.where} (${h.name})` });
    };
    if (!shownPose) {
      for (const name of ["plus", "minus"]) if (it.drawn(name)) for (const h of scene[`${name}_hinges`] ?? []) hinge(h, name);
      for (const name of ["plus", "minus"]) if (it.drawn(name)) for (const j of scene[`${name}_sliding`] ?? []) {
        const [x, y] = screenOf(...j.at);
        parts.push({ tag: "path", class: `slide ${name}`, d: `M${x - 6} ${y}h12m-4 -4l4 4l-4 4`, title: tr`slides: ${j.name}` });
      }
      for (const name of ["least", "most"]) if (layers[name] && scene[`${name}_touches`]?.length) {
        const squares = scene[`${name}_touches`].map((at) => screenOf(...at).map((v) => (v - 3).toFixed(1)).join(" "));
        parts.push({ tag: "path", class: `touch ${name}`, d: squares.map((at) => `M${at}h6v6h-6Z`).join("") });
      }
    }
    if (layers.reactions && !shownPose) for (const r of scene.reactions ?? []) {
      const size = Math.hypot(r.x_N, r.y_N) || 1, c = Math.cos(view.theta), n = Math.sin(view.theta);
      const ux = (c * r.x_N + n * r.y_N) / size, uy = -(c * r.y_N - n * r.x_N) / size;
      const [x, y] = screenOf(...r.at), long = 20 + (34 * size) / (scene.weight_N || size);
      const [a, b] = [x - ux * long, y - uy * long], across = [-uy, ux];
      parts.push({ tag: "path", class: "reaction", d: `M${a} ${b}L${x} ${y}m${-ux * 8 + across[0] * 4} ${-uy * 8 + across[1] * 4}L${x} ${y}L${x - ux * 8 - across[0] * 4} ${y - uy * 8 - across[1] * 4}`,
        title: tr`reaction at ${r.name}: ${quantity(r.x_N, "N", 3)} across, ${quantity(r.y_N, "N", 3)} up` });
    }
    shapes(marks, shownPose?.falling ? openJoints() : parts);
  }
  function drawLoads(scene) {
    shapes(loads, (scene.loads ?? []).filter((l) => l.force_N).map((l) => {
      const [x, y] = screenOf(...l.at), [a, b] = screenOf(l.at[0], l.at[1] + l.scale * l.force_N);
      const ux = x - a, uy = y - b, size = Math.hypot(ux, uy) || 1, [vx, vy] = [ux / size, uy / size];
      return { tag: "path", class: "load", d: `M${a} ${b}L${x} ${y}M${x - vx * 9 - vy * 4} ${y - vy * 9 + vx * 4}L${x} ${y}L${x - vx * 9 + vy * 4} ${y - vy * 9 - vx * 4}`, title: tr`load of ${quantity(l.force_N, "N", 4)}` };
    }));
  }

  // Handles

  function drawKnobs(handles, scene) {
    const wanted = new Map();
    if (!shownPose || shownPose.falling) {
      for (const h of handles) wanted.set(h.name, { ...h, text: Array.isArray(h.value) ? `${number(h.value[0])}; ${number(h.value[1])} m` : quantity(h.value, h.unit), now: Array.isArray(h.value) ? h.value[0] : h.value });
      if (scene.through && it.layers?.through) {
        const t = scene.through;
        wanted.set("through", { name: "through", label: tr`Thrust line through ${said(t.name)}`, at: t.at, along: "both", text: tr`at ${number(t.reached, 3)} of the joint, ${quantity(t.thrust_N, "N", 4)}`, now: t.reached, sort: "through" });
      }
      const [, , x1] = it.bounds, reach = x1 + 0.1 * (x1 - it.bounds[0]);
      if (!scene.seen) wanted.set("tilt", { name: "tilt", label: tr`Tilt of the ground`, at: [reach, 0], along: "y", text: `${number(degrees(scene.gamma), 3)}°, ${number(scene.gamma, 3)} g`, now: scene.gamma, sort: "tilt" });
    }
    for (const [name, element] of knob) if (!wanted.has(name)) { element.remove(); knob.delete(name); }
    const names = [...wanted.keys()], places = names.map((name) => screenOf(...wanted.get(name).at));
    const apart = names.length > MANY ? places : spread(places, coarse.matches ? CLOSE.coarse : CLOSE.fine, names.indexOf(dragging?.name), view.w, view.h);
    for (const [i, [name, w]] of [...wanted].entries()) {
      let element = knob.get(name);
      if (!element) { element = make(name, w); knob.set(name, element); knobs.append(element); }
      const [x, y] = apart[i];
      element.at = apart[i];
      set(element, { transform: `translate(${x} ${y})` });
      set(element.leader, { x2: places[i][0] - x, y2: places[i][1] - y });
      if (element.now !== w.text) {
        element.now = w.text;
        set(element, { "aria-valuenow": number(w.now, 6).replace("−", "-"), "aria-valuetext": w.text });
        element.tag.textContent = `${w.label}  ${w.text}`;
        fitTag(element);
      }
      element.data = w;
    }
  }
  function fitTag(element) {
    const width = 12 + element.tag.textContent.length * 6.3;
    const left = element.at && element.at[0] > view.w - width - 20;
    set(element.back, { width, x: left ? -width - 12 : 12 });
    set(element.tag, { x: left ? -width - 6 : 18 });
  }
  function make(name, w) {
    const tag = s("text", { y: -12 }), back = s("rect", { y: -26, height: 20, rx: 4 });
    const shape = w.along === "x" ? "M-9 0L-4 -5V5ZM9 0L4 -5V5Z" : w.along === "y" ? "M0 -9L-5 -4H5ZM0 9L-5 4H5Z" : "";
    const element = s("g", { class: `knob ${w.sort ?? ""}`, role: "slider", tabindex: "0", "aria-label": w.label, "data-handle": name, "aria-keyshortcuts": "ArrowLeft ArrowRight ArrowUp ArrowDown Enter" },
      s("line", { class: "leader", x1: 0, y1: 0 }), s("circle", { class: "hit", r: coarse.matches ? CLOSE.coarse / 2 : 15 }), shape ? s("path", { class: "arrows", d: shape }) : null, s("circle", { class: "dot", r: w.along === "both" ? 6 : 4 }), s("g", { class: "tag" }, back, tag));
    element.leader = element.firstElementChild;
    element.tag = tag; element.back = back; element.data = w;
    element.addEventListener("pointerdown", (event) => grab(event, element));
    element.addEventListener("pointerenter", () => fitTag(element));
    element.addEventListener("focus", () => fitTag(element));
    element.addEventListener("dblclick", () => hands.type(name, element.data));
    element.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (step) { const m = event.shiftKey ? 10 : 1; hands.step(name, step[0] * m, step[1] * m, element.data); event.preventDefault(); }
      else if (event.key === "Enter") { hands.type(name, element.data); event.preventDefault(); }
    });
    return element;
  }
  /** The handle nearest to a pointer, of many that cover each other. */
  function nearest(event) {
    const edge = svg.getBoundingClientRect(), far = (e) => Math.hypot(event.clientX - edge.left - e.at[0], event.clientY - edge.top - e.at[1]);
    return [...knob.values()].reduce((best, e) => (far(e) < far(best) ? e : best));
  }
  /** An enlarged picture of what a finger covers. */
  function drawLoupe(event) {
    if (!dragging || event.pointerType === "mouse") return;
    const x = event.clientX - dragging.edge.left, y = event.clientY - dragging.edge.top, above = y > 2.8 * LOUPE;
    const cx = Math.min(Math.max(above ? x : x + (x > view.w / 2 ? -2 : 2) * LOUPE, LOUPE), view.w - LOUPE), cy = above ? y - 1.8 * LOUPE : Math.max(y, LOUPE);
    set(loupe, { visibility: "visible", transform: `translate(${cx} ${cy})` });
    set(inside, { transform: `scale(2) translate(${-(x - dragging.dx)} ${-(y - dragging.dy)})` });
  }
  function grab(event, touched) {
    if (event.button !== 0) return;
    const element = knob.size > MANY ? nearest(event) : touched;
    event.preventDefault();
    element.focus({ preventScroll: true });
    element.setPointerCapture(event.pointerId);
    const edge = svg.getBoundingClientRect(), at = screenOf(...element.data.at); // a knob moved aside is led as from its own place
    dragging = { name: element.data.name, dx: event.clientX - edge.left - at[0], dy: event.clientY - edge.top - at[1], edge, theta: view.theta };
    element.classList.add("held");
    // Raw positions come as the hand moves, those of pointermove wait for the next picture.
    const kind = "onpointerrawupdate" in window ? "pointerrawupdate" : "pointermove";
    const move = (e) => moved(e, false);
    const up = (e) => {
      element.removeEventListener(kind, move);
      element.classList.remove("held");
      if (e.type === "pointerup") moved(e, true);
      dragging = null;
      set(loupe, { visibility: "hidden" });
      if (it.bounds && outside()) { fit(); redraw(); }
    };
    element.addEventListener(kind, move);
    element.addEventListener("pointerup", up, { once: true });
    element.addEventListener("pointercancel", up, { once: true });
  }
  /** The line through a point is dragged from where the stones are pressed. */
  svg.addEventListener("pointerdown", (event) => {
    if (event.target.closest?.(".knob")) return;
    if (!hands.begin(event)) { if (view.free && event.button === 0 && event.pointerType !== "touch") shift(event); return; }
    svg.setPointerCapture(event.pointerId);
    dragging = { name: "through", dx: 0, dy: 0, edge: svg.getBoundingClientRect(), theta: view.theta };
    const move = (e) => moved(e, false);
    const up = () => { svg.removeEventListener("pointermove", move); dragging = null; set(loupe, { visibility: "hidden" }); };
    svg.addEventListener("pointermove", move);
    svg.addEventListener("pointerup", up, { once: true });
    svg.addEventListener("pointercancel", up, { once: true });
  });
  /** An enlarged drawing follows the pointer that holds it beside the blocks. */
  function shift(event) {
    svg.setPointerCapture(event.pointerId);
    const move = (e) => { view.cx += e.movementX; view.cy += e.movementY; redraw(); };
    const up = () => svg.removeEventListener("pointermove", move);
    svg.addEventListener("pointermove", move);
    svg.addEventListener("pointerup", up, { once: true });
    svg.addEventListener("pointercancel", up, { once: true });
  }
  function moved(event, ends) {
    if (!dragging) return;
    drawLoupe(event);
    const px = event.clientX - dragging.edge.left - dragging.dx, py = event.clientY - dragging.edge.top - dragging.dy;
    if (dragging.name === "tilt") {
      const theta = Math.max(-1.3, Math.min(1.3, Math.atan2(py - view.cy, px - view.cx)));
      hands.tilt(Math.tan(theta), ends, event.timeStamp);
    } else if (dragging.name === "through") hands.through(modelOf(px, py), ends, event.timeStamp);
    else hands.drag(dragging.name, modelOf(px, py), ends, event.timeStamp);
  }

  // Stones that move

  /** Show the stones in a pose; null brings them back. line: points of a thrust line of that pose; body: other stones; falling: the open joints are marked and the handles stay. */
  function pose(value, { line = null, lineOffset = 0, points = 0, body = null, falling = false } = {}) {
    const was = shownPose;
    shownPose = value ? { value, line, lineOffset, points, body: body ?? last, falling } : null;
    if (!last?.outline) return;
    if (!value) { set(dynamic, { d: "" }); redraw(); return; }
    if (!was) redraw(); else { drawPose(); if (falling) shapes(marks, openJoints()); }
  }
  /** Marks at the joints that a pose has opened: a hinge where one end still touches. */
  function openJoints() {
    const { value } = shownPose, { joint_p: p, joint_q: q, joint_block: block, centroid } = last, parts = [];
    const size = Math.max(it.bounds[2] - it.bounds[0], it.bounds[3] - it.bounds[1]), least = 0.002 * size;
    const moved = (b, x, y) => {
      if (b < 0) return [x, y];
      const turn = value[3 * b + 2], c = Math.cos(turn), n = Math.sin(turn), dx = x - centroid[2 * b], dy = y - centroid[2 * b + 1];
      return [value[3 * b] + c * dx - n * dy, value[3 * b + 1] + n * dx + c * dy];
    };
    for (let j = 0; j < p.length / 2; j += 1) {
      const [a, b] = [block[2 * j], block[2 * j + 1]];
      const gaps = [p, q].map((end) => { const one = moved(a, end[2 * j], end[2 * j + 1]), two = moved(b, end[2 * j], end[2 * j + 1]); return { gap: Math.hypot(one[0] - two[0], one[1] - two[1]), at: one }; });
      const [closed, open] = gaps[0].gap < gaps[1].gap ? gaps : [gaps[1], gaps[0]];
      if (open.gap < least || closed.gap > 0.3 * open.gap) continue;
      const [x, y] = screenOf(...closed.at);
      parts.push({ tag: "circle", class: "hinge plus", cx: x, cy: y, r: 5.5, title: "hinge" });
    }
    return parts;
  }
  function drawPose() {
    const { value, line, lineOffset, points, body } = shownPose;
    set(ghost, { d: stonesPath(body.outline, body.outline_start) });
    set(stones, { d: stonesPath(body.outline, body.outline_start, body.centroid, value) });
    let d = "", pen = false;
    if (line) for (let i = 0; i < points; i += 1) {
      const x = line[lineOffset + 2 * i], y = line[lineOffset + 2 * i + 1];
      if (!Number.isFinite(x + y)) { pen = false; continue; }
      d += `${pen ? "L" : "M"}${f(x)} ${f(y)}`;
      pen = true;
    }
    set(dynamic, { d });
  }
  function moving() { return shownPose !== null; }
  function held() { return dragging !== null; }
  return it;
}
export { LINES };
