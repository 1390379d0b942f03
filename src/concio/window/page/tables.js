/* Tables of the model, linked with the picture both ways, and the values of the text in fields. */
import { t, el, digits, keyWord, terms } from "./words.js";
import { view, select } from "./picture.js";
import { plain } from "./selecting.js";
import { resultNumbers } from "./look.js";

const TEXTS = ["title", "name", "body", "body_a", "body_b", "group", "material", "role", "layer", "law", "kind", "blocks_file"];
const MOST = 400;
let send = async () => false;
export function setTables(sender) { send = sender; }

function table(caption, heads, rows) {
  if (!rows.length) return el("p", { class: "quiet" }, `${caption} (0)`);
  const body = el("tbody", {}, ...rows.slice(0, MOST));
  const more = rows.length > MOST ? el("p", { class: "quiet" }, `${MOST} / ${rows.length}`) : null;
  return el("div", {}, el("div", { class: "scroll" }, el("table", {}, el("caption", {}, `${caption} (${rows.length})`),
    el("thead", {}, el("tr", {}, ...heads.map((h) => el("th", { scope: "col" }, h)))), body)), more);
}

function row(kind, id, cells, path = undefined) {
  const chosen = kind === "bodies" || kind === "joints" ? view.selected[kind].has(id) : view.selected.things.has(id);
  const pick = (event) => { if (!event.target.closest("button, input")) select(kind, [id], event.shiftKey || event.ctrlKey); };
  const made = el("tr", {
    tabindex: 0, "aria-selected": String(chosen), "data-row": `${kind} ${id}`, onclick: pick,
    onkeydown: (event) => {
      if (event.target.closest("button, input")) return;
      if (event.key === "Enter" || event.key === " ") { event.preventDefault(); pick(event); }
      const next = { ArrowDown: made.nextElementSibling, ArrowUp: made.previousElementSibling }[event.key];
      if (next) { event.preventDefault(); next.focus(); }
    },
  }, ...cells.map((c) => el("td", { class: "n" }, c instanceof Node ? c : String(c ?? ""))));
  if (path !== undefined) made.append(el("td", {}, path ? el("button", { onclick: () => send([{ do: "remove", path }]) }, t("remove")) : ""));
  return made;
}

/* the group of a load of the file, to be written over */
function groupOf(load, k) {
  if (load.table === null) return load.group;
  const made = el("input", { value: load.group, size: 8, id: `group-${k}`, list: "known-groups", "aria-label": `${t("group")}: ${t("load")} ${k + 1}` });
  made.addEventListener("change", () => { if (made.value.trim() && made.value.trim() !== load.group) send([{ do: "set", path: ["loads", load.table, "group"], value: made.value.trim() }]); });
  return made;
}

const spot = (p) => (p ? p.map(digits).join(", ") : "");

export function tables(pane) {
  const shown = view.shown;
  pane.replaceChildren();
  if (!shown) return;
  const name = (k) => shown.bodies[k]?.name ?? "";
  const { moves, forces } = answerColumns(shown);
  const own = (one, list) => (one.table === null ? null : [list, one.table]);
  pane.append(
    el("datalist", { id: "known-groups" }, ...shown.groups.map((value) => el("option", { value }))),
    table(t("loads"), [t("kind"), t("group"), t("value"), t("body"), t("where"), ""], shown.loads.map((l, k) => row("things", `load ${k}`, [terms(l.kind), groupOf(l, k), l.words || spot(l.value), l.bodies.join(", "), spot(l.at) || (l.edge || l.polygon || []).map(spot).join(" – ")], own(l, "loads")))),
    table(t("supports"), [t("name"), t("body"), t("directions"), t("displacement"), ""], shown.supports.map((s, k) => row("things", `support ${k}`, [s.name, s.body, s.directions, spot(s.displacement)], own(s, "supports")))),
    table(t("ties"), [t("name"), t("between"), t("value"), ""], shown.ties.map((s, k) => row("things", `tie ${k}`, [s.name, `${s.body_a} – ${s.body_b || spot(s.at_b)}`, terms(s.words)], own(s, "ties")))),
    table(t("materials"), [t("name"), t("value")], Object.entries(shown.materials).map(([n, words]) => el("tr", {}, el("td", {}, n), el("td", {}, terms(words))))),
    table(t("laws"), [t("name"), t("value")], Object.entries(shown.laws).map(([n, words]) => el("tr", {}, el("td", {}, n), el("td", {}, terms(words))))),
    table(t("bodies"), [t("name"), t("kind"), t("role"), t("layer"), t("material"), t("size"), ...moves.heads], shown.bodies.map((b, k) => row("bodies", k, [b.name, terms(b.kind), terms(b.role), b.layer, b.material, digits(b.size), ...moves.cells(k)]))),
    table(t("joints"), [t("between"), t("law"), t(shown.dim === 2 ? "length" : "area"), t("gap"), ...forces.heads], shown.joints.map((j, k) => row("joints", k, [`${name(j.a)} – ${name(j.b)}`, j.law, digits(j.size), digits(j.gap), ...forces.cells(k)]))),
  );
}

