/* Answers on view: one is played in the main picture, another beside it or above it, with their verdicts and numbers. */
import { t, el, field, digits, language } from "./words.js";
import { call } from "./net.js";
import { boxAround, canvas, draw, inSpace, view } from "./picture.js";
import { drawFilm, filmOf, hasForces, numbersOf, ringsOf } from "./film.js";
import { pose } from "./space.js";
import { answerBox, askedOf } from "./ask.js";

let known = [], first = "", second = "", doc = () => null, films = new Map(), told = new Map(), numbers = null, numbered = "", changed = () => {};
let step = 0, size = 50, over = false, forces = false, playing = 0, phase = 1;
export function setLook(document_, tables) { doc = document_; changed = tables; }

async function filmFor(key) {
  if (films.has(key)) return films.get(key);
  const found = filmOf((await call("film", { key })).film);
  if (found) films.set(key, found);
  return found;
}
async function toldOf(key) {
  if (!told.has(key)) told.set(key, await call("result", { key }));
  return told.get(key);
}

/* a new answer: it is the one on view; its numbers go into the tables while the model is the one that was asked */
let newest = 0;
export async function answered(found) {
  const mine = (newest += 1);
  stop();
  first = found ? found.key : ""; numbers = null; step = Infinity;
  films.delete(first); told.delete(first);
  const film = found ? await filmFor(found.key).catch(() => null) : null;
  if (mine !== newest) return;
  numbers = numbersOf(film); numbered = found?.hash || "";
  changed();
}
export const resultNumbers = () => (view.shown && numbered === doc()?.hash ? numbers : null);
export function modelChanged() { stop(); rest(); }

export async function lookPane(into) {
  try { known = doc() ? (await call("answers")).answers : []; } catch { known = []; }
  if (!known.length) return into.replaceChildren(el("p", { class: "quiet" }, t("no_answers")));
  if (!known.some((a) => a.key === first)) first = known[0].key;
  if (!known.some((a) => a.key === second)) second = "";
  const headline = (a) => (language === "it" && a.italian ? a.italian.map(([text]) => text).join(" ") : a.headline);
  const name = (a) => `${a.hash === doc().hash ? "" : `(${t("other_model")}) `}${askedOf(a)}: ${headline(a)}`;
  const pick = (word, value, none, act) => {
    const one = el("select", { onchange: () => { act(one.value); step = Infinity; lookPane(into); } }, ...(none ? [el("option", { value: "" }, t("nothing_else"))] : []), ...known.map((a) => el("option", { value: a.key }, name(a))));
    one.value = value;
    return field(t(word), one);
  };
  const [film, other] = await Promise.all([filmFor(first), second ? filmFor(second) : null]);
  if (step === Infinity) step = film && !film.alternatives ? film.count - 1 : 0;
  step = Math.min(step, (film?.count || 1) - 1);
  const parts = [pick("look_at", first, false, (v) => { first = v; }), pick("beside", second, true, (v) => { second = v; })];
  if (film) parts.push(controls(film, other)); else parts.push(el("p", { class: "quiet" }, t("no_film")));
  const found = await Promise.all([first, second].filter(Boolean).map(toldOf));
  const columns = found.map((one, k) => el("section", { class: "beside" }, el("h2", {}, askedOf(one)), el("div", { class: "small-picture", id: `small-${k}` }), answerBox(one, one.hash !== doc().hash)));
  into.replaceChildren(...parts, el("div", { class: "columns" }, ...columns), ...(found.length > 1 ? [compared(found)] : []));
  render(film, other);
}

function controls(film, other) {
  const word = el("span", { id: "step-word", role: "status" }), shown = () => { word.textContent = film.words[step] || ""; };
  const slider = el("input", { type: "range", min: 0, max: film.count - 1, value: step, id: "film-step", "aria-label": t("step") });
  const scale = el("input", { type: "range", min: 0, max: 100, value: size, "aria-label": t("enlarged") });
  const play = el("button", { id: "play", "aria-pressed": String(Boolean(playing)) }, t("play"));
  slider.addEventListener("input", () => { stop(); step = Number(slider.value); shown(); render(film, other); });
  scale.addEventListener("input", () => { size = Number(scale.value); render(film, other); });
  play.addEventListener("click", () => { if (playing) { stop(); phase = 1; render(film, other); } else start(film, other, () => { slider.value = step; shown(); }); });
  const above = el("input", { type: "checkbox", checked: over });
  above.addEventListener("change", () => { over = above.checked; render(film, other); });
  const lines = el("input", { type: "checkbox", checked: forces, id: "forces" });
  lines.addEventListener("change", () => { forces = lines.checked; if (forces) stop(); render(film, other); });
  shown();
  return el("div", {},
    el("div", { class: "row" }, play, ...(film.count > 1 ? [el("label", {}, `${t("step")} `), slider] : []), word),
    film.frames ? "" : el("div", { class: "row" }, el("span", {}, t("enlarged")), scale),
    Array.from({ length: film.count }, (_, k) => k).some((k) => hasForces(film, k)) ? el("label", { class: "row" }, lines, t("forces")) : "",
    other && !inSpace() ? el("label", { class: "row" }, above, t("overlaid")) : "",
    el("div", { class: "row" }, el("button", { id: "film-off", onclick: () => { stop(); rest(); } }, t("model_alone"))));
}

