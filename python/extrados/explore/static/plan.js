// The plan of a building: walls drawn on a grid, openings by their edges, and the pushover of its frame in colours. The deck follows.
import { drawingBoard, line } from "./board.js";
import { h, number, quantity, s, set, shapes } from "./dom.js";
import { pinch } from "./gestures.js";
import { tr } from "./words.js";

const NEAR = 14, TAP = 6, SHOWN = 4000, CARD = 140; // px, px, ms of a pushover on the page, px of its curve
const TOOLS = { select: tr`Select`, wall: tr`Wall`, opening: tr`Opening` };
const HINTS = {
  select: tr`Tap a wall or an opening; drag it, or its ends. Delete removes it.`, wall: tr`Drag from corner to corner. Walls meet at ends and along each other.`,
  opening: tr`Drag along a wall, from one edge of the opening to the other.`,
};
const LABELS = { thickness: tr`Thickness`, sill: tr`Sill`, head: tr`Head` };
const COLOURS = ["#e8e2d4", "#cfe3d6", "#f2c28b", "#e08b5a", "#e0342b", "#5b1136"]; // as in the figures of reports
const STATES = [tr`elastic`, tr`cracked`, tr`flexural strength`, tr`shear strength`, tr`drift limit in flexure`, tr`drift limit in shear`];
const PUSHES = [["+x", 0], ["−x", 180], ["+y", 90], ["−y", 270]];
const far = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const same = (a, b) => far(a, b) < 1e-6;
const round = (v) => Math.round(v * 1e4) / 1e4 + 0;

