// Stored runs: charts and bodies of one analysis, stepped or played; two runs side by side.
import { chart } from "./chart.js";
import { download, h, number, s, set } from "./dom.js";
import { carried, space } from "./space.js";
import { piecesPath, stonesPath } from "./stage.js";
import { tr } from "./words.js";

export function resultsPanel(app, wide) {
  const columns = [column("A"), column("B")];
  const second = h("button", { "aria-pressed": "false", onclick: () => both(columns[1].box.hidden) }, tr`Compare two runs`);
  const linked = h("label", { hidden: true }, h("input", { type: "checkbox", checked: true }), tr` move both together`);
  const compute = h("button", { class: "first", onclick: () => computing() }, tr`Run the deck…`);
  const log = h("pre", { class: "log", hidden: true, "aria-live": "polite" });
  const bar = h("div", { class: "row wrap results-bar" }, compute, second, linked, h("button", { onclick: () => app.ask({ do: "list" }) }, tr`Refresh the list of runs`));
  const pair = h("div", { class: "columns" }, columns.map((c) => c.box));
  const apart = h("section", { class: "apart", hidden: true, "aria-label": tr`Differences of the two runs` });
  wide.append(bar, log, apart, pair);
  /** Numbers of both runs under the same names that differ: of A, of B, and the ratio. */
  function compared() {
    const [a, b] = columns.map((c) => new Map(c.words?.numbers ?? []));
    const rows = [...a].filter(([key, v]) => b.has(key) && b.get(key) !== v);
    apart.hidden = columns[1].box.hidden || !a.size || columns[0].words.kind !== columns[1].words?.kind;
    const said = (v) => (Number.isInteger(v) ? String(v) : typeof v === "number" ? number(v, 4) : v === null ? "–" : String(v));
    apart.replaceChildren(h("h3", {}, rows.length ? tr`Numbers that differ` : tr`No number differs.`), rows.length ? h("table", { class: "numbers" }, h("thead", {}, h("tr", {}, h("th", {}, ""), h("th", { scope: "col" }, "A"), h("th", { scope: "col" }, "B"), h("th", { scope: "col" }, "B / A"))),
      h("tbody", {}, rows.map(([key, v]) => { const w = b.get(key), both = typeof v === "number" && typeof w === "number" && v !== 0; return h("tr", {}, h("th", { scope: "row" }, key.replaceAll("_", " ")), h("td", {}, said(v)), h("td", {}, said(w)), h("td", {}, both ? number(w / v, 4) : "")); }))) : "");
  }
  columns[1].box.hidden = true;
  function both(shown) {
    columns[1].box.hidden = !shown; linked.hidden = !shown;
    second.setAttribute("aria-pressed", String(shown));
    for (const c of columns) c.redraw();
    compared();
  }
  app.results = { columns, both };

  let stopping = null;
  function computing() {
    const field = h("input", { type: "text", value: app.source.path ?? app.name, "aria-label": tr`Path of the deck within the folder` });
    const replace = h("input", { type: "checkbox", checked: Boolean(app.source.path) });
    const box = app.dialog(tr`Run the whole deck`, h("form", { onsubmit: (e) => {
      e.preventDefault();
      log.hidden = false; log.textContent = "";
      app.ask({ do: "compute", path: field.value, replace: replace.checked });
      stopping = true;
      box.close();
    } }, h("p", {}, tr("The page saves the deck and runs all its analyses, as the command `extrados run` does. The deck is saved as")), field, h("label", {}, replace, tr` replace an existing file`), h("div", { class: "row" }, h("button", { type: "submit", class: "first" }, tr`Run`))));
  }
  app.on("computing", (line, _, words) => {
    if (words.saved) app.source = { path: words.saved };
    if (line) log.textContent += `${line}\n`;
    log.scrollTop = log.scrollHeight;
    if (words.done) {
      log.textContent += "done\n";
      stopping = null;
      if (words.runs) {
        app.welcome.runs = words.runs;
        for (const c of columns) c.list();
        if (words.runs[0]) columns[0].load(words.runs[0].path);
      }
    }
    compute.textContent = stopping ? tr`Running…` : tr`Run the deck…`;
    compute.disabled = Boolean(stopping);
  });
  app.on("welcome", () => columns.forEach((c) => c.list()));
  app.on("folder", () => columns.forEach((c) => c.list()));
  app.on("run", (words, arrays) => columns.find((c) => c.side === words.side)?.take(words, arrays));
  app.on("tab", (name) => { if (name === "results") { app.ask({ do: "list" }); requestAnimationFrame(() => columns.forEach((c) => c.redraw())); } else columns.forEach((c) => c.pause()); });
  app.on("theme", () => columns.forEach((c) => c.redraw()));

  function column(side) {
    const it = { side, words: null, arrays: {}, time: 0, playing: null, path: "", charts: [], k: 0, load, list, take, redraw, pause, seek };
    const runs = h("select", { "aria-label": tr`Run ${side}`, onchange: () => load(runs.value) });
    const kinds = h("select", { "aria-label": tr`Analysis of run ${side}`, onchange: () => app.ask({ do: "run", path: it.path, analysis: kinds.value, side }) });
    const answer = h("p", { class: "answer-text" });
    const svg = s("svg", { class: "body-view", role: "img" });
    const figure = h("div", { class: "fill body-box" }, svg);
    const slider = h("input", { type: "range", min: 0, max: 1, step: "any", value: 0, "aria-label": tr`Position in run ${side}`, oninput: () => seek(Number(slider.value)) });
    const clock = h("output", { class: "clock" });
    const play = h("button", { "aria-label": tr`Play`, onclick: () => (it.playing ? pause() : run()) }, "▶");
    const scale = h("select", { "aria-label": tr`Scale of displacements`, onchange: () => picture() }, [1, 10, 100, 1000].map((v) => h("option", { value: v }, `× ${v}`)));
    const player = h("div", { class: "player" }, play, slider, clock, scale);
    const area = h("div", { class: "charts" });
    const numbers = h("table", { class: "numbers" }), tables = h("div", { class: "tables" }), more = h("details", {}, h("summary", {}, tr`Numbers`), numbers);
    const sheets = h("div", { class: "figures" }), report = h("details", { ontoggle: () => figures() }, h("summary", {}, tr`Figures of the report`), sheets);
    it.box = h("section", { class: "column", "aria-label": tr`Run ${side}` }, h("div", { class: "row" }, runs, kinds), answer, figure, player, area, tables, more, report);
    const view = space(figure);
    it.drawn = () => (it.words?.body?.sort === "space" ? view.svg : svg);
    figure.hidden = player.hidden = true;
    new ResizeObserver(() => redraw()).observe(figure);

    function list() {
      const there = app.welcome?.runs ?? [];
      runs.replaceChildren(h("option", { value: "" }, there.length ? tr`choose a run` : tr`no stored runs in the folder`), ...there.map((r) => h("option", { value: r.path, selected: r.path === it.path }, `${r.path}  (${new Date(1000 * r.time).toLocaleString()})`)));
    }
    function load(path) {
      if (!path) return;
      it.path = path; it.words = null;
      app.ask({ do: "run", path, side }, { reply: (words) => {
        const first = words.run?.analyses.find((a) => a.status === "ok");
        if (first) app.ask({ do: "run", path, analysis: first.name, side });
      } });
    }
    /** The figures as the report has them, once they are opened. */
    let pictures = [];
    function figures() {
      for (const url of pictures) URL.revokeObjectURL(url);
      pictures = [];
      sheets.replaceChildren();
      const name = it.words?.analysis;
      if (!report.open || !name) return;
      app.ask({ do: "figures", path: it.path, analysis: name }, { reply: (words) => {
        if (!words.figures || it.words?.analysis !== name) return;
        sheets.replaceChildren(...words.figures.map((one) => {
          const url = URL.createObjectURL(new Blob([one.svg], { type: "image/svg+xml" })), label = one.name.replaceAll("-", " ");
          pictures.push(url);
          return h("figure", {}, h("img", { src: url, alt: `${it.words.title}: ${name}, ${label}` }), h("figcaption", {}, label, " ", h("button", { onclick: () => download(new Blob([one.svg], { type: "image/svg+xml" }), `${name}-${one.name}.svg`) }, tr`Download`)));
        }), words.figures.length ? "" : h("p", { class: "hint" }, tr`This run has no figures, since the option --no-figures was given.`));
      } });
    }
    /** Nothing of an earlier run stands below the words of another. */
    function clear() {
      pause();
      it.arrays = {}; it.charts = [];
      figure.hidden = player.hidden = true;
      for (const part of [area, tables, numbers]) part.replaceChildren();
    }
    function take(words, arrays) {
      it.words = words;
      runs.value = words.path;
      kinds.replaceChildren(...words.analyses.map((a) => h("option", { value: a.name, selected: a.name === words.analysis }, `${a.name}${a.status === "ok" ? "" : ` (${a.status})`}`)));
      const told = words.analyses.find((a) => a.name === words.analysis) ?? words.analyses[0];
      const outcome = told?.verdict?.outcome;
      const mark = { stands: "good", collapses: "bad", "cannot-stand": "bad" }[outcome] ?? "";
      answer.replaceChildren(...(outcome ? [h("b", { class: mark }, tr`Verdict: ${outcome.replaceAll("-", " ")}. `), ...(told.verdict.violated ?? []).map((w) => h("span", { class: "warning" }, `${w} `))] : []), told ? told.answer || `${told.status}: ${told.reason}` : "");
      if (words.charts === undefined) { clear(); compared(); return; }
      it.arrays = arrays;
      figures();
      compared();
      numbers.replaceChildren(h("tbody", {}, (words.numbers ?? []).map(([k, v]) => h("tr", {}, h("th", { scope: "row" }, k), h("td", {}, typeof v === "number" ? number(v, 6) : String(v))))));
      const cell = (v) => (Number.isInteger(v) && Math.abs(v) < 1e7 ? String(v).replace("-", "−") : typeof v === "number" ? number(v, 5) : v === null ? "" : String(v));
      tables.replaceChildren(...(words.tables ?? []).map((t) => h("figure", {}, h("figcaption", {}, t.title), h("table", { class: "numbers rows" }, h("thead", {}, h("tr", {}, t.columns.map((c, k) => h("th", { scope: "col", class: typeof t.rows[0]?.[k] === "string" ? "text" : "" }, c.replaceAll("_", " "))))), h("tbody", {}, t.rows.map((row) => h("tr", {}, row.map((v) => h("td", { class: typeof v === "number" ? "" : "text" }, cell(v))))))), t.left_out ? h("p", {}, tr`and ${t.left_out} more, in the folder of the run`) : null)));
      more.open = !words.charts.length && !words.body;
      area.replaceChildren();
      it.charts = words.charts.map((spec) => {
        const box = h("div", { class: "fill chart-box" });
        area.append(box);
        return { spec, chart: chart(box, { onpick: spec.cursor ? (x) => seek(x / (spec.x.factor ?? 1)) : null }) };
      });
      it.time = 0; it.k = 0;
      const times = arrays.body_time;
      figure.hidden = !words.body; player.hidden = !words.body || !times || times.length < 2;
      scale.hidden = words.body?.sort !== "mesh" && !words.body?.walls;
      const solid = words.body?.sort === "space";
      svg.toggleAttribute("hidden", solid);
      view.show(solid ? { ...arrays, both: words.body.walls, push: words.body.push } : null);
      view.label = `${words.title}.`;
      if (times) { set(slider, { min: times[0], max: times[times.length - 1] }); it.time = times[0]; }
      if (scale.hidden === false) { // the state of the greatest load, moved so that it can be seen
        let k = 0;
        for (let i = 0; i < times.length; i += 1) if (arrays.state_held[i] && Math.abs(arrays.state_load[i]) > Math.abs(arrays.state_load[k])) k = i;
        it.time = times[k];
        const places = arrays.node ?? arrays.vertex, n = places.length, moved = arrays.state_moved;
        let far = 0, low = Infinity, high = -Infinity;
        for (let i = 0; i < n; i += 1) { low = Math.min(low, places[i]); high = Math.max(high, places[i]); far = Math.max(far, Math.abs(moved?.[n * k + i] ?? 0)); }
        scale.value = [1000, 100, 10].find((v) => v * far <= 0.08 * (high - low)) ?? 1;
      }
      redraw();
    }
    function redraw() {
      if (!it.words?.charts || it.box.hidden) return;
      for (const { spec, chart: c } of it.charts) c.draw({ ...spec, heat: spec.heat ?? undefined, marks: spec.marks && it.arrays[spec.marks] ? it.arrays[spec.marks] : undefined }, it.arrays);
      seek(it.time, false);
    }
    function seek(value, tell = true) {
      const times = it.arrays.body_time;
      if (times?.length) {
        it.time = Math.min(Math.max(value, times[0]), times[times.length - 1]);
        let low = 0, high = times.length - 1;
        while (low < high) { const m = (low + high + 1) >> 1; if (times[m] <= it.time + 1e-9) low = m; else high = m - 1; }
        it.k = low;
        slider.value = it.time;
        const unit = it.words.body?.unit ?? "";
        clock.textContent = it.words.body?.label === "event" ? tr`event ${Math.round(times[low])}` : `${number(it.time, 4)} ${unit}`;
        slider.setAttribute("aria-valuetext", `${it.words.body?.label} ${clock.textContent}`);
      } else it.time = value;
      picture();
      for (const { spec, chart: c } of it.charts) {
        if (spec.cursor) c.at(it.time * (spec.x.factor && it.words.body?.unit === "mm" ? 1 : 1));
        if (spec.trace === "state" && it.arrays.state_load && c.X) trace(c);
      }
      const other = columns?.find((o) => o !== it);
      if (tell && other && !other.box.hidden && linked.querySelector("input").checked && other.words?.body) other.seek(it.words.body?.unit === other.words.body.unit && it.words.body?.unit ? it.time : other.arrays.body_time[0] + (other.arrays.body_time.at(-1) - other.arrays.body_time[0]) * ((it.time - times[0]) / (times.at(-1) - times[0] || 1)), false);
    }
    /** The load of the state that is shown, on the load curve. */
    function trace(c) {
      const y = c.Y(it.arrays.state_load[it.k] * 1e-3), where = c.place();
      c.front.replaceChildren(s("line", { class: "cursor", x1: where.left, x2: where.left + where.w, y1: y, y2: y }));
    }
    function picture() {
      const body = it.words?.body, a = it.arrays, w = figure.clientWidth, hgt = figure.clientHeight;
      if (!body || !w || figure.hidden) return;
      if (body.sort === "space") { solids(a, body); return; }
      set(svg, { viewBox: `0 0 ${w} ${hgt}`, width: w, height: hgt, "aria-label": `${it.words.title}: ${body.label} ${clock.textContent}` });
      const xy = body.sort === "mesh" ? a.node : a.outline;
      let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity;
      for (let i = 0; i < xy.length; i += 2) { x0 = Math.min(x0, xy[i]); x1 = Math.max(x1, xy[i]); y0 = Math.min(y0, xy[i + 1]); y1 = Math.max(y1, xy[i + 1]); }
      const room = 0.1 * Math.max(x1 - x0, y1 - y0);
      x0 -= room; x1 += room; y1 += room; y0 -= 0.4 * room;
      const k = Math.min(w / (x1 - x0), hgt / (y1 - y0)), cx = (w - k * (x0 + x1)) / 2, cy = (hgt + k * (y0 + y1)) / 2;
      const world = s("g", { transform: `matrix(${k} 0 0 ${-k} ${cx} ${cy})` });
      if (body.sort === "mesh") mesh(world, a);
      else stones(world, a, body);
      svg.replaceChildren(world);
      if (body.lines?.length) svg.append(s("g", {}, body.lines.map((l, i) => s("text", { class: `line-label ${l.name}`, x: 10, y: 16 + 15 * i, text: `— ${l.label}` }))));
    }
    function solids(a, body) {
      if (body.over_time) { const n = a.pose.shape[1] * 6; view.move(carried(a, a.pose.subarray(n * it.k, n * (it.k + 1)), 1)); return; }
      if (!body.walls) { view.move(carried(a, a.pose, it.time)); return; }
      const n = a.vertex.length, off = n * it.k, factor = Number(scale.value), place = new Float32Array(n), faces = a.face_start.length - 1;
      for (let i = 0; i < n; i += 1) place[i] = a.vertex[i] + factor * a.state_moved[off + i];
      view.move(place, a.state_tone.subarray(faces * it.k, faces * (it.k + 1)));
      clock.textContent = `event ${Math.round(a.body_time[it.k])}, base shear ${number(a.state_load[it.k] / 1e3, 4)} kN, widest crack ${number(1e3 * a.state_width[it.k], 2)} mm`;
    }
    function stones(world, a, body) {
      if (a.support_outline) world.append(s("path", { class: "supports", d: stonesPath(a.support_outline, a.support_start) }));
      const blocks = a.outline_start.length - 1;
      if (a.body_pose) {
        const off = 3 * blocks * it.k;
        world.append(s("path", { class: "ghost", d: stonesPath(a.outline, a.outline_start) }), s("path", { class: "stones", d: stonesPath(a.outline, a.outline_start, a.centroid, a.body_pose, off) }));
        if (a.body_line) { const n = a.body_line.shape[1], line = a.body_line.subarray(2 * n * it.k, 2 * n * (it.k + 1)); world.append(s("path", { class: "thrust dynamic", d: piecesPath(line, [0, n]) })); }
      } else world.append(s("path", { class: "stones", d: stonesPath(a.outline, a.outline_start) }));
      const still = !a.body_pose || (body.swings && it.k === 0);
      if (still) for (const l of body.lines ?? []) world.append(s("path", { class: `thrust ${l.name === "collapse" ? "plus" : l.name}`, d: piecesPath(a[`${l.name}_line`], a[`${l.name}_start`]) }));
    }
    function mesh(world, a) {
      const factor = Number(scale.value), n = a.node.length / 2, off = 2 * n * it.k, place = new Float32Array(2 * n);
      for (let i = 0; i < 2 * n; i += 1) place[i] = a.node[i] + (a.state_moved ? factor * a.state_moved[off + i] : 0);
      let d = "";
      for (let e = 0; e + 1 < a.element_start.length; e += 1) {
        for (let i = a.element_start[e]; i < a.element_start[e + 1]; i += 1) { const p = a.element[i]; d += `${i === a.element_start[e] ? "M" : "L"}${place[2 * p].toFixed(4)} ${place[2 * p + 1].toFixed(4)}`; }
        d += "Z";
      }
      world.append(s("path", { class: "mesh", d }));
      if (!a.state_width_n) return;
      const points = a.point_xy.length / 2, at = points * it.k, levels = ["", "", "", ""];
      let most = 1e-9;
      for (let i = 0; i < points; i += 1) most = Math.max(most, a.state_width_n[at + i] || 0, a.state_width_s?.[at + i] || 0);
      for (let i = 0; i < points; i += 1) {
        const e = a.point_element?.[i] ?? -1;
        let ux = 0, uy = 0;
        if (e >= 0 && a.state_moved) { const from = a.element_start[e], to = a.element_start[e + 1]; for (let j = from; j < to; j += 1) { ux += a.state_moved[off + 2 * a.element[j]] / (to - from); uy += a.state_moved[off + 2 * a.element[j] + 1] / (to - from); } }
        const x = a.point_xy[2 * i] + factor * ux, y = a.point_xy[2 * i + 1] + factor * uy, half = 0.45 * (a.point_reach?.[i] ?? a.point_band?.[i] ?? 0.05);
        for (const [width, turn] of [[a.state_width_n[at + i], Math.PI / 2], [a.state_width_s?.[at + i] ?? 0, 0]]) {
          if (!(width > Math.max(1e-3 * most, 1e-9))) continue;
          const angle = a.state_angle[at + i] + turn, c = half * Math.cos(angle), t = half * Math.sin(angle);
          levels[Math.min(3, Math.floor((4 * width) / most))] += `M${(x - c).toFixed(4)} ${(y - t).toFixed(4)}L${(x + c).toFixed(4)} ${(y + t).toFixed(4)}`;
        }
      }
      levels.forEach((path, k) => world.append(s("path", { class: `crack w${k}`, d: path })));
      clock.textContent = `event ${Math.round(a.body_time[it.k])}, ${number(a.state_load[it.k] / 1e3, 4)} kN, widest crack ${number(1e3 * most, 2)} mm`;
    }
    function pause() { if (it.playing) cancelAnimationFrame(it.playing); it.playing = null; play.textContent = "▶"; }
    function run() {
      const times = it.arrays.body_time, end = times[times.length - 1], real = it.words.body.unit === "s";
      if (it.time >= end - 1e-9) it.time = times[0];
      let last = performance.now();
      const speed = real ? 1 : (end - times[0]) / 6;
      const step = (now) => {
        const to = it.time + ((now - last) / 1000) * speed;
        last = now;
        seek(to);
        if (to >= end) { pause(); return; }
        it.playing = requestAnimationFrame(step);
      };
      play.textContent = "❚❚";
      it.playing = requestAnimationFrame(step);
    }
    return it;
  }
}
