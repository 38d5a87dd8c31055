// The words of the page in the language of its reader: English texts, and a catalogue of each other language (words/).

/** Languages with a catalogue, English besides. */
export const LANGUAGES = { en: "English", it: "Italiano", es: "Español", fr: "Français", de: "Deutsch" };
const KEPT = "extrados-language";
let catalogue = {};

/** A text in the language of the page, as tr`Collapse at ${x} g.`; a text that its catalogue lacks is English. */
export function tr(strings, ...values) {
  return inPage(typeof strings === "string" ? strings : strings.reduce((left, right, k) => `${left}{${k - 1}}${right}`), values);
}
/** The same of a text with its values as {0}, {1}. */
export function inPage(text, values = []) { return (catalogue[text] ?? text).replace(/\{(\d)\}/g, (_, k) => values[k]); }
/** Whether the page is in another language than English. */
export function translated() { return Object.keys(catalogue).length > 0; }
/** Take a catalogue, before the modules that draw are loaded. */
export function use(words) { catalogue = words ?? {}; }

/** The language that was chosen in this browser, else that of the browser, else English. */
export function language() {
  let chosen = null;
  try { chosen = localStorage.getItem(KEPT); } catch { /* a browser without storage */ }
  return [chosen, navigator.language?.slice(0, 2)].find((one) => Object.hasOwn(LANGUAGES, one ?? "")) ?? "en";
}
export async function load() {
  const name = language();
  document.documentElement.lang = name;
  if (name === "en") return;
  try {
    const reply = await fetch(new URL(`words/${name}.json`, import.meta.url));
    if (reply.ok) use(await reply.json());
  } catch { /* the page stays English */ }
}
/** Choose a language: the page is loaded anew and keeps its deck. */
export function choose(name) {
  try { localStorage.setItem(KEPT, name); } catch { return; }
  location.reload();
}