/* columns of the answer, where it is of this model: how far each block moves, what each joint carries */
function answerColumns(shown) {
  const none = { heads: [], cells: () => [] }, found = resultNumbers(), j = found?.joints;
  const [factor, symbol] = found?.units?.motion || [1, "m"], [kilo, force] = found?.units?.force || [1, "kN"];
  const same = j && j.a.length === shown.joints.length && shown.joints.every((one, k) => one.a === j.a[k] && one.b === j.b[k]);
  return {
    moves: found?.bodies?.length === shown.bodies.length ? { heads: [`${t("moved")} [${symbol}]`], cells: (k) => [digits(factor * found.bodies[k])] } : none,
    forces: same ? { heads: [`N [${force}]`, `V [${force}]`, `${t("open_part")} [%]`], cells: (k) => [digits(kilo * j.N[k]), digits(kilo * j.V[k]), digits(100 * j.open[k])] } : none,
  };
}

export function showChosen(pane) {
  let first = null;
  for (const one of pane.querySelectorAll("[data-row]")) {
    const [kind, ...rest] = one.dataset.row.split(" "), id = rest.join(" ");
    const chosen = kind === "things" ? view.selected.things.has(id) : view.selected[kind].has(Number(id));
    one.setAttribute("aria-selected", String(chosen));
    if (chosen && !first) first = one;
  }
  if (first && !pane.contains(document.activeElement)) first.scrollIntoView({ block: "nearest" });
}

/* values with which the window has begun the model, and which nobody has stated since: they are marked in the text */
export function begunWith(doc) {
  const lines = doc?.values ? doc.text.split("\n") : [];
  return (doc?.values || []).filter((one) => /#.*begun with (.+): state yours/.exec(lines[one.line - 1])?.[1] === plain(one.written))
    .map((one) => `${keyWord(one.path)} ${plain(one.written)}`);
}

export const meant = (text) => text.replace(/; begun with .+: state yours/g, "").replace(/[ \t]*# begun with .+: state yours/g, "");

/* every value of the text in a field of its own */
export function data(pane, doc) {
  pane.replaceChildren();
  if (!doc || !doc.values) return;
  const groups = new Map();
  for (const one of doc.values) {
    const head = one.path.slice(0, -1).map((_, k) => keyWord(one.path, k)).join(" ");
    if (!groups.has(head)) groups.set(head, []);
    groups.get(head).push(one);
  }
  for (const [head, values] of groups) {
    const box = el("details", { open: groups.size < 12 || values[0].path[0] !== "blocks" }, el("summary", {}, head || doc.name));
    for (const one of values) box.append(fieldOf(one, doc.read_only));
    pane.append(box);
  }
}

function fieldOf(one, readOnly) {
  const key = String(one.path[one.path.length - 1]), id = `value-${one.path.join("-")}`, text = plain(one.written);
  const input = el("input", { id, value: text, readonly: Boolean(readOnly) });
  const commit = () => {
    if (input.value === text) return;
    const command = TEXTS.includes(key) ? { value: input.value } : { written: input.value };
    send([{ do: "set", path: one.path, ...command }]);
  };
  input.addEventListener("change", commit);
  return el("div", { class: "field" }, el("label", { for: id, title: `${key}, ${t("line", { line: one.line })}` }, keyWord(one.path)), input);
}
