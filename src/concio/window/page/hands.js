/* What hands do in the picture: click, rubber band, pan, turn, drag a load, and the keys of the picture. */
import { t, say } from "./words.js";
import { bodyAt, nextBody, rounded, tidy } from "./geometry.js";
import { draw, fit, inSpace, mark, node, seen, select, svg, unit, view, zoom } from "./picture.js";
import { camera, cornersOf, facesOf, hit, look, middleOf, project, shift, turn } from "./space.js";

const REACH = 9;
let listeners = { placed: () => {}, dragged: () => {}, released: () => {} }, other = null, press = null;
export function listen(to) { listeners = { ...listeners, ...to }; }
/* another tool takes the pointer in the plane: {down, move, up, click}, all with points in metres */
export function lend(tool) { other = tool; }

export function point(event) {
  const spot = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  return inSpace() ? [spot.x, spot.y] : [spot.x, -spot.y];
}

svg.addEventListener("contextmenu", (event) => { if (inSpace()) event.preventDefault(); });
svg.addEventListener("pointerdown", (event) => {
  if (!view.shown || (event.button > 1 && !inSpace())) return;
  const thing = event.target.closest("[data-thing]")?.dataset.thing;
  press = { at: point(event), last: [event.clientX, event.clientY], from: [...seen.box], x: event.clientX, y: event.clientY, moved: false, more: event.shiftKey || event.ctrlKey, pan: event.button > 0 || event.altKey, target: event.target };
  if (other && !press.pan) press.other = other.down?.(press.at, event) || false;
  else if (thing?.startsWith("load") && view.tool === "select" && !inSpace()) {
    const load = view.shown.loads[Number(thing.split(" ")[1])];
    if (load.table !== null && load.kind === "point" && load.at) press.load = load;
  }
  svg.setPointerCapture?.(event.pointerId);
});

svg.addEventListener("pointermove", (event) => {
  if (!press) return other?.hover?.(point(event));
  if (Math.hypot(event.clientX - press.x, event.clientY - press.y) > 4) press.moved = true;
  if (!press.moved) return;
  if (press.other) return other?.move?.(point(event));
  if (inSpace()) return turned(event);
  if (press.load) return draggedLoad(event);
  if (press.pan || view.tool !== "select" || other) {
    const u = unit(), dx = (event.clientX - press.x) * u, dy = (event.clientY - press.y) * u, [x0, y0, x1, y1] = press.from;
    seen.box = [x0 - dx, y0 + dy, x1 - dx, y1 + dy];
    seen.fitted = false;
    return draw();
  }
  svg.querySelector(".band")?.remove();
  const [x, y] = point(event), [a, b] = press.at;
  node("rect", { class: "band", x: Math.min(a, x), y: -Math.max(b, y), width: Math.abs(x - a), height: Math.abs(y - b) }, svg);
  press.band = [Math.min(a, x), Math.min(b, y), Math.max(a, x), Math.max(b, y)];
});

function turned(event) {
  const dx = event.clientX - press.last[0], dy = event.clientY - press.last[1];
  press.last = [event.clientX, event.clientY];
  if (press.pan || event.shiftKey) shift(dx, dy); else turn(dx, dy);
  seen.fitted = false;
  draw();
}

function draggedLoad(event) {
  const found = bodyAt(point(event), view.shown.bodies, Infinity, true);
  if (!found) return;
  press.drop = { at: tidy(found, seen.box[2] - seen.box[0]), body: found.body.name };
  mark(press.drop.at);
  listeners.dragged(press.load, press.drop);
}

svg.addEventListener("pointerup", (event) => {
  const was = press;
  press = null;
  if (!was || !view.shown) return;
  if (was.other && was.moved) return other?.up?.(point(event));
  if (was.load && was.drop) { mark(null); listeners.released(was.load, was.drop); return; }
  if (was.band) {
    const [x0, y0, x1, y1] = was.band;
    return select("bodies", view.shown.bodies.map((b, k) => [b.centre, k]).filter(([[x, y]]) => x >= x0 && x <= x1 && y >= y0 && y <= y1).map(([, k]) => k), was.more);
  }
  if (was.moved) return;
  if (other && !was.pan) return other.click?.(point(event), event);
  click(point(event), was.target, was.more);
});
svg.addEventListener("pointercancel", () => { press = null; draw(); });

