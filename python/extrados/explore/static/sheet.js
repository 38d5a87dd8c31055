// A blank sheet: arches, piers, walls and blocks drawn by hand or by sizes, over a photograph. The deck beside it follows each shape.
import { drawingBoard, line } from "./board.js";
import { h, number, s, set, shapes } from "./dom.js";
import { pinch } from "./gestures.js";
import { arch, inside, mirrored, rotated, shifted, snapped, wall } from "./shapes.js";
import { piecesPath } from "./stage.js";
import { tr } from "./words.js";

const NEAR = 14, TAP = 8; // px: of a vertex that is taken, and of a press that is no drag
const TOOLS = { select: tr`Select`, block: tr`Block`, pier: tr`Pier`, wall: tr`Wall`, arch: tr`Arch`, support: tr`Support` };
const HINTS = {
  select: tr`Tap a shape, drag it. Delete removes it.`, block: tr`Tap the vertices. Tap the first vertex again to close the block.`,
  pier: tr`Drag from one corner to the opposite one.`, wall: tr`Drag from one corner to the opposite one.`,
  arch: tr`Drag from springing to springing, then tap the crown of the intrados.`, support: tr`Drag along a face that the ground supports. Without supports the lowest level is the ground.`,
  scale: tr`Tap two points of the photograph whose distance you know.`, photo: tr`Drag the photograph to its place.`,
};
const FIELDS = { pier: ["courses"], wall: ["courses", "units"], arch: ["thickness", "voussoirs"], block: [], select: [], support: [] };
const SIZES = { pier: ["x", "y", "width", "height"], wall: ["x", "y", "width", "height"], arch: ["x", "y", "span", "rise"] };
const LABELS = { courses: tr`Courses`, units: tr`Units`, thickness: tr`Thickness`, voussoirs: tr`Voussoirs`, x: tr`x of the left end`, y: tr`y of the base`, width: tr`Width`, height: tr`Height`, span: tr`Clear span`, rise: tr`Rise` };
const group = (name) => name.replace(/\.\d+$/, "");

