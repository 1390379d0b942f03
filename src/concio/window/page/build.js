/* Forms that add loads, supports and ties; the picture fills them in. */
import { t, el, field, say } from "./words.js";
import { numbers } from "./geometry.js";
import { inSpace, mark, view } from "./picture.js";
import { selection } from "./selecting.js";

let doc, send, form = {}, preset = [];   /* blocks to which the next load is given */

function bodyNames(id) {
  const bodies = view.shown ? view.shown.bodies : [];
  return el("datalist", { id }, ...bodies.slice(0, 2000).map((b) => el("option", { value: b.name })));
}

const input = (name, value = "", more = {}) => (form[name] = el("input", { name, value, ...more }));
function choice(name, pairs) {
  return (form[name] = el("select", { name }, ...pairs.map(([value, word]) => el("option", { value }, word))));
}

export function setBuild(document_, sender) { doc = document_; send = sender; }

export function build(pane) {
  form = {};
  const parts = { load: loadForm, support: supportForm, tie: tieForm }[view.tool];
  pane.replaceChildren();
  if (parts) pane.append(parts(), bodyNames("body-names"), el("datalist", { id: "group-names" }, ...(view.shown ? view.shown.groups : []).map((value) => el("option", { value }))));
  else pane.append(el("p", {}, t(inSpace() ? "space_help" : "drag_help")), selection(doc(), send, loadOf));
}

function loadOf(names) {
  preset = names;
  document.querySelector("[data-tool=load]").click();
  form.kind.value = "weight";
  form.kind.dispatchEvent(new Event("change"));
  form.value.focus();
}

/* the blocks that a field names: one, or several with commas between them */
function bodiesOf(text) {
  const known = new Set(view.shown.bodies.map((b) => b.name)), word = text.trim();
  return !word ? undefined : known.has(word) ? [word] : word.split(",").map((part) => part.trim()).filter(Boolean);
}

function finish(heading, rows, make) {
  const wrong = el("p", { role: "alert", class: "quiet" });
  return el("form", {
    novalidate: true,
    onsubmit: async (event) => {
      event.preventDefault();
      try {
        const table = make();
        wrong.textContent = "";
        if (await send([{ do: "add", ...table }])) { mark(null); say(t("add")); }
      } catch (error) { wrong.textContent = error.message; }
    },
  }, el("h2", {}, heading), ...rows, wrong, el("button", { class: "main", type: "submit" }, t("add")));
}

function needed(name, count, word) {
  const found = numbers(form[name].value, count);
  if (!found) throw new Error(`${word}: ${count} ${count === 1 ? "number" : "numbers"}`);
  return found;
}

const dim = () => (inSpace() ? 3 : 2);
const pairs = (v) => Array.from({ length: v.length / dim() }, (_, k) => v.slice(dim() * k, dim() * k + dim()));
const DOWN = { 2: "0, -1", 3: "0, 0, -1" }, SHARES = { 2: "0.1, 0", 3: "0.1, 0, 0" };

/* the part of a block's surface that a form names: an edge in the plane, a polygon in space; empty where nothing is written */
function surface() {
  const text = form.edge.value.trim();
  if (!text) return {};
  const found = numbers(text, inSpace() ? text.split(/[\s,;]+/).filter(Boolean).length : 4);
  if (!found || found.length % dim() || found.length < 2 * dim()) throw new Error(t(inSpace() ? "polygon" : "edge"));
  return { [inSpace() && found.length > 6 ? "polygon" : "edge"]: pairs(found) };
}
const surfaceField = () => field(t(inSpace() ? "polygon" : "edge"), input("edge"));
const pointField = (plane, space, name) => field(inSpace() ? space : plane, input(name));

