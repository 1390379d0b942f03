/* The page: what is open, what is shown, what each key does. All that counts is on the other side; this can be reloaded. */
import { call, drop, goodbye, Refused } from "./net.js";
import { t, el, label, language, say, setLanguage, setWords, spoken, templateWord } from "./words.js";
import { view, show, clear, draw, fit, zoom, mark, onSelected } from "./picture.js";
import { listen } from "./hands.js";
import { build, placed, setBuild } from "./build.js";
import { begunWith, data, meant, setTables, showChosen, tables } from "./tables.js";
import { answer, follow, programs, questionPane, reportPane, run, setAsk } from "./ask.js";
import { forgetLayers, layersPane, setLayers } from "./layers.js";
import { hasPicture, photoPane, setPhoto, underlay } from "./photo.js";
import { answered, lookPane, modelChanged, setLook } from "./look.js";

const $ = (id) => document.getElementById(id);
const TABS = ["layers", "photo", "data", "build", "ask", "look", "tables", "report", "text", "python"]; /* in the order of the work */
let hello = null, state = {}, doc = null, tab = "ask", pictured = "", gone = 0, shownReport = "";
const panes = {};

/* --- what is told of a failure --- */
function fail(error) {
  const text = error instanceof Refused ? error.text : String(error.message || error);
  say(text);
  banner("wrong", text, [[t("close"), () => banner("wrong")]]);
}
async function tried(action) { try { return (await action()) ?? true; } catch (error) { fail(error); return null; } }

function banner(id, text = "", buttons = []) {
  const old = document.querySelector(`[data-banner="${id}"]`);
  if (!text) return old?.remove();
  if (old?.dataset.text === text) return;
  const made = el("div", { class: "banner", "data-banner": id, "data-text": text, role: "alert" }, el("span", {}, text), ...buttons.map(([word, act]) => el("button", { onclick: act }, word)));
  if (old) old.replaceWith(made); else $("banners").append(made);
}

/* a model that cannot be read yet, above a picture in which it is to be traced */
const NOTHING = { dim: 2, title: "", tables: [], bodies: [], joints: [], loads: [], supports: [], ties: [], findings: [], notes: [], attention: [], attention_italian: [], groups: [], materials: {}, laws: {}, fixed: 0, fault: null };

/* --- the state --- */
function take(found) {
  if (doc && found.document && found.document.name === doc.name && found.document.version < doc.version) return true; /* overtaken */
  if (found.asking < state.asking) found = { ...found, asking: state.asking, asked: state.asked }; /* told before the last question */
  state = { ...state, ...found };
  const before = doc;
  doc = found.document ? { ...(before && before.name === found.document.name ? before : {}), ...found.document } : null;
  const changed = (before && before.hash) !== (doc && doc.hash) || (before && before.name) !== (doc && doc.name);
  header();
  if (changed) { modelChanged(); if (!doc || (before && before.name !== doc.name)) { clear(); forgetLayers(); pictured = ""; } refresh(["data", "text", "python"]); picture(); }
  else if (before && before.saved !== doc.saved) refresh(["python"]);
  tabs();
  followed();
  if (!doc && !$("start").open) start();
  return true;
}

function followed() {
  follow(state, () => { const key = answer ? `${answer.asking} ${answer.key}` : ""; if (key !== shownReport) { shownReport = key; answered(answer); refresh(["report", "python", "look"]); } });
}

function header() {
  $("file").textContent = doc ? doc.name : "concio";
  document.title = doc ? `${doc.name} – concio` : "concio";
  $("saved").textContent = doc ? t(doc.saved ? "saved" : "not_saved") : "";
  const writes = doc && state.mine && !doc.read_only;
  $("save").disabled = !writes || doc.saved; $("undo").disabled = !writes || !doc.undo; $("redo").disabled = !writes || !doc.redo;
  $("undo").title = doc?.undo || ""; $("redo").title = doc?.redo || "";
  banner("read", doc?.read_only || "");
  banner("pen", doc && !doc.read_only && !state.mine ? t("read_only_page") : "", [[t("take_pen"), () => tried(async () => take(await call("take", seen())))]]);
  banner("recovered", doc && doc.recovered && !doc.saved ? t("recovered", { count: doc.recovered }) : "", [[t("undo"), undo], [t("close"), () => { doc.recovered = 0; banner("recovered"); }]]);
  banner("conflict", doc?.conflict ? t("conflict") : "", [[t("keep_mine"), () => resolve("mine")], [t("keep_theirs"), () => resolve("theirs")]]);
}

