/* Forms that add loads, supports and ties; the picture fills them in. */
import { t, el, field, say } from "./words.js";
import { numbers } from "./geometry.js";
import { view, mark } from "./picture.js";

let doc, send, form = {};

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
  const plane = !view.shown || view.shown.dim === 2;
  const parts = { load: loadForm, support: supportForm, tie: tieForm }[view.tool];
  pane.replaceChildren();
  if (!plane) pane.append(el("p", {}, t("space_note")));
  else if (parts) pane.append(parts(), bodyNames("body-names"));
  else pane.append(el("p", {}, t("drag_help")), selection());
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

function loadForm() {
  const kinds = [["point", t("point_load")], ["pressure", t("pressure")], ["traction", t("traction")], ["weight", t("share")]];
  const made = finish(t("load"), [
    el("p", { class: "quiet" }, t("click_block")),
    field(t("kind"), choice("kind", kinds)),
    field(t("value"), input("value", "0, -1"), t("value_help")),
    field(t("body"), input("body", "", { list: "body-names" })),
    field(t("at_point"), input("at")),
    field(t("edge"), input("edge")),
    field(t("group"), input("group", "live")),
  ], () => {
    const kind = form.kind.value, table = { kind, group: form.group.value.trim() || "live", bodies: form.body.value.trim() ? [form.body.value.trim()] : undefined };
    table.value = kind === "pressure" ? needed("value", 1, t("value"))[0] : needed("value", 2, t("value"));
    if (kind === "point") table.at = needed("at", 2, t("at_point"));
    else if (kind !== "weight") table.edge = pairs(needed("edge", 4, t("edge")));
    return { to: "loads", table };
  });
  form.kind.addEventListener("change", () => {
    form.value.value = { pressure: "10", weight: "0.1, 0" }[form.kind.value] || "0, -1";
  });
  return made;
}

const pairs = ([a, b, c, d]) => [[a, b], [c, d]];

function supportForm() {
  return finish(t("support"), [
    el("p", { class: "quiet" }, t("click_edge")),
    field(t("name"), input("name", free("supports", "support"))),
    field(t("body"), input("body", "", { list: "body-names" })),
    field(t("edge"), input("edge")),
    field(t("directions"), choice("directions", [["all", "x, y"], ["x", "x"], ["y", "y"]])),
    field(t("displacement"), input("displacement", "", { placeholder: "0.001, 0" })),
  ], () => {
    const table = { name: form.name.value.trim(), body: form.body.value.trim(), directions: form.directions.value };
    if (form.edge.value.trim()) table.edge = pairs(needed("edge", 4, t("edge")));
    if (form.displacement.value.trim()) table.displacement = needed("displacement", 2, t("displacement"));
    return { to: "supports", table };
  });
}

function tieForm() {
  return finish(t("tie"), [
    el("p", { class: "quiet" }, t("click_two")),
    field(t("name"), input("name", free("ties", "tie"))),
    field(t("from_body"), input("body_a", "", { list: "body-names" })), field(t("at_a"), input("at_a")),
    field(t("to_body"), input("body_b", "", { list: "body-names" })), field(t("at_b"), input("at_b")),
    field(t("stiffness"), input("stiffness", "13 MN/m")),
    field(t("prestress"), input("prestress", "0")), field(t("yield_force"), input("yield_force")),
  ], () => {
    const table = { name: form.name.value.trim(), body_a: form.body_a.value.trim(), at_a: needed("at_a", 2, t("at_a")) };
    if (form.body_b.value.trim()) table.body_b = form.body_b.value.trim();
    table.at_b = needed("at_b", 2, t("at_b"));
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

/* what was clicked in the picture */
export function placed(found) {
  const put = (name, text) => { if (form[name]) form[name].value = text; };
  const edge = found.edge ? found.edge.flat().map((v) => Number(v.toPrecision(9))).join(", ") : "";
  if (view.tool === "tie") {
    const first = !form.at_a.value || form.at_b.value;
    put(first ? "body_a" : "body_b", found.body); put(first ? "at_a" : "at_b", found.at.join(", "));
    if (first) { put("body_b", ""); put("at_b", ""); }
  } else {
    put("body", found.body); put("at", found.at.join(", ")); put("edge", edge);
  }
  say(`${found.body} ${found.at.join(", ")}`);
}

/* materials and laws for what is selected */
function selection() {
  const shown = view.shown, chosen = shown ? [...view.selected.bodies].map((k) => shown.bodies[k]) : [];
  const box = el("div", {}, el("p", {}, t("selected", { count: chosen.length })));
  if (!chosen.length || !doc()) return box;
  const tables = new Map();
  (doc().values || []).forEach((v) => { if (v.path[0] === "blocks" && v.path[2] === "name") tables.set(plain(v.written), v.path[1]); });
  const mine = chosen.filter((b) => tables.has(b.name) && b.kind !== "fixed");
  const material = el("select", {}, ...Object.keys(shown.materials).map((m) => el("option", { value: m }, m)));
  const law = el("select", {}, ...Object.keys(shown.laws).map((m) => el("option", { value: m }, m)));
  if (mine.length) {
    box.append(field(t("set_material"), material), el("button", { onclick: () => send(mine.map((b) => ({ do: "set", path: ["blocks", tables.get(b.name), "material"], value: material.value }))) }, t("apply")));
  } else box.append(el("p", { class: "quiet" }, t("from_generator")));
  if (chosen.length === 2) {
    box.append(field(t("set_law"), law), el("button", { onclick: () => send([{ do: "add", to: "rules", table: { law: law.value, between: chosen.map((b) => b.name) } }]) }, t("apply")));
  }
  return box;
}

export function plain(written) {
  if (/^"([^"\\]*)"$/.test(written) || /^'[^'\n]*'$/.test(written)) return written.slice(1, -1);
  return written;
}