function loadForm() {
  const kinds = [["point", t("point_load")], ["pressure", t(inSpace() ? "pressure_face" : "pressure")], ["traction", t(inSpace() ? "traction_face" : "traction")], ["weight", t("share")]];
  const names = preset.join(", ");
  preset = [];
  const made = finish(t("load"), [
    el("p", { class: "quiet" }, t(inSpace() ? "click_face" : "click_block")),
    field(t("kind"), choice("kind", kinds)),
    field(t("value"), input("value", DOWN[dim()]), t(inSpace() ? "value_help_space" : "value_help")),
    field(t("body"), input("body", names, { list: "body-names" })),
    pointField(t("at_point"), t("at_point_space"), "at"),
    surfaceField(),
    field(t("group"), input("group", "live", { list: "group-names" })),
  ], () => {
    const kind = form.kind.value, table = { kind, group: form.group.value.trim() || "live", bodies: bodiesOf(form.body.value) };
    if (kind === "point" && table.bodies?.length > 1) throw new Error(t("one_block"));
    table.value = kind === "pressure" ? needed("value", 1, t("value"))[0] : needed("value", dim(), t("value"));
    if (kind === "point") table.at = needed("at", dim(), t("at_point"));
    else if (kind !== "weight") {
      Object.assign(table, surface());
      if (!table.edge && !table.polygon) throw new Error(t(inSpace() ? "polygon" : "edge"));
    }
    return { to: "loads", table };
  });
  form.kind.addEventListener("change", () => {
    form.value.value = { pressure: "10", weight: SHARES[dim()] }[form.kind.value] || DOWN[dim()];
  });
  return made;
}

function supportForm() {
  const ways = inSpace() ? ["all", "x", "y", "z", "xy", "xz", "yz"] : ["all", "x", "y"];
  return finish(t("support"), [
    el("p", { class: "quiet" }, t(inSpace() ? "click_face" : "click_edge")),
    field(t("name"), input("name", free("supports", "support"))),
    field(t("body"), input("body", "", { list: "body-names" })),
    surfaceField(),
    field(t("directions"), choice("directions", ways.map((w) => [w, w === "all" ? [..."xyz"].slice(0, dim()).join(", ") : [...w].join(", ")]))),
    field(t("displacement"), input("displacement", "", { placeholder: inSpace() ? "0, 0, -0.001" : "0.001, 0" })),
  ], () => {
    const table = { name: form.name.value.trim(), body: form.body.value.trim(), directions: form.directions.value, ...surface() };
    if (form.displacement.value.trim()) table.displacement = needed("displacement", dim(), t("displacement"));
    return { to: "supports", table };
  });
}

function tieForm() {
  return finish(t("tie"), [
    el("p", { class: "quiet" }, t("click_two")),
    field(t("name"), input("name", free("ties", "tie"))),
    field(t("from_body"), input("body_a", "", { list: "body-names" })), pointField(t("at_a"), t("at_a_space"), "at_a"),
    field(t("to_body"), input("body_b", "", { list: "body-names" })), pointField(t("at_b"), t("at_b_space"), "at_b"),
    field(t("stiffness"), input("stiffness", "13 MN/m")),
    field(t("prestress"), input("prestress", "0")), field(t("yield_force"), input("yield_force")),
  ], () => {
    const table = { name: form.name.value.trim(), body_a: form.body_a.value.trim(), at_a: needed("at_a", dim(), t("at_a")) };
    if (form.body_b.value.trim()) table.body_b = form.body_b.value.trim();
    table.at_b = needed("at_b", dim(), t("at_b"));
    table.stiffness = form.stiffness.value.trim();
    if (Number(form.prestress.value)) table.prestress = Number(form.prestress.value);
    if (form.yield_force.value.trim()) table.yield_force = Number(form.yield_force.value);
    return { to: "ties", table };
  });
}

function free(list, word) {
  const names = new Set((view.shown ? view.shown[list] : []).map((one) => one.name));
  for (let k = 1; ; k++) if (!names.has(`${word} ${k}`)) return `${word} ${k}`;
}

const isFixed = (name) => view.shown.bodies.find((b) => b.name === name)?.kind === "fixed";

/* what was clicked in the picture */
export function placed(found) {
  const fixed = view.tool === "load" && isFixed(found.body);
  const wrong = document.querySelector("#pane-build [role=alert]");
  if (wrong) wrong.textContent = fixed ? t("fixed_no_load", { name: found.body }) : "";
  if (fixed) return;
  const put = (name, text) => { if (form[name]) form[name].value = text; };
  const edge = (found.edge || found.polygon || []).map((p) => p.map((v) => Number(v.toPrecision(9))).join(", ")).join(inSpace() ? "; " : ", ");
  if (view.tool === "tie") {
    const first = !form.at_a.value || form.at_b.value;
    put(first ? "body_a" : "body_b", found.body); put(first ? "at_a" : "at_b", found.at.join(", "));
    if (first) { put("body_b", ""); put("at_b", ""); }
  } else {
    const whole = view.tool === "support" && isFixed(found.body); /* a fixed body moves as a whole */
    put("body", found.body); put("at", found.at.join(", ")); put("edge", whole ? "" : edge);
  }
  say(`${found.body} ${found.at.join(", ")}`);
}
