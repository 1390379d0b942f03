/* The picture of a plane model: SVG in metres, turned so that up is up; selection, tools, dragging. */
import { t, say } from "./words.js";
import { bodyAt, boxOf, nextBody, rounded, tidy } from "./geometry.js";

const NS = "http://www.w3.org/2000/svg", NAMED = 150, REACH = 9;
const svg = document.getElementById("picture");
export const view = { shown: null, tool: "select", selected: { bodies: new Set(), joints: new Set(), things: new Set() }, names: null };
let listeners = { selected: () => {}, placed: () => {}, dragged: () => {}, released: () => {} };
let box = [0, 0, 1, 1], fitted = true;

export function listen(to) { listeners = { ...listeners, ...to }; }

function node(tag, attributes = {}, parent = null) {
  const made = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (parent) parent.append(made);
  return made;
}

const d = (ring) => "M" + ring.map(([x, y]) => `${x} ${-y}`).join("L") + "Z";
const unit = () => Math.max((box[2] - box[0]) / Math.max(svg.clientWidth, 1), (box[3] - box[1]) / Math.max(svg.clientHeight, 1));

function place() {
  svg.setAttribute("viewBox", `${box[0]} ${-box[3]} ${box[2] - box[0]} ${box[3] - box[1]}`);
  svg.style.setProperty("--u", unit());
}

export function fit() {
  const shown = view.shown;
  if (!shown || shown.dim !== 2) return;
  const points = shown.bodies.flatMap((b) => b.rings.flat());
  const [x0, y0, x1, y1] = boxOf(points.length ? points : [[0, 0]], 0), tail = 0.12 * Math.max(x1 - x0, y1 - y0);
  shown.loads.forEach((l) => (l.tips || []).forEach(([x, y], k) => points.push([x, y], [x - tail * l.ways[k][0], y - tail * l.ways[k][1]])));
  shown.ties.forEach((one) => points.push(one.at_a, one.at_b));
  box = boxOf(points.map((p) => [p[0], p[1]]));
  const wide = svg.clientWidth / Math.max(svg.clientHeight, 1), w = box[2] - box[0], h = box[3] - box[1];
  if (w / h < wide) { const more = (h * wide - w) / 2; box = [box[0] - more, box[1], box[2] + more, box[3]]; }
  else { const more = (w / wide - h) / 2; box = [box[0], box[1] - more, box[2], box[3] + more]; }
  fitted = true;
  draw();
}