export function planPanel(app, frame, box) {
  const it = { walls: [], storeys: 1, floors: true, tool: "wall", chosen: null, hole: null, push: null };
  const sizes = { thickness: 0.3, sill: 0.9, head: 2.2 };
  let on = false, fitted = true, fresh = false, given = 0, storey = 1, step = 0.25, from = null, pointer = null, dragged = null, past = [], future = [], sent = 0, cursor = [0, 0], playing = null;

  const grid = s("path", { class: "grid" }), masonry = s("g"), states = s("g", { class: "plan-states" }), draft = s("g"), curve = s("g", { class: "plan-curve" });
  const board = drawingBoard(frame, box, "sheet plan", {
    picture: tr`Plan. Arrow keys move the cross or the selection, Enter sets a point, Escape cancels the wall, Delete removes the selected wall or opening.`,
    tools: tr`Tools of the plan`, options: tr`Options of the tool`,
  }, [grid, masonry, states, draft, curve], () => (fitted ? fit() : draw()));
  const { view, words, svg, tools, options, bar, press, X, M } = board;

  // Places on the plan, along a wall

  const length = (w) => far(w.start, w.end), way = (w) => [(w.end[0] - w.start[0]) / length(w), (w.end[1] - w.start[1]) / length(w)];
  const at = (w, t) => [w.start[0] + t * way(w)[0], w.start[1] + t * way(w)[1]];
  const along = (w, p) => Math.min(Math.max((p[0] - w.start[0]) * way(w)[0] + (p[1] - w.start[1]) * way(w)[1], 0), length(w));
  const there = (w) => !w.storeys || (w.storeys[0] <= storey && storey <= w.storeys[1]);
  /** The part of a wall from a to b along it, of a share of its thickness. */
  function part(w, a, b, share = 1) {
    const [x, y] = way(w), t = (share * w.thickness) / 2, [p, q] = [at(w, a), at(w, b)];
    return [[p[0] - t * y, p[1] + t * x], [q[0] - t * y, q[1] + t * x], [q[0] + t * y, q[1] - t * x], [p[0] + t * y, p[1] - t * x]];
  }
  function nearest(p) {
    let best = -1, least = NEAR / view.k;
    it.walls.forEach((w, k) => { const d = there(w) ? far(at(w, along(w, p)), p) - w.thickness / 2 : Infinity; if (d < least) { least = d; best = k; } });
    return best;
  }
  /** A place at the end of a wall, on a wall, else on the grid. */
  function snap(p, skip = []) {
    const others = it.walls.filter((w, k) => there(w) && !skip.includes(k)), ends = others.flatMap((w) => [w.start, w.end]).filter((e) => far(e, p) < NEAR / view.k);
    if (ends.length) return [...ends.reduce((a, b) => (far(a, p) < far(b, p) ? a : b))];
    const to = p.map((v) => round(Math.round(v / step) * step)), wall = others.find((w) => far(at(w, along(w, p)), p) < NEAR / view.k);
    return wall ? at(wall, along(wall, to)).map(round) : to;
  }
  function fit() {
    fitted = true;
    const low = it.push ? CARD + 20 : 0; // room for the curve
    const points = it.walls.flatMap((w) => [w.start, w.end]), all = points.length ? points : [[-1, -1], [9, 6]];
    const xs = all.map((p) => p[0]), ys = all.map((p) => p[1]), [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    view.k = Math.min((view.w - 90) / Math.max(x1 - x0, 1), (view.h - 110 - low) / Math.max(y1 - y0, 1));
    view.cx = view.w / 2 - (view.k * (x0 + x1)) / 2;
    view.cy = (view.h - low) / 2 + 12 + (view.k * (y0 + y1)) / 2;
    draw();
  }
  function zoom(by, x = view.w / 2, y = view.h / 2, dx = 0, dy = 0) {
    if (by === null) { fit(); return; }
    fitted = false;
    board.enlarge(by, x, y, dx, dy);
    draw();
  }

  // The plan and its deck

  const kept = () => JSON.stringify([it.walls, it.storeys, it.floors]);
  function commit(change) {
    past.push(kept());
    if (past.length > 300) past.shift();
    future = [];
    change();
    send();
  }
  function send() {
    sent += 1;
    halt(); it.push = null;
    draw();
    const walls = it.walls.map(({ name, start, end, thickness, openings }) => ({ name, start, end, thickness, openings }));
    app.ask({ do: "draw-plan", walls, fresh, floors: it.floors, storeys: it.storeys, lane: "draw-plan" }, { reply: (reply) => {
      sent = 0;
      if (reply.draft !== undefined) app.drafted({ text: reply.draft, trouble: it.walls.length ? reply.trouble : [tr`The plan is empty.`] });
      draw();
    } });
  }
  function travel(out, into) {
    if (!out.length) return;
    into.push(kept());
    [it.walls, it.storeys, it.floors] = JSON.parse(out.pop());
    it.chosen = it.hole = null; from = null;
    send();
  }
  it.undo = () => { if (from) { from = null; draw(); } else travel(past, future); };
  it.redo = () => travel(future, past);
  const free = () => { for (let n = 1; ; n += 1) if (!it.walls.some((w) => w.name === `wall ${n}`)) return `wall ${n}`; };
  function addWall(a, b) {
    if (far(a, b) < 0.1) { app.say(tr`These points do not define a wall.`, true); draw(); return; }
    commit(() => { it.walls = [...it.walls, { name: free(), start: a, end: b, thickness: sizes.thickness, openings: [] }]; it.chosen = it.walls.length - 1; it.hole = null; });
  }
  function addOpening(k, a, b) {
    const x = [Math.min(a, b), Math.max(a, b)].map((v) => round(Math.round(v / 0.05) * 0.05));
    if (x[1] - x[0] < 0.05) { app.say(tr`Drag along the wall for an opening.`, true); draw(); return; }
    commit(() => { change(k, (w) => ({ ...w, openings: [...w.openings, { storey, x, z: [sizes.sill, sizes.head] }] })); it.chosen = k; it.hole = it.walls[k].openings.length - 1; });
  }
  const change = (k, make) => { it.walls = it.walls.map((w, i) => (i === k ? make(w) : w)); };
  const reopen = (k, j, x) => change(k, (w) => ({ ...w, openings: w.openings.map((o, i) => (i === j ? { ...o, x: x.map(round) } : o)) }));
  function remove() {
    const k = it.chosen;
    if (k === null) return;
    commit(() => {
      if (it.hole !== null) change(k, (w) => ({ ...w, openings: w.openings.filter((_, j) => j !== it.hole) })); else { it.walls = it.walls.filter((_, i) => i !== k); it.chosen = null; }
      it.hole = null;
    });
  }
  /** Ends of walls at a place go to another one, those of walls that meet there too. */
  function moved(walls, pairs) {
    const to = (p) => pairs.find(([a]) => same(a, p))?.[1] ?? p;
    return walls.map((w) => (there(w) ? { ...w, start: to(w.start), end: to(w.end) } : w));
  }

  // Hands and keys

  const place = (event) => { const edge = svg.getBoundingClientRect(); return [event.clientX - edge.left, event.clientY - edge.top]; };
  const fingers = pinch(svg, { begin: () => { dragged = null; from = null; }, zoom });
  svg.addEventListener("wheel", (event) => { event.preventDefault(); zoom(1.0015 ** -event.deltaY, ...place(event)); }, { passive: false });
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || fingers.size > 1) return;
    svg.focus({ preventScroll: true });
    svg.setPointerCapture(event.pointerId);
    const p = M(...place(event)), k = nearest(p);
    dragged = { p, at: place(event), walls: it.walls };
    if (it.tool === "wall") { from ??= snap(p); dragged.first = true; }
    else if (it.tool === "opening") { if (k < 0) dragged = null; else Object.assign(dragged, { k, t: along(it.walls[k], p) }); }
    else grab(p, k);
    draw();
  });
  /** What a press takes hold of: an edge of the selected opening, an end of the selected wall, an opening, a wall. */
  function grab(p, k) {
    const w = it.walls[it.chosen], near = (q) => far(q, p) < NEAR / view.k;
    if (w && it.hole !== null) { const edge = w.openings[it.hole].x.findIndex((t) => near(at(w, t))); if (edge >= 0) { Object.assign(dragged, { k: it.chosen, edge }); return; } }
    if (w && it.hole === null) { const end = [w.start, w.end].find(near); if (end) { dragged.end = end; return; } }
    it.chosen = k < 0 ? null : k;
    it.hole = null;
    if (k < 0) return;
    const t = along(it.walls[k], p), hole = it.walls[k].openings.findIndex((o) => o.storey === storey && o.x[0] < t && t < o.x[1]);
    if (hole >= 0) { it.hole = hole; Object.assign(dragged, { k, hole, x: it.walls[k].openings[hole].x }); } else dragged.wall = it.walls[k];
    toolbar();
  }
  svg.addEventListener("pointermove", (event) => {
    if (fingers.size > 1) return;
    const p = M(...place(event));
    if (dragged && far(place(event), dragged.at) > TAP) dragged.moved = true;
    if (it.tool === "select" && dragged?.moved) it.walls = led(p);
    pointer = it.tool === "wall" ? snap(p) : p;
    draw();
  });
  /** The walls while a wall, an end or an opening is dragged. */
  function led(p) {
    const { walls, k, edge, hole, x, end, wall } = dragged, cut = (v) => Math.round(v / 0.05) * 0.05;
    it.walls = walls;
    if (edge !== undefined) { const now = [...walls[k].openings[it.hole].x]; now[edge] = cut(along(walls[k], p)); if (now[1] - now[0] > 0.05) reopen(k, it.hole, now); }
    else if (hole !== undefined) { const by = cut((p[0] - dragged.p[0]) * way(walls[k])[0] + (p[1] - dragged.p[1]) * way(walls[k])[1]); if (x[0] + by > -1e-9 && x[1] + by < length(walls[k]) + 1e-9) reopen(k, hole, [x[0] + by, x[1] + by]); }
    else if (end) { const to = snap(p, walls.map((w, i) => (same(w.start, end) || same(w.end, end) ? i : -1))); return moved(walls, [[end, to]]).some((w) => length(w) < 0.1) ? walls : moved(walls, [[end, to]]); }
    else if (wall) { const by = [0, 1].map((c) => Math.round((p[c] - dragged.p[c]) / step) * step), to = (q) => q.map((v, c) => round(v + by[c])), next = moved(walls, [[wall.start, to(wall.start)], [wall.end, to(wall.end)]]); return next.some((w) => length(w) < 0.1) ? walls : next; }
    return it.walls;
  }
  svg.addEventListener("pointerup", (event) => {
    const was = dragged, p = M(...place(event));
    dragged = null;
    if (!was) return;
    if (it.tool === "opening") { addOpening(was.k, was.t, along(it.walls[was.k], p)); return; }
    if (it.tool === "wall") { if (was.moved || !same(from, snap(p))) { const a = from; from = null; addWall(a, snap(p)); } return; }
    if (was.moved && JSON.stringify(it.walls) !== JSON.stringify(was.walls)) { const now = it.walls; it.walls = was.walls; commit(() => { it.walls = now; }); } else { it.walls = was.walls; draw(); }
  });
  svg.addEventListener("pointercancel", () => { if (dragged) it.walls = dragged.walls; dragged = null; draw(); });
  svg.addEventListener("keydown", (event) => {
    const to = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (to) {
      const by = to.map((v) => v * step * (event.shiftKey ? 10 : 1)), w = it.walls[it.chosen];
      if (it.tool === "select" && w) {
        const shift = (p) => p.map((v, c) => round(v + by[c])), d = by[0] * way(w)[0] + by[1] * way(w)[1];
        commit(() => { if (it.hole === null) it.walls = moved(it.walls, [[w.start, shift(w.start)], [w.end, shift(w.end)]]); else reopen(it.chosen, it.hole, w.openings[it.hole].x.map((v) => v + d)); });
      } else { cursor = cursor.map((v, c) => round(Math.round((v + by[c]) / step) * step)); pointer = cursor; draw(); app.say(`x ${number(cursor[0], 4)} m, y ${number(cursor[1], 4)} m`); }
    } else if (event.key === "Enter") {
      if (it.tool === "select") { dragged = {}; grab(cursor, nearest(cursor)); dragged = null; draw(); }
      else if (it.tool === "wall") { if (from) { const a = from; from = null; addWall(a, snap(cursor)); } else { from = snap(cursor); draw(); } }
      else if (from) { const [k, t] = from; from = null; addOpening(k, t, along(it.walls[k], cursor)); }
      else { const k = nearest(cursor); if (k >= 0) from = [k, along(it.walls[k], cursor)]; }
    } else if (event.key === "Escape") { from = null; it.chosen = it.hole = null; draw(); }
    else if (event.key === "Delete" || event.key === "Backspace") remove();
    else return;
    event.preventDefault();
  });

  // The pushover

  function pushed(direction) {
    halt();
    app.say(tr`calculating the capacity …`);
    app.ask({ do: "push-plan", direction }, { reply: (reply, arrays) => {
      if (!reply.pushed) return;
      app.say("");
      it.push = { ...reply.pushed, arrays, at: 0 };
      if (fitted) fit();
      const last = arrays.control.length - 1;
      if (matchMedia("(prefers-reduced-motion: reduce)").matches) { it.push.at = last; draw(); return; }
      const begin = performance.now();
      const next = (now) => {
        it.push.at = Math.min(last, Math.max(0, Math.floor((last * (now - begin)) / SHOWN)));
        draw();
        playing = it.push.at < last ? requestAnimationFrame(next) : null;
      };
      playing = requestAnimationFrame(next);
    } });
  }
  function halt() { if (playing) cancelAnimationFrame(playing); playing = null; }
  function painted() {
    if (!it.push) { shapes(states, []); shapes(curve, []); return; }
    const { arrays, at: now, peak_base_shear_N: peak } = it.push, n = arrays.element_wall.length, out = [];
    for (let e = 0; e < n; e += 1) {
      const w = it.walls[arrays.element_wall[e]];
      if (!w || arrays.element_storey[e] !== storey) continue;
      const state = arrays.state[now * n + e];
      out.push({ tag: "path", class: "plan-state", fill: COLOURS[state], "data-state": state, d: line(part(w, arrays.element_part[4 * e], arrays.element_part[4 * e + 1], arrays.element_kind[e] === 1 ? 1 : 0.4).map(X)), title: STATES[state] });
    }
    shapes(states, out);
    const found = STATES.map((text, k) => [text, COLOURS[k], k]).filter(([, , k]) => arrays.state.includes(k)), keys = [];
    let x = 12;
    for (const [text, fill] of found) { keys.push({ tag: "rect", class: "plan-key", x, y: 30, width: 11, height: 11, fill }, { tag: "text", x: x + 16, y: 40, text }); x += 30 + 6.4 * text.length; }
    const { control, shear } = arrays, wide = Math.min(260, view.w - 24), high = CARD - 26, x0 = view.w - wide - 12, y0 = view.h - 34, most = control[control.length - 1] || 1;
    const P = (k) => [x0 + 44 + ((wide - 56) * control[k]) / most, y0 - ((high - 26) * Math.max(shear[k], 0)) / (peak || 1)], points = Array.from({ length: now + 1 }, (_, k) => P(k));
    shapes(curve, [...keys, { tag: "rect", class: "plan-card", x: x0, y: y0 - high, width: wide, height: high + 26, rx: 6 }, { tag: "path", class: "plan-axes", d: `M${x0 + 44} ${y0 - high + 16}V${y0}H${x0 + wide - 8}` },
      { tag: "path", class: "plan-line", d: line(points, "") }, { tag: "circle", class: "sheet-point", cx: points.at(-1)[0], cy: points.at(-1)[1], r: 4 },
      { tag: "text", x: x0 + 8, y: y0 - high + 14, text: tr`Base shear ${quantity(shear[now], "N", 3)}` }, { tag: "text", x: x0 + 44, y: y0 + 17, text: tr`displacement ${number(1e3 * control[now], 3)} mm` }]);
  }

  // What is seen

  function setTool(name) { it.tool = name; from = pointer = null; toolbar(); draw(); }
  function toolbar() {
    tools.replaceChildren(press(tr`Done`, close, { class: "layer first", "data-plan-tool": "done" }), ...Object.entries(TOOLS).map(([name, label]) => press(label, () => setTool(name), { "aria-pressed": String(it.tool === name), "data-plan-tool": name })),
      press(tr`Delete`, remove), ...PUSHES.map(([label, direction]) => press(tr`Push ${label}`, () => pushed(direction), { "data-push": direction })),
      h("span", { class: "spring" }), press("−", () => zoom(1 / 1.3), { "aria-label": tr`Smaller` }), press("+", () => zoom(1.3), { "aria-label": tr`Larger` }), press(tr`Fit`, fit, { "aria-label": tr`Fit the drawing` }));
    const w = it.walls[it.chosen], o = w && it.hole !== null ? w.openings[it.hole] : null;
    const value = (key) => (key === "thickness" ? (w ?? sizes).thickness : o ? o.z[key === "sill" ? 0 : 1] : sizes[key]);
    const enter = (key, v) => {
      sizes[key] = v;
      if (key === "thickness" && w) commit(() => change(it.chosen, (one) => ({ ...one, thickness: v })));
      else if (o) commit(() => change(it.chosen, (one) => ({ ...one, openings: one.openings.map((each, j) => (j === it.hole ? { ...each, z: key === "sill" ? [v, each.z[1]] : [each.z[0], v] } : each)) })));
    };
    const field = (key) => h("label", { class: "sheet-field" }, LABELS[key], " ", h("input", { type: "text", inputmode: "decimal", size: 4, value: String(value(key)), "data-plan-size": key, onchange: (e) => {
      const v = Number(e.target.value.replace(",", "."));
      if (v > 0 || (key === "sill" && v === 0)) enter(key, v); else e.target.value = String(value(key));
    } }));
    const pick = (label, values, now, act, more = {}) => h("label", { class: "sheet-field" }, label, " ", h("select", { onchange: (e) => act(Number(e.target.value)), ...more }, values.map(([v, text]) => h("option", { value: v, selected: v === now }, text))));
    options.replaceChildren(pick(tr`Grid`, [0.05, 0.1, 0.25, 0.5, 1].map((v) => [v, `${v} m`]), step, (v) => { step = v; draw(); }),
      fresh ? pick(tr`Storeys`, [1, 2, 3, 4, 5].map((v) => [v, v]), it.storeys, (v) => { commit(() => { it.storeys = v; }); storey = Math.min(storey, v); toolbar(); }, { "data-storeys": true }) : "",
      it.storeys > 1 ? pick(tr`Storey shown`, Array.from({ length: it.storeys }, (_, k) => [k + 1, k + 1]), storey, (v) => { storey = v; it.hole = null; toolbar(); draw(); }) : "",
      fresh ? h("label", { class: "sheet-field" }, h("input", { type: "checkbox", checked: it.floors, onchange: (e) => commit(() => { it.floors = e.target.checked; }) }), " ", tr`Rigid floors, 3 kPa`) : "",
      field("thickness"), ...(it.tool === "opening" || o ? [field("sill"), field("head")] : []), h("span", { class: "hint" }, HINTS[it.tool]));
  }
  function draw() {
    if (!on || !view.w) return;
    const [left, top] = M(0, 0), [right, low] = M(view.w, view.h);
    let d = "", gap = step;
    while (gap * view.k < 9) gap *= 2;
    for (let x = Math.ceil(left / gap) * gap; x < right; x += gap) d += `M${X([x, 0])[0].toFixed(1)} 0V${view.h}`;
    for (let y = Math.ceil(low / gap) * gap; y < top; y += gap) d += `M0 ${X([0, y])[1].toFixed(1)}H${view.w}`;
    set(grid, { d });
    const w = it.walls[it.chosen], knobs = !w ? [] : it.hole === null ? [w.start, w.end] : w.openings[it.hole].x.map((t) => at(w, t));
    shapes(masonry, [...it.walls.flatMap((one, k) => (!there(one) ? [] : [{ tag: "path", class: k === it.chosen && it.hole === null ? "stones chosen" : "stones", "data-wall": one.name, d: line(part(one, 0, length(one)).map(X)), title: one.name },
      ...one.openings.flatMap((o, j) => (o.storey === storey ? [{ tag: "path", class: k === it.chosen && it.hole === j ? "plan-hole chosen" : "plan-hole", d: line(part(one, ...o.x).map(X)) }] : []))]))]);
    painted();
    const points = it.tool === "wall" && from && pointer && far(from, pointer) > 0.01 ? [from, pointer] : null, hole = it.tool === "opening" && dragged && pointer ? [dragged.t, along(it.walls[dragged.k], pointer)] : null;
    const outline = points ? part({ start: points[0], end: points[1], thickness: sizes.thickness }, 0, far(...points)) : hole ? part(it.walls[dragged.k], Math.min(...hole), Math.max(...hole) + 1e-6) : null;
    shapes(draft, [...(outline ? [{ tag: "path", class: "sheet-draft", d: line(outline.map(X)) }] : []), ...knobs.map((p) => ({ tag: "circle", class: "sheet-point", cx: X(p)[0], cy: X(p)[1], r: 5 })),
      ...(pointer && it.tool !== "select" ? [{ tag: "path", class: "sheet-cross", d: `M${X(pointer)[0] - 8} ${X(pointer)[1]}h16m-8 -8v16` }] : [])]);
    words.textContent = told(points);
  }
  function told(points) {
    if (points) return tr`${number(far(...points), 3)} m long`;
    if (!it.walls.length || sent) return "";
    if (app.draft) return app.draft.trouble[0] ?? "";
    const p = it.push, w = it.walls[it.chosen];
    if (p) return tr`Greatest base shear ${quantity(p.peak_base_shear_N, "N", 3)}, ${number(p.peak_base_shear_N / p.weight_N, 3)} of the weight.`;
    return w ? `${w.name}: ${number(length(w), 4)} m` : "";
  }

  // Begin and end

  /** Draw a new plan, or on that of the deck. */
  function begin(blank = false) {
    app.setTab("structure");
    app.ask({ do: "plan" }, { reply: (reply) => {
      if (!reply.plan) return;
      on = true;
      app.root.dataset.draw = "on";
      svg.toggleAttribute("hidden", false); bar.hidden = false;
      past = []; future = []; from = null; it.chosen = it.hole = it.push = null; storey = 1;
      fresh = blank || !reply.plan.walls.length;
      take(fresh ? { walls: [], storeys: [3], floors: 0 } : reply.plan);
      view.w = box.clientWidth; view.h = box.clientHeight;
      set(svg, { viewBox: `0 0 ${view.w} ${view.h}`, width: view.w, height: view.h });
      setTool(fresh ? "wall" : "select");
      if (fresh) send();
      fit();
      svg.focus({ preventScroll: true });
    } });
  }
  function take(plan) { it.walls = plan.walls; it.storeys = plan.storeys.length; given = plan.floors; it.floors = fresh || given > 0; }
  function close() {
    on = false;
    halt();
    delete app.root.dataset.draw;
    svg.toggleAttribute("hidden", true); bar.hidden = true;
    app.drafted(null);
    app.space?.redraw();
  }
  // the text was changed beside the plan, or another deck was opened
  app.on("text", () => {
    if (!on || sent) return;
    app.ask({ do: "plan" }, { reply: (reply) => { if (reply.plan && !sent && !app.draft) { if (!reply.plan.walls.length) { close(); return; } if (JSON.stringify(reply.plan.walls.map((w) => [w.name, w.start, w.end, w.thickness, w.openings])) !== JSON.stringify(it.walls.map((w) => [w.name, w.start, w.end, w.thickness, w.openings]))) { take(reply.plan); it.chosen = it.hole = it.push = null; } draw(); } } });
  });
  app.on("theme", draw);
  app.on("tab", (name) => { if (on && name !== "structure") close(); });
  return Object.assign(it, { begin, close, zoom, drawing: () => on, place: () => [view.k, view.cx, view.cy] });
}
