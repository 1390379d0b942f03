/* Questions: what will act before they run, progress, the verdict in its own words, report and files. */
import { t, el, field, say, language, spoken } from "./words.js";
import { call } from "./net.js";
import { view } from "./picture.js";

let questions = [], toFill = {}, chosen = "run", controls = {}, asked = () => {}, doc = () => null, rewrite = () => {}, pending = 0;
const answers = [];
export let answer = null;

export function setAsk(hello, sender, document_, writer) { questions = hello.questions; toFill = hello.to_fill; asked = sender; doc = document_; rewrite = writer; }
const $ = (id) => document.getElementById(id);

const movedGroups = () => [...new Set((view.shown?.supports || []).filter((s) => s.moves).map((s) => s.group))];
function fits(q) { return !q.needs.length || (view.shown && q.needs.some((n) => (n === "moved" ? movedGroups().length : view.shown.tables.includes(n)))); }
const needs = (table) => (table === "moved" ? t("needs_moved") : t("needs", { table }));

export function questionPane(pane) {
  const buttons = questions.map((q) => el("button", {
    "aria-pressed": String(q.name === chosen), "data-question": q.name, "aria-disabled": fits(q) ? false : "true", title: fits(q) ? t(`a_${q.name}`) : needs(q.needs[0]),
    onclick: () => { chosen = q.name; questionPane(pane); pane.querySelector(`[data-question="${q.name}"]`).focus(); },
  }, t(`q_${q.name}`)));
  const now = questions.find((q) => q.name === chosen), there = !view.shown || fits(now);
  controls = {};
  const acts = el("div", { id: "acts" });
  const fields = now.options.map((o) => optionField(o, () => showActs(acts, now)));
  const choices = [el("div", { class: "choices", role: "group", "aria-label": t("ask") }, ...buttons), el("p", {}, t(`a_${now.name}`))];
  if (!there) return pane.replaceChildren(...choices, missing(now.needs[0]));
  pane.replaceChildren(
    ...choices,
    ...fields, el("section", {}, el("h2", {}, t("acts_on")), acts),
    el("p", { class: "quiet" }, `${t("all_options")} `, el("code", { lang: "en" }, `concio ${now.name} --help`)),
    el("div", { class: "foot" }, el("button", { class: "main", id: "run", disabled: !view.shown || Boolean(view.shown.fault || view.shown.untraced), onclick: run }, t("run_it"))),
  );
  showActs(acts, now);
}

/* a question whose table is not in the text: which one, and where it can be written down at once */
function missing(table) {
  const told = el("section", { id: "missing" }, el("p", {}, `${needs(table)[0].toUpperCase()}${needs(table).slice(1)}.`));
  if (table === "moved") told.append(el("button", { onclick: () => document.querySelector("[data-tool=support]").click() }, t("support")));
  if (toFill[table] && doc()) told.append(el("button", { onclick: () => rewrite(doc().text.replace(/\s*$/, "\n") + toFill[table]) }, t("add_table")));
  return told;
}

function optionField(option, changed) {
  const name = option.name, word = t(name === "language" ? "language_report" : name);
  if (option.kind === "groups") {
    const groups = view.shown ? view.shown.groups : [];
    const first = groups.includes("live") ? ["live"] : [];
    const boxes = groups.map((g) => el("label", {}, el("input", { type: "checkbox", value: g, checked: first.includes(g), onchange: changed }), ` ${g} `));
    controls[name] = () => boxes.map((b) => b.querySelector("input")).filter((i) => i.checked).map((i) => i.value);
    return el("fieldset", {}, el("legend", {}, word), ...boxes, el("p", { class: "quiet" }, t("constant_groups")));
  }
  if (option.kind === "flag") {
    const box = el("input", { type: "checkbox", onchange: changed });
    controls[name] = () => box.checked;
    return el("label", { class: "row" }, box, word);
  }
  const choices = option.kind === "moved" ? movedGroups() : ["", ...option.choices];
  const one = ["choice", "moved"].includes(option.kind) ? el("select", {}, ...choices.map((c) => el("option", { value: c }, c))) : el("input", {});
  if (name === "language") one.value = language;
  one.addEventListener("change", changed);
  controls[name] = () => one.value.trim();
  return field(word, one);
}