const seen = () => (doc ? { version: doc.version, name: doc.name } : {});
let timer = 0;
function pollIn(milliseconds) { clearTimeout(timer); timer = setTimeout(poll, milliseconds); }
async function poll() {
  try {
    take(await call("state", seen()));
    gone = 0; banner("gone");
  } catch { if ((gone += 1) > 1) banner("gone", t("server_gone")); }
  const busy = state.asked && ["working", "waiting"].includes(state.asked.state);
  pollIn(gone ? 2000 : busy ? 250 : document.hidden ? 5000 : 1000);
}

let again = false;
async function picture() {
  if (!doc || again) return;
  again = true;
  const late = setTimeout(() => { $("busy").textContent = t("drawing_busy"); $("busy").hidden = false; }, 300);
  try {
    while (doc && pictured !== doc.hash + doc.name) {
      const asked = doc.hash + doc.name, found = await call("picture", { wait: 5, early: !view.shown });
      if (!doc || found.hash + doc.name !== asked) continue;
      if (found.state === "early") { show(found.early); attention(); }
      else if (found.state === "done") { const first = found.done.untraced && !view.shown; pictured = asked; show(found.done); fault(null); if (first) go("photo"); }
      else if (found.state === "error") { pictured = asked; if ((hasPicture() || tabNames().includes("layers")) && !view.shown) { show(NOTHING); go(hasPicture() ? "photo" : "layers"); } fault(found.error); }
      else if (found.state === "cancelled") await new Promise((then) => setTimeout(then, 100));
      if (pictured === asked) { attention(); refresh(["ask", "build", "tables", "layers", "photo"]); tabs(); underlay(() => refresh(["photo"], true)); }
    }
  } catch (error) { fail(error); }
  clearTimeout(late); $("busy").hidden = true; again = false;
}

function fault(error) {
  const found = error || view.shown?.fault;
  $("fault").replaceChildren(...(found ? [el("p", {}, el("strong", {}, `${t("fault")}. `), el("span", { lang: "en" }, [found.where, found.what].filter(Boolean).join(": "))), found.hint ? el("p", { lang: "en" }, `→ ${found.hint}`) : ""] : []));
  if (error) $("run")?.setAttribute("disabled", "");
}

function attention() {
  const shown = view.shown, lines = shown ? shown.attention : [], own = begunWith(doc);
  $("attention-list").replaceChildren(
    ...(own.length ? [el("li", { id: "begun" }, `${t("begun_with")} ${own.join(", ")}.`, el("button", { onclick: () => go("data") }, t("data")), el("button", { onclick: () => send([{ do: "text", text: meant(doc.text) }]) }, t("begun_meant")))] : []),
    ...(shown?.untraced ? [el("li", { id: "untraced" }, t("photo_untraced"), el("button", { onclick: () => go("photo") }, t("photo")))] : []),
    ...lines.map((line, k) => spoken("li", {}, line, shown.attention_italian[k])),
    ...(shown ? shown.findings : []).slice(0, 20).map((found) => el("li", { lang: "en" }, found.sentence, el("button", { onclick: () => { mark(found.at); } }, t("where")))),
    ...(shown && shown.notes.length ? [el("li", {}, el("details", {}, el("summary", {}, `${t("left_out")} (${shown.notes.length})`), ...shown.notes.map((line) => el("p", { lang: "en" }, line))))] : []),
  );
  if (shown && shown !== NOTHING && !shown.early && !shown.untraced && !lines.length && !shown.findings.length && !shown.notes.length && !own.length) $("attention-list").append(el("li", { class: "quiet" }, t("no_attention")));
}

