// A deck as the fragment of a link: compressed, and opened by any page.
import { tr } from "./words.js";

const MARK = "#deck=", MOST = 1e6; // bytes of a deck

async function through(bytes, stream) {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader(), parts = [];
  let size = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    size += part.value.length;
    if (size > MOST) { await reader.cancel(); throw new Error(tr`the deck of this link is too large`); }
    parts.push(part.value);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}
/** The fragment that holds a deck. */
export async function fragmentOf(text) {
  const bytes = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  let letters = "";
  for (const byte of bytes) letters += String.fromCharCode(byte);
  return MARK + btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}
/** The deck of a link or a fragment; null without a deck. */
export async function deckOf(link) {
  const at = link.indexOf(MARK);
  if (at < 0) return null;
  const letters = atob(link.slice(at + MARK.length).trim().replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = await through(Uint8Array.from(letters, (c) => c.charCodeAt(0)), new DecompressionStream("deflate-raw"));
  return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
}
