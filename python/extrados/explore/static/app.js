// The page: the open deck, the requests to the session, and the layout.
import { h, number, quantity } from "./dom.js";
import { stage } from "./stage.js";
import { structurePanel } from "./structure.js";
import { motionPanel } from "./motion.js";
import { resultsPanel } from "./results.js";
import { solidPanel } from "./solid.js";
import { outMenu } from "./out.js";
import { classPanel } from "./class.js";
import { fallPanel } from "./fall.js";
import { deckOf, fragmentOf } from "./share.js";
import { planPanel } from "./plan.js";
import { sheetPanel } from "./sheet.js";
import { said } from "./said.js";
import { sidebar } from "./sidebar.js";
import { choose, language, LANGUAGES, tr } from "./words.js";

const REST = 130; // ms without a change, after which the hand rests
const BESIDE = 100; // ms between two looks of what stands beside the drawing while a hand moves
const SAID = 8000; // ms for which words at the foot stay that complain of nothing
const KEPT = "extrados-kept";
const CHANGE = new Set(["hello", "open", "draw", "draw-plan", "drop", "blocks", "analysis", "drag", "set", "show", "rocking"]); // messages that change the picture
const TABS = [["structure", tr`Structure`], ["motion", tr`Motion`], ["results", tr`Results`]];