function click(at, target, more) {
  const own = target.closest?.("[data-body],[data-joint],[data-thing]");
  if (view.tool !== "select") return inSpace() ? placeInSpace(at) : placeInPlane(at);
  if (own?.dataset.thing !== undefined) return select("things", [own.dataset.thing], more);
  if (inSpace()) {
    const found = hit(...at);
    select("bodies", found ? [found.index] : [], more);
    if (found) { view.face = [found.index, found.face]; draw(); say(view.shown.bodies[found.index].name); }
    return;
  }
  if (!own) return select("bodies", []);
  if (own.dataset.body !== undefined) select("bodies", [Number(own.dataset.body)], more);
  else select("joints", [Number(own.dataset.joint)], more);
}

function placeInPlane(at) {
  const found = bodyAt(at, view.shown.bodies, REACH * unit(), false, view.shown.joints);
  if (!found && view.tool !== "tie") return say(t("click_block"));
  const size = seen.box[2] - seen.box[0], spot = found ? tidy(found, size) : at.map((v) => rounded(v, size));
  mark(spot, view.tool === "tie" ? null : found.edge);
  listeners.placed({ at: spot, body: found?.body.name || "", edge: found?.edge || null });
}

/* in space: the face under the pointer; near a corner, or the middle of an edge or of the face, the point is that one */
function placeInSpace([x, y]) {
  const found = hit(x, y);
  if (!found) return say(t("click_block"));
  placeOn(found.index, found.face, found.at, (p) => Math.hypot(project(p)[0] - x, project(p)[1] - y));
}

function placeOn(index, face, at, away) {
  const corners = cornersOf(index, face), next = (k) => corners[(k + 1) % corners.length];
  const known = [...corners, ...corners.map((p, k) => middleOf([p, next(k)])), middleOf(corners)].sort((p, q) => away(p) - away(q));
  const spot = away(known[0]) <= REACH ? known[0] : at.map((v) => rounded(v, camera.unit * svg.clientWidth));
  const clean = spot.map((v) => Number(v.toFixed(9)));
  view.face = [index, face];
  mark(clean, view.tool === "tie" ? null : corners);
  listeners.placed({ at: clean, body: view.shown.bodies[index].name, polygon: corners });
}

svg.addEventListener("wheel", (event) => {
  if (!view.shown) return;
  event.preventDefault();
  zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), point(event));
}, { passive: false });

const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
svg.addEventListener("keydown", (event) => {
  const shown = view.shown;
  if (!shown || event.ctrlKey || event.metaKey || event.altKey) return;
  const now = [...view.selected.bodies].pop() ?? null, way = WAYS[event.key];
  if (way && inSpace() && event.shiftKey) { turn(20 * way[0], -20 * way[1]); seen.fitted = false; draw(); }
  else if (way) {
    const places = inSpace() ? shown.bodies.map((b) => ({ centre: [project(b.centre)[0], -project(b.centre)[1]] })) : shown.bodies;
    const next = nextBody(places, now, way);
    if (next !== null) { select("bodies", [next], event.shiftKey && next !== now); say(shown.bodies[next].name); }
  } else if (event.key === "+" || event.key === "=") zoom(1.25);
  else if (event.key === "-") zoom(0.8);
  else if (event.key === "0") fit();
  else if (event.key === "f" && inSpace() && now !== null) {
    const faces = facesOf(now), at = view.face?.[0] === now ? faces.indexOf(view.face[1]) : -1;
    view.face = [now, faces[(at + 1) % faces.length]];
    draw();
    say(`${shown.bodies[now].name}: ${t("face")} ${(at + 1) % faces.length + 1} / ${faces.length}`);
  } else if ((event.key === "Enter" || event.key === " ") && now !== null && view.tool !== "select") placed(now);
  else return;
  event.preventDefault();
  event.stopPropagation();
});

/* by keyboard: the chosen face of the selected block, in the plane its topmost edge, with its middle */
function placed(now) {
  const body = view.shown.bodies[now];
  if (inSpace()) {
    const face = view.face?.[0] === now ? view.face[1] : facesOf(now)[0];
    return placeOn(now, face, middleOf(cornersOf(now, face)), () => Infinity);
  }
  const ring = body.rings[0], sides = ring.map((a, k) => [a, ring[(k + 1) % ring.length]]);
  const [a, b] = sides.sort((e, f) => f[0][1] + f[1][1] - e[0][1] - e[1][1])[0], at = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  mark(at, [a, b]);
  listeners.placed({ at, body: body.name, edge: [a, b] });
}

/* views and cuts of space */
for (const one of document.querySelectorAll("[data-look]")) one.addEventListener("click", () => { look(one.dataset.look); fit(); });
const share = document.getElementById("cut-share"), axis = document.getElementById("cut-axis");
for (const one of [share, axis]) one.addEventListener("input", () => { const way = Number(axis.value); camera.cut = { axis: way < 0 ? -1 - way : way, share: share.value / 100, sign: way < 0 ? -1 : 1 }; draw(); });
