/* The words of the page in the chosen language, and small helpers that build elements without writing HTML text. */
let table = {}, ofFiles = { keys: {}, terms: {}, templates: {} };
export let language = localStorage.getItem("language") || (navigator.language.startsWith("it") ? "it" : "en");

export function setWords(words, italian) { table = words; ofFiles = italian; }

/* what model files are made of, in the chosen language: a key, a template, the words of a table */
const FREE = ["materials", "joints", "layers", "mechanisms", "walls", "factors"];   /* names in these are the user's own */
export const keyWord = (path, k = path.length - 1) => (typeof path[k] === "number" ? path[k] + 1 : (language === "it" && !FREE.includes(path[k - 1]) && ofFiles.keys[path[k]]) || path[k]);
export const templateWord = (kind) => (language === "it" && ofFiles.templates[kind]) || kind.replaceAll("_", " ");
export function terms(text) {
  if (language !== "it" || !text) return text;
  const known = Object.keys(ofFiles.terms).sort((a, b) => b.length - a.length);
  return text.replace(new RegExp(`\\b(${known.join("|")})\\b`, "g"), (word) => ofFiles.terms[word]);
}
export function setLanguage(to) { language = to; localStorage.setItem("language", to); document.documentElement.lang = to; }

export function t(key, values = {}) {
  const pair = table[key] || [key, key];
  return pair[language === "it" ? 1 : 0].replace(/\{(\w+)\}/g, (_, name) => values[name] ?? "");
}

export function label(root = document) {
  for (const one of root.querySelectorAll("[data-t]")) one.textContent = t(one.dataset.t);
  for (const one of root.querySelectorAll("[data-label]")) one.setAttribute("aria-label", t(one.dataset.label));
}

/* el("p", {class: "quiet"}, "text", child...): attributes, listeners ("onclick") and children */
export function el(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.filter((c) => c !== null && c !== undefined));
  return made;
}

/* a text of the program: in Italian where it is known, each piece with its language; otherwise as it is, in English */
export function spoken(tag, attributes, english, italian) {
  if (language !== "it" || !italian) return el(tag, { ...attributes, lang: "en" }, english);
  return el(tag, attributes, ...italian.flatMap(([text, lang], k) => [k ? " " : "", el("span", { lang }, text)]));
}

let fields = 0;
export function field(word, control, help = "") {
  const id = `field-${(fields += 1)}`;
  control.id = id;
  const row = el("div", { class: "field" }, el("label", { for: id }, word), control);
  if (!help) return row;
  control.setAttribute("aria-describedby", `${id}-help`);
  return el("div", {}, row, el("p", { class: "quiet", id: `${id}-help` }, help));
}

export function say(text) { document.getElementById("say").textContent = text; }

export const digits = (value) => String(Number(Number(value).toPrecision(6)));
