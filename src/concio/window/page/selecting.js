/* Blocks selected by layer, material or course, and what is assigned to them: a material, a law of their joint, a load. */
import { t, el, field, say } from "./words.js";
import { courseOf } from "./geometry.js";
import { select, view } from "./picture.js";

const loose = (b) => b.kind !== "fixed";
const numbersOf = (test) => view.shown.bodies.map((b, k) => [b, k]).filter(([b]) => test(b)).map(([, k]) => k);
function pick(numbers) { select("bodies", numbers); say(t("selected", { count: numbers.length })); }

export function plain(written) {
  if (/^"([^"\\]*)"$/.test(written) || /^'[^'\n]*'$/.test(written)) return written.slice(1, -1);
  return written;
}

/* all blocks of a layer or a material, by name; without a block being clicked before */
function byName() {
  const shown = view.shown, kinds = ["layer", "material"].map((key) => [key, [...new Set(shown.bodies.filter(loose).map((b) => b[key]).filter(Boolean))].sort()]);
  if (!kinds.some(([, names]) => names.length)) return null;
  const list = el("select", { name: "select-by" }, el("option", { value: "" }, "–"),
    ...kinds.map(([key, names]) => el("optgroup", { label: t(key) }, ...names.map((name) => el("option", { value: JSON.stringify([key, name]) }, name)))));
  list.addEventListener("change", () => { if (list.value) { const [key, name] = JSON.parse(list.value); pick(numbersOf((b) => loose(b) && b[key] === name)); document.querySelector("[name=select-by]")?.focus(); } });
  return field(t("select_by"), list);
}

/* from the selected blocks to all that are like one of them */
function wider(chosen) {
  const bodies = view.shown.bodies, like = (key) => numbersOf((b) => loose(b) && chosen.some((c) => c[key] === b[key]));
  const course = [...new Set([...view.selected.bodies].filter((k) => loose(bodies[k])).flatMap((k) => courseOf(bodies, k)))];
  const parts = [["course", course], ["layer", chosen.some((b) => b.layer) ? like("layer") : []], ["material", like("material")]];
  return el("div", { class: "row", role: "group", "aria-label": t("select_like") }, el("span", { class: "quiet" }, t("select_like")),
    ...parts.filter(([, found]) => found.length).map(([key, found]) => el("button", { id: `like-${key}`, onclick: () => { pick(found); document.getElementById(`like-${key}`)?.focus(); } }, `${t(key)} (${found.length})`)));
}

/* one word is all that is said of a layer: a material or "block" gives way, a use or a role stays */
function beside(word, material) {
  if (!word || word === "block" || word in view.shown.materials) return material;
  return word === "rigid" ? { use: word, material } : { role: word, material };
}
const valueOf = (written) => (plain(written) === written && Number.isFinite(Number(written)) ? Number(written) : plain(written));

/* the commands that give the blocks a material, or what keeps them from it */
function assigned(doc, chosen, material) {
  const values = doc.values || [], own = new Map();
  values.forEach((v) => { if (v.path[0] === "blocks" && v.path[2] === "name") own.set(plain(v.written), v.path[1]); });
  if (chosen.every((b) => own.has(b.name))) return chosen.map((b) => ({ do: "set", path: ["blocks", own.get(b.name), "material"], value: material }));
  if (values.some((v) => v.path[0] === "solids_file")) return chosen.map((b) => ({ do: "set", path: ["solids", "layers", b.name], value: material }));
  if (!values.some((v) => v.path[0] === "blocks_file")) return t("from_generator");
  const layers = [...new Set(chosen.map((b) => b.layer))], names = new Set(chosen.map((b) => b.name));
  if (view.shown.bodies.some((b) => loose(b) && layers.includes(b.layer) && !names.has(b.name))) return t("whole_layers");
  return layers.map((layer) => {
    const stated = values.filter((v) => ["drawing", "layers", layer].every((key, k) => v.path[k] === key));
    const table = stated.filter((v) => v.path.length > 3), use = stated.find((v) => v.path.length === 3), word = use && plain(use.written);
    if (!table.length) return { do: "set", path: ["drawing", "layers", layer], value: beside(word, material) };
    const kept = Object.fromEntries(table.map((v) => [v.path[3], valueOf(v.written)]));
    return table.some((v) => v.path[3] === "material") ? { do: "set", path: ["drawing", "layers", layer, "material"], value: material } : { do: "set", path: ["drawing", "layers", layer], value: { ...kept, material } };
  });
}

export function selection(doc, send, load) {
  const shown = view.shown, chosen = shown ? [...view.selected.bodies].map((k) => shown.bodies[k]) : [], free = chosen.filter(loose);
  const box = el("div", {}, ...[shown && byName()].filter(Boolean), el("p", {}, t("selected", { count: chosen.length })));
  if (!free.length || !doc) return box;
  box.append(wider(free));
  const material = el("select", { name: "set-material" }, ...Object.keys(shown.materials).map((m) => el("option", { value: m }, m)));
  const law = el("select", {}, ...Object.keys(shown.laws).map((m) => el("option", { value: m }, m)));
  const commands = assigned(doc, free, material.value);
  if (Array.isArray(commands)) box.append(field(t("set_material"), material), el("button", { id: "apply-material", onclick: () => send(assigned(doc, free, material.value)) }, t("apply")));
  else box.append(el("p", { class: "quiet" }, commands));
  box.append(el("p", {}, el("button", { id: "load-selected", onclick: () => load(free.map((b) => b.name)) }, t("load_selected"))));
  if (chosen.length === 2) {
    box.append(field(t("set_law"), law), el("button", { onclick: () => send([{ do: "add", to: "rules", table: { law: law.value, between: chosen.map((b) => b.name) } }]) }, t("apply")));
  }
  return box;
}
