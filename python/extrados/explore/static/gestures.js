// Two fingers on a drawing: it is moved and enlarged.

/** begin(): two fingers have been put down; zoom(by, x, y, dx, dy): enlarge about a place (px) after a shift (px). */
export function pinch(svg, { begin, zoom }) {
  const fingers = new Map(); // places of the fingers on the drawing
  const middle = () => { const [a, b] = [...fingers.values()]; return { x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2, apart: Math.hypot(a[0] - b[0], a[1] - b[1]) }; };
  svg.addEventListener("pointerdown", (event) => {
    if (event.pointerType !== "touch") return;
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size === 2) begin();
  }, true);
  svg.addEventListener("pointermove", (event) => {
    if (!fingers.has(event.pointerId)) return;
    const was = fingers.size === 2 ? middle() : null;
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (!was) return;
    const now = middle(), edge = svg.getBoundingClientRect();
    zoom(now.apart / (was.apart || 1), now.x - edge.left, now.y - edge.top, now.x - was.x, now.y - was.y);
  }, true);
  for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, (event) => fingers.delete(event.pointerId), true);
  return fingers;
}
