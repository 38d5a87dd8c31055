// Shapes of masonry as blocks: an arch of voussoirs, a pier or wall of courses; copies of blocks. Lengths in metres.

const round = (v) => Math.round(v * 1e6) / 1e6 + 0;
const FACET = Math.PI / 36; // greatest angle that one edge of a curved face spans

/** Courses from one corner to the opposite one; of several units in running bond. A list of outlines. */
export function wall([x0, y0], [x1, y1], courses, units) {
  const [left, right] = [Math.min(x0, x1), Math.max(x0, x1)], [low, high] = [Math.min(y0, y1), Math.max(y0, y1)];
  const blocks = [], unit = (right - left) / units;
  for (let c = 0; c < courses; c += 1) {
    const bottom = low + ((high - low) * c) / courses, top = low + ((high - low) * (c + 1)) / courses;
    const cuts = [left];
    for (let u = 1; u <= units; u += 1) cuts.push(left + unit * (u - (c % 2 && units > 1 ? 0.5 : 0)));
    if (c % 2 && units > 1) cuts.push(right);
    for (let k = 0; k + 1 < cuts.length; k += 1) blocks.push([[cuts[k], bottom], [cuts[k + 1], bottom], [cuts[k + 1], top], [cuts[k], top]].map((p) => p.map(round)));
  }
  return blocks;
}

/** Voussoirs between two springings of the intrados, its crown `rise` above the middle of their chord; null where there is no such arc. */
export function arch(a, b, rise, thickness, count) {
  if (a[0] > b[0]) [a, b] = [b, a];
  const span = Math.hypot(b[0] - a[0], b[1] - a[1]);
  if (!(span > 0 && rise > 0 && thickness > 0 && count >= 1)) return null;
  const u = [(b[0] - a[0]) / span, (b[1] - a[1]) / span], n = [-u[1], u[0]];
  const radius = (span * span / 4 + rise * rise) / (2 * rise), down = radius - rise;
  const centre = [(a[0] + b[0]) / 2 - down * n[0], (a[1] + b[1]) / 2 - down * n[1]];
  const half = Math.atan2(span / 2, down), facets = 2 * Math.ceil(half / count / FACET); // even: the crown is a vertex
  const at = (k, r) => {
    const t = -half + (2 * half * k) / (count * facets);
    return [0, 1].map((i) => round(centre[i] + r * (Math.sin(t) * u[i] + Math.cos(t) * n[i])));
  };
  const steps = Array.from({ length: facets + 1 }, (_, k) => k);
  return Array.from({ length: count }, (_, v) => [
    ...steps.map((k) => at(v * facets + k, radius)), ...steps.map((k) => at(v * facets + facets - k, radius + thickness)),
  ]);
}

export const mirrored = (points, axis) => points.map(([x, y]) => [round(2 * axis - x), y]).reverse();
export const shifted = (points, dx, dy) => points.map(([x, y]) => [round(x + dx), round(y + dy)]);
/** Points turned about a centre, degrees counter-clockwise. */
export function rotated(points, [cx, cy], degrees) {
  const t = (degrees * Math.PI) / 180, c = Math.cos(t), n = Math.sin(t);
  return points.map(([x, y]) => [round(cx + c * (x - cx) - n * (y - cy)), round(cy + n * (x - cx) + c * (y - cy))]);
}
export function inside([x, y], points) {
  let within = false;
  for (let i = 0, j = points.length - 1; i < points.length; j = i, i += 1) {
    const [xi, yi] = points[i], [xj, yj] = points[j];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) within = !within;
  }
  return within;
}
/** The nearest vertex within reach, else the nearest place of an edge, else null. */
export function snapped([x, y], outlines, reach) {
  let best = null, far = reach;
  for (const points of outlines) for (const p of points) { const d = Math.hypot(p[0] - x, p[1] - y); if (d < far) { far = d; best = [...p]; } }
  if (best) return best;
  for (const points of outlines) for (let i = 0, j = points.length - 1; i < points.length; j = i, i += 1) {
    const [a, b] = [points[j], points[i]], l2 = (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2;
    const share = Math.min(1, Math.max(0, ((x - a[0]) * (b[0] - a[0]) + (y - a[1]) * (b[1] - a[1])) / (l2 || 1)));
    const p = [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])], d = Math.hypot(p[0] - x, p[1] - y);
    if (d < far) { far = d; best = p.map(round); }
  }
  return best;
}
