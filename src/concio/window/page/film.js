/* What an answer shows in motion: the data of its report, drawn over the model; the same arrays that the report draws. */
import { d, kindOf, node, view } from "./picture.js";

const TYPES = { f4: Float32Array, f8: Float64Array, i4: Int32Array, u1: Uint8Array };
const STATES = ["open", "stick", "slip", "crushed"];

function unpack(packed) {
  const text = atob(packed.data), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return new TYPES[packed.type](bytes.buffer);
}
const unpacked = (record) => Object.fromEntries(Object.entries(record).map(([key, value]) => [key, value && value.data !== undefined ? unpack(value) : value]));

/* steps with a displacement that is drawn larger, or frames of a motion that are true to scale; null where there is neither */
export function filmOf(data) {
  if (!data) return null;
  if (data.frames) return { frames: true, count: data.frames.length, words: data.words, at: data.at, rate: data.rate, scale: 1, kinds: data.kinds, data };
  if (!data.steps?.length || !data.bodies) return null;
  const steps = data.steps.map(() => null), space = Boolean(data.bodies.triangle);
  return { frames: false, alternatives: Boolean(data.alternatives), count: steps.length, words: data.steps.map((s) => s.label), scale: data.scale, space, kinds: data.bodies.kind, names: data.bodies.name,
    bodies: unpacked(data.bodies), pieces: unpacked(data.pieces), joints: unpacked(data.joints), origin: data.origin, units: data.units,
    step: (k) => (steps[k] ??= unpacked(data.steps[k])) };
}

/* outlines of every body [m] at a step, moved by the share and scale that are asked for */
export function ringsOf(film, k, scale) {
  if (film.frames) return film.data.frames[k].map((rings) => rings.map((flat) => Array.from({ length: flat.length / 2 }, (_, i) => [flat[2 * i], flat[2 * i + 1]])));
  const { start, ring, point } = film.bodies, move = film.step(k).move, [x0, y0] = film.origin, heads = new Set(ring), found = [];
  for (let b = 0; b + 1 < start.length; b++) {
    const rings = [];
    for (let i = start[b]; i < start[b + 1]; i++) {
      if (heads.has(i)) rings.push([]);
      rings[rings.length - 1].push([x0 + point[2 * i] + scale * move[2 * i], y0 + point[2 * i + 1] + scale * move[2 * i + 1]]);
    }
    found.push(rings);
  }
  return found;
}

/* whether a step has lines of force: they run through the model as it is described */
export const hasForces = (film, k) => Boolean(film && !film.frames && !film.space && film.step(k).chain?.length);

function drawForces(g, film, k) {
  const { chain, carried } = film.step(k), [x0, y0] = film.origin, most = carried.reduce((a, b) => Math.max(a, Math.abs(b)), 0);
  for (let i = 0; i < carried.length; i++) {
    const share = Math.abs(carried[i]) / most;
    node("line", { class: carried[i] < 0 ? "force pull" : "force", x1: x0 + chain[4 * i], y1: -y0 - chain[4 * i + 1], x2: x0 + chain[4 * i + 2], y2: -y0 - chain[4 * i + 3], "stroke-width": 0.6 + 6 * share }, g);
  }
}

/* the model as it moves, into an SVG; ghost: outlines alone, for a second answer above the first */
export function drawFilm(into, film, k, scale, ghost = false, forces = false) {
  const g = node("g", { class: ghost ? "film ghosted" : "film", "pointer-events": "none" }, into);
  ringsOf(film, k, scale).forEach((rings, b) => {
    const kind = kindOf({ kind: film.kinds[b], role: film.kinds[b] });
    node("path", { class: `body ${kind}${!ghost && view.selected.bodies.has(b) ? " on" : ""}`, d: rings.map(d).join(""), "fill-rule": "evenodd" }, g);
  });
  const step = film.frames ? null : film.step(k);
  if (forces && hasForces(film, k)) return drawForces(g, film, k);
  if (ghost || !step?.state || film.space) return;
  const { ends } = film.pieces, [x0, y0] = film.origin;
  for (let i = 0; i < step.state.length; i++) {
    const state = STATES[step.state[i]];
    if (state === "stick") continue;
    const at = (moved, e) => [x0 + ends[4 * i + 2 * e] + scale * moved[4 * i + 2 * e], y0 + ends[4 * i + 2 * e + 1] + scale * moved[4 * i + 2 * e + 1]];
    const [a, b, c, e] = [at(step.moved_a, 0), at(step.moved_a, 1), at(step.moved_b, 1), at(step.moved_b, 0)];
    node("path", { class: `state ${state}`, d: d([a, b, c, e]) }, g);
  }
}

/* numbers of the last step for the tables, where the answer is of the model that is shown */
export function numbersOf(film) {
  if (!film || film.frames) return null;
  const step = film.step(film.count - 1), r = film.space ? 6 : 3, dim = film.space ? 3 : 2;
  const bodies = film.kinds.map((_, b) => Math.hypot(...step.motion.slice(r * b, r * b + dim)));
  const joints = step.N ? { a: film.joints.a, b: film.joints.b, N: step.N, V: step.V, open: step.open_share } : null;
  return { bodies: step.N ? bodies : null, joints, units: film.units };
}