/* --- commands --- */
let queue = Promise.resolve();
function send(commands) { /* one after the other, each on the text that the one before has left */
  return next(() => (doc ? tried(async () => take(await call("do", { commands, hash: doc.hash, ...seen() }))) : null));
}
let open = 0;
function next(action) { open += 1; queue = queue.then(action).finally(() => { open -= 1; }); return queue; }
const undo = () => next(() => tried(async () => take(await call("undo", seen()))));
const redo = () => next(() => tried(async () => take(await call("redo", seen()))));
const save = () => tried(async () => { take(await call("save", seen())); say(t("saved")); });
const cancel = () => tried(async () => take(await call("cancel", seen())));
const resolve = (keep) => tried(async () => take(await call("resolve", { keep, ...seen() })));
async function ask(question, options, told) {
  if (!await tried(async () => take(await call("ask", { question, options, ...seen() }).finally(told)))) followed();
  pollIn(100);
}

/* --- tabs --- */
function tabs() {
  const shownTabs = TABS.filter((name) => (name !== "photo" || hasPicture()) && (name !== "layers" || (doc?.values || []).some((v) => v.path[0] === "blocks_file" && /\.dxf["']$/i.test(v.written))));
  if (!shownTabs.includes(tab)) tab = "ask";
  const key = shownTabs.join() + language + tab;
  if ($("tabs").dataset.key === key) return;
  const held = document.activeElement?.closest?.("#tabs");
  $("tabs").dataset.key = key;
  $("tabs").replaceChildren(...shownTabs.map((name) => el("button", {
    role: "tab", id: `tab-${name}`, "aria-selected": String(name === tab), "aria-controls": `pane-${name}`, tabindex: name === tab ? 0 : -1,
    onclick: () => go(name),
    onkeydown: (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (step) { event.preventDefault(); go(shownTabs[(shownTabs.indexOf(name) + step + shownTabs.length) % shownTabs.length], true); }
    },
  }, t(name))));
  for (const name of TABS) panes[name].hidden = name !== tab;
  if (held) $(`tab-${tab}`)?.focus();
}

function go(name, focus = false) {
  tab = name;
  refresh([name], true);
  tabs();
  if (focus) $(`tab-${name}`)?.focus();
}

const fill = {
  ask: (pane) => questionPane(pane), build: (pane) => build(pane), tables: (pane) => tables(pane), data: (pane) => data(pane, doc),
  report: (pane) => reportPane(pane), layers: (pane) => layersPane(pane), photo: (pane) => photoPane(pane), look: (pane) => lookPane(pane).catch(fail), text: textPane, python: pythonPane,
};
const stale = new Set(TABS);
function refresh(names, force = false) {
  for (const name of names) {
    stale.add(name);
    if (name !== tab || !hello) continue;
    if (!force && panes[name].contains(document.activeElement) && ["text"].includes(name)) continue;
    const held = panes[name].contains(document.activeElement) ? document.activeElement.id : "";
    stale.delete(name);
    fill[name](panes[name]);
    if (held) $(held)?.focus();
  }
}

function textPane(pane) {
  const area = el("textarea", { "aria-label": t("text"), spellcheck: "false", readonly: !state.mine || Boolean(doc?.read_only) });
  area.value = doc?.text || "";
  const wrong = el("p", { role: "alert" }, doc?.syntax || "");
  const apply = async () => { if (await send([{ do: "text", text: area.value }])) textPane(pane); };
  area.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) { event.preventDefault(); apply(); }
    if (event.key === "Escape") { event.stopPropagation(); $("tab-text").focus(); }
  });
  pane.replaceChildren(el("p", { class: "quiet" }, t("text_help")), area, wrong, el("button", { class: "main", onclick: apply }, t("apply")));
}

function pythonPane(pane) {
  if (!doc) return;
  const found = programs(doc.name);
  const one = (head, text) => el("section", {}, el("h2", {}, head), el("pre", {}, text), el("button", { onclick: async () => { await navigator.clipboard.writeText(text); say(t("copied")); } }, t("copy")));
  const older = doc.saved ? "" : el("p", { role: "note" }, t("python_unsaved"));
  pane.replaceChildren(older, one(t("python"), found.python), one(t("command_line"), found.command));
}

/* --- open, templates, drop --- */
async function start() {
  const found = (await tried(() => call("start"))) || { files: [], folder: "" }, dialog = $("start");
  const chooser = el("input", { type: "file", accept: ".toml,.dxf,.obj,.ply,.stl,.off,.ifc,.3dm,.png,.jpg,.jpeg,.tif,.tiff", id: "chooser", "aria-label": t("choose_file"), hidden: true });
  chooser.addEventListener("change", () => chooser.files[0] && dropped(chooser.files[0]));
  const pick = (action) => tried(async () => { take(await action()); dialog.close(); const own = ["layers", "photo"].find((n) => tabNames().includes(n)); if (own) go(own); });
  dialog.replaceChildren(
    el("h2", { id: "start-head" }, `${t("open_file")}: ${found.folder}`),
    el("div", { class: "choices" }, ...(found.files.length ? found.files.map((name) => el("button", { onclick: () => pick(() => call("open", { name })) }, name)) : [el("p", { class: "quiet" }, t("no_files"))])),
    el("h2", {}, t("start_template")),
    el("div", { class: "choices" }, ...hello.templates.map((kind) => el("button", { onclick: () => pick(() => call("new", { kind })) }, templateWord(kind)))),
    el("div", { class: "drop" }, el("button", { onclick: () => chooser.click() }, t("choose_file")), chooser, el("p", { class: "quiet" }, t("drop_here"))),
    ...(doc ? [el("button", { onclick: () => dialog.close() }, t("close"))] : []),
  );
  if (!dialog.open) dialog.showModal();
}
const tabNames = () => [...document.querySelectorAll("#tabs button")].map((b) => b.id.slice(4));

async function dropped(file) {
  const done = await tried(async () => take(await drop(file)));
  if (done) { $("start").close(); const own = ["layers", "photo"].find((n) => tabNames().includes(n)); if (own) go(own); }
}
addEventListener("dragover", (event) => { event.preventDefault(); });
addEventListener("drop", (event) => { event.preventDefault(); if (event.dataTransfer.files[0]) dropped(event.dataTransfer.files[0]); });
$("start").addEventListener("cancel", (event) => { if (!doc) event.preventDefault(); });

/* --- a load is dragged: the newest place wins; bounds of an earlier one are grey --- */
let dragging = null, flying = false;
async function bound() {
  if (flying || !dragging) return;
  flying = true;
  const asked = dragging;
  try {
    const found = await call("drag", { table: asked.load.table, at: asked.to.at, body: asked.to.body });
    if (found.state === "done") showBound(found.done.lines, asked !== dragging, found.done.italian);
    else if (found.state === "error") showBound([found.error.what], asked !== dragging);
  } catch (error) { showBound([error.text || error.message], true); }
  flying = false;
  if (dragging && asked !== dragging) bound();
}
function showBound(lines, old, italian = []) {
  $("bound").hidden = false;
  $("bound").className = old ? "old" : "";
  $("bound").replaceChildren(el("p", { class: "quiet" }, t(old ? "drag_old" : "drag_bound")), ...lines.map((line, k) => spoken("p", {}, line, italian[k])));
}
onSelected(() => { if (tab === "tables") showChosen(panes.tables); if (tab === "build") build(panes.build); });
listen({
  placed,
  dragged: (load, to) => { if (!state.mine || doc.read_only) return; dragging = { load, to }; $("bound").classList.add("old"); if (!$("bound").hidden) $("bound").firstChild.textContent = t("drag_old"); bound(); },
  released: async (load, to) => {
    dragging = null;
    await send([{ do: "set", path: ["loads", load.table, "at"], value: to.at }, { do: "set", path: ["loads", load.table, "bodies"], value: [to.body] }]);
    $("bound").hidden = true;
  },
});

/* --- keys --- */
const KEYS = [
  ["Ctrl+S", "save", save], ["Ctrl+Z", "undo", undo], ["Ctrl+Y", "redo", redo], ["Ctrl+O", "open", start], ["Ctrl+Enter", "run_it", () => run()],
  ["Ctrl+.", "cancel", cancel], ["?", "keys", help], ["s", "select", () => tool("select")], ["l", "load", () => tool("load")], ["v", "support", () => tool("support")],
  ["t", "tie", () => tool("tie")], ["p", "picture", () => $("picture").focus()], ["Alt+1..9", "tables", null],
];
function help() {
  $("help").replaceChildren(el("h2", { id: "help-head" }, t("keys_of")),
    el("table", {}, el("tbody", {}, ...KEYS.map(([key, word]) => el("tr", {}, el("td", {}, el("kbd", {}, key)), el("td", {}, word === "tables" ? TABS.map(t).join(", ") : t(word)))))),
    el("p", {}, t("picture_help")), el("button", { onclick: () => $("help").close() }, t("close")));
  $("help").showModal();
}
function tool(name) {
  view.tool = name;
  mark(null);
  for (const one of document.querySelectorAll("[data-tool]")) one.setAttribute("aria-pressed", String(one.dataset.tool === name));
  if (name === "select") { if (tab === "build") refresh(["build"], true); } else go("build");
}
addEventListener("keydown", (event) => {
  const typing = event.target.closest?.("input, textarea, select"), control = event.ctrlKey || event.metaKey;
  if (event.altKey && /^[1-9]$/.test(event.key)) { const name = tabNames()[Number(event.key) - 1]; if (name) { event.preventDefault(); go(name, true); } return; }
  if (document.querySelector("dialog[open]")) return;
  const name = control ? `Ctrl+${event.key === "Enter" ? "Enter" : event.key.toUpperCase()}` : event.key;
  if (typing && (!control || ["Ctrl+Z", "Ctrl+Y"].includes(name) || (name === "Ctrl+Enter" && event.target.tagName === "TEXTAREA"))) return;
  if (event.key === "Escape" && view.tool !== "select") return tool("select");
  const found = KEYS.find(([key]) => key === name || (name === "Ctrl+SHIFT+Z" && key === "Ctrl+Y"));
  if (found?.[2]) { event.preventDefault(); found[2](); }
});

/* --- beginning --- */
async function begin() {
  setLanguage(language);
  hello = await call("hello");
  setWords(hello.words, hello.of_files);
  for (const [name, colour] of Object.entries(hello.look)) document.documentElement.style.setProperty(`--look-${name}`, colour);
  for (const name of TABS) { panes[name] = el("div", { role: "tabpanel", id: `pane-${name}`, "aria-labelledby": `tab-${name}`, tabindex: -1, hidden: name !== tab }); $("panes").append(panes[name]); }
  setBuild(() => doc, send); setTables(send); setLayers(send); setLook(() => doc, () => refresh(["tables"])); setPhoto(() => doc, send); setAsk(hello, ask, () => doc, async (text) => { if (await send([{ do: "text", text }])) go("data", true); });
  for (const [id, act] of [["save", save], ["undo", undo], ["redo", redo], ["open", start], ["keys", help], ["cancel", cancel], ["fit", fit], ["zoom-in", () => zoom(1.4)], ["zoom-out", () => zoom(1 / 1.4)]]) $(id).addEventListener("click", act);
  $("names").addEventListener("change", () => { view.names = $("names").checked; draw(); });
  $("language").addEventListener("click", () => { setLanguage(language === "it" ? "en" : "it"); label(); header(); attention(); fault(null); tabs(); refresh(TABS, true); follow(state, () => {}); });
  for (const one of document.querySelectorAll("[data-tool]")) one.addEventListener("click", () => tool(one.dataset.tool));
  label();
  take(hello);
  refresh(TABS, true);
  pollIn(500);
  window.concio = { view, state: () => ({ ...state, document: doc }), pictured: () => pictured, idle: () => !open, dragging: () => dragging };
}
addEventListener("pagehide", goodbye);
begin().catch(fail);