const scaleOf = (film) => (film.frames ? 1 : forces && hasForces(film, Math.min(step, film.count - 1)) ? 0 : film.scale * (size / 50) ** 2 * phase);

/* into the main picture, and into the small ones where two answers are compared */
function render(film, other) {
  if (!view.shown) return;
  const fits = (f) => f && Boolean(f.space) === inSpace();
  const at = (f) => Math.min(step, f.count - 1);
  if (inSpace()) {
    const images = [film, other].map((f) => (fits(f) && f.kinds.length === view.shown.bodies.length ? snapshot(f, at(f)) : null));
    [0, 1].forEach((k) => { const place = document.getElementById(`small-${k}`); if (place && other && images[k] && !playing) place.replaceChildren(el("img", { class: "answer", src: images[k], alt: known.find((a) => a.key === [first, second][k])?.headline || "" })); });
    pose(fits(film) && film.kinds.length === view.shown.bodies.length ? film.step(at(film)).motion : null, film ? scaleOf(film) : 1);
    return draw();
  }
  view.moved = fits(film) ? (into) => { drawFilm(into, film, at(film), scaleOf(film), false, forces); if (over && fits(other)) drawFilm(into, other, at(other), scaleOf(other), true); } : null;
  draw();
  if (other) [film, other].forEach((f, k) => { const place = document.getElementById(`small-${k}`); if (place && fits(f)) place.replaceChildren(small(f, at(f), [film, other])); });
}

function snapshot(film, k) {
  pose(film.step(k).motion, scaleOf(film));
  draw();
  return canvas.toDataURL("image/png");
}

/* both small pictures have one box, so that what is larger looks larger */
function small(film, k, both) {
  const points = both.flatMap((f) => (f ? ringsOf(f, Math.min(step, f.count - 1), scaleOf(f)).flat(2) : [])), [x0, y0, x1, y1] = boxAround(points.concat(view.shown.bodies.flatMap((b) => b.rings.flat())));
  const made = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  made.setAttribute("viewBox", `${x0} ${-y1} ${x1 - x0} ${y1 - y0}`); made.setAttribute("role", "img"); made.setAttribute("aria-label", film.words[k] || t("picture"));
  drawFilm(made, film, k, scaleOf(film), false, forces);
  return made;
}

function start(film, other, follow) {
  const begun = performance.now(), from = film.frames ? film.at[step === film.count - 1 ? 0 : step] : 0;
  document.getElementById("play")?.setAttribute("aria-pressed", "true");
  const tick = (now) => {
    if (!playing) return;
    const s = (now - begun) / 1000;
    if (film.frames) {
      const at = from + s * film.rate;
      step = film.at.findLastIndex((v) => v <= at);
      if (at >= film.at[film.count - 1]) { step = film.count - 1; stop(); }
    } else if (film.count > 1 && !film.alternatives) { step = Math.floor(s * 8) % film.count; phase = 1; }
    else phase = 0.5 - 0.5 * Math.cos(s * 1.6);
    follow();
    render(film, other);
    if (playing) playing = requestAnimationFrame(tick);
  };
  playing = requestAnimationFrame(tick);
}
function stop() {
  if (playing) cancelAnimationFrame(playing);
  playing = 0;
  document.getElementById("play")?.setAttribute("aria-pressed", "false");
}
/* the model as it is described */
export function rest() {
  view.moved = null; phase = 1;
  if (view.shown && inSpace()) pose(null);
  draw();
}

/* numbers that both answers have, by their names in --json */
function compared([a, b]) {
  const names = Object.keys(a.numbers || {}).filter((n) => n in (b.numbers || {}));
  if (!names.length) return el("p", { class: "quiet" }, t("no_common"));
  const rows = names.map((n) => el("tr", {}, el("th", { scope: "row" }, n), el("td", { class: "n" }, digits(a.numbers[n])), el("td", { class: "n" }, digits(b.numbers[n])), el("td", { class: "n" }, a.numbers[n] ? digits(b.numbers[n] / a.numbers[n]) : "")));
  return el("div", { class: "scroll" }, el("table", { id: "compared" }, el("caption", {}, t("numbers_of_both")), el("thead", {}, el("tr", {}, ...["", "1", "2", "2 / 1"].map((h) => el("th", { scope: "col" }, h)))), el("tbody", {}, ...rows)));
}