export function zoom(factor, at = null) {
  const [x, y] = at || [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
  box = [x + (box[0] - x) / factor, y + (box[1] - y) / factor, x + (box[2] - x) / factor, y + (box[3] - y) / factor];
  fitted = false;
  draw();
}

export function show(shown) {
  const first = !view.shown || view.shown.dim !== shown.dim || fitted;
  view.shown = shown;
  const names = new Set(shown.bodies.map((_, k) => k));
  view.selected.bodies = new Set([...view.selected.bodies].filter((k) => names.has(k)));
  view.selected.joints = new Set([...view.selected.joints].filter((k) => k < shown.joints.length));
  if (view.names === null) { view.names = shown.bodies.length <= NAMED; document.getElementById("names").checked = view.names; }
  svg.classList.toggle("space", shown.dim === 3);
  if (shown.dim === 3) return drawSpace();
  if (first) fit(); else draw();
}

function drawSpace() {
  svg.replaceChildren();
  const image = node("image", { width: "100%", height: "100%" }, svg);
  svg.removeAttribute("viewBox");
  image.setAttribute("href", "data:image/svg+xml;base64," + btoa(unescape(encodeURIComponent(view.shown.figure))));
}

export function clear() { view.shown = null; svg.replaceChildren(); }

export function draw() {
  const shown = view.shown;
  if (!shown || shown.dim !== 2) return;
  place();
  svg.replaceChildren();
  const u = unit(), defs = node("defs", {}, svg);
  const hatch = node("pattern", { id: "hatch", width: 8 * u, height: 8 * u, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" }, defs);
  node("rect", { width: 8 * u, height: 8 * u, fill: "var(--look-fixed)" }, hatch);
  node("rect", { width: 1.2 * u, height: 8 * u, fill: "var(--look-hatch)" }, hatch);
  const bodies = node("g", {}, svg);
  shown.bodies.forEach((body, k) => {
    const kind = body.kind === "fixed" ? "fixed" : body.kind === "rigid" ? "rigid" : body.role === "mortar" ? "mortar" : "";
    const path = node("path", { class: `body ${kind}${view.selected.bodies.has(k) ? " on" : ""}`, d: body.rings.map(d).join(""), "fill-rule": "evenodd", "data-body": k }, bodies);
    node("title", {}, path).textContent = body.name;
  });
  const joints = node("g", {}, svg);
  shown.joints.forEach((joint, k) => {
    const [[ax, ay], [bx, by]] = joint.ends;
    node("line", { class: `joint${view.selected.joints.has(k) ? " on" : ""}`, x1: ax, y1: -ay, x2: bx, y2: -by, "data-joint": k }, joints);
  });
  if (view.names) shown.bodies.forEach((body) => nameOf(body, u));
  shown.ties.forEach((one, k) => {
    const mark = node("line", { class: `tie${on("tie", k)}`, x1: one.at_a[0], y1: -one.at_a[1], x2: one.at_b[0], y2: -one.at_b[1], "data-thing": `tie ${k}` }, svg);
    node("title", {}, mark).textContent = `${one.name}: ${one.words}`;
  });
  shown.supports.forEach((one, k) => drawSupport(one, k, u));
  shown.loads.forEach((load, k) => drawLoad(load, k, u));
  shown.findings.forEach((found) => {
    const mark = node("circle", { class: "finding", cx: found.at[0], cy: -found.at[1], r: 7 * u }, svg);
    node("title", {}, mark).textContent = found.sentence;
  });
  if (view.ghost) node("circle", { class: "ghost", cx: view.ghost[0], cy: -view.ghost[1], r: 6 * u }, svg);
  if (view.ghostEdge) node("line", { class: "ghost", x1: view.ghostEdge[0][0], y1: -view.ghostEdge[0][1], x2: view.ghostEdge[1][0], y2: -view.ghostEdge[1][1] }, svg);
}

const on = (kind, k) => (view.selected.things.has(`${kind} ${k}`) ? " on" : "");

function nameOf(body, u) {
  const xs = body.rings[0].map((p) => p[0]), ys = body.rings[0].map((p) => p[1]);
  const w = Math.max(...xs) - Math.min(...xs), h = Math.max(...ys) - Math.min(...ys);
  if (w < body.name.length * 5.6 * u || h < 11 * u) return;
  node("text", { class: "on-block", x: body.centre[0], y: -body.centre[1] }, svg).textContent = body.name;
}

function drawSupport(one, k, u) {
  const [a, b] = one.edge || [one.at, one.at], many = Math.hypot(b[0] - a[0], b[1] - a[1]) > 20 * u ? 3 : 1;
  const g = node("g", { class: `held${on("support", k)}`, "data-thing": `support ${k}` }, svg);
  node("title", {}, g).textContent = `${one.name}: ${one.directions}`;
  for (let i = 0; i < many; i++) {
    const s = many === 1 ? 0.5 : i / (many - 1), x = a[0] + s * (b[0] - a[0]), y = -(a[1] + s * (b[1] - a[1]));
    node("path", { d: `M${x} ${y}l${6 * u} ${10 * u}h${-12 * u}z` }, g);
  }
}

function drawLoad(load, k, u) {
  if (!load.tips) return;
  const mine = load.table !== null && load.kind === "point" && load.at;
  const g = node("g", { class: `load${mine ? " mine" : ""}${on("load", k)}`, "data-thing": `load ${k}` }, svg), long = 34 * u;
  node("title", {}, g).textContent = `${load.group}: ${load.words}`;
  const many = load.tips.length > 1 ? load.tips.filter((_, i) => i % 2 === 0) : load.tips;
  many.forEach(([x, y], i) => {
    const [wx, wy] = load.ways[many.length === load.tips.length ? i : 2 * i], tx = x - long * wx, ty = y - long * wy;
    node("line", { class: "arrow", x1: tx, y1: -ty, x2: x - 6 * u * wx, y2: -(y - 6 * u * wy) }, g);
    const side = 3.6 * u, bx = x - 9 * u * wx, by = y - 9 * u * wy;
    node("path", { class: "head", d: `M${x} ${-y}L${bx - side * wy} ${-(by + side * wx)}L${bx + side * wy} ${-(by - side * wx)}Z` }, g);
    if (mine) node("circle", { class: "grip", cx: x, cy: -y, r: 11 * u }, g);
  });
  const [x, y] = many[Math.floor(many.length / 2)], [wx, wy] = load.ways[0];
  node("text", { x: x - (long + 9 * u) * wx, y: -(y - (long + 9 * u) * wy) }, g).textContent = load.words;
}

/* --- selection --- */
export function select(kind, ids, more = false) {
  if (!more) { view.selected.bodies.clear(); view.selected.joints.clear(); view.selected.things.clear(); }
  const set = view.selected[kind];
  for (const id of ids) if (more && set.has(id) && ids.length === 1) set.delete(id); else set.add(id);
  draw();
  listeners.selected();
}

function point(event) {
  const spot = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  return [spot.x, -spot.y];
}

export function mark(at, edge = null) { view.ghost = at; view.ghostEdge = edge; draw(); }

/* --- pointer: click, band, pan, drag a load --- */
let press = null;
svg.addEventListener("pointerdown", (event) => {
  if (!view.shown || view.shown.dim !== 2 || event.button > 1) return;
  const thing = event.target.closest("[data-thing]")?.dataset.thing, at = point(event);
  press = { at, from: [...box], x: event.clientX, y: event.clientY, moved: false, more: event.shiftKey || event.ctrlKey, pan: event.button === 1 || event.altKey };
  if (thing?.startsWith("load") && view.tool === "select") {
    const load = view.shown.loads[Number(thing.split(" ")[1])];
    if (load.table !== null && load.kind === "point" && load.at) press.load = load;
  }
  press.target = event.target;
  svg.setPointerCapture?.(event.pointerId);
});
svg.addEventListener("pointermove", (event) => {
  if (!press) return;
  if (Math.hypot(event.clientX - press.x, event.clientY - press.y) > 4) press.moved = true;
  if (!press.moved) return;
  if (press.load) {
    const found = bodyAt(point(event), view.shown.bodies, Infinity, true);
    if (!found) return;
    const size = box[2] - box[0];
    press.drop = { at: tidy(found, size), body: found.body.name };
    mark(press.drop.at);
    listeners.dragged(press.load, press.drop);
  } else if (press.pan || view.tool !== "select") {
    const u = unit(), dx = (event.clientX - press.x) * u, dy = (event.clientY - press.y) * u;
    box = [press.from[0] - dx, press.from[1] + dy, press.from[2] - dx, press.from[3] + dy];
    fitted = false;
    draw();
  } else {
    svg.querySelector(".band")?.remove();
    const [x, y] = point(event), [a, b] = press.at;
    node("rect", { class: "band", x: Math.min(a, x), y: -Math.max(b, y), width: Math.abs(x - a), height: Math.abs(y - b) }, svg);
    press.band = [Math.min(a, x), Math.min(b, y), Math.max(a, x), Math.max(b, y)];
  }
});
svg.addEventListener("pointerup", (event) => {
  const was = press;
  press = null;
  if (!was || !view.shown) return;
  if (was.load && was.drop) { mark(null); listeners.released(was.load, was.drop); return; }
  if (was.band) {
    const [x0, y0, x1, y1] = was.band;
    select("bodies", view.shown.bodies.map((b, k) => [b.centre, k]).filter(([[x, y]]) => x >= x0 && x <= x1 && y >= y0 && y <= y1).map(([, k]) => k), was.more);
    return;
  }
  if (was.moved) return;
  click(point(event), was.target, was.more);
});
svg.addEventListener("pointercancel", () => { press = null; draw(); });

function click(at, target, more) {
  if (view.tool !== "select") {
    const found = bodyAt(at, view.shown.bodies, REACH * unit(), false, view.shown.joints);
    if (!found && view.tool !== "tie") return say(t("click_block"));
    const size = box[2] - box[0], spot = found ? tidy(found, size) : at.map((v) => rounded(v, size));
    mark(spot, view.tool === "tie" ? null : found.edge);
    return listeners.placed({ at: spot, body: found?.body.name || "", edge: found?.edge || null, onEdge: Boolean(found) && found.edgeAway <= REACH * unit() });
  }
  const own = target.closest?.("[data-body],[data-joint],[data-thing]");
  if (!own) return select("bodies", []);
  if (own.dataset.body !== undefined) select("bodies", [Number(own.dataset.body)], more);
  else if (own.dataset.joint !== undefined) select("joints", [Number(own.dataset.joint)], more);
  else select("things", [own.dataset.thing], more);
}

svg.addEventListener("wheel", (event) => {
  if (!view.shown || view.shown.dim !== 2) return;
  event.preventDefault();
  zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), point(event));
}, { passive: false });

svg.addEventListener("keydown", (event) => {
  const shown = view.shown, ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  if (!shown || shown.dim !== 2 || event.ctrlKey || event.metaKey || event.altKey) return;
  const now = [...view.selected.bodies].pop() ?? null;
  if (ways[event.key]) {
    const next = nextBody(shown.bodies, now, ways[event.key]);
    if (next !== null) { select("bodies", [next], event.shiftKey && next !== now); say(shown.bodies[next].name); }
  } else if (event.key === "+" || event.key === "=") zoom(1.25);
  else if (event.key === "-") zoom(0.8);
  else if (event.key === "0") fit();
  else if ((event.key === "Enter" || event.key === " ") && now !== null && view.tool !== "select") {
    const body = shown.bodies[now];
    const top = body.rings[0].map((a, k) => [a, body.rings[0][(k + 1) % body.rings[0].length]]).sort((e, f) => f[0][1] + f[1][1] - e[0][1] - e[1][1])[0];
    const at = [(top[0][0] + top[1][0]) / 2, (top[0][1] + top[1][1]) / 2];
    mark(at, top);
    listeners.placed({ at, body: body.name, edge: top, onEdge: true });
  } else return;
  event.preventDefault();
});

new ResizeObserver(() => { if (view.shown && view.shown.dim === 2) { if (fitted) fit(); else draw(); } }).observe(svg);
