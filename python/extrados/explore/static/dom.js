// Elements and numbers, in few words.

const SVG = "http://www.w3.org/2000/svg";

function fill(element, attributes, children) {
  for (const [key, value] of Object.entries(attributes ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key === "text") element.textContent = value;
    else if (key === "value" && "value" in element) element.value = value;
    else if (key === "checked") element.checked = value;
    else element.setAttribute(key, value === true ? "" : value);
  }
  for (const child of children.flat(3)) if (child !== null && child !== undefined && child !== false) element.append(child);
  return element;
}
export const h = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
export const s = (tag, attributes, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);
/** Attributes of an element; those that it has already been given so are left alone. */
export function set(element, attributes) {
  const given = (element.given ??= {});
  for (const key in attributes) {
    const value = attributes[key] ?? null, text = value === null ? null : String(value);
    if (given[key] === text) continue;
    given[key] = text;
    if (text === null) element.removeAttribute(key); else element.setAttribute(key, text);
  }
  return element;
}
/** The shapes of a group, each {tag, text, title, ...attributes}; elements that are there are kept, and changed where they differ. */
export function shapes(group, wanted) {
  let element = group.firstElementChild;
  for (const { tag, text, title, ...attributes } of wanted) {
    if (element?.localName !== tag) { const made = document.createElementNS(SVG, tag); if (element) element.replaceWith(made); else group.append(made); element = made; }
    for (const key in element.given) if (!(key in attributes)) attributes[key] = null;
    set(element, attributes);
    const said = text ?? title ?? "";
    if ((element.said ?? "") !== said) { element.said = said; if (title) element.replaceChildren(s("title", { text: title })); else element.textContent = said; }
    element = element.nextElementSibling;
  }
  while (element) { const next = element.nextElementSibling; element.remove(); element = next; }
}

/** A number with so many digits that matter, no more zeros than needed. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(digits - 1).replace("-", "−").replace("e+", "e").replace("e-", "e−");
  const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(places, 8)).replace("-", "−");
}

const STEPS = [["G", 1e9], ["M", 1e6], ["k", 1e3], ["", 1]];
/** A quantity with unit; of N, J and Pa with the prefix that suits its size. */
export function quantity(value, unit, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (["N", "J", "Pa", "N/m"].includes(unit)) {
    const [prefix, factor] = STEPS.find(([, f]) => Math.abs(value) >= f) ?? ["", 1];
    return `${number(value / factor, digits)} ${prefix}${unit}`;
  }
  if (unit === "deg") return `${number(value, digits)}°`;
  return unit ? `${number(value, digits)} ${unit}` : number(value, digits);
}

export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
export const degrees = (gamma) => (Math.atan(gamma) * 180) / Math.PI;

export function download(blob, name) {
  const link = h("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
