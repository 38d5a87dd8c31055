// What is seen, taken out: PNG, SVG, and films of what moves.
import { download, h, number } from "./dom.js";
import { fragmentOf } from "./share.js";
import { language, tr } from "./words.js";

const STYLED = ["fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin", "stroke-linecap", "opacity", "fill-opacity", "stroke-opacity", "font-size", "font-family", "font-weight", "text-anchor", "vector-effect", "visibility", "display"];

/** A drawing with its styles written into it, so that it stands alone. */
export function alone(svg, background) {
  const copy = svg.cloneNode(true), from = [svg, ...svg.querySelectorAll("*")], to = [copy, ...copy.querySelectorAll("*")];
  from.forEach((element, k) => {
    const style = getComputedStyle(element);
    // attributes, since the page's own policy lets no style be written into elements
    for (const name of STYLED) to[k].setAttribute(name, style.getPropertyValue(name));
    for (const name of ["class", "tabindex", "role"]) to[k].removeAttribute(name);
  });
  for (const hidden of copy.querySelectorAll("[data-handle]")) hidden.remove();
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  const [, , w, hgt] = copy.getAttribute("viewBox").split(" ").map(Number);
  const paper = document.createElementNS("http://www.w3.org/2000/svg", "rect");
  for (const [key, value] of Object.entries({ x: 0, y: 0, width: w, height: hgt, fill: background })) paper.setAttribute(key, value);
  if (svg.backdrop) {
    const image = document.createElementNS("http://www.w3.org/2000/svg", "image");
    for (const [key, value] of Object.entries({ href: svg.backdrop.toDataURL(), x: 0, y: 0, width: w, height: hgt })) image.setAttribute(key, value);
    copy.prepend(image);
  }
  copy.prepend(paper);
  return { text: new XMLSerializer().serializeToString(copy), w, h: hgt };
}

async function picture({ text, w, h: hgt }, canvas, width, height) {
  const image = new Image(), url = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  try {
    image.src = url;
    await image.decode();
    const context = canvas.getContext("2d");
    canvas.width = width; canvas.height = height;
    const scale = Math.min(width / w, height / hgt);
    context.fillStyle = text.match(/<rect[^>]*fill="([^"]+)"/)?.[1] ?? "#fff";
    context.fillRect(0, 0, width, height);
    context.drawImage(image, (width - w * scale) / 2, (height - hgt * scale) / 2, w * scale, hgt * scale);
  } finally { URL.revokeObjectURL(url); }
}

