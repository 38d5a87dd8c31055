// Panels beside the drawing: results of limit analysis, sizes, deck.
import { teachPanel } from "./teach.js";
import { capital, degrees, download, h, number, quantity } from "./dom.js";
import { said } from "./said.js";
import { tr } from "./words.js";

const NAMES = { structure: tr`Structure`, motion: tr`Motion`, joints: tr`Joints`, material: tr`Material`, supports: tr`Supports`, initial: tr`Start` };

export function sidebar(app, box) {
  const pages = { answer: h("div", { class: "page answer" }), sizes: h("div", { class: "page sizes" }), deck: h("div", { class: "page deck" }), teach: h("div", { class: "page teach" }) };
  const labels = { answer: tr`Answer`, sizes: tr`Sizes`, deck: tr`Deck`, teach: tr`Lessons` };
  const tabs = h("div", { class: "tabs small", role: "tablist", "aria-label": tr`Beside the drawing` }, Object.keys(pages).map((name) => h("button", { role: "tab", "data-side": name, onclick: () => { app.root.dataset.sheet = chosen === name && app.root.dataset.sheet === "open" ? "" : "open"; choose(name); } }, labels[name])));
  box.append(tabs, ...Object.values(pages));
  let chosen = "answer";
  function choose(name) {
    chosen = name;
    for (const [key, page] of Object.entries(pages)) page.hidden = key !== name;
    for (const button of tabs.children) button.setAttribute("aria-selected", button.dataset.side === name);
    fill();
  }

  // Answer

  const row = (label, value, about = "") => h("tr", { title: about }, h("th", { scope: "row" }, label), h("td", {}, value));
  // What is pressed stays until it is let go: replaced between the two, a button would not hear its click.
  let pressed = false, late = false;
  pages.answer.addEventListener("pointerdown", () => { pressed = true; });
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => setTimeout(() => { pressed = false; if (late) answer(); }));
  function answer() {
    const scene = app.scene;
    if (!scene) return;
    late = pressed;
    if (pressed) return;
    if (app.draft) { pages.answer.replaceChildren(h("p", { class: "verdict" }, h("b", {}, tr`The drawing is not a structure yet: `), app.draft.trouble.join(" "))); return; }
    if (scene.seen) { pages.answer.replaceChildren(...app.solid.page(scene.seen, scene.empty)); return; }
    if (scene.empty) { pages.answer.replaceChildren(h("p", { class: "verdict" }, scene.empty)); return; }
    const parts = [];
    const c = scene.capacity, way = scene.way ?? "plus", side = way === "plus" ? "+x" : "−x";
    if (scene.immovable) parts.push(h("p", { class: "verdict good" }, scene.immovable));
    else if (scene.unknown) parts.push(h("p", { class: "verdict" }, h("b", {}, tr`Limit analysis gives no result: `), scene.unknown));
    else if (!scene.stands) parts.push(h("p", { class: "verdict bad" }, h("b", {}, tr`Cannot stand. `), capital(app.detail?.why ?? tr`no thrust line stays within the blocks`), "."));
    else if (!scene.within) parts.push(h("p", { class: "verdict bad" }, h("b", {}, tr`Collapses towards ${side}. `), capital(said(scene.why)), "."));
    else parts.push(h("p", { class: "verdict good" }, h("b", {}, scene.gamma ? tr`Stands when tilted. ` : tr`Stands. `), scene.gamma ? tr`Collapse towards ${side} at ${number(c[`${way}_g`], 4)} g.` : tr`Collapse at ${number(Math.min(c.plus_g, c.minus_g), 4)} g.`));
    const rows = [];
    if (scene.stands === false && app.handles.length) parts.push(h("p", { class: "remark" }, tr`Drag a circle or a diamond of the drawing to change a size.`));
    if (c && (scene.dilating?.plus || scene.dilating?.minus)) parts.push(h("p", { class: "remark" }, tr`Joints slide in the mechanism: the collapse acceleration is an upper bound (dilatant friction). The analysis tilt of a deck also gives the least state found without dilatancy.`));
    if (c) {
      rows.push(row(tr`Capacity to +x`, h("span", { "data-number": "plus" }, `${number(c.plus_g, 4)} g · ${number(degrees(c.plus_g), 4)}°`), tr`horizontal acceleration, and tilt of the ground, at which the structure becomes a mechanism`));
      rows.push(row(tr`Capacity to −x`, h("span", { "data-number": "minus" }, `${number(c.minus_g, 4)} g · ${number(degrees(c.minus_g), 4)}°`)));
    }
    if (scene.least_N !== undefined) {
      rows.push(row(tr`Least thrust`, h("span", { "data-number": "least" }, quantity(scene.least_N, "N")), tr`horizontal thrust of the chain at the present tilt`));
      rows.push(row(tr`Greatest thrust`, h("span", { "data-number": "most" }, quantity(scene.most_N, "N"))));
    }
    if (scene.chosen) rows.push(row(tr`Chosen line`, quantity(scene.chosen.thrust_N, "N"), tr`thrust of the chosen line, between the least and the greatest thrust`));
    if (scene.through) rows.push(row(tr`Through the point`, quantity(scene.through.thrust_N, "N")));
    if (app.detail && "safety" in app.detail) rows.push(row(tr`Geometric safety`, app.detail.safety === null ? tr`unbounded` : number(app.detail.safety, 3), tr`length of the joints, divided by the least length about the same middles that still contains a thrust line under self-weight`));
    if (scene.required_friction !== undefined) rows.push(row(tr`Required friction`, number(scene.required_friction, 3), tr`coefficient of friction required at collapse to ${side}`));
    for (const tie of scene.ties ?? []) rows.push(row(tr`${tie.name}, at collapse`, quantity(tie.force_N, "N"), tr`tension of the tie at collapse to ${side}`));
    rows.push(row(tr`Weight`, tr`${quantity(scene.weight_N, "N")} for ${number(scene.depth_m, 3)} m of depth`));
    rows.push(row(tr`Stones, joints`, `${scene.blocks}, ${scene.joints}`));
    for (const [key, value] of Object.entries(scene.measures ?? {})) rows.push(row(said(key.replace(/_m$/, "").replaceAll("_", " ")), quantity(value, key.endsWith("_m") ? "m" : "")));
    parts.push(h("table", { class: "numbers" }, h("tbody", {}, rows)));
    if (scene.chains?.length > 1) {
      parts.push(h("label", { class: "field" }, tr`Thrust of the `, h("select", { "aria-label": tr`Chain whose thrust is shown`, onchange: (e) => app.show({ chain: e.target.value, through: null }) }, scene.chains.map((name) => h("option", { value: name, selected: name === scene.chain }, name)))));
    }
    for (const [name, text] of [["plus", tr`Hinges, load to +x`], ["minus", tr`Hinges, load to −x`]]) {
      if (!scene[`${name}_hinges`]?.length || !app.drawn(name)) continue;
      parts.push(h("h3", {}, text), h("ul", { class: "plain" }, scene[`${name}_hinges`].map((x) => h("li", {}, said(x.where))), (scene[`${name}_sliding`] ?? []).slice(0, 6).map((x) => h("li", {}, tr`slides: ${said(x.name)}`))));
    }
    if (scene.reactions?.length && app.layers.reactions) {
      const of = { least: tr`at least thrust`, through: tr`of the chosen line`, plus: tr`at collapse to +x`, minus: tr`at collapse to −x` }[scene.reactions_of] ?? "";
      parts.push(h("h3", {}, tr`Reactions ${of}`), h("table", { class: "numbers" }, h("thead", {}, h("tr", {}, h("th", {}, ""), h("th", {}, tr`across`), h("th", {}, tr`up`))), h("tbody", {}, scene.reactions.slice(0, 12).map((r) => h("tr", {}, h("th", { scope: "row" }, said(r.name)), h("td", {}, quantity(r.x_N, "N", 3)), h("td", {}, quantity(r.y_N, "N", 3)))))));
    }
    if (scene.remark) parts.push(h("p", { class: "remark" }, scene.remark));
    for (const text of scene.warnings ?? []) parts.push(h("p", { class: "remark" }, text));
    parts.push(loads(), needs());
    const focused = pages.answer.contains(document.activeElement) || pages.answer.contains(app.root.getRootNode().activeElement);
    if (!focused || !pages.answer.querySelector("input:focus")) pages.answer.replaceChildren(...parts);
  }
  function loads() {
    const name = app.scene.limit_analysis, there = app.scene.loads ?? [];
    const add = () => {
      if (!name) { app.ask({ do: "analysis", add: "tilt" }); return; }
      const w = (app.scene.weight_N || 1e4) / 20, size = 10 ** Math.floor(Math.log10(w));
      app.change({ [`analysis.${name}.load`]: [...there.map((l) => raw(l)), { x: 0, force: Math.round(w / size) * size }] });
    };
    const raw = (l) => ({ x: Number((l.at[0] + app.anchor[0]).toPrecision(9)), force: l.force_N, ...(l.horizontal_N ? { horizontal: l.horizontal_N } : {}) });
    const simple = there.every((l) => l.end === null);
    return h("div", { class: "row wrap" },
      h("button", { onclick: add, disabled: !simple }, name ? tr`Add a load` : tr`Add limit analysis`),
      there.length && simple ? h("button", { onclick: () => app.change({ [`analysis.${name}.load`]: there.length > 1 ? there.slice(0, -1).map(raw) : null }) }, tr`Remove the last load`) : null,
      app.deck?.structure?.kind !== "blocks" ? h("button", { title: tr`Turn every stone into a block whose vertices can be dragged`, onclick: () => app.ask({ do: "blocks" }) }, tr`Free the stones`) : null);
  }

  /** The least interventions for an acceleration, each with a button that adds it to the deck. */
  let target = "", needed = null, asking = false;
  const mark = () => JSON.stringify(app.scene.capacity ?? null);
  function ask(e) {
    e.preventDefault();
    const value = Number(target.trim().replace(/g$/, "").replace(",", "."));
    if (!(value > 0)) { needed = { mark: mark(), trouble: tr`Give an acceleration above 0, in g.` }; answer(); return; }
    asking = true;
    e.target.querySelector("input").blur();
    app.ask({ do: "needed", acceleration: value }, { reply: (words) => {
      asking = false;
      needed = { mark: mark(), ...(words.needed ?? { trouble: (words.complaints ?? [words.bad ?? ""]).join(" ") }) };
      answer();
    } });
    answer();
  }
  function needs() {
    const field = h("input", { type: "text", id: "needed-g", value: target, inputmode: "decimal", placeholder: "0.2", "aria-label": tr`Acceleration that the structure is to carry, in g`, oninput: (e) => { target = e.target.value; } });
    const form = h("form", { class: "row wrap", onsubmit: ask }, h("label", { for: "needed-g" }, tr`Required acceleration `), field, " g ", h("button", { type: "submit", disabled: asking }, asking ? tr`Sizing…` : tr`Find the interventions`));
    const parts = [h("h3", {}, tr`Strengthening`), form];
    if (needed && needed.mark === mark()) {
      if (needed.trouble) parts.push(h("p", { class: "remark" }, needed.trouble));
      else parts.push(h("p", { class: "answer-text" }, needed.statement), needed.bound ? h("p", { class: "remark" }, tr`Joints slide: these sizes are based on dilatant friction, an upper bound of the capacity. The analysis strengthen of a deck uses the least capacity without dilatancy.`) : null, h("ul", { class: "plain" }, needed.interventions.map((one) => h("li", { "data-intervention": one.name },
        h("b", {}, `${capital(one.name)}: `), `${one.met ? one.size : one.reason}.`, one.met && one.next ? tr` Afterwards: ${one.next}. ` : " ",
        one.changes ? h("button", { onclick: () => app.change(one.changes) }, tr`Add to the deck`) : null))));
    }
    return h("section", { class: "needed", "aria-label": tr`Find the interventions` }, parts);
  }

  // Sizes

  function sizes() {
    const active = box.getRootNode().activeElement;
    if (pages.sizes.contains(active) && active.matches("input, select")) return;
    const groups = new Map();
    for (const form of app.forms) { if (!groups.has(form.section)) groups.set(form.section, []); groups.get(form.section).push(form); }
    pages.sizes.replaceChildren(h("p", { class: "hint" }, tr`A number, or a number with its unit. Grey values are defaults. Clear a field to restore its default.`), ...[...groups].map(([section, forms]) => h("details", { open: section === "structure" || section === "motion" }, h("summary", {}, NAMES[section]), h("div", { class: "fields" }, forms.map((form) => field(section, form))))));
  }
  function field(section, form) {
    const key = `${section}.${form.key}`, id = `field-${key}`.replaceAll(".", "-");
    const put = (value) => app.change({ [key]: value });
    let input;
    if (form.sort === "choice") input = h("select", { id, onchange: (e) => put(e.target.value) }, (form.choices.includes(form.value) ? form.choices : [form.value ?? "", ...form.choices]).map((c) => h("option", { value: c, selected: c === form.value }, String(c))));
    else if (form.sort === "yes") input = h("input", { id, type: "checkbox", checked: form.value === true, onchange: (e) => put(e.target.checked) });
    else {
      const text = form.value === null ? "" : typeof form.value === "number" ? String(Number(form.value.toPrecision(7))) : String(form.value);
      const send = (e) => {
        const raw = e.target.value.trim().replaceAll("−", "-");
        if (raw === text.replaceAll("−", "-")) return;
        const value = raw === "" ? null : form.number && /^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(raw) ? (Number.isInteger(Number(raw)) && !raw.includes(".") ? Number(raw) : Number(raw)) : raw;
        put(value);
      };
      input = h("input", { id, type: "text", value: text, spellcheck: "false", inputmode: form.number ? "decimal" : null, placeholder: form.given ? "" : tr`default`, class: form.given ? "" : "default", onchange: send });
    }
    return h("div", { class: "line", title: form.about }, h("label", { for: id }, form.key.replaceAll("_", " ")), input, h("span", { class: "unit" }, typeof form.value === "string" && form.sort === "text" ? "" : form.unit));
  }

  // Deck

  const text = h("textarea", { spellcheck: "false", "aria-label": tr`The deck as text`, wrap: "off" });
  const numbersBox = h("pre", { class: "gutter", "aria-hidden": "true" });
  const complaints = h("ul", { class: "complaints", role: "alert" });
  let timer = null;
  text.addEventListener("input", () => { lines(); clearTimeout(timer); timer = setTimeout(() => app.edit(text.value), 450); });
  text.addEventListener("scroll", () => { numbersBox.scrollTop = text.scrollTop; });
  function lines() { numbersBox.textContent = text.value.split("\n").map((_, k) => k + 1).join("\n"); }
  const shown = () => app.draft?.text ?? app.text;
  const copy = async () => {
    try { await navigator.clipboard.writeText(shown()); app.say(tr`The deck is copied.`); } catch { text.select(); document.execCommand("copy"); app.say(tr`The deck is copied.`); }
  };
  app.save = () => {
    if (app.draft) { app.say(tr`The drawing is not a structure yet: complete it, or download it as it is.`, true); return; }
    const field = h("input", { type: "text", value: app.source.path ?? app.name, "aria-label": tr`Path within the folder` });
    const replace = h("input", { type: "checkbox", checked: Boolean(app.source.path) });
    const box = app.dialog(tr`Save the deck`, h("form", { onsubmit: (e) => {
      e.preventDefault();
      app.ask({ do: "save", path: field.value, replace: replace.checked }, { reply: (words) => { if (words.saved) { app.source = { path: words.saved }; app.say(tr`Saved as ${words.saved}`); box.close(); } } });
    } }, h("p", {}, tr`In ${app.welcome.folder}, as`), field, h("label", {}, replace, tr` replace an existing file`), h("div", { class: "row" }, h("button", { type: "submit", class: "first" }, tr`Save`))));
  };
  const adder = h("select", { "aria-label": tr`Add an analysis`, onchange: (e) => { if (e.target.value) app.ask({ do: "analysis", add: e.target.value }); e.target.value = ""; } });
  pages.deck.append(h("div", { class: "row wrap" }, h("button", { onclick: copy }, tr`Copy`), h("button", { class: "keeps", onclick: () => app.save() }, tr`Save…`), h("button", { onclick: () => download(new Blob([shown()], { type: "application/toml" }), app.draft ? "drawing.toml" : app.name) }, tr`Download`), h("button", { onclick: () => app.chooser() }, tr`Open…`), adder), complaints, h("div", { class: "editor" }, numbersBox, text));
  function deck() {
    const editing = box.getRootNode().activeElement === text;
    if (!editing && text.value !== shown()) text.value = shown();
    if (!editing) complaints.replaceChildren(...(app.draft?.trouble ?? []).map((c) => h("li", {}, c)));
    lines();
  }
  app.on("welcome", (w) => adder.replaceChildren(h("option", { value: "" }, tr`Add analysis…`), ...w.kinds.analysis.map((k) => h("option", { value: k }, k))));
  app.on("complaint", (words, message) => { if (message?.do === "open" && message.here === "same") complaints.replaceChildren(...(words.complaints ?? [words.bad]).map((c) => h("li", {}, c))); });

  function fill() { if (chosen === "answer") answer(); else if (chosen === "sizes") sizes(); else if (chosen === "deck") deck(); }
  app.on("scene", () => { if (complaints.firstChild) complaints.replaceChildren(); });
  app.on("beside", () => { if (chosen === "answer") answer(); });
  app.on("detail", () => { if (chosen === "answer") answer(); });
  app.on("layers", () => { if (chosen === "answer") answer(); });
  app.on("text", fill);
  app.on("draft", fill);
  addEventListener("beforeprint", answer);
  teachPanel(app, pages.teach);
  choose("answer");
}
