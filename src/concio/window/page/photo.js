/* A picture under the model: its scale by two clicks, four corners that make it flat, stones traced in it and corrected. */
import { t, el, field, say, digits } from "./words.js";
import { call } from "./net.js";
import { draw, drawings, fit, mark, node, unit, view, d } from "./picture.js";
import { lend } from "./hands.js";
import { numbers } from "./geometry.js";

let doc = () => null, send = async () => false, under = null, found = null, mode = "", clicks = [], stones = [], hover = null, busy = false, asked = "";
const form = { method: "courses", unit: "0.25, 0.12", joint: "0.01", distance: "1", size: "3, 2" };
export function setPhoto(document_, sender) { doc = document_; send = sender; }
const table = () => (doc()?.values || []).filter((v) => v.path[0] === "record" && v.path[1] === "picture");
export const hasPicture = () => table().length > 0;

/* what is drawn below the bodies, and above them what was traced and clicked */
drawings.under.push({
  points: () => (under ? [[under.box[0], under.box[1]], [under.box[2], under.box[3]]] : []),
  draw: (svg) => {
    if (!under) return;
    const [x0, y0, x1, y1] = under.box;
    node("image", { href: under.href, x: x0, y: -y1, width: x1 - x0, height: y1 - y0, preserveAspectRatio: "none", class: "underlay" }, svg);
  },
});
drawings.over.push({
  draw: (svg, u) => {
    if (found) for (const ring of found.stones) node("path", { class: "traced", d: d(ring) }, svg);
    if (mode === "outline" && ways.length) for (const way of ways) node("polyline", { class: "wire", points: way.map(([x, y]) => `${x},${-y}`).join(" ") }, svg);
    if (mode === "outline" && ahead) node("polyline", { class: ahead.to === hover ? "wire" : "wire old", points: ahead.way.map(([x, y]) => `${x},${-y}`).join(" ") }, svg);
    const own = clicks.concat(hover && clicks.length ? [hover] : []);
    if (own.length) node("polyline", { class: "ghost", points: own.map(([x, y]) => `${x},${-y}`).join(" ") }, svg);
    clicks.forEach(([x, y]) => node("circle", { class: "ghost", cx: x, cy: -y, r: 5 * u }, svg));
    if (mode === "corner" && view.shown) for (const [x, y] of corners()) node("circle", { class: "corner", cx: x, cy: -y, r: 4 * u }, svg);
  },
});
const corners = () => view.shown.bodies.filter((b) => b.layer === "traced").flatMap((b) => b.rings[0]);

/* the picture of the text, when what is said of it has changed */
export async function underlay(after) {
  const key = doc() ? JSON.stringify(table().map((v) => v.written)) : "";
  if (key === asked) return;
  asked = key;
  under = null; found = null;
  if (!hasPicture()) return draw();
  try {
    const said = await call("underlay");
    if (said.state === "cancelled") { asked = ""; return void setTimeout(() => underlay(after), 200); }
    if (said.state === "error") return say(said.error.what);
    under = said.done;
    after();
    fit();
  } catch (error) { say(error.text || error.message); }
}

/* pixels of the file as the text counts them, from a point of the page that is not rectified */
const pixel = ([x, y]) => { const [x0, , x1, y1] = under.box, s = under.columns / (x1 - x0); return [(x - x0) * s, (y1 - y) * s].map((v) => Math.round(v * 100) / 100); };
const set = (key, value) => ({ do: "set", path: ["record", "picture", key], value });
const without = (...keys) => keys.filter((k) => table().some((v) => v.path[2] === k)).map((k) => ({ do: "remove", path: ["record", "picture", k] }));

function begin(name, pane) { mode = mode === name ? "" : name; clear(); lend(mode ? TOOLS[mode] : null); draw(); photoPane(pane); }
let shown = null, ways = [], ahead = null, flying = false;
function clear() { clicks = []; hover = null; ways = []; ahead = null; }

/* the way along the joints, from the last click to the pointer while it moves, and between clicks for good */
let line = Promise.resolve();
function way(a, b) { /* one after the other: the newest request would end the one before */
  line = line.catch(() => null).then(async () => {
    let said;
    do said = await call("wire", { a, b, joint: Number(form.joint) || null }); while (said.state === "cancelled");
    return said.state === "done" ? said.done.way : null;
  });
  return line;
}
async function fixed(a, b) {
  const mine = ways, found = (ahead?.to === b && ahead.way) || (await way(a, b).catch(() => null));
  if (found && mine === ways) { ways.push(found); draw(); }
}
async function preview() {
  if (flying || !clicks.length || !hover) return;
  const from = clicks.at(-1), to = hover;
  flying = true;
  const found = await way(from, to).catch(() => null);
  flying = false;
  if (mode !== "outline" || from !== clicks.at(-1)) return;
  ahead = found ? { to, way: found } : null;
  draw();
  if (to !== hover) preview();
}
const TOOLS = {
  scale: { click: (at) => { clicks.push(at); if (clicks.length === 2) done("scale"); draw(); } },
  flat: { click: (at) => { clicks.push(at); if (clicks.length === 4) done("flat"); draw(); } },
  cut: { click: (at) => { clicks.push(at); if (clicks.length === 2) done("cut"); draw(); }, hover: (at) => { hover = at; draw(); } },
  outline: { click: (at) => { const near = clicks.length > 2 && Math.hypot(at[0] - clicks[0][0], at[1] - clicks[0][1]) < 10 * unit(); if (near) return done("outline"); if (clicks.length) fixed(clicks.at(-1), at); clicks.push(at); ahead = null; draw(); }, hover: (at) => { hover = at; draw(); preview(); } },
  corner: { down: (at) => { const near = corners().map((p) => [Math.hypot(p[0] - at[0], p[1] - at[1]), p]).sort((a, b) => a[0] - b[0])[0]; if (!near || near[0] > 10 * unit()) return false; clicks = [near[1]]; return true; },
    move: (at) => { hover = at; draw(); }, up: (at) => { const from = clicks[0]; clicks = []; hover = null; send([{ do: "corner", from, to: at.map((v) => Math.round(v * 1e5) / 1e5) }]); } },
};
async function done(what) {
  const own = clicks;
  clear(); mode = ""; lend(null);
  if (what === "scale") {
    const distance = Number(form.distance);
    if (!(distance > 0)) return say(t("photo_distance"));
    await send([...without("corners", "size"), set("points", own.map(pixel)), set("distance", distance)]);
  } else if (what === "flat") {
    const size = numbers(form.size, 2);
    if (!size) return say(t("photo_size"));
    await send([...without("points", "distance"), set("corners", own.map(pixel)), set("size", size)]);
  } else if (what === "outline") { stones.push(own); await trace("outlines"); }
  else {
    const name = [...view.selected.bodies].map((k) => view.shown.bodies[k].name)[0];
    if (name) await send([{ do: "split", name, line: own }]); else say(t("click_block"));
  }
  if (shown) photoPane(shown);
}