export function outMenu(app) {
  const paper = () => getComputedStyle(app.root).getPropertyValue("--paper").trim();
  const shown = (svg) => svg.getBoundingClientRect().width > 0;
  const charts = () => [...app.root.querySelectorAll("svg.chart, svg.polygon, svg.gauge")].filter(shown);
  const seen = () => (app.tab !== "results" ? (app.scene?.seen?.sort === "space" ? app.space.svg : app.drawing.svg) : shown(app.results.columns[0].drawn()) ? app.results.columns[0].drawn() : charts()[0]);
  const stem = () => app.name.replace(/\.toml$/, "") || "extrados";
  const svg = () => download(new Blob([alone(seen(), paper()).text], { type: "image/svg+xml" }), `${stem()}.svg`);
  function all() {
    charts().forEach((chart, k) => download(new Blob([alone(chart, paper()).text], { type: "image/svg+xml" }), `${stem()}-chart-${k + 1}.svg`));
  }
  async function png() {
    const canvas = document.createElement("canvas"), drawn = alone(seen(), paper());
    await picture(drawn, canvas, Math.round(2 * drawn.w), Math.round(2 * drawn.h));
    canvas.toBlob((blob) => download(blob, `${stem()}.png`), "image/png");
  }
  /** Every picture of what moves, drawn in turn at 1280 x 720 and sent to be filmed. */
  async function film(kind, slow) {
    const moves = movement();
    if (!moves) { app.say(tr`Nothing moves in this view. A film can show a mechanism, a motion or a stored run.`, true); return; }
    const rate = kind === "gif" ? 15 : 30, length = Math.min(moves.real ? (moves.end - moves.start) / slow : 6, 40);
    const count = Math.max(2, Math.round(length * rate)), canvas = document.createElement("canvas"), parts = [new TextEncoder().encode(kind), Uint8Array.of(rate)];
    if (count > 1200) { app.say(tr`The film would be too long.`, true); return; }
    for (let k = 0; k < count; k += 1) {
      moves.seek(moves.start + ((moves.end - moves.start) * k) / (count - 1));
      app.say(tr`drawing picture ${k + 1} of ${count}`);
      await picture(alone(seen(), paper()), canvas, 1280, 720);
      const context = canvas.getContext("2d");
      context.fillStyle = getComputedStyle(app.root).getPropertyValue("--ink"); context.font = "22px sans-serif";
      context.fillText(moves.real && slow !== 1 ? tr`${moves.label()}, ${number(slow, 2)} of real speed` : moves.label(), 24, 40);
      const blob = await new Promise((done) => canvas.toBlob(done, "image/jpeg", 0.92));
      const length = new Uint8Array(4);
      new DataView(length.buffer).setUint32(0, blob.size);
      parts.push(length, new Uint8Array(await blob.arrayBuffer()));
    }
    app.say(tr`making the film …`);
    const answer = await fetch(app.film, { method: "POST", body: new Blob(parts) });
    if (!answer.ok) { app.say(await answer.text(), true); return; }
    download(await answer.blob(), `${stem()}.${kind}`);
    app.say(tr`The film is done.`);
  }
  function movement() {
    if (app.tab === "motion" && app.motion.arrays?.pose) {
      const a = app.motion.arrays;
      return { start: 0, end: app.motion.end, real: true, seek: app.motion.seek, label: () => `${app.motion.time.toFixed(2)} s` };
    }
    if (app.tab === "structure" && app.mechanismAt()) {
      app.stopMechanism();
      return { start: 0, end: 1, real: false, seek: (t) => app.mechanismAt(t < 1 ? Math.sin(Math.PI * t) ** 2 : null), label: () => "mechanism" };
    }
    const column = app.results.columns[0], times = column.arrays.body_time;
    if (app.tab === "results" && times?.length > 1) return { start: times[0], end: times[times.length - 1], real: column.words.body.unit === "s", seek: (t) => column.seek(t, false), label: () => `${column.words.body.label} ${column.time.toPrecision(3)} ${column.words.body.unit}` };
    return null;
  }
  /** A link that holds the deck: of a class its address, else one that any page opens from Open…. */
  async function link() {
    const text = (app.root.dataset.role === "pupil" ? location.href.split("#")[0] : "extrados:") + await fragmentOf(app.text);
    const field = h("textarea", { readonly: true, rows: 5, "aria-label": tr`Link that holds the deck` });
    field.value = text;
    app.dialog(tr`Share the deck`, h("p", {}, tr`The link contains the whole deck. Paste the link under Open… of any page of extrados. Or append the part that begins with # to the address of a page.`), field,
      h("div", { class: "row" }, h("button", { class: "first", onclick: async () => { field.select(); try { await navigator.clipboard.writeText(text); } catch { document.execCommand("copy"); } app.say(tr`The link is copied.`); } }, tr`Copy`)));
    field.select();
  }
  /** One file with the structure, computed over a size and the tilt. */
  function standalone() {
    app.ask({ do: "standalone", language: language() }, { reply: (words) => {
      if (words.share !== undefined && words.page === undefined) app.say(tr`computing the page: ${Math.round(100 * words.share)} %`);
      if (words.page) { download(new Blob([words.page], { type: "text/html" }), `${stem()}.html`); app.say(tr`The page has ${(words.page.length / 1e6).toFixed(1)} MB.`); }
    } });
  }
  const menu = h("div", { class: "menu", hidden: true, role: "menu" });
  const entry = (label, act, keeps = false) => h("button", { role: "menuitem", class: keeps ? "keeps" : null, onclick: () => { menu.hidden = true; button.setAttribute("aria-expanded", "false"); Promise.resolve(act()).catch((error) => app.say(String(error), true)); } }, label);
  menu.append(entry(tr`Link that holds the deck`, link), entry(tr`Page without a server, HTML`, standalone, true), entry(tr`Picture, PNG`, png), entry(tr`Drawing, SVG`, svg), entry(tr`Charts, SVG`, all), ...(app.embedded ? [] : [entry(tr`Print…`, () => print())]), ...(app.embedded ? [] : [entry(tr`Film, MP4, real time`, () => film("mp4", 1), true), entry(tr`Film, MP4, a fifth of the speed`, () => film("mp4", 0.2), true), entry(tr`Film, GIF, real time`, () => film("gif", 1), true), entry(tr`Film, GIF, a fifth of the speed`, () => film("gif", 0.2), true)]));
  const button = h("button", { class: "out", "aria-haspopup": "menu", "aria-expanded": "false", onclick: () => { menu.hidden = !menu.hidden; button.setAttribute("aria-expanded", String(!menu.hidden)); if (!menu.hidden) menu.querySelector("button").focus(); } }, tr`Export`);
  const box = h("div", { class: "menu-box", onkeydown: (e) => { if (e.key === "Escape") { menu.hidden = true; button.focus(); } } }, button, menu);
  app.root.addEventListener("pointerdown", (e) => { if (!e.composedPath().includes(box)) menu.hidden = true; });
  app.film_of = film;
  return box;
}