export function sheetPanel(app, frame, box) {
  const it = { blocks: [], ground: [], tool: "pier", chosen: new Set(), support: null, photo: null };
  const sizes = { courses: 5, units: 4, thickness: 0.5, voussoirs: 15, x: 0, y: 0, width: 1, height: 3, span: 4, rise: 2 };
  let on = false, fresh = false, step = 0.25, taken = [], pointer = null, dragged = null, past = [], future = [], sent = 0, cursor = [0, 0];

  const grid = s("path", { class: "grid" }), zero = s("path", { class: "ground" }), image = s("image", { preserveAspectRatio: "none" });
  const drawn = s("g"), lines = s("g", { class: "marks" }), draft = s("g");
  const board = drawingBoard(frame, box, "sheet", {
    picture: tr`Sheet. Arrow keys move the cross, Enter sets a point, Escape cancels the shape, Delete removes the selected shape.`,
    tools: tr`Tools of the sheet`, options: tr`Options of the tool`,
  }, [image, grid, zero, drawn, lines, draft], (first) => (first ? fit() : draw()));
  const { view, words, svg, tools, options, bar, press, X, M } = board;
  const file = h("input", { type: "file", accept: "image/*", "aria-label": tr`Photograph as background`, onchange: () => { photograph(file.files[0]); file.value = ""; } });

  const snap = (p, outlines = it.blocks.map((b) => b.points)) => snapped(p, outlines, NEAR / view.k) ?? p.map((v) => Math.round(v / step) * step);
  const picked = () => it.blocks.filter((b) => it.chosen.has(group(b.name)));
  function fit() {
    const points = it.blocks.flatMap((b) => b.points), p = it.photo;
    if (p) points.push([p.x, p.y], [p.x + p.scale * p.w, p.y + p.scale * p.h]);
    const xs = points.map((v) => v[0]).concat(points.length ? [] : [-1, 7]), ys = points.map((v) => v[1]).concat(points.length ? [0] : [0, 5]);
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    view.k = Math.min((view.w - 70) / Math.max(x1 - x0, 0.1), (view.h - 90) / Math.max(y1 - y0, 0.1));
    view.cx = view.w / 2 - (view.k * (x0 + x1)) / 2;
    view.cy = view.h / 2 + (view.k * (y0 + y1)) / 2 + 10;
    draw();
  }
  function zoom(by, x = view.w / 2, y = view.h / 2, dx = 0, dy = 0) {
    if (by === null) { fit(); return; }
    board.enlarge(by, x, y, dx, dy);
    draw();
  }

  // The sheet and its deck

  /** A change of the sheet: one step of undo, and the deck anew. */
  function commit(change) {
    past.push(JSON.stringify([it.blocks, it.ground]));
    if (past.length > 300) past.shift();
    future = [];
    change();
    send();
  }
  function send() {
    sent += 1;
    draw();
    app.ask({ do: "draw", blocks: it.blocks, ground: it.ground, fresh, lane: "draw" }, { reply: (reply) => {
      sent = 0;
      if (reply.draft !== undefined) app.drafted({ text: reply.draft, trouble: it.blocks.length ? reply.trouble : [tr`The sheet is empty.`] });
      else if (reply.scene) fresh = false;
      draw();
    } });
  }
  function travel(from, to) {
    if (!from.length) return;
    to.push(JSON.stringify([it.blocks, it.ground]));
    [it.blocks, it.ground] = JSON.parse(from.pop());
    it.chosen.clear(); it.support = null; taken = [];
    send();
  }
  it.undo = () => { if (taken.length) { taken.pop(); draw(); } else travel(past, future); };
  it.redo = () => travel(future, past);
  const free = (stem) => { for (let n = 1; ; n += 1) if (!it.blocks.some((b) => group(b.name) === `${stem} ${n}` || b.name === `${stem} ${n}`)) return `${stem} ${n}`; };
  /** Put outlines on the sheet as one shape. */
  function add(stem, outlines) {
    const name = free(stem);
    commit(() => {
      it.blocks = [...it.blocks, ...outlines.map((points, k) => ({ name: outlines.length > 1 ? `${name}.${k + 1}` : name, points }))];
      grounded();
      it.chosen = new Set([name]); it.support = null;
    });
  }
  /** Faces of each shape at a level, as segments. */
  function feet(level) {
    const found = new Map();
    for (const b of it.blocks) for (const [x, y] of b.points) if (Math.abs(y - level) < 1e-9) found.set(group(b.name), [...(found.get(group(b.name)) ?? []), x]);
    return [...found.values()].map((xs) => [Math.min(...xs), level, Math.max(...xs), level]).filter((g) => g[2] - g[0] > 1e-9);
  }
  const lowest = () => Math.min(...it.blocks.flatMap((b) => b.points.map((p) => p[1])));
  /** Without supports of its own the lowest level is the ground; with them, new faces on their lowest level are supports too. */
  function grounded(row = null) {
    if (row && !it.ground.length) it.ground = feet(lowest());
    if (row) it.ground = [...it.ground, row];
    const levels = it.ground.filter((g) => g[1] === g[3]).map((g) => g[1]);
    if (!levels.length) return;
    const level = Math.min(...levels), covered = (f) => it.ground.some((g) => g[1] === level && g[3] === level && Math.min(g[0], g[2]) < f[0] + 1e-9 && Math.max(g[0], g[2]) > f[2] - 1e-9);
    it.ground = [...it.ground, ...feet(level).filter((f) => !covered(f))];
  }
  function remove() {
    if (it.support !== null) { commit(() => { it.ground = it.ground.filter((_, k) => k !== it.support); it.support = null; }); return; }
    if (!it.chosen.size) return;
    commit(() => { it.blocks = it.blocks.filter((b) => !it.chosen.has(group(b.name))); it.chosen.clear(); });
  }
  function copies(make, count = 1) {
    const from = it.chosen.size ? picked() : it.blocks, stems = [...new Set(from.map((b) => group(b.name)))];
    if (!from.length) return;
    commit(() => {
      const made = new Set();
      for (let k = 1; k <= count; k += 1) for (const stem of stems) {
        const name = free(stem.replace(/ \d+$/, ""));
        for (const b of from.filter((one) => group(one.name) === stem)) {
          it.blocks = [...it.blocks, { name: b.name === stem ? name : `${name}${b.name.slice(stem.length)}`, points: make(b.points, k) }];
        }
        made.add(name);
      }
      grounded();
      it.chosen = made;
    });
  }

  // Points taken, by pointer or keys

  function take(p) {
    const { tool } = it;
    if (tool === "block" && taken.length >= 3 && Math.hypot(p[0] - taken[0][0], p[1] - taken[0][1]) < (NEAR + 4) / view.k) { finish(); return; }
    taken = [...taken, p];
    if (taken.length >= { pier: 2, wall: 2, support: 2, scale: 2, arch: 3 }[tool]) finish();
    else draw();
  }
  /** What the points taken make with the tool: outlines, or null. */
  function made(points) {
    const [a, b, c] = points;
    if (it.tool === "block") return points.length > 2 ? [points] : null;
    if (!b) return null;
    if (["pier", "wall"].includes(it.tool)) return Math.abs(a[0] - b[0]) > 1e-9 && Math.abs(a[1] - b[1]) > 1e-9 ? wall(a, b, sizes.courses, it.tool === "pier" ? 1 : sizes.units) : null;
    if (it.tool !== "arch") return null;
    const span = Math.hypot(b[0] - a[0], b[1] - a[1]), way = b[0] >= a[0] ? 1 : -1;
    const rise = c ? (way * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))) / (span || 1) : span / 2;
    return arch(a, b, rise, sizes.thickness, sizes.voussoirs);
  }
  function finish() {
    const points = taken;
    taken = [];
    if (it.tool === "support") {
      const row = [...points[0], ...points[1]];
      if (Math.hypot(row[2] - row[0], row[3] - row[1]) > 1e-9) commit(() => grounded(row));
    } else if (it.tool === "scale") scale(...points);
    else {
      const outlines = made(points);
      if (outlines) add(it.tool, outlines); else { app.say(tr`These points do not define a shape.`, true); draw(); }
    }
  }
  function choose(p, more = false) {
    const found = [...it.blocks].reverse().find((b) => inside(p, b.points));
    if (!more) it.chosen.clear();
    if (found) it.chosen.add(group(found.name));
    const near = found ? -1 : it.ground.findIndex((g) => snapped(p, [[g.slice(0, 2), g.slice(2)]], NEAR / view.k));
    it.support = near < 0 ? null : near;
    draw();
    return found;
  }
  const place = (event) => { const edge = svg.getBoundingClientRect(); return [event.clientX - edge.left, event.clientY - edge.top]; };
  const fingers = pinch(svg, { begin: () => { dragged = null; if (taken.length < 2 && it.tool !== "block") taken = []; }, zoom });
  svg.addEventListener("wheel", (event) => { event.preventDefault(); zoom(1.0015 ** -event.deltaY, ...place(event)); }, { passive: false });
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || fingers.size > 1) return;
    svg.focus({ preventScroll: true });
    svg.setPointerCapture(event.pointerId);
    const at = place(event), p = M(...at);
    dragged = { at, p, moved: false };
    if (it.tool === "photo") { if (it.photo) dragged.photo = { ...it.photo }; return; }
    if (it.tool === "select") {
      const there = it.blocks.find((b) => it.chosen.has(group(b.name)) && inside(p, b.points)) ?? choose(p, event.shiftKey);
      if (there) dragged.corner = picked().flatMap((b) => b.points).reduce((best, v) => (Math.hypot(v[0] - p[0], v[1] - p[1]) < Math.hypot(best[0] - p[0], best[1] - p[1]) ? v : best));
      return;
    }
    if (it.tool !== "block" && !taken.length) { take(it.tool === "scale" ? p : snap(p)); dragged.first = true; }
  });
  svg.addEventListener("pointermove", (event) => {
    if (fingers.size > 1) return;
    const at = place(event), p = M(...at);
    if (dragged && Math.hypot(at[0] - dragged.at[0], at[1] - dragged.at[1]) > TAP) dragged.moved = true;
    if (dragged?.photo) Object.assign(it.photo, { x: dragged.photo.x + p[0] - dragged.p[0], y: dragged.photo.y + p[1] - dragged.p[1] });
    else if (dragged?.corner && dragged.moved) {
      const others = it.blocks.filter((b) => !it.chosen.has(group(b.name))).map((b) => b.points), c = dragged.corner;
      const to = snap([c[0] + p[0] - dragged.p[0], c[1] + p[1] - dragged.p[1]], others);
      dragged.by = [to[0] - c[0], to[1] - c[1]];
    }
    pointer = it.tool === "scale" ? p : snap(p);
    draw();
  });
  svg.addEventListener("pointerup", (event) => {
    const was = dragged, p = M(...place(event));
    dragged = null;
    if (!was) return;
    if (was.by && (was.by[0] || was.by[1])) { moveBy(...was.by); return; }
    if (["select", "photo"].includes(it.tool)) { draw(); return; }
    if (was.first && !was.moved) return; // the next tap takes the second point
    take(it.tool === "scale" ? p : snap(p));
  });
  svg.addEventListener("pointercancel", () => { dragged = null; draw(); });
  function moveBy(dx, dy) {
    if (it.chosen.size) commit(() => { it.blocks = it.blocks.map((b) => (it.chosen.has(group(b.name)) ? { ...b, points: shifted(b.points, dx, dy) } : b)); grounded(); });
  }
  svg.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (way) {
      const by = way.map((v) => v * step * (event.shiftKey ? 10 : 1));
      if (it.tool === "select" && it.chosen.size) moveBy(...by);
      else { cursor = [Math.round((cursor[0] + by[0]) / step) * step, Math.round((cursor[1] + by[1]) / step) * step]; pointer = cursor; draw(); app.say(`x ${number(cursor[0], 4)} m, y ${number(cursor[1], 4)} m`); }
    } else if (event.key === "Enter") { if (it.tool === "select") choose(cursor, event.shiftKey); else take([...cursor]); }
    else if (event.key === "Escape") { taken = []; it.chosen.clear(); it.support = null; draw(); }
    else if (event.key === "Delete" || event.key === "Backspace") remove();
    else return;
    event.preventDefault();
  });

  // The photograph: it stays in this page

  function photograph(given) {
    if (!given) return;
    const url = URL.createObjectURL(given), picture = new Image();
    picture.onload = () => {
      if (it.photo) URL.revokeObjectURL(it.photo.url);
      it.photo = { url, w: picture.naturalWidth, h: picture.naturalHeight, x: 0, y: 0, scale: 8 / picture.naturalWidth, seen: 0.6 };
      setTool("scale");
      fit();
    };
    picture.onerror = () => { URL.revokeObjectURL(url); app.say(tr`This browser cannot show ${given.name} as a picture.`, true); };
    picture.src = url;
  }
  function scale(a, b) {
    const now = Math.hypot(a[0] - b[0], a[1] - b[1]);
    if (!(now > 0)) return;
    form(tr`Scale of the photograph`, [["distance", tr`Distance of the two points, m`, number(now, 4)]], ({ distance }) => {
      if (!(distance > 0)) return false;
      const by = distance / now, p = it.photo;
      Object.assign(p, { x: a[0] + by * (p.x - a[0]), y: a[1] + by * (p.y - a[1]), scale: by * p.scale });
      setTool("photo");
      fit();
      return true;
    });
  }

  // Forms

  /** A dialog with numbers; done(values) says whether they are right. */
  function form(title, fields, done) {
    const inputs = fields.map(([key, label, value]) => [key, h("input", { type: "text", inputmode: "decimal", value: String(value), "aria-label": label }), label]);
    const shown = app.dialog(title, h("form", { onsubmit: (e) => {
      e.preventDefault();
      const values = Object.fromEntries(inputs.map(([key, input]) => [key, Number(input.value.trim().replaceAll("−", "-").replace(",", ".").replace(/\s*m$/, "") || NaN)]));
      if (Object.values(values).every(Number.isFinite) && done(values)) shown.close(); else app.say(tr`These numbers do not define a shape.`, true);
    } }, ...inputs.map(([, input, label]) => h("label", { class: "line" }, label, " ", input)), h("div", { class: "row" }, h("button", { type: "submit", class: "first" }, tr`Draw it`))));
    inputs[0][1].select();
  }
  function bySizes() {
    if (it.tool === "block") {
      form(tr`Block by sizes`, ["x", "y", "width", "height"].map((key) => [key, LABELS[key], sizes[key]]), (v) => {
        if (!(v.width > 0 && v.height > 0)) return false;
        Object.assign(sizes, v);
        add("block", wall([v.x, v.y], [v.x + v.width, v.y + v.height], 1, 1));
        return true;
      });
      return;
    }
    const tool = it.tool, keys = [...SIZES[tool], ...FIELDS[tool]];
    form({ pier: tr`Pier by sizes`, wall: tr`Wall by sizes`, arch: tr`Arch by sizes` }[tool], keys.map((key) => [key, LABELS[key], sizes[key]]), (v) => {
      if (["width", "height", "span", "rise", "thickness"].some((key) => key in v && !(v[key] > 0)) || ["courses", "units", "voussoirs"].some((key) => key in v && !(Number.isInteger(v[key]) && v[key] > 0 && v[key] <= 200))) return false;
      Object.assign(sizes, v);
      if (tool === "arch") {
        const found = arch([v.x, v.y], [v.x + v.span, v.y], v.rise, v.thickness, v.voussoirs);
        if (!found) return false;
        add(tool, found);
      } else add(tool, wall([v.x, v.y], [v.x + v.width, v.y + v.height], v.courses, tool === "pier" ? 1 : v.units));
      toolbar();
      return true;
    });
  }
  function mirror() {
    const from = it.chosen.size ? picked() : it.blocks;
    if (!from.length) return;
    form(tr`Mirror`, [["axis", tr`x of the axis, m`, Math.max(...from.flatMap((b) => b.points.map((p) => p[0])))]], ({ axis }) => { copies((points) => mirrored(points, axis)); return true; });
  }
  function array() {
    const from = it.chosen.size ? picked() : it.blocks;
    if (!from.length) return;
    const middle = from.flatMap((b) => b.points.map((p) => p[0])).reduce((sum, v, _, all) => sum + v / all.length, 0);
    form(tr`Copies`, [["count", tr`Number of copies`, 1], ["dx", tr`Step in x, m`, 0], ["dy", tr`Step in y, m`, 0], ["angle", tr`Rotation of each, degrees`, 0], ["cx", tr`x of the centre, m`, number(middle, 4)], ["cy", tr`y of the centre, m`, 0]], (v) => {
      if (!Number.isInteger(v.count) || v.count < 1 || v.count > 200 || !(v.dx || v.dy || v.angle)) return false;
      copies((points, k) => shifted(rotated(points, [v.cx, v.cy], k * v.angle), k * v.dx, k * v.dy), v.count);
      return true;
    });
  }

  // What is seen

  function setTool(name) { it.tool = name; it.support = null; taken = []; pointer = null; toolbar(); draw(); }
  function toolbar() {
    const tool = (name, label) => press(label, () => setTool(name), { "aria-pressed": String(it.tool === name), "data-tool": name });
    tools.replaceChildren(press(tr`Done`, close, { class: "layer first", "data-tool": "done" }), ...Object.entries(TOOLS).map(([name, label]) => tool(name, label)),
      press(tr`Mirror…`, mirror), press(tr`Copies…`, array), press(tr`Delete`, remove), h("label", { class: "layer button" }, tr`Photograph…`, file),
      h("span", { class: "spring" }), press("−", () => zoom(1 / 1.3), { "aria-label": tr`Smaller` }), press("+", () => zoom(1.3), { "aria-label": tr`Larger` }), press(tr`Fit`, fit, { "aria-label": tr`Fit the drawing` }));
    const field = (key) => h("label", { class: "sheet-field" }, LABELS[key], " ", h("input", { type: "text", inputmode: "decimal", size: 4, value: String(sizes[key]), "data-size": key, onchange: (e) => {
      const value = Number(e.target.value.replace(",", "."));
      if (value > 0 && (key === "thickness" || (Number.isInteger(value) && value <= 200))) { sizes[key] = value; draw(); } else e.target.value = String(sizes[key]);
    } }));
    const p = it.photo;
    options.replaceChildren(
      h("label", { class: "sheet-field" }, tr`Grid`, " ", h("select", { onchange: (e) => { step = Number(e.target.value); draw(); } }, [0.05, 0.1, 0.25, 0.5, 1].map((v) => h("option", { value: v, selected: v === step }, `${v} m`)))),
      ...(FIELDS[it.tool] ?? []).map(field),
      it.tool === "block" || SIZES[it.tool] ? press(tr`By sizes…`, bySizes) : "",
      ...(p ? [tool("scale", tr`Scale`), tool("photo", tr`Move photograph`), h("input", { type: "range", min: 0.1, max: 1, step: 0.05, value: p.seen, "aria-label": tr`Opacity of the photograph`, oninput: (e) => { p.seen = Number(e.target.value); draw(); } }), press(tr`Remove photograph`, () => { URL.revokeObjectURL(p.url); it.photo = null; setTool("select"); })] : []),
      h("span", { class: "hint" }, HINTS[it.tool]));
  }
  function draw() {
    if (!on || !view.w) return;
    const p = it.photo, [left, top] = M(0, 0), [right, low] = M(view.w, view.h);
    if (p) { const [x, y] = X([p.x, p.y + p.scale * p.h]); set(image, { href: p.url, x, y, width: p.scale * p.w * view.k, height: p.scale * p.h * view.k, opacity: p.seen }); } else set(image, { href: null, width: 0, height: 0 });
    let d = "", gap = step;
    while (gap * view.k < 9) gap *= 2;
    for (let x = Math.ceil(left / gap) * gap; x < right; x += gap) d += `M${X([x, 0])[0].toFixed(1)} 0V${view.h}`;
    for (let y = Math.ceil(low / gap) * gap; y < top; y += gap) d += `M0 ${X([0, y])[1].toFixed(1)}H${view.w}`;
    set(grid, { d });
    set(zero, { d: `M0 ${view.cy}H${view.w}` });
    const moved = (b) => (dragged?.by && it.chosen.has(group(b.name)) ? shifted(b.points, ...dragged.by) : b.points);
    shapes(drawn, [...it.blocks.map((b) => ({ tag: "path", class: it.chosen.has(group(b.name)) ? "stones chosen" : "stones", d: line(moved(b).map(X)), title: b.name })),
      ...(it.ground.length || !it.blocks.length ? it.ground : feet(lowest())).map((g, k) => ({ tag: "path", class: k === it.support ? "held chosen" : "held", d: line([X(g.slice(0, 2)), X(g.slice(2))], "") }))]);
    const [ax, ay] = app.anchor ?? [0, 0], current = !sent && !app.draft && app.deck?.structure?.kind === "blocks";
    const shift = (name) => {
      const from = app.arrays[`${name}_line`], to = new Float64Array(from.length);
      for (let i = 0; i < to.length; i += 2) [to[i], to[i + 1]] = X([from[i] + ax, from[i + 1] + ay]);
      return piecesPath(to, app.arrays[`${name}_start`]);
    };
    shapes(lines, current ? ["least", "most", "plus"].filter((name) => app.drawn(name) && app.arrays[`${name}_line`]).map((name) => ({ tag: "path", class: `thrust ${name}`, d: shift(name) })) : []);
    const points = pointer && taken.length && it.tool !== "select" ? [...taken, pointer] : taken, outlines = points.length ? made(points) : null;
    shapes(draft, [...(outlines ?? []).map((one) => ({ tag: "path", class: "sheet-draft", d: line(one.map(X)) })),
      ...(outlines || points.length < 2 ? [] : [{ tag: "path", class: "sheet-draft", d: line(points.map(X), "") }]),
      ...taken.map((one) => { const [x, y] = X(one); return { tag: "circle", class: "sheet-point", cx: x, cy: y, r: 4.5 }; }),
      ...(pointer && !["select", "photo"].includes(it.tool) ? [{ tag: "path", class: "sheet-cross", d: `M${X(pointer)[0] - 8} ${X(pointer)[1]}h16m-8 -8v16` }] : [])]);
    words.textContent = told(points);
  }
  /** Sizes of what is being drawn, else what the deck gives. */
  function told(points) {
    if (points.length > 1) {
      const [a, b] = points.slice(-2);
      return tr`${number(Math.abs(b[0] - a[0]), 3)} m across, ${number(Math.abs(b[1] - a[1]), 3)} m up, ${number(Math.hypot(b[0] - a[0], b[1] - a[1]), 3)} m long`;
    }
    if (!it.blocks.length) return "";
    if (app.draft) return app.draft.trouble[0] ?? "";
    const c = app.scene?.capacity;
    return !app.scene || sent ? "" : c ? tr`Stands. Collapse at ${number(Math.min(c.plus_g, c.minus_g), 3)} g.` : app.scene.falls ? tr`Cannot stand.` : "";
  }

  // Begin and end

  /** Draw on a blank sheet, or on the blocks of the deck. */
  function begin(blank = false) {
    app.setTab("structure");
    on = true;
    app.root.dataset.draw = "on";
    svg.toggleAttribute("hidden", false); bar.hidden = false;
    past = []; future = []; taken = []; it.chosen.clear(); view.w = 0;
    const start = (found) => {
      it.blocks = found.blocks; it.ground = found.ground;
      fresh = !it.blocks.length;
      setTool(fresh ? "pier" : "select");
      const { clientWidth: w, clientHeight: hgt } = box;
      view.w = w; view.h = hgt;
      set(svg, { viewBox: `0 0 ${w} ${hgt}`, width: w, height: hgt });
      if (fresh) send();
      fit();
      svg.focus({ preventScroll: true });
    };
    if (blank) start({ blocks: [], ground: [] }); else app.ask({ do: "sheet" }, { reply: (reply) => { if (reply.sheet) start(reply.sheet); } });
  }
  function close() {
    on = false;
    delete app.root.dataset.draw;
    svg.toggleAttribute("hidden", true); bar.hidden = true;
    app.drafted(null);
    app.drawing.zoom(null);
    app.sheet.button?.focus();
  }
  // the text was changed beside the sheet, or another deck was opened
  app.on("text", () => {
    if (!on || sent) return;
    app.ask({ do: "sheet" }, { reply: (reply) => { if (reply.sheet && !sent && !app.draft) { if (!reply.sheet.blocks.length) { close(); return; } it.blocks = reply.sheet.blocks; it.ground = reply.sheet.ground; fresh = false; draw(); } } });
  });
  app.on("beside", draw);
  app.on("theme", draw);
  app.on("tab", (name) => { if (on && name !== "structure") close(); });
  return Object.assign(it, { begin, close, zoom, drawing: () => on, place: () => [view.k, view.cx] });
}