function options() {
  const found = {};
  for (const [name, read] of Object.entries(controls)) {
    const value = read();
    if (value && (!Array.isArray(value) || value.length)) found[name] = value;
  }
  return found;
}

/* what will act, in the words of the verdict; the newest question wins */
let newest = 0;
async function showActs(place, question) {
  const shown = view.shown, mine = (newest += 1);
  if (!shown) return place.replaceChildren();
  if (shown.untraced) return place.replaceChildren(el("p", {}, t("photo_untraced")));
  if (shown.fault) return place.replaceChildren(el("p", { lang: "en" }, shown.fault.what));
  try {
    const found = await call("acts", { question: question.name, options: options() });
    if (mine !== newest || !place.isConnected) return;
    if (found.state === "cancelled") return void setTimeout(() => mine === newest && showActs(place, question), 150);
    if (found.state === "error") return place.replaceChildren(el("p", { lang: "en" }, found.error.what));
    place.replaceChildren(el("ul", {}, ...found.done.lines.map((line, k) => spoken("li", {}, line, found.done.italian[k]))));
  } catch (error) { place.replaceChildren(el("p", {}, error.text || error.message)); }
}

/* the page is busy at once, not only when the program has said so: the answer that is shown is then an earlier one */
export async function run() {
  pending += 1;
  busy({ question: chosen });
  say(t("working"));
  await asked(chosen, options(), () => { pending -= 1; });
}

/* the state of the question in the verdict's place */
function howFar(progress) {
  if (progress?.iteration === undefined) return "";
  const parts = [t("iteration", progress)];
  if (progress.residual) parts.push(t("residual", progress));
  if (progress.left) parts.push(t("time_left", progress));
  return parts.join(", ");
}

let shownKey = "", early = "";
function busy(now) {
  const bar = $("progress"), share = now.progress?.share, lines = (now.found || []).join("\n");
  if (share > 0) bar.value = share; else bar.removeAttribute("value");
  $("progress-text").textContent = `${now.early ? t("report_follows") : `${t("working")}: ${t(`q_${now.question}`)}`} ${Math.round(now.seconds || 0)} ${t("seconds")}. ${now.early ? "" : howFar(now.progress)}`;
  $("found").textContent = lines; $("found").hidden = !lines;
  $("running").hidden = false;
  $("verdict-text").classList.toggle("before", !now.early);
  shownKey = "";
}
function rests() {
  $("running").hidden = $("found").hidden = true;
  $("verdict-text").classList.remove("before");
  if ($("say").textContent === t("working")) say("");
}

export async function follow(state, after) {
  if (pending) return;
  const now = state.asked;
  if (now && ["working", "waiting"].includes(now.state)) {
    busy(now);
    const key = `${state.asking} ${language}`;
    if (now.early && early !== key) { early = key; answerSoon(now); }
    return;
  }
  if (!now) { rests(); if (answer) { answer = null; shownKey = ""; } return verdict(after); }
  if (now.state === "cancelled") { rests(); if (shownKey !== "cancelled") { shownKey = "cancelled"; say(t("cancelled")); verdict(after, t("cancelled")); } return; }
  const key = `${state.asking} ${state.document?.hash} ${language}`;
  if (key === shownKey) return;
  shownKey = key;
  if (answer?.asking !== state.asking) {
    const number = state.asking;
    try {
      const found = await call("result", { key: now.key });
      if (key !== shownKey) return; /* something else was asked meanwhile */
      if (answer && answer.key !== found.key) answers.unshift(answer);
      answer = { ...found, asking: number };
    } catch { if (key === shownKey) shownKey = ""; return; }
  }
  rests();
  verdict(after);
}