async function trace(method) {
  const size = numbers(form.unit, 2);
  if (!size && method !== "outlines") return say(t("photo_unit"));
  busy = true; photoPane(shown);
  try {
    let said;
    do said = await call("trace", { method, unit: size || [0, 0], joint: Number(form.joint) || null, clicks: stones }); while (said.state === "cancelled");
    if (said.state === "error") say(said.error.what + (said.error.hint ? ` → ${said.error.hint}` : "")); else found = said.done;
    form.wrong = said.state === "error" ? said.error.what : "";
  } catch (error) { form.wrong = error.text || error.message; }
  busy = false; photoPane(shown); draw();
}

export function photoPane(pane) {
  shown = pane;
  if (!under) return pane.replaceChildren(el("p", { class: "quiet" }, t(hasPicture() ? "drawing_busy" : "photo_none")));
  const kept = (name, word, help = "") => { const one = el("input", { value: form[name], name: `photo-${name}` }); one.addEventListener("input", () => { form[name] = one.value; }); return field(t(word), one, help); };
  const tool = (name, word) => el("button", { "aria-pressed": String(mode === name), "data-photo": name, onclick: () => begin(name, pane) }, t(word));
  const method = el("select", { name: "photo-method" }, ...["courses", "regions"].map((m) => el("option", { value: m }, t(`photo_${m}`))));
  method.value = form.method;
  method.addEventListener("change", () => { form.method = method.value; });
  const parts = [el("h2", {}, t("photo_scale")), el("p", { class: "quiet" }, t(under.known ? "photo_known" : "photo_unknown"))];
  if (!under.flat) parts.push(kept("distance", "photo_distance"), el("div", { class: "row" }, tool("scale", "photo_two")), kept("size", "photo_size"), el("div", { class: "row" }, tool("flat", "photo_four")));
  else parts.push(el("div", { class: "row" }, el("button", { onclick: () => send(without("corners", "size")) }, t("photo_unflat"))));
  if (under.known) {
    parts.push(el("h2", {}, t("photo_trace")), field(t("kind"), method), kept("unit", "photo_unit"), kept("joint", "photo_joint"),
      el("div", { class: "row" }, el("button", { class: "main", id: "trace", disabled: busy, onclick: () => trace(form.method) }, t("photo_find")), tool("outline", "photo_outline"),
        el("button", { id: "take-stones", disabled: !found, onclick: async () => { if (await send([{ do: "stones", stones: found.stones }])) { found = null; stones = []; photoPane(pane); draw(); } } }, t("photo_take"))));
    if (form.wrong) parts.push(el("p", { role: "alert" }, el("span", { lang: "en" }, form.wrong)));
    if (found) parts.push(el("p", { role: "status" }, t("photo_found", { count: found.stones.length, width: found.width ? digits(Math.round(1000 * found.width)) : "–" })), doubts());
    parts.push(el("h2", {}, t("photo_correct")), el("div", { class: "row" }, tool("cut", "photo_cut"), tool("corner", "photo_corner"),
      el("button", { id: "merge", onclick: () => send([{ do: "merge", names: [...view.selected.bodies].map((k) => view.shown.bodies[k].name) }]) }, t("photo_merge"))), el("p", { class: "quiet" }, t("photo_help")));
  }
  pane.replaceChildren(...parts);
}

/* doubtful joints, the weakest first */
function doubts() {
  const rows = found.joints.map((one) => el("tr", {}, el("td", {}, t(`photo_${one.kind}`)), el("td", { class: "n" }, digits(one.strength)),
    el("td", {}, el("button", { onclick: () => mark(one.ends[0].map((v, k) => (v + one.ends[1][k]) / 2), one.ends) }, t("where")))));
  return el("div", { class: "scroll" }, el("table", {}, el("caption", {}, t("photo_doubts")), el("thead", {}, el("tr", {}, ...["kind", "photo_strength", "where"].map((h) => el("th", { scope: "col" }, t(h))))), el("tbody", {}, ...rows)));
}
