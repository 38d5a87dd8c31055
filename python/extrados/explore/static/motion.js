// Motion: the pulse or record, the rocking response over earlier ones, the map of pulses, energy, friction, and play.
import { chart } from "./chart.js";
import { h, number, quantity, s, set } from "./dom.js";
import { said } from "./said.js";
import { tr } from "./words.js";

const SPEEDS = [[1, tr`real time`], [0.5, tr`half`], [0.2, tr`a fifth`], [0.05, tr`a twentieth`]];

export function motionPanel(app, lower, frame) {
  const it = { arrays: null, words: null, earlier: [], time: 0, playing: null, speed: 0.2, stop: false, map: null, mark: "" };
  app.motion = it;
  const box = (name) => h("div", { class: "fill", "data-chart": name });
  const boxes = { pulse: box("pulse"), history: box("history"), map: box("map"), energy: box("energy"), friction: box("friction") };
  const mapLegend = h("div", { class: "map-legend", "aria-label": tr`Outcomes on the map` });
  const thirds = { map: h("div", { class: "fill beside" }, boxes.map, mapLegend), energy: boxes.energy, friction: boxes.friction };
  const words = h("p", { class: "outcome", role: "status" });
  const impulse = h("p", { class: "impulse" });
  const keep = h("button", { title: tr`Keep this response in the picture`, onclick: () => { if (it.arrays) { it.earlier.push({ time: it.arrays.time, rotation: it.arrays.rotation }); if (it.earlier.length > 5) it.earlier.shift(); draw(); } } }, tr`Keep`);
  const drop = h("button", { onclick: () => { it.earlier = []; draw(); } }, tr`Clear`);
  const kinds = h("select", { "aria-label": tr`Kind of motion`, onchange: (e) => begin(e.target.value) }, h("option", { value: "" }, tr`choose a motion`), h("option", { value: "step-pulse" }, tr`step pulse`), h("option", { value: "sine-pulse" }, tr`sine pulse`), h("option", { value: "harmonic" }, tr`harmonic`), h("option", { value: "record" }, tr`El Centro 1940`));
  const lowerTabs = h("div", { class: "tabs small", role: "tablist", "aria-label": tr`Charts` }, [["map", tr`Map of pulses`], ["energy", tr`Energy`], ["friction", tr`Friction`]].map(([name, label]) => h("button", { role: "tab", "data-third": name, onclick: () => third(name) }, label)));
  const panel = h("div", { class: "cards motion", "data-for": "motion" },
    h("div", { class: "card" }, h("div", { class: "card-head" }, h("h2", {}, tr`Motion`), kinds), boxes.pulse),
    h("div", { class: "card" }, h("div", { class: "card-head" }, h("h2", {}, tr`Rocking`), keep, drop), boxes.history),
    h("div", { class: "card" }, h("div", { class: "card-head" }, lowerTabs), ...Object.values(thirds)));
  lower.append(panel);
  const slider = h("input", { type: "range", min: 0, max: 1, step: "any", value: 0, "aria-label": tr`Time`, oninput: () => seek(Number(slider.value)) });
  const clock = h("output", { class: "clock" });
  const play = h("button", { class: "play", "aria-label": tr`Play`, onclick: () => toggle() }, "▶");
  const player = h("div", { class: "player", hidden: true }, play, slider, clock,
    h("select", { "aria-label": tr`Speed`, onchange: (e) => { it.speed = Number(e.target.value); } }, SPEEDS.map(([v, label]) => h("option", { value: v, selected: v === it.speed }, label))),
    h("label", {}, h("input", { type: "checkbox", onchange: (e) => { it.stop = e.target.checked; } }), tr` stop at impacts`));
  const answer = h("div", { class: "motion-words", hidden: true, role: "group", "aria-label": tr`Response in words`, tabindex: "0" }, words, impulse);
  frame.prepend(answer);
  frame.append(player);

  const charts = {
    pulse: chart(boxes.pulse, { ondraw: pulseHandles }),
    history: chart(boxes.history, { onpick: (t) => seek(t) }),
    map: chart(boxes.map, { onpick: place, ondraw: dot }),
    energy: chart(boxes.energy, { onpick: (t) => seek(t) }), friction: chart(boxes.friction),
  };
  let shownThird = "map";
  function third(name) {
    shownThird = name;
    for (const key of ["map", "energy", "friction"]) thirds[key].hidden = key !== name;
    for (const button of lowerTabs.children) button.setAttribute("aria-selected", button.dataset.third === name);
    draw();
  }
  third("map");

  app.on("tab", (name) => {
    const there = name === "motion";
    panel.hidden = player.hidden = answer.hidden = !there;
    frame.classList.toggle("with-player", there);
    if (there) { refresh(); requestAnimationFrame(draw); } else { pause(); app.drawing.pose(null); }
  });
  app.on("scene", (opened, when) => {
    if (opened) { it.earlier = []; it.arrays = it.words = it.map = it.ground = it.impulse = null; words.textContent = impulse.textContent = ""; pause(); draw(); }
    const motion = app.deck?.motion;
    kinds.value = motion ? ([...kinds.options].some((o) => o.value === motion.kind) ? motion.kind : "") : "";
    if (app.tab === "motion") refresh(when);
  });
  app.on("theme", () => draw());
  app.on("complaint", (told, message) => {
    const text = (told.complaints ?? [told.bad]).join(" ");
    if (message?.do === "rocking") none(text, null);
    else if (message?.do === "domain") { it.map = { why: text }; drawMap(); }
    else if (message?.do === "impulse") impulse.textContent = tr`No primary impulse: ${text}`;
  });
  /** Say why there is no response; the motion, where there is one, is drawn all the same. */
  function none(text, ground) {
    it.arrays = it.words = null; it.ground = ground;
    words.textContent = text;
    slider.disabled = play.disabled = true;
    clock.textContent = "";
    app.drawing.pose(null);
    draw();
  }

  let slow = null;
  function refresh(when) {
    if (!app.scene) return;
    if (app.deck?.motion) app.ask({ do: "rocking", lane: "rocking" }, { when: when ?? performance.now() });
    else { none(tr`There is no motion yet: choose one below, or drop a record on the page.`, null); }
    clearTimeout(slow);
    slow = setTimeout(() => {
      if (app.deck?.structure) app.ask({ do: "domain", lane: "domain" });
      if (app.deck?.structure && app.deck?.motion?.kind === "record") app.ask({ do: "impulse", lane: "impulse" });
    }, 60);
  }
  const blank = (title) => ({ title, x: { label: tr`time`, unit: "s" }, y: { label: tr`acceleration`, unit: "g" }, series: [], span: [0, 1] });
  function begin(kind) {
    const g = app.scene?.capacity ? Math.max(1.6 * app.scene.capacity.plus_g, 0.02) : 0.3;
    const amplitude = `${Number(g.toPrecision(2))} g`, time = Number((0.08 * Math.sqrt(app.scene?.size_m ?? 4)).toPrecision(2));
    const tables = { "step-pulse": { kind, amplitude, duration: time }, "sine-pulse": { kind, amplitude, period: 2 * time }, harmonic: { kind, amplitude, frequency: 1, duration: 6 }, record: { kind, file: "extrados:el-centro-1940" } };
    if (tables[kind]) app.change({ motion: tables[kind] });
  }
  app.on("rocking", (told, arrays) => {
    if (told.refused) { none(told.refused, arrays); return; }
    it.words = told; it.arrays = it.ground = arrays;
    const open = told.violated.length > 0;
    const verdict = open ? tr`Outcome open: an assumption does not hold. ` : { "no-hinging": tr`No rocking. `, recovery: tr`Rocking, then recovery. `, collapse: tr`Collapse. ` }[told.outcome] ?? "";
    words.replaceChildren(h("b", { class: open ? "" : told.outcome === "collapse" ? "bad" : "good" }, verdict), said(told.answer), ...told.warnings.slice(0, 2).map((w) => h("span", { class: "warning" }, ` ${said(w)}`)));
    it.end = told.active_s || 1;
    const end = it.end;
    set(slider, { max: end });
    slider.disabled = play.disabled = !arrays.pose;
    it.time = Math.min(it.time, end);
    draw(false);
    seek(it.time, false);
  });
  app.on("impulse", (told) => { impulse.textContent = told.refused ? tr`No primary impulse: ${told.refused}` : told.answer; it.impulse = told; draw(); });
  app.on("domain", (told, arrays) => { it.map = { told, arrays }; drawMap(); });

  /** map: the map of pulses too, which a new response leaves as it is. */
  function draw(map = true) {
    if (app.tab !== "motion") return;
    const { arrays, words: told, ground } = it;
    if (!ground?.motion) charts.pulse.draw(blank(tr`Ground acceleration`), {});
    else {
      let [low, high] = [0, 0];
      for (const v of ground.motion) { low = Math.min(low, v); high = Math.max(high, v); }
      charts.pulse.draw({ title: tr`Ground acceleration`, x: { array: "motion_time", label: tr`time`, unit: "s" }, y: { label: tr`acceleration`, unit: "g" }, series: [{ array: "motion", label: tr`ground` }], least: Math.min(0, 1.1 * low), most: Math.max(0, 1.22 * high) }, ground);
    }
    if (!arrays) { for (const key of ["history", "energy", "friction"]) charts[key].draw({ ...blank({ history: tr`Rotation`, energy: tr`Energy`, friction: tr`Friction along the joints` }[key]), y: { label: "", unit: "" } }, {}); }
    else {
      const critical = 1e3 * told.critical_rad[0], most = 1e3 * Math.abs(told.peak_rotation_rad);
      const flat = (v) => ({ x: Float32Array.of(0, arrays.time.at(-1) || 1), y: Float32Array.of(v, v) });
      const level = flat(critical), under = flat(-1e3 * told.critical_rad[1]);
      const showLimit = most > 0.25 * critical;
      charts.history.draw({ title: tr`Rotation`, x: { array: "time", label: tr`time`, unit: "s" }, y: { label: tr`rotation`, unit: "mrad" }, symmetric: true, span: [0, it.end], marks: Float64Array.from(told.impact_times_s),
        series: [...it.earlier.map((e) => ({ array: e.rotation, x: e.time, label: tr`earlier`, factor: 1e3, faint: true, unnamed: true, colour: 5 })), { array: "rotation", label: arrays.rotation_upper ? tr`lower block` : tr`now`, factor: 1e3, unnamed: !arrays.rotation_upper, colour: 0 },
          ...(arrays.rotation_upper ? [{ array: "rotation_upper", label: tr`upper block`, factor: 1e3, colour: 2, dashed: true }] : []),
          ...(showLimit ? [{ array: level.y, x: level.x, label: tr`critical`, dashed: true, colour: 1, unnamed: true }, { array: under.y, x: under.x, label: tr`critical`, dashed: true, colour: 1, unnamed: true }] : [])] }, arrays);
      const axis = { array: "time", label: tr`time`, unit: "s" }, span = [0, it.end];
      const big = Math.max(...[...arrays.potential, ...arrays.kinetic].map(Math.abs), 1e-12), kilo = big > 2000 ? [1e-3, "kJ"] : [1, "J"];
      if (shownThird === "energy") charts.energy.draw({ title: tr`Energy`, span, x: axis, y: { label: tr`energy`, unit: kilo[1] }, series: [{ array: "kinetic", label: tr`kinetic`, factor: kilo[0] }, { array: "potential", label: tr`potential`, factor: kilo[0] }, { array: "ledger", label: tr`energy supplied less energy lost`, dashed: true, factor: kilo[0] }] }, arrays);
    }
    if (map || !it.map || it.map.why) drawMap(); else dot(charts.map);
    cursors();
  }
  function drawMap() {
    if (app.tab !== "motion" || shownThird !== "map") return;
    for (const old of boxes.map.querySelectorAll(".map-why, .remark")) old.remove();
    if (it.map?.why) boxes.map.append(h("p", { class: "map-why" }, tr`No map: ${it.map.why}.`));
    if (!it.map || it.map.why) { mapLegend.replaceChildren(); charts.map.draw({ title: tr`Pulses that cause collapse`, x: { label: tr`duration`, unit: "s" }, y: { label: tr`amplitude`, unit: "g" }, series: [], span: [0, 1] }, {}); return; }
    const { told, arrays } = it.map;
    charts.map.draw({ title: told.pulse === "step" ? tr`Collapse by step pulses` : tr`Collapse by sine pulses`, x: { array: "duration", label: told.pulse === "step" ? "t_p" : "T_p", unit: "s" }, y: { label: tr`amplitude`, unit: "g" }, series: [], heat: { codes: "codes", x: "duration", y: "amplitude", stride: told.stride }, least: 0 }, arrays);
    mapLegend.replaceChildren(...told.outcomes.map((o, k) => h("span", {}, h("i", { class: `m${k}` }), said(o))));
    boxes.map.append(...(told.conditions ?? []).map((text) => h("p", { class: "remark" }, said(text))));
  }
  function pulse() {
    const found = app.deck?.motion?.pulse;
    if (found) return found;
    const first = it.impulse?.impulses?.[0];
    return first && app.deck?.motion?.kind === "record" ? { duration_s: first.period_s, amplitude_g: Math.abs(first.amplitude_g), record: true } : null;
  }
  function dot(c) {
    const p = pulse();
    if (!p || !c.X || shownThird !== "map" || it.map?.why) { c.front.replaceChildren(); return; }
    const where = c.place(), x = Math.min(Math.max(c.X(p.duration_s), where.left), where.left + where.w), y = Math.min(Math.max(c.Y(p.amplitude_g), where.top), where.top + where.h);
    const label = p.record ? tr`primary impulse` : tr`present pulse`;
    const text = tr`${label}: ${quantity(p.amplitude_g, "g", 3)} for ${quantity(p.duration_s, "s", 3)}`;
    if (c.dot?.isConnected) { set(c.dot, { transform: `translate(${x} ${y})`, "aria-valuetext": text }); return; }
    c.dot = s("g", { class: "dot-now", transform: `translate(${x} ${y})`, role: "slider", tabindex: "0", "aria-label": tr`Pulse on the map`, "aria-valuenow": p.amplitude_g, "aria-valuetext": text, onkeydown: keys }, s("circle", { r: 7 }), s("circle", { r: 2 }));
    c.front.replaceChildren(c.dot);
  }
  function keys(e) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key], p = pulse();
    if (!step || !p) return;
    e.preventDefault();
    const m = e.shiftKey ? 0.1 : 0.02;
    pulseTo(p.duration_s * (1 + m * step[0]), p.amplitude_g * (1 + m * step[1]));
  }
  /** Give the pulse another duration and amplitude; only pulses have them. */
  function pulseTo(duration, amplitude, when) {
    const motion = app.deck?.motion;
    if (!motion?.pulse) return;
    const sign = motion.amplitude < 0 ? -1 : 1;
    const key = motion.kind === "step-pulse" ? "duration" : "period";
    app.change({ "motion.amplitude": `${Number((sign * Math.max(amplitude, 1e-3)).toPrecision(3))} g`, [`motion.${key}`]: Number(Math.max(duration, 1e-3).toPrecision(3)) }, "pulse", { rocking: true }, when);
  }
  function place(x, y) { if (pulse() && !pulse().record) pulseTo(x, y); else if (!app.deck?.motion) begin("step-pulse"); }
  function pulseHandles(c) {
    const motion = app.deck?.motion;
    if (!motion?.pulse || !c.X) { c.front.replaceChildren(); return; }
    const step = motion.kind === "step-pulse", p = motion.pulse, sign = motion.amplitude < 0 ? -1 : 1;
    const spots = { amplitude: [step ? 0.5 * p.duration_s : 0.25 * p.duration_s, sign * p.amplitude_g], duration: [p.duration_s, step ? 0 : 0] };
    for (const [name, [t, a]] of Object.entries(spots)) {
      c.knobs ??= {};
      const label = name === "amplitude" ? tr`Amplitude of the pulse` : step ? tr`Duration of the first part` : tr`Period of the pulse`;
      const text = name === "amplitude" ? quantity(sign * p.amplitude_g, "g", 3) : quantity(p.duration_s, "s", 3);
      let knob = c.knobs[name];
      if (!knob) {
        const tag = s("text", { class: "knob-tag", x: 10, y: -8 });
        knob = c.knobs[name] = s("g", { class: "knob pulse", role: "slider", tabindex: "0", "aria-label": label, "data-handle": `pulse-${name}` }, s("circle", { class: "hit", r: 13 }), s("path", { class: "arrows", d: name === "amplitude" ? "M0 -9L-5 -4H5ZM0 9L-5 4H5Z" : "M-9 0L-4 -5V5ZM9 0L4 -5V5Z" }), s("circle", { class: "dot", r: 4 }), tag);
        knob.tagText = tag;
        knob.addEventListener("pointerdown", (e) => grab(e, knob, name, c));
        knob.addEventListener("dblclick", () => write(name));
        knob.addEventListener("keydown", (e) => {
          const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: 1, ArrowDown: -1 }[e.key], now = app.deck.motion.pulse;
          if (e.key === "Enter") { e.preventDefault(); write(name); return; }
          if (!step) return;
          e.preventDefault();
          const m = 1 + (e.shiftKey ? 0.1 : 0.02) * step;
          if (name === "amplitude") pulseTo(now.duration_s, now.amplitude_g * m); else pulseTo(now.duration_s * m, now.amplitude_g);
        });
      }
      if (knob.parentNode !== c.front) c.front.append(knob);
      set(knob, { transform: `translate(${c.X(t)} ${c.Y(a)})`, "aria-valuenow": name === "amplitude" ? p.amplitude_g : p.duration_s, "aria-valuetext": text });
      knob.tagText.textContent = text;
      const where = c.place(), cut = c.X(t) + 14 + 6 * text.length > where.left + where.w + 14;
      set(knob.tagText, { x: cut ? -12 : 10, "text-anchor": cut ? "end" : null });
    }
  }
  function write(name) {
    const motion = app.deck.motion, key = name === "amplitude" ? "amplitude" : motion.kind === "step-pulse" ? "duration" : "period";
    const field = h("input", { type: "text", value: name === "amplitude" ? `${number(motion.pulse.amplitude_g, 5)} g` : number(motion.pulse.duration_s, 5), "aria-label": key });
    const box = app.dialog(key, h("form", { onsubmit: (e) => { e.preventDefault(); const text = field.value.trim().replaceAll("−", "-"); app.change({ [`motion.${key}`]: /^[-+\d.]+$/.test(text) ? (name === "amplitude" ? `${text} g` : Number(text)) : text }); box.close(); } }, field, h("button", { type: "submit", class: "first" }, tr`Set`)));
  }
  function grab(event, knob, name, c) {
    event.preventDefault(); event.stopPropagation();
    knob.focus({ preventScroll: true });
    knob.setPointerCapture(event.pointerId);
    const kind = "onpointerrawupdate" in window ? "pointerrawupdate" : "pointermove";
    const edge = c.svg.getBoundingClientRect(), step = app.deck.motion.kind === "step-pulse";
    const invert = c.invert;
    const move = (e) => {
      const [t, a] = invert(e.clientX - edge.left, e.clientY - edge.top), now = app.deck.motion.pulse;
      if (name === "amplitude") pulseTo(now.duration_s, Math.max(app.deck.motion.amplitude < 0 ? -a : a, 1e-3), e.timeStamp); else pulseTo(Math.max(t, 0.005), now.amplitude_g, e.timeStamp);
    };
    knob.addEventListener(kind, move);
    const up = () => { knob.removeEventListener(kind, move); };
    knob.addEventListener("pointerup", up, { once: true });
    knob.addEventListener("pointercancel", up, { once: true });
  }

  // Play

  function seek(time, tellIt = true) {
    const a = it.arrays;
    if (!a?.pose || app.tab !== "motion") return;
    const end = it.end;
    it.time = Math.min(Math.max(time, 0), end);
    slider.value = it.time;
    clock.textContent = tr`${it.time.toFixed(3)} s of ${end.toFixed(2)} s`;
    slider.setAttribute("aria-valuetext", clock.textContent);
    const k = frameAt(it.time), blocks = a.pose.shape[1], n = a.line ? a.line.shape[1] : 0;
    const turned = a.picture_time.length > 0;
    it.frame = k;
    const [p, w] = [a.picture_time[k], a.picture_time[k + 1]];
    const share = w > p ? Math.min(1, (it.time - p) / (w - p)) : 0;
    const pose = new Float32Array(blocks * 3), at = 3 * blocks * k, next = share > 0 ? at + 3 * blocks : at;
    for (let i = 0; i < pose.length; i += 1) pose[i] = a.pose[at + i] + share * (a.pose[next + i] - a.pose[at + i]);
    const piers = a.moving_outline ? { outline: a.moving_outline, outline_start: a.moving_start, centroid: a.moving_centroid } : null;
    if (turned && (piers ?? app.arrays).centroid?.length === 2 * blocks) app.drawing.pose(pose, { line: a.line, lineOffset: a.line ? 2 * n * k : 0, points: n, body: piers });
    cursors();
  }
  function frameAt(time) {
    const t = it.arrays.picture_time;
    let low = 0, high = t.length - 1;
    while (low < high) { const m = (low + high + 1) >> 1; if (t[m] <= time) low = m; else high = m - 1; }
    return low;
  }
  function cursors() {
    charts.history.at(it.time); charts.pulse.at(it.time);
    if (shownThird === "energy") charts.energy.at(it.time);
    if (shownThird === "friction" && it.arrays?.friction) {
      const n = it.arrays.friction.shape[1], k = it.frame ?? 0;
      const now = it.arrays.friction.subarray(k * n, (k + 1) * n), joint = Float32Array.from({ length: n }, (_, j) => j), most = new Float32Array(n);
      for (let i = 0; i < it.arrays.friction.length; i += 1) { const v = it.arrays.friction[i]; if (Number.isFinite(v) && v > most[i % n]) most[i % n] = Math.min(v, 2); }
      charts.friction.draw({ title: tr`Friction needed at ${it.time.toFixed(2)} s`, x: { array: "joint", label: tr`joint`, unit: "" }, y: { label: tr`coefficient`, unit: "" }, series: [{ array: "now", label: tr`now`, sort: n > 60 ? "line" : "both" }, { array: "most", label: tr`greatest so far`, dashed: true }], least: 0, most: 1 }, { joint, now: now.map((v) => Math.min(v, 2)), most });
    }
  }
  function toggle() { if (it.playing) pause(); else run(); }
  function pause() { if (it.playing) cancelAnimationFrame(it.playing); it.playing = null; play.textContent = "▶"; play.setAttribute("aria-label", tr`Play`); }
  function run() {
    const a = it.arrays;
    if (!a?.pose) return;
    const end = it.end;
    if (it.time >= end - 1e-6) it.time = 0;
    play.textContent = "❚❚"; play.setAttribute("aria-label", tr`Pause`);
    let last = performance.now();
    const step = (now) => {
      const before = it.time;
      let to = it.time + ((now - last) / 1000) * it.speed;
      last = now;
      if (it.stop) { const hit = it.words.impact_times_s.find((t) => t > before + 1e-9 && t <= to); if (hit !== undefined) { seek(hit); pause(); app.say(tr`impact at ${hit.toFixed(3)} s`); return; } }
      seek(to);
      if (to >= end) { pause(); return; }
      it.playing = requestAnimationFrame(step);
    };
    it.playing = requestAnimationFrame(step);
  }
  it.seek = seek; it.toggle = toggle; it.pause = pause;
  app.root.addEventListener("keydown", (e) => { if (e.key === " " && app.tab === "motion" && !e.composedPath()[0].matches?.("input, textarea, button, select")) { e.preventDefault(); toggle(); } });
}