/* what was asked, in words, with the options that were given */
export function askedOf(one) {
  const given = one.command.replace(/ --out result$/, "").split(" ").filter((word) => word.startsWith("-") && !word.startsWith("--language")).join(" ");
  return t(`q_${one.question}`) + (given ? ` (${given})` : "");
}

function toneOf(found) {
  if (found.code === 0) return "good";
  return found.code === 3 ? "bad" : "unsure";
}

export function answerBox(found, old) {
  const box = el("div", { class: `${toneOf(found)}${old ? " old" : ""}` });
  const v = found.verdict;
  if (old) box.append(el("p", { class: "stamp" }, t("changed_since")));
  if (v) {
    box.append(spoken("p", { class: "headline" }, v.headline, found.italian?.headline), spoken("p", { class: "sentence" }, v.sentence, found.italian?.sentence));
    v.attention.forEach((line, k) => box.append(el("p", {}, `${t("attention")}: `, spoken("span", {}, line, found.italian?.attention[k]))));
  }
  if (found.message) box.append(el("pre", { lang: "en" }, found.message));
  if (!v && found.lines.length) box.append(el("pre", { lang: "en" }, found.lines.slice(0, 3).join("\n")));
  if (found.lines.length || found.kept) box.append(el("details", {}, el("summary", {}, t("all_lines") + (found.kept ? ` (${t("kept")})` : "")), el("pre", { lang: "en" }, found.lines.join("\n"))));
  return box;
}

/* the verdict is known, its report is still being written */
function answerSoon(now) {
  const place = $("verdict-text");
  place.dataset.note = "early";
  place.replaceChildren(answerBox({ lines: [], ...now.early }, now.hash !== doc()?.hash));
}

function verdict(after, note = "") {
  const place = $("verdict-text"), now = doc();
  const parts = note ? [el("p", {}, note)] : [];
  if (answer) parts.push(answerBox(answer, now && answer.hash !== now.hash));
  else if (!note) parts.push(el("p", { class: "quiet" }, t("no_verdict")));
  if (answer && t("verdict_language")) parts.push(el("p", { class: "quiet" }, t("verdict_language")));
  if (answers.length && answer) {
    const before = answers.find((a) => a.key !== answer.key);
    if (before) parts.push(el("details", {}, el("summary", {}, `${t("earlier")}: ${askedOf(before)}`), answerBox(before, now && before.hash !== now.hash)));
  }
  const text = parts.map((p) => p.textContent).join("");
  if (place.textContent !== text || place.dataset.note !== note) { place.replaceChildren(...parts); place.dataset.note = note; }
  after();
}

export function reportPane(pane) {
  pane.replaceChildren();
  if (!answer || !answer.files.length) return pane.append(el("p", { class: "quiet" }, t("no_report")));
  const report = answer.files.find((f) => f.endsWith("report.html")), base = new URL("..", location.href);
  const bar = el("div", { class: "row" }, el("button", { onclick: () => write(bar) }, t("export")));
  pane.append(bar);
  if (report) {
    const address = new URL(report, base).href;
    bar.append(el("a", { href: address, target: "_blank", rel: "noopener" }, t("open_report")), el("a", { href: address, download: "report.html" }, t("save_report")));
    pane.append(el("iframe", { src: address, title: t("report"), sandbox: "allow-scripts allow-modals" }));
  } else for (const file of answer.files) pane.append(el("p", {}, el("img", { class: "answer", src: new URL(file, base).href, alt: file.split("/").pop() })));
}

async function write(bar) {
  try {
    const found = await call("export", { key: answer.key });
    const text = t("exported", { folder: found.folder });
    bar.append(el("span", { role: "status" }, text));
  } catch (error) { bar.append(el("span", { role: "alert" }, error.text || error.message)); }
}

export function programs(file) {
  if (answer) return { python: answer.python, command: answer.command };
  return { python: `import concio\n\nmodel = concio.load(${JSON.stringify(file)})\nresult = concio.solve(model)\nprint(result.verdict)\n`, command: `concio run ${file} --out result` };
}
