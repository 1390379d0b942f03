/* The picture of a model: in the plane SVG in metres, turned so that up is up; in space SVG in pixels above blocks of WebGL. */
import { boxOf } from "./geometry.js";
import { along, camera, cornersOf, fitSpace, middleOf, paint, project, setModel, towards } from "./space.js";

const NS = "http://www.w3.org/2000/svg", NAMED = 150;
export const svg = document.getElementById("picture"), canvas = document.getElementById("space");
export const view = { shown: null, tool: "select", selected: { bodies: new Set(), joints: new Set(), things: new Set() }, names: null, face: null, moved: null };
export const seen = { box: [0, 0, 1, 1], fitted: true };
export const drawings = { under: [], over: [] };   /* what others draw below the bodies and above them */
let selectedNow = () => {};

export function onSelected(act) { selectedNow = act; }
export const inSpace = () => view.shown?.dim === 3;

export function node(tag, attributes = {}, parent = null) {
  const made = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (parent) parent.append(made);
  return made;
}

export const d = (ring) => "M" + ring.map(([x, y]) => `${x} ${-y}`).join("L") + "Z";
const flat = (p) => (inSpace() ? project(p) : [p[0], -p[1]]);
const outline = (points) => "M" + points.map(flat).map(([x, y]) => `${x} ${y}`).join("L") + "Z";
export const unit = () => {
  const [x0, y0, x1, y1] = seen.box;
  return inSpace() ? 1 : Math.max((x1 - x0) / Math.max(svg.clientWidth, 1), (y1 - y0) / Math.max(svg.clientHeight, 1));
};

export const viewBox = () => { const [x0, y0, x1, y1] = seen.box; return `${x0} ${-y1} ${x1 - x0} ${y1 - y0}`; };
function place() {
  svg.setAttribute("viewBox", inSpace() ? `0 0 ${svg.clientWidth} ${svg.clientHeight}` : viewBox());
  svg.style.setProperty("--u", unit());
}

/* the box of some points, with room, as wide as the picture is */
export function boxAround(points) {
  const [x0, y0, x1, y1] = boxOf(points), wide = svg.clientWidth / Math.max(svg.clientHeight, 1), w = x1 - x0, h = y1 - y0;
  const dx = w / h < wide ? (h * wide - w) / 2 : 0, dy = w / h < wide ? 0 : (w / wide - h) / 2;
  return [x0 - dx, y0 - dy, x1 + dx, y1 + dy];
}

export function fit() {
  const shown = view.shown;
  if (!shown) return;
  seen.fitted = true;
  if (inSpace()) { camera.size = [svg.clientWidth, svg.clientHeight]; fitSpace(shown); return draw(); }
  const points = shown.bodies.flatMap((b) => b.rings.flat());
  const [x0, y0, x1, y1] = boxOf(points.length ? points : [[0, 0]], 0), tail = 0.12 * Math.max(x1 - x0, y1 - y0);
  shown.loads.forEach((l) => (l.tips || []).forEach(([x, y], k) => points.push([x, y], [x - tail * l.ways[k][0], y - tail * l.ways[k][1]])));
  shown.ties.forEach((one) => points.push(one.at_a, one.at_b));
  for (const act of drawings.under) points.push(...(act.points?.() || []));
  seen.box = boxAround(points.length ? points.map((p) => [p[0], p[1]]) : [[0, 0], [1, 1]]);
  draw();
}

export function zoom(factor, at = null) {
  seen.fitted = false;
  if (inSpace()) { camera.unit /= factor; return draw(); }
  const [x0, y0, x1, y1] = seen.box, [x, y] = at || [(x0 + x1) / 2, (y0 + y1) / 2];
  seen.box = [x + (x0 - x) / factor, y + (y0 - y) / factor, x + (x1 - x) / factor, y + (y1 - y) / factor];
  draw();
}

export function show(shown) {
  const first = !view.shown || view.shown.dim !== shown.dim || seen.fitted;
  keepSelected(view.shown, shown);
  view.shown = shown; view.moved = null; view.face = null;
  if (view.names === null && shown.bodies.length) { view.names = shown.bodies.length <= NAMED; document.getElementById("names").checked = view.names; }
  canvas.hidden = document.getElementById("turning").hidden = shown.dim !== 3;
  if (shown.dim === 3) setModel(shown, canvas);
  if (first) fit(); else draw();
}