export function mount(root, transport, film, { embedded = false } = {}) {
  const app = {
    root, transport, film, embedded, words: {}, scene: null, arrays: {}, handles: [], deck: null, text: "", name: "", source: {}, forms: [], drops: [],
    detail: null, tab: "structure", view: { gamma: 0, through: null, thrust: null, chain: null }, welcome: null, timings: [],
    layers: { least: true, most: true, through: true, plus: true, minus: false, central: false, reactions: true, joints: true },
    ask, change, show, edit, say, open, rest, on, tellDetail: () => tell("detail"),
    /** True at rest: all requested results are shown, and the text is up to date. */
    get still() { return !moved && !unanswered.size; },
    undo: () => (board() ? board().undo() : travel(-1)), redo: () => (board() ? board().redo() : travel(1)), drafted, draft: null, typed, setTab, remember, dialog,
  };
  const board = () => [app.sheet, app.plan].find((one) => one?.drawing()); // the sheet or the plan, while it is open
  const listeners = {};
  const waiting = new Map(); // number of a message -> what to do with its replies
  const flying = new Map(); // lane -> {busy, next}
  const unanswered = new Set(); // numbers of messages that change the picture
  let counter = 0, scenes = 0, moved = true, held = false, timer = null, beside = null, besides = -BESIDE, past = [], future = [], travelling = false, dirty = false, connected = false, wasOpen = false, start = null;
  let last = null; // the deck of the last page, which this one replaces with its first change
  try { last = JSON.parse(localStorage.getItem(KEPT)); } catch { /* a browser without storage */ }

  function on(event, listener) { (listeners[event] ??= []).push(listener); }
  function tell(event, ...rest) { for (const listener of listeners[event] ?? []) listener(...rest); }

  // The shell

  const status = h("div", { class: "status", role: "status", "aria-live": "polite" });
  const banner = h("div", { class: "banner", role: "alert", hidden: true });
  const undoButton = h("button", { class: "icon", title: tr`Undo (Ctrl+Z)`, "aria-label": tr`Undo`, onclick: () => app.undo() }, "↶");
  const redoButton = h("button", { class: "icon", title: tr`Redo (Ctrl+Shift+Z)`, "aria-label": tr`Redo`, onclick: () => app.redo() }, "↷");
  const title = h("h1", { class: "title" });
  const tabs = h("div", { class: "tabs", role: "tablist", "aria-label": tr`Views` }, TABS.map(([name, label], k) =>
    h("button", { role: "tab", id: `tab-${name}`, "data-tab": name, onclick: () => setTab(name), onkeydown: (e) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
      if (step) { const next = TABS[(k + step + TABS.length) % TABS.length][0]; setTab(next); root.querySelector(`[data-tab=${next}]`).focus(); }
    } }, label)));
  const themeButton = h("button", { class: "icon", title: tr`Dark or light`, "aria-label": tr`Dark or light`, onclick: theme }, "◐");
  const top = h("header", { class: "top" },
    h("span", { class: "brand" }, "extrados"),
    h("button", { class: "open", onclick: () => chooser() }, tr`Open…`), undoButton, redoButton, title, tabs);
  const stageBox = h("div", { class: "stage-box" });
  const layersBar = h("div", { class: "layers", role: "group", "aria-label": tr`What is drawn` });
  const stageFrame = h("section", { class: "stage-frame", "aria-label": tr`Drawing` }, layersBar, stageBox);
  const lower = h("section", { class: "lower", "aria-label": tr`Details` });
  const wide = h("section", { class: "wide", hidden: true }), classBox = h("section", { class: "wide", hidden: true, "aria-label": tr`Class` });
  const side = h("aside", { class: "side", "aria-label": tr`Numbers, sizes and deck` });
  const mainBox = h("main", { class: "main" }, stageFrame, lower, wide, classBox);
  root.replaceChildren(top, banner, h("div", { class: "body" }, mainBox, side), status);

  const drawing = stage(stageBox, {
    drag: (name, place, ends, when) => ask({ do: "drag", handle: name, to: place, ends, lane: `drag:${name}` }, { when }),
    step: (name, dx, dy) => {
      if (name === "tilt") show({ gamma: Math.round((app.view.gamma + 0.005 * (dx - dy)) * 1e4) / 1e4 });
      else if (name === "through") nudgeThrough(dx + dy);
      else ask({ do: "drag", handle: name, by: [dx, dy] });
    },
    type: (name, data) => typed(name, data),
    through: (place, ends, when) => show({ through: place }, when),
    begin: (event) => pressed(event),
    tilt: (gamma, ends, when) => show({ gamma: Math.round(gamma * 2000) / 2000 }, when),
  });
  app.drawing = drawing;
  app.solid = solidPanel(app, stageBox);
  drawing.layers = app.layers;
  /** Whether a line with its hinges is drawn: as chosen, but of a collapse the side to which the structure falls. */
  app.drawn = drawing.drawn = (name) => (["plus", "minus"].includes(name) && ["plus", "minus"].includes(app.scene?.falls) ? app.scene.falls === name : app.layers[name]);

  /** Choose the line that has a thrust, between the least and the greatest; text may have a unit. */
  app.choose = (thrust, when) => { reveal(); show({ thrust, lines: app.view.lines }, when); };
  function reveal() {
    app.layers.through = true;
    app.view.lines = Object.keys(app.layers).filter((key) => app.layers[key]);
    layersBar.querySelector("[data-layer=through]").setAttribute("aria-pressed", "true");
  }
  function nudgeThrough(steps) {
    const t = app.scene?.through;
    if (t) show({ through: { joint: t.joint, share: Math.min(1, Math.max(0, t.reached + 0.02 * steps)) } });
  }
  function typed(name, data) {
    const field = h("input", { type: "text", value: name === "tilt" ? `${number(app.view.gamma, 5)} g` : Array.isArray(data.value) ? data.value.map((v) => number(v, 6)).join("; ") : quantity(data.value ?? data.now, data.unit ?? "", 6).replace("°", " deg"), "aria-label": data.label });
    dialog(data.label, h("form", { onsubmit: (e) => {
      e.preventDefault();
      const text = field.value.replaceAll("−", "-");
      if (name === "tilt") {
        const found = text.match(/^\s*([-+]?[\d.]+)\s*(g|deg|°|)\s*$/);
        if (!found) { say(tr`expected a tilt such as 0.1 g or 5 deg`, true); return; }
        show({ gamma: found[2] === "deg" || found[2] === "°" ? Math.tan((Number(found[1]) * Math.PI) / 180) : Number(found[1]) });
      } else if (name === "through") { const t = app.scene.through; if (t) show({ through: { joint: t.joint, share: Number(text.split(" ")[0]) } }); }
      else ask({ do: "drag", handle: name, text });
      e.target.closest("dialog").close();
    } }, h("p", {}, name === "tilt" ? tr`A number in g, or in degrees with its unit, such as 5 deg.` : Array.isArray(data.value) ? tr`Two coordinates x; y in metres, or with their units.` : tr`A number, or a number with its unit, such as 75 cm.`), field, h("div", { class: "row" }, h("button", { type: "submit", class: "first" }, tr`Set`))));
    field.select();
  }

  // Messages

  /** Ask something of the session. In a lane one message is under way at a time, and only the newest waits. */
  function ask(message, { when = performance.now(), reply = null } = {}) {
    const lane = message.lane;
    if (lane) {
      const there = flying.get(lane);
      if (there?.busy) {
        if (there.next?.message.ends) message.ends = true;
        if (message.do === "show") message = { ...there.next?.message, ...message }; // each key of a view is asked for by itself
        there.next = { message, when, reply };
        return;
      }
      flying.set(lane, { busy: true, next: null });
    }
    counter += 1;
    message.of = counter;
    waiting.set(counter, { message, when, reply, lane, scene: scenes });
    if (CHANGE.has(message.do)) unanswered.add(counter);
    if (waiting.size > 400) waiting.delete(waiting.keys().next().value);
    if (!transport.send(message)) { waiting.delete(counter); unanswered.delete(counter); if (lane) flying.delete(lane); }
  }
  function landed(entry) {
    if (!entry.lane) return;
    const there = flying.get(entry.lane);
    flying.delete(entry.lane);
    if (there?.next) ask(there.next.message, there.next);
  }
  function change(changes, lane, more = {}, when = performance.now()) { ask({ do: "set", changes, lane, ...more }, { when }); }
  /** Another view of the same building. All views share one lane: the last request determines the final view. */
  function show(view, when) {
    const other = view.through ? { thrust: null } : (view.thrust ?? null) !== null ? { through: null } : {};
    Object.assign(app.view, view, other);
    ask({ do: "show", ...view, ...other, lane: "show" }, { when: when ?? performance.now() });
  }
  function edit(text) { ask({ do: "open", text, here: "same" }); }
  function open(source) { ask({ do: "open", ...source }); }

  transport.onstate = (state, tries, reason) => {
    connected = state === "open";
    if (state === "open") {
      banner.hidden = true;
      flying.clear(); waiting.clear(); unanswered.clear();
      const kept = wasOpen && app.text ? { text: app.text, name: app.name, ...app.source, drops: app.drops } : null;
      ask({ do: "hello", kept });
      if (kept && (app.view.gamma || app.view.through || app.view.thrust !== null)) ask({ do: "show", gamma: app.view.gamma, lines: app.view.lines, thrust: app.view.thrust, through: app.scene?.through ? { joint: app.scene.through.joint, share: app.scene.through.wanted } : null });
      if (wasOpen) say(tr`The server runs again. This page has kept its state.`);
    } else {
      banner.hidden = false;
      banner.textContent = state === "moved" ? tr`extrados was started again with another address. Open the address that extrados has printed. The list of Open… there contains this deck as the deck of your last page.` : reason ? tr`The server has ended the connection: ${reason}` : tr`The server does not answer. This page keeps your deck and tries to connect again … (${tries})`;
    }
    root.dataset.connected = connected;
  };
  transport.onreply = ({ words, arrays }) => {
    const entry = waiting.get(words.of);
    if (!words.presets) unanswered.delete(words.of); // after what there is to choose from comes the first deck
    // A collapse requested for an earlier scene: its pictures and its refusal do not belong to the present scene.
    if (entry?.message.do === "fall" && entry.scene !== scenes) { entry.reply?.(words, arrays); landed(entry); return; }
    if (words.complaints || words.bad) {
      if (!["rocking", "domain", "impulse"].includes(words.to)) say((words.complaints ?? [words.bad]).join("\n"), true);
      tell("complaint", words, entry?.message);
      entry?.reply?.(words, arrays);
      if (entry) landed(entry);
      if (moved && CHANGE.has(words.to)) rest();
      return;
    }
    if (words.presets) { app.welcome = words; tell("welcome", words); }
    if (words.decks && app.welcome) { app.welcome.decks = words.decks; if (words.runs) app.welcome.runs = words.runs; tell("folder"); }
    if (words.scene) {
      scenes += 1;
      app.scene = words.scene; app.arrays = arrays; app.view.gamma = words.limit && words.to === "show" ? words.scene.gamma : app.view.gamma; app.handles = (words.handles ?? []).map((one) => ({ ...one, label: said(one.label) })); app.deck = words.deck; app.anchor = words.anchor ?? [0, 0]; app.detail = null;
      if (words.opened !== undefined) opened(words);
      app.turned();
      drawing.show(app.scene, arrays, app.handles, words.opened === true);
      if (["drag", "set"].includes(words.to)) dirty = true;
      tell("scene", words.opened === true, entry?.when);
      follow();
      if (words.to !== "hello") say(words.limit ?? "");
      else if (!entry?.message.kept && app.handles.length) say(tr`Drag a circle or a diamond of the drawing to change a size.`);
      rest();
    }
    else if (words.to === "set" && words.deck) { // a motion alone has changed
      app.deck = words.deck;
      dirty = true;
      if (words.rocking === undefined) tell("scene", false, entry?.when);
      say("");
      rest();
    }
    if (words.scene && app.draft) drafted(null);
    if (words.detail) { app.detail = words.detail; Object.assign(app.arrays, arrays); drawing.redraw(); tell("detail"); }
    if (words.text !== undefined) start ??= words.text; // a page that is only opened leaves the deck of the last page
    if (words.text !== undefined && words.to === "rest") settled(words);
    for (const key of ["rocking", "domain", "impulse", "push", "run", "computing", "saved", "fall", "frozen"]) if (words[key] !== undefined) tell(key, words[key], arrays, words);
    entry?.reply?.(words, arrays);
    if (entry) {
      if (entry.message.do !== "hello" || words.scene) landed(entry);
      if (words.scene && entry.when && ["drag", "show", "set"].includes(entry.message.do)) painted(entry, words.ms);
      if (words.rocking) painted(entry, words.ms, "rocking");
      if (words.domain?.stride > 1 && !words.domain.part) painted(entry, words.ms);
    }
  };
  /** Do something once the next frame is on the screen. */
  function afterwards(next) {
    requestAnimationFrame(() => {
      const channel = new MessageChannel();
      channel.port1.onmessage = next;
      channel.port2.postMessage(0);
    });
  }
  /** From the event to the picture that the next frame has put on the screen; `drawn`, to where that frame is waited for. */
  function painted(entry, server, what = entry.message.do) {
    const drawn = performance.now() - entry.when;
    afterwards(() => { app.timings.push({ do: what, ms: performance.now() - entry.when, drawn, server }); if (app.timings.length > 5000) app.timings.shift(); });
  }
  /** The drawing comes first: what stands beside it follows when the picture is on the screen, and not with each picture of a hand that moves. */
  function follow() {
    if (beside === null) { beside = 0; afterwards(() => { if (beside === 0) beside = setTimeout(followed, besides + BESIDE - performance.now()); }); }
  }
  function followed() {
    clearTimeout(beside);
    beside = null;
    besides = performance.now();
    tell("beside");
  }
  function opened(words) {
    app.text = words.text; app.name = words.name; app.forms = words.forms;
    if (words.opened) {
      app.source = words.source; app.view = { gamma: 0, through: null, thrust: null, chain: null };
      wasOpen = true;
      if (!travelling) { past = [words.text]; future = []; }
      if (!words.source.dropped && words.source.here !== "dropped") app.drops = [];
    }
    tell("text");
  }
  /** The text of a drawn deck that has no model yet, with the reasons; null where the deck at hand is shown. */
  function drafted(draft) {
    app.draft = draft;
    undoButton.disabled = redoButton.disabled = false;
    tell("draft");
  }
  function rest() {
    moved = true;
    clearTimeout(timer);
    timer = setTimeout(() => { timer = null; ask({ do: "rest", lane: "rest" }); }, REST);
  }
  function settled(words) {
    app.text = words.text; app.forms = words.forms; app.name = words.name;
    if (beside !== null) followed();
    if (timer === null && !unanswered.size) moved = false;
    if (!held) { dirty = false; remember(); } // one step back undoes all of a drag, also of a slow one
    tell("text");
  }
  /** Keep the present text in the history of undo. */
  function remember() {
    if (!travelling && past.at(-1) !== app.text) { past.push(app.text); future = []; if (past.length > 300) past.shift(); }
    travelling = false;
    undoButton.disabled = past.length < 2 && !board();
    redoButton.disabled = future.length === 0 && !board();
    title.textContent = app.deck?.title || app.name || "";
    title.title = app.name;
    if (app.text === start) return;
    start = "";
    try { localStorage.setItem(KEPT, JSON.stringify({ text: app.text, name: app.name, source: app.source })); } catch { /* a browser without storage */ }
  }
  root.addEventListener("pointerdown", () => { held = true; }, true);
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => { if (held && dirty) rest(); held = false; }, true);
  function travel(way) {
    if (dirty) { // the last change is not in the history yet
      clearTimeout(timer);
      timer = null;
      ask({ do: "rest" }, { reply: (words) => { if (words.text !== undefined) travel(way); } });
      return;
    }
    if (way < 0 ? past.length < 2 : !future.length) return;
    if (way < 0) future.push(past.pop()); else past.push(future.pop());
    travelling = true;
    clearTimeout(timer);
    timer = null;
    ask({ do: "open", text: past.at(-1), here: "same" });
  }

  /** Words at the foot of the page. */
  let saying = null;
  function say(text, bad = false) {
    if (status.textContent === text && status.classList.contains("bad") === bad && status.hidden === !text) return;
    status.textContent = text;
    status.classList.toggle("bad", bad);
    status.hidden = !text;
    clearTimeout(saying);
    if (text && !bad) saying = setTimeout(() => { status.hidden = true; }, SAID);
  }

  function setTab(name) {
    app.tab = name;
    for (const button of tabs.children) { button.setAttribute("aria-selected", button.dataset.tab === name); button.tabIndex = button.dataset.tab === name ? 0 : -1; }
    root.dataset.tab = name;
    tell("tab", name);
  }

  function theme() {
    chosen = root.dataset.theme === "dark" ? "light" : "dark";
    try { localStorage.setItem("extrados-theme", chosen); } catch { /* a browser without storage */ }
    dress();
  }
  const night = matchMedia("(prefers-color-scheme: dark)");
  let chosen = "";
  try { chosen = localStorage.getItem("extrados-theme") ?? ""; } catch { /* a browser without storage */ }
  /** Dark or light, as it was chosen here, else as the machine has it. */
  function dress() {
    root.dataset.theme = chosen || (night.matches ? "dark" : "light");
    tell("theme");
  }
  night.addEventListener("change", dress);
  addEventListener("beforeprint", () => { root.dataset.theme = "light"; tell("theme"); });
  addEventListener("afterprint", dress);
  dress();

  /** A dialog with what it holds; it is gone when closed. */
  function dialog(label, ...content) {
    const box = h("dialog", { "aria-label": label, onclose: () => box.remove(), onclick: (e) => { if (e.target === box) box.close(); } },
      h("div", { class: "dialog-head" }, h("h2", {}, label), h("button", { class: "icon", "aria-label": tr`Close`, onclick: () => box.close() }, "×")), ...content);
    root.append(box);
    box.showModal();
    return box;
  }
  function chooser() {
    const w = app.welcome;
    if (!w) return;
    const field = h("input", { type: "search", placeholder: tr`Find a deck, or paste a link …`, "aria-label": tr`Find a deck, or paste a link`, oninput: async () => { if (await openLink(field.value)) shown.close(); else list(); } });
    const box = h("div", { class: "choices" });
    const file = h("input", { type: "file", accept: ".toml,.dxf,.json,.csv,.txt,.at2", "aria-label": tr`A file of this machine`, onchange: () => { dropped(file.files[0]); shown.close(); } });
    const shown = dialog(tr`Open a deck`, h("div", { class: "row" }, field, h("label", { class: "button" }, tr`From this machine…`, file)), box);
    const item = (label, about, source) => h("button", { class: "choice", onclick: () => { open(source); shown.close(); setTab(app.tab === "results" ? "structure" : app.tab); } }, h("b", {}, label), h("span", {}, about));
    function list() {
      const words = field.value.toLowerCase().split(/\s+/);
      const fits = (...texts) => words.every((word) => texts.join(" ").toLowerCase().includes(word));
      const groups = [];
      if (last?.text && app.root.dataset.role !== "pupil" && fits("last", last.name)) groups.push([tr`Last session`, [item(last.name, tr`the deck of your last page`, { text: last.text, name: last.name, ...last.source })]]);
      if (w.folder) groups.push([tr`Decks in ${w.folder}`, w.decks.filter((d) => fits(d)).map((d) => item(d, "", { path: d }))]);
      const blank = h("button", { class: "choice", "data-blank": true, onclick: () => { shown.close(); app.sheet.begin(true); } }, h("b", {}, tr`Blank sheet`), h("span", {}, tr`draw arches, piers, walls and blocks`));
      const plan = h("button", { class: "choice", "data-blank-plan": true, onclick: () => { shown.close(); app.plan.begin(true); } }, h("b", {}, tr`Blank plan`), h("span", {}, tr`draw walls and openings of a building`));
      groups.push([tr`New`, [...(fits("new blank sheet draw") ? [blank] : []), ...(fits("new blank plan draw building walls") ? [plan] : []), ...w.kinds.structure.filter((k) => fits("new", k)).map((k) => item(tr`new ${k}`, tr`a starter deck`, { starter: k }))]]);
      groups.push([tr`Decks with known answers`, w.presets.filter((p) => fits(p.name, p.title, p.kind)).map((p) => item(p.title || p.name, `${p.name}${p.kind ? ` · ${p.kind}` : ""}`, { preset: p.name }))]);
      box.replaceChildren(...groups.filter(([, items]) => items.length).flatMap(([name, items]) => [h("h3", {}, name), h("div", { class: "choice-grid" }, items)]));
    }
    list();
    field.focus();
  }
  app.chooser = chooser;
  /** Open the deck that a link holds; whether it holds one. */
  async function openLink(link) {
    try {
      const text = await deckOf(link);
      if (text !== null) open({ text, name: "shared.toml" });
      return text !== null;
    } catch (error) { say(tr`The deck in the link cannot be read: ${error.message}`, true); return false; }
  }
  app.openLink = openLink;

  // Files dropped on the page

  function dropped(fileGiven) {
    if (!fileGiven) return;
    if (root.dataset.role === "pupil") { say(tr`Pupils of a class cannot open files.`, true); return; }
    if (fileGiven.size > 8e6) { say(tr`${fileGiven.name} is larger than 8 MB`, true); return; }
    const reader = new FileReader();
    reader.onload = () => {
      const data = reader.result.slice(reader.result.indexOf(",") + 1), name = fileGiven.name;
      if (!name.endsWith(".toml")) { app.drops = app.drops.filter((d) => d.name !== name); app.drops.push({ name, data }); }
      const drops = app.drops;
      ask({ do: "drop", name, data }, { reply: (words) => {
        app.drops = drops;
        if (words.complaints?.some((c) => c.includes("unit"))) askUnit(name, data);
      } });
    };
    reader.readAsDataURL(fileGiven);
  }
  function askUnit(name, data) {
    const box = dialog(tr`The unit of the drawing`, h("p", {}, tr`${name} states no length unit. The unit is`), h("div", { class: "row" }, ["m", "cm", "mm", "in", "ft"].map((unit) => h("button", { onclick: () => { ask({ do: "drop", name, data, unit }); box.close(); } }, unit))));
  }
  root.addEventListener("dragover", (e) => { e.preventDefault(); root.classList.add("dropping"); });
  root.addEventListener("dragleave", (e) => { if (!root.contains(e.relatedTarget)) root.classList.remove("dropping"); });
  root.addEventListener("drop", (e) => { e.preventDefault(); root.classList.remove("dropping"); dropped(e.dataTransfer.files[0]); });
  app.dropped = dropped;

  root.addEventListener("keydown", (e) => {
    const writing = e.composedPath()[0].matches?.("textarea, input[type=text], input[type=search]");
    if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "z" && !writing) { e.preventDefault(); if (e.shiftKey) app.redo(); else app.undo(); }
    if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "y" && !writing) { e.preventDefault(); app.redo(); }
    if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "s") { e.preventDefault(); app.save?.(); }
    if (e.key === "?" && !writing) help();
    const by = { "+": 1.3, "-": 1 / 1.3, 0: null }[e.key];
    if (by !== undefined && !writing && !e.ctrlKey && !e.metaKey && app.tab !== "results") (board() ?? drawing).zoom(by);
  });
  function help() {
    dialog(tr`How to use this page`, h("ul", { class: "help" },
      h("li", {}, tr`Drag a handle of the drawing: sizes of the building, the vertex of a free block, a load, the thrust line, the tilt of the ground.`),
      h("li", {}, tr`Tab selects the next handle. Arrow keys move the handle, with Shift ten times as far. Enter or a double click opens a field for its value, with or without a unit.`),
      h("li", {}, tr`Click or drag inside the stones to draw the thrust line through this point. The slider below the drawing sets the thrust, from the least to the greatest (keys Home and End).`),
      h("li", {}, tr`Two fingers, the wheel, or the keys + and − zoom the drawing; 0 fits the drawing into its frame.`),
      h("li", {}, tr`Ctrl+Z undoes a change, Ctrl+Shift+Z repeats it, Ctrl+S saves the deck, Space plays a motion.`),
      h("li", {}, tr`Drop a deck (TOML), a drawing (DXF, JSON) or a record (CSV, AT2) on the page.`),
      h("li", {}, tr`A program on this machine serves the page. No data leaves this machine.`)),
      embedded ? null : h("label", { class: "field" }, tr`Language`, " ", h("select", { onchange: (e) => translate(e.target.value) }, Object.entries(LANGUAGES).map(([key, name]) => h("option", { value: key, lang: key, selected: key === language() }, name)))));
  }
  /** The page anew in another language, with its deck. */
  async function translate(name) {
    history.replaceState(null, "", location.pathname + await fragmentOf(app.text));
    choose(name);
  }

  // Layers over the drawing

  const LAYERS = [["least", tr`Least thrust`], ["most", tr`Greatest`], ["through", tr`Chosen line`], ["plus", tr`Collapse +x`], ["minus", tr`Collapse −x`], ["central", tr`Central`], ["reactions", tr`Reactions`], ["joints", tr`Joints`]];
  const playButton = h("button", { class: "layer", "aria-pressed": "false", title: tr`Animate the mechanism`, onclick: () => mechanism() }, tr`▶ Mechanism`);
  const drawButton = h("button", { class: "layer", "data-draw": true, title: tr`Draw on the blocks of the deck, or on a blank sheet`, onclick: () => app.sheet.begin() }, tr`✎ Draw`);
  layersBar.append(drawButton, ...LAYERS.map(([name, label]) => h("button", { class: `layer ${name}`, "aria-pressed": String(Boolean(app.layers[name])), "data-layer": name, onclick: (e) => {
    app.layers[name] = !app.layers[name];
    e.currentTarget.setAttribute("aria-pressed", String(app.layers[name]));
    show({ lines: Object.keys(app.layers).filter((key) => app.layers[key]) });
    tell("layers");
  } }, h("i", { class: "swatch" }), label)), playButton, h("span", { class: "spring" }),
    ...[["−", tr`Smaller`, 1 / 1.3], ["+", tr`Larger`, 1.3], [tr`Fit`, tr`Fit the drawing`, null]].map(([text, label, by]) => h("button", { class: "layer", "aria-label": label, title: label, onclick: () => drawing.zoom(by) }, text)));
  let swing = null;
  const wayShown = () => (app.view.gamma < 0 || (app.layers.minus && !app.layers.plus) ? "minus" : "plus");
  function mechanism() {
    if (swing) { app.stopMechanism(); return; }
    app.fall.stop();
    const way = wayShown();
    if (!app.arrays[`${way}_velocity`]) { say(tr`There is no mechanism to show.`, true); return; }
    playButton.setAttribute("aria-pressed", "true");
    const begin = performance.now();
    const step = (now) => {
      const share = 0.5 - 0.5 * Math.cos((now - begin) / 700);
      drawing.pose(between(way, share));
      swing = requestAnimationFrame(step);
    };
    swing = requestAnimationFrame(step);
  }
  /** The stones on their way along a mechanism: as carried on, or by its velocities as long as a hand moves. */
  function between(way, share) {
    const { centroid } = app.arrays, pose = app.arrays[`${way}_pose`], velocity = app.arrays[`${way}_velocity`];
    const out = new Float32Array(velocity.length), n = velocity.length / 3;
    let scale = 0;
    if (!pose) { let most = 0; for (let b = 0; b < n; b += 1) most = Math.max(most, Math.hypot(velocity[3 * b], velocity[3 * b + 1])); scale = (0.05 * (app.scene.size_m ?? 1)) / (most || 1); }
    for (let b = 0; b < n; b += 1) for (let k = 0; k < 3; k += 1) {
      const home = k < 2 ? centroid[2 * b + k] : 0;
      out[3 * b + k] = pose ? home + share * (pose[3 * b + k] - home) : home + share * scale * velocity[3 * b + k];
    }
    return out;
  }
  /** The mechanism at a share of its way, for films; null where there is none. */
  app.mechanismAt = (share) => {
    if (app.scene?.seen) return app.solid.mechanismAt(share);
    const way = wayShown();
    if (!app.arrays[`${way}_velocity`]) return false;
    if (share !== undefined) drawing.pose(share === null ? null : between(way, share));
    return true;
  };
  app.stopMechanism = () => { if (swing) { cancelAnimationFrame(swing); swing = null; drawing.pose(null); playButton.setAttribute("aria-pressed", "false"); } app.solid.stop(); };
  app.mechanismShown = () => swing !== null;
  /** A press beside the handles: the line of thrust follows from there on. */
  function pressed(e) {
    if (e.button !== 0 || app.tab === "motion" || !app.scene?.chains?.length || drawing.moving() || !e.target.closest?.(".stones, .joints, .thrust")) return false;
    reveal();
    const edge = drawing.svg.getBoundingClientRect();
    show({ lines: app.view.lines, through: drawing.modelOf(e.clientX - edge.left, e.clientY - edge.top) });
    return true;
  }
  const turned = () => drawing.setTheta(app.tab === "motion" ? 0 : Math.atan(app.scene?.gamma ?? 0));
  app.turned = turned;

  top.append(outMenu(app), themeButton, h("button", { class: "icon", "aria-label": tr`Help`, title: tr`Help (?)`, onclick: help }, "?"));
  sidebar(app, side);
  structurePanel(app, lower);
  app.sheet = Object.assign(sheetPanel(app, stageFrame, stageBox), { button: drawButton });
  app.plan = planPanel(app, stageFrame, stageBox);
  fallPanel(app, stageFrame);
  motionPanel(app, lower, stageFrame);
  resultsPanel(app, wide);
  classPanel(app, tabs, classBox);
  const nothing = h("p", { class: "map-why nothing", hidden: true });
  stageBox.append(nothing);
  const arranged = () => {
    const results = ["results", "class"].includes(app.tab), plain = Boolean(app.scene?.empty);
    wide.hidden = app.tab !== "results"; classBox.hidden = app.tab !== "class"; stageFrame.hidden = results; layersBar.hidden = plain;
    lower.hidden = results || (plain && app.tab === "structure");
    nothing.textContent = app.scene?.empty ?? "";
    nothing.hidden = !plain || Boolean(app.scene.seen || app.arrays.outline);
  };
  on("scene", arranged);
  on("tab", (name) => {
    arranged();
    if (name !== "structure") app.stopMechanism();
    turned();
    drawing.fit();
    drawing.redraw();
  });
  setTab("structure");
  app.connected = () => connected;
  return app;
}

