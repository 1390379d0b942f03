/* Pure functions of the plane: distances, the nearest edge, the point under the pointer. */
export function nearestOnSegment([px, py], [ax, ay], [bx, by]) {
  const dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy;
  const s = square > 0 ? Math.max(0, Math.min(1, ((px - ax) * dx + (py - ay) * dy) / square)) : 0;
  const at = [ax + s * dx, ay + s * dy];
  return { at, away: Math.hypot(px - at[0], py - at[1]) };
}

export function edges(rings) {
  return rings.flatMap((ring) => ring.map((a, k) => [a, ring[(k + 1) % ring.length]]));
}

/* the nearest edge; of those within reach one that no joint covers goes first: loads and supports are on free faces */
export function nearestEdge(point, rings, joints = [], reach = 0) {
  let best = { away: Infinity, edge: null, at: null }, free = best;
  for (const [a, b] of edges(rings)) {
    const found = nearestOnSegment(point, a, b);
    if (found.away < best.away) best = { ...found, edge: [a, b] };
    if (found.away < Math.min(free.away, reach) && !covered([a, b], joints)) free = { ...found, edge: [a, b] };
  }
  return free.edge && Number.isFinite(reach) ? free : best;
}

export function covered([a, b], joints) {
  const middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], long = Math.hypot(b[0] - a[0], b[1] - a[1]);
  return joints.some((ends) => nearestOnSegment(middle, ...ends).away < 1e-3 * long);
}

export function inside([x, y], rings) {
  let odd = false;
  for (const [[x0, y0], [x1, y1]] of edges(rings)) {
    if ((y0 > y) !== (y1 > y) && x < x0 + ((y - y0) / (y1 - y0)) * (x1 - x0)) odd = !odd;
  }
  return odd;
}

/* the body at a point, or the nearest one within reach, with the point moved onto it */
export function bodyAt(point, bodies, reach, free = false, joints = []) {
  let best = null;
  bodies.forEach((body, index) => {
    if (!body.rings.length || (free && body.kind === "fixed")) return;
    const own = joints.filter((j) => j.a === index || j.b === index).map((j) => j.ends);
    const edge = nearestEdge(point, body.rings, own, reach), within = inside(point, body.rings);
    const away = within ? 0 : edge.away;
    if (away > reach || (best && away >= best.away)) return;
    const at = edge.away <= reach || !within ? edge.at : point;
    best = { index, body, at, away, edge: edge.edge, edgeAway: edge.away, snapped: at === edge.at };
  });
  return best;
}

export function boxOf(points, margin = 0.08) {
  let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of points) { x0 = Math.min(x0, x); y0 = Math.min(y0, y); x1 = Math.max(x1, x); y1 = Math.max(y1, y); }
  const pad = margin * Math.max(x1 - x0, y1 - y0, 1e-9);
  return [x0 - pad, y0 - pad, x1 + pad, y1 + pad];
}

/* the next body from one in a direction (dx, dy), for the arrow keys */
export function nextBody(bodies, from, [dx, dy]) {
  if (from === null) return bodies.length ? 0 : null;
  const [x, y] = bodies[from].centre;
  let best = null, least = Infinity;
  bodies.forEach((body, k) => {
    const u = body.centre[0] - x, v = body.centre[1] - y, along = u * dx + v * dy, across = Math.abs(u * dy - v * dx);
    if (k === from || along <= 1e-9 || across > 2 * along) return;
    if (along + 2 * across < least) { least = along + 2 * across; best = k; }
  });
  return best === null ? from : best;
}

/* the blocks at the level of one, itself included: they share at least half of their height and of its own with it */
export function courseOf(bodies, k) {
  const spans = bodies.map((b) => { const up = b.vertices ? b.vertices.map((p) => p[2]) : b.rings[0].map((p) => p[1]); return [Math.min(...up), Math.max(...up)]; });
  const [low, high] = spans[k];
  return bodies.map((b, n) => n).filter((n) => bodies[n].kind !== "fixed" && Math.min(high, spans[n][1]) - Math.max(low, spans[n][0]) > (0.5 - 1e-6) * Math.max(high - low, spans[n][1] - spans[n][0]));
}

export const rounded = (v, size) => {
  const step = 10 ** (Math.floor(Math.log10(Math.max(size, 1e-9))) - 4);
  return Number((Math.round(v / step) * step).toPrecision(9));
};

/* the point of a found body in few digits, still on its edge where it was moved there */
export function tidy(found, size) {
  const at = found.at.map((v) => rounded(v, size));
  return found.snapped ? nearestOnSegment(at, ...found.edge).at.map((v) => Math.round(v * 1e9) / 1e9) : at;
}

export function numbers(text, count) {
  const found = text.trim().split(/[\s,;]+/).filter(Boolean).map(Number);
  return found.length === count && found.every(Number.isFinite) ? found : null;
}