/* what is selected stays so by its name: numbers are others when blocks come or go */
function keepSelected(before, shown) {
  const names = (one) => one.bodies.map((b) => b.name), between = (one) => one.joints.map((j) => `${one.bodies[j.a].name} | ${one.bodies[j.b].name}`);
  const kept = (set, old, now) => { const chosen = new Set([...set].map((k) => old[k])); return new Set(now.map((name, k) => [name, k]).filter(([name]) => chosen.has(name)).map(([, k]) => k)); };
  const { selected } = view;
  selected.bodies = before ? kept(selected.bodies, names(before), names(shown)) : new Set();
  if (!before || !shown.early) selected.joints = before && !before.early ? kept(selected.joints, between(before), between(shown)) : new Set();
  const counts = (one) => [one.loads, one.supports, one.ties].map((list) => list.length).join();
  if (!before || counts(before) !== counts(shown)) selected.things = new Set();
}

export function clear() { view.shown = view.moved = null; canvas.hidden = document.getElementById("turning").hidden = true; svg.replaceChildren(); }

export function draw() {
  const shown = view.shown;
  if (!shown) return;
  place();
  svg.replaceChildren();
  const u = unit();
  if (inSpace()) paint(view.selected.bodies); else drawPlane(shown, u);
  drawJoints(shown);
  if (view.names) shown.bodies.forEach((body, k) => nameOf(body, k, u));
  shown.ties.forEach((one, k) => {
    const [[ax, ay], [bx, by]] = [flat(one.at_a), flat(one.at_b)];
    const made = node("line", { class: `tie${on("tie", k)}`, x1: ax, y1: ay, x2: bx, y2: by, "data-thing": `tie ${k}` }, svg);
    node("title", {}, made).textContent = `${one.name}: ${one.words}`;
  });
  shown.supports.forEach((one, k) => drawSupport(one, k, u));
  shown.loads.forEach((load, k) => drawLoad(load, k, u));
  shown.findings.forEach((found) => {
    const [x, y] = flat(found.at), made = node("circle", { class: "finding", cx: x, cy: y, r: 7 * u }, svg);
    node("title", {}, made).textContent = found.sentence;
  });
  if (view.ghostEdge) node("path", { class: "ghost", d: outline(view.ghostEdge) }, svg);
  else if (inSpace() && view.face) node("path", { class: "ghost", d: outline(cornersOf(...view.face)) }, svg);
  if (view.ghost) { const [x, y] = flat(view.ghost); node("circle", { class: "ghost", cx: x, cy: y, r: 6 * u }, svg); }
  for (const act of drawings.over) act.draw(svg, u);
}

export function kindOf(body) { return body.kind === "fixed" ? "fixed" : body.kind === "rigid" ? "rigid" : body.role === "mortar" ? "mortar" : ""; }

