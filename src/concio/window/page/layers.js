/* What the layers of a drawing mean: counts, what is proposed, a small picture of each; the unit asked with a block. */
import { t, el, field, digits } from "./words.js";
import { call } from "./net.js";
import { boxOf, numbers } from "./geometry.js";
import { drawings, fit, node, view } from "./picture.js";

const USES = ["", "block", "rigid", "fixed", "hole", "names", "ignore", "load"], NS = "http://www.w3.org/2000/svg";
let send = async () => false, lines = [], filling = false;
const typed = new Map(), begun = new Set();   /* texts that are being typed, and layers said to be loads whose value is not given yet: the table may be filled again meanwhile */
export function setLayers(sender) { send = sender; }

/* while the drawing gives no model yet, its lines stand in the picture */
const alone = () => (view.shown && !view.shown.bodies.length ? lines : []);
drawings.under.push({
  points: () => alone().flat(),
  draw: (svg) => alone().forEach((line) => node("path", { class: "sketch", d: "M" + line.map(([x, y]) => `${x} ${-y}`).join("L") }, svg)),
});
export function forgetLayers() { lines = []; typed.clear(); begun.clear(); }

function thumbnail(lines, box) {
  const svg = document.createElementNS(NS, "svg");
  svg.setAttribute("viewBox", `${box[0]} ${-box[3]} ${box[2] - box[0]} ${box[3] - box[1]}`);
  svg.setAttribute("width", 120); svg.setAttribute("height", 70); svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(NS, "path");
  path.setAttribute("d", lines.map((l) => "M" + l.map(([x, y]) => `${x} ${-y}`).join("L")).join(""));
  path.setAttribute("fill", "none"); path.setAttribute("stroke", "currentColor"); path.setAttribute("vector-effect", "non-scaling-stroke");
  svg.append(path);
  return svg;
}

let newest = 0;
export async function layersPane(pane) {
  const mine = (newest += 1);
  let found;
  try {
    let answered;
    do answered = await call("layers"); while (answered.state === "cancelled" && mine === newest); /* another picture was asked for meanwhile */
    if (mine !== newest) return;
    if (answered.error) throw Object.assign(new Error(answered.error.what), {}); found = answered.done;
  } catch (error) { return pane.replaceChildren(el("p", { role: "alert" }, error.text || error.message)); }
  if (!found) return;
  lines = found.layers.flatMap((l) => l.lines);
  if (alone().length) fit();
  const points = lines.flat(), box = points.length ? boxOf(points) : [0, 0, 1, 1];
  const proposals = found.layers.filter((l) => l.proposed && l.proposed !== "load" && l.stated === null);
  const mend = el("input", { value: found.mend, placeholder: "0.5 mm", onchange: () => send([mend.value.trim() ? { do: "set", path: ["drawing", "mend"], value: mend.value.trim() } : { do: "remove", path: ["drawing", "mend"] }]) });
  const unit = el("select", { onchange: () => send([{ do: "set", path: ["drawing", "unit"], value: unit.value }]) }, ...["mm", "cm", "m", "in", "ft"].map((u) => el("option", { value: u }, u)));
  const size = { 0.001: "mm", 0.01: "cm", 1: "m", 0.0254: "in", 0.3048: "ft" }[found.metres];
  if (size && found.unit) unit.value = size; else unit.selectedIndex = -1;
  const rows = found.layers.map((layer) => {
    const stated = begun.has(layer.name) ? "load" : typeof layer.stated === "string" ? layer.stated : layer.stated ? layer.stated.use || (layer.stated.load && "load") || layer.stated.support || layer.stated.material : "";
    const words = USES.includes(stated) ? USES : [...USES, stated];
    const pick = el("select", { "aria-label": `${t("layer_meaning")}: ${layer.name}`, onchange: () => {
      extra.hidden = pick.value !== "load";
      if (pick.value === "load") { begun.add(layer.name); return value.focus(); }
      begun.delete(layer.name);
      if (pick.value || layer.stated !== null) send([pick.value ? { do: "set", path: ["drawing", "layers", layer.name], value: pick.value } : { do: "remove", path: ["drawing", "layers", layer.name] }]);
    } },
      ...words.map((w) => el("option", { value: w }, USES.includes(w) ? t(`layer_${w || "none"}`) : w)));
    pick.value = stated;
    const given = stated === "load" && layer.stated?.load ? layer.stated : {}, points = "POINT" in layer.count;
    const value = el("input", { value: (given.value || []).toString(), placeholder: "0, -10", "aria-label": `${t("layer_value")}: ${layer.name}`, onchange: load });
    const group = el("input", { value: given.group || "dead", "aria-label": `${t("group")}: ${layer.name}`, onchange: load });
    function load() {
      const vector = filling ? null : numbers(value.value, 2); /* a field that is taken away is not left by a person */
      if (!vector) return;
      for (const one of [value, group]) typed.delete(one.getAttribute("aria-label"));
      begun.delete(layer.name);
      send([{ do: "set", path: ["drawing", "layers", layer.name], value: { load: points ? "point" : "traction", value: vector, group: group.value.trim() || "dead" } }]);
    }
    for (const one of [value, group]) {
      const key = one.getAttribute("aria-label");
      if (typed.has(key)) one.value = typed.get(key);
      one.addEventListener("input", () => typed.set(key, one.value));
      one.addEventListener("blur", () => { if (typed.has(key)) load(); });
    }
    const extra = el("div", { hidden: stated !== "load" }, el("p", { class: "quiet" }, t("layer_value")), value, el("p", { class: "quiet" }, t("group")), group);
    const note = layer.proposed && layer.stated === null ? el("p", { class: "quiet" }, `${t("layer_proposed")}: ${t(`layer_${layer.proposed}`)}`) : null;
    return el("tr", {}, el("th", { scope: "row" }, layer.name, layer.off ? el("p", { class: "quiet" }, t("layer_off")) : null),
      el("td", { lang: "en" }, Object.entries(layer.count).map(([k, n]) => `${n} ${k}`).join(", ")), el("td", {}, pick, note, extra), el("td", {}, thumbnail(layer.lines, box)));
  });
  const held = pane.querySelector(":focus")?.getAttribute("aria-label");
  filling = true;
  pane.replaceChildren(
    field(t("layer_unit"), unit, found.known ? t("layer_known", { width: digits(found.known[0]), height: digits(found.known[1]) }) : ""),
    field(t("layer_mend"), mend),
    el("button", { class: proposals.length ? "main" : "", disabled: !proposals.length, onclick: () => send(proposals.map((l) => ({ do: "set", path: ["drawing", "layers", l.name], value: l.proposed }))) }, t("layer_apply")),
    el("table", { class: "layers" }, el("caption", {}, t("layers")), el("thead", {}, el("tr", {}, ...["layer", "layer_count", "layer_meaning", "picture"].map((h) => el("th", { scope: "col" }, t(h))))), el("tbody", {}, ...rows)),
  );
  filling = false;
  if (held) pane.querySelector(`[aria-label="${CSS.escape(held)}"]`)?.focus();
}