export function hatched(into, u) {
  const hatch = node("pattern", { id: "hatch", width: 8 * u, height: 8 * u, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" }, node("defs", {}, into));
  node("rect", { width: 8 * u, height: 8 * u, fill: "var(--look-fixed)" }, hatch);
  node("rect", { width: 1.2 * u, height: 8 * u, fill: "var(--look-hatch)" }, hatch);
}

function drawPlane(shown, u) {
  hatched(svg, u);
  for (const act of drawings.under) act.draw(svg, u);
  const bodies = node("g", { class: view.moved ? "faint" : "" }, svg);
  shown.bodies.forEach((body, k) => {
    const path = node("path", { class: `body ${kindOf(body)}${view.selected.bodies.has(k) ? " on" : ""}`, d: body.rings.map(d).join(""), "fill-rule": "evenodd", "data-body": k }, bodies);
    node("title", {}, path).textContent = body.name;
  });
  if (view.moved) view.moved(svg, u);
}

function drawJoints(shown) {
  const joints = node("g", {}, svg);
  shown.joints.forEach((joint, k) => {
    const on = view.selected.joints.has(k), mark = { class: `joint${on ? " on" : ""}`, "data-joint": k };
    if (!joint.ends.length) return;
    if (inSpace()) { if (on) node("path", { ...mark, class: "joint on face", d: outline(joint.ends) }, joints); return; }
    const [[ax, ay], [bx, by]] = joint.ends;
    node("line", { ...mark, x1: ax, y1: -ay, x2: bx, y2: -by }, joints);
  });
}

const on = (kind, k) => (view.selected.things.has(`${kind} ${k}`) ? " on" : "");

function nameOf(body, k, u) {
  const corners = inSpace() ? body.vertices.map(project) : body.rings[0], xs = corners.map((p) => p[0]), ys = corners.map((p) => p[1]);
  const w = Math.max(...xs) - Math.min(...xs), h = Math.max(...ys) - Math.min(...ys);
  if (w < body.name.length * 5.6 * u || h < 11 * u || (inSpace() && view.shown.bodies.length > 40 && !view.selected.bodies.has(k))) return;
  const [x, y] = flat(body.centre);
  node("text", { class: "on-block", x, y }, svg).textContent = body.name;
}

function drawSupport(one, k, u) {
  const g = node("g", { class: `held${on("support", k)}`, "data-thing": `support ${k}` }, svg);
  node("title", {}, g).textContent = `${one.name}: ${one.directions}`;
  if (one.polygon) node("path", { class: "held-face", d: outline(one.polygon) }, g);
  const [a, b] = (one.edge || [one.polygon ? middleOf(one.polygon) : one.at, one.polygon ? middleOf(one.polygon) : one.at]).map(flat), many = Math.hypot(b[0] - a[0], b[1] - a[1]) > 20 * u ? 3 : 1;
  for (let i = 0; i < many; i++) {
    const s = many === 1 ? 0.5 : i / (many - 1), x = a[0] + s * (b[0] - a[0]), y = a[1] + s * (b[1] - a[1]);
    node("path", { d: `M${x} ${y}l${6 * u} ${10 * u}h${-12 * u}z` }, g);
  }
}

function drawLoad(load, k, u) {
  if (!load.tips) return;
  const mine = load.table !== null && load.kind === "point" && load.at && !inSpace(), long = 34 * u;
  const g = node("g", { class: `load${mine ? " mine" : ""}${on("load", k)}`, "data-thing": `load ${k}` }, svg);
  node("title", {}, g).textContent = `${load.group}: ${load.words}`;
  if (load.polygon) node("path", { class: "arrow face", d: outline(load.polygon) }, g);
  const all = load.tips.map((p, i) => [p, load.ways[i]]), many = all.length > 1 ? all.filter((_, i) => i % 2 === 0) : all;
  many.forEach(([tip, way]) => {
    const [x, y] = flat(tip), [wx, wy] = inSpace() ? along(way) : [way[0], -way[1]], size = Math.hypot(wx, wy);
    if (size < 0.2) return node("circle", { class: "head", cx: x, cy: y, r: 5 * u }, g);
    node("line", { class: "arrow", x1: x - long * wx, y1: y - long * wy, x2: x - 6 * u * wx, y2: y - 6 * u * wy }, g);
    const side = 3.6 * u / size, bx = x - 9 * u * wx / size, by = y - 9 * u * wy / size;
    node("path", { class: "head", d: `M${x} ${y}L${bx + side * wy} ${by - side * wx}L${bx - side * wy} ${by + side * wx}Z` }, g);
    if (mine) node("circle", { class: "grip", cx: x, cy: y, r: 11 * u }, g);
  });
  const [tip, way] = many[Math.floor(many.length / 2)], [x, y] = flat(tip), [wx, wy] = inSpace() ? along(way) : [way[0], -way[1]];
  node("text", { x: x - (long + 9 * u) * wx, y: y - (long + 9 * u) * wy + (Math.hypot(wx, wy) < 0.2 ? 14 * u : 0) }, g).textContent = load.words;
}

export const facesEye = (way) => towards(way) > 0;

/* --- selection --- */
export function select(kind, ids, more = false) {
  if (!more) { view.selected.bodies.clear(); view.selected.joints.clear(); view.selected.things.clear(); view.face = null; }
  const set = view.selected[kind];
  for (const id of ids) if (more && set.has(id) && ids.length === 1) set.delete(id); else set.add(id);
  draw();
  selectedNow();
}

export function mark(at, edge = null) { view.ghost = at; view.ghostEdge = edge; draw(); }

new ResizeObserver(() => { if (view.shown) { if (seen.fitted) fit(); else draw(); } }).observe(svg);
