/* The interactive view of a report: one canvas, typed arrays, no library. Lengths in m, forces in kN. */
(() => {
  const { $, unpacked, data, say, written } = base;
  const look = data.look, bodies = unpacked(data.bodies), pieces = unpacked(data.pieces), joints = unpacked(data.joints);
  const steps = data.steps.map(() => null);
  const count = bodies.name.length, pieceCount = pieces.pair.length;
  const STATES = ["open", "sticks", "slips", "is crushed"].map(say);
  const canvas = $("canvas"), pen = canvas.getContext("2d");
  const view = { x: 0, y: 0, zoom: 1, scale: data.scale, step: data.steps.length - 1, colour: "none", states: true, crosses: true, picked: null };
  const moved = new Float32Array(bodies.point.length);
  const boxes = new Float32Array(4 * count);
  let beside = {}; /* size of the forces, motions... of the step: beside it dust is nothing */
  let step, width = 0, height = 0, waiting = false, range = [0, 1], shade = null, bigStress = 1;

  const stepAt = (k) => (steps[k] ??= unpacked(data.steps[k]));
  /* while a large drawing moves under the finger it is drawn without joints and crosses, and in full when it rests */
  const LARGE = 1500;
  let draft = false, resting = 0;
  const drawMoving = () => {
    if (count > LARGE) {
      draft = true; clearTimeout(resting);
      resting = setTimeout(() => { draft = false; draw(); }, 150);
    }
    draw();
  };
  const draw = () => { if (!waiting) { waiting = true; requestAnimationFrame(() => { waiting = false; paint(draft); }); } };

  /* the last points of all rings: outlines, then holes, each closed by its first point */
  const ends = new Set(Array.from(bodies.ring, (first) => first - 1));

  /* length of the longest stress cross: the median size of the larger half of the free bodies */
  const sizes = [];
  for (let b = 0; b < count; b++) {
    if (bodies.kind[b] === "fixed") continue;
    let area = 0;
    for (let i = bodies.start[b]; i < bodies.start[b + 1] - 1; i++) {
      if (ends.has(i)) continue;
      area += (bodies.point[2 * i] * bodies.point[2 * i + 3] - bodies.point[2 * i + 2] * bodies.point[2 * i + 1]) / 2;
    }
    sizes.push(Math.sqrt(Math.abs(area)));
  }
  sizes.sort((a, b) => a - b);
  const typical = sizes[Math.floor(0.75 * (sizes.length - 1))] || data.size / 10;

  /* numbers */
  const digits = (v, beside = 0) => {
    if (!Number.isFinite(v)) return "–";
    const size = Math.abs(v);
    if (v === 0 || size <= 1e-6 * beside) return "0";
    if (size < 1e-4) return written(v.toExponential(2));
    const short = Number(v.toPrecision(4));
    return size >= 1e4 ? short.toLocaleString(document.documentElement.lang, { maximumFractionDigits: 0 }) : written(String(short));
  };
  /* quantities come in kN and m, and are reported in the units of the report: [factor, symbol] of each kind */
  const units = data.units;
  const told = (v, kind, beside = 0) => {
    const [factor, symbol] = units[kind] || [1, kind];
    return `${digits(factor * v, factor * beside)} ${symbol}`;
  };

  /* geometry */
  function place() {
    const s = view.scale, p = bodies.point, m = step.move;
    for (let i = 0; i < p.length; i++) moved[i] = p[i] + s * m[i];
    for (let b = 0; b < count; b++) {
      let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
      for (let i = bodies.start[b]; i < bodies.start[b + 1]; i++) {
        const x = moved[2 * i], y = moved[2 * i + 1];
        if (x < x0) x0 = x; if (x > x1) x1 = x; if (y < y0) y0 = y; if (y > y1) y1 = y;
      }
      boxes.set([x0, y0, x1, y1], 4 * b);
    }
  }
  function fit() {
    let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
    for (let i = 0; i < moved.length; i += 2) {
      x0 = Math.min(x0, moved[i]); x1 = Math.max(x1, moved[i]); y0 = Math.min(y0, moved[i + 1]); y1 = Math.max(y1, moved[i + 1]);
    }
    const above = 44; /* room for the buttons */
    view.zoom = Math.min(width / (x1 - x0), (height - above) / (y1 - y0)) * 0.94 || 1;
    view.x = (x0 + x1) / 2; view.y = (y0 + y1) / 2 + above / 2 / view.zoom;
  }
  function tallness() {
    let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
    for (let i = 0; i < moved.length; i += 2) {
      x0 = Math.min(x0, moved[i]); x1 = Math.max(x1, moved[i]); y0 = Math.min(y0, moved[i + 1]); y1 = Math.max(y1, moved[i + 1]);
    }
    return (y1 - y0) / (x1 - x0);
  }
  const X = (x) => width / 2 + (x - view.x) * view.zoom;
  const Y = (y) => height / 2 - (y - view.y) * view.zoom;
  const inside = (b) => X(boxes[4 * b + 2]) >= 0 && X(boxes[4 * b]) <= width && Y(boxes[4 * b + 1]) >= 0 && Y(boxes[4 * b + 3]) <= height;

  /* colours: cividis, from nine of its values */
  const RAMP = ["#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#fee838"];
  const BINS = 48;
  const parse = (c) => [1, 3, 5].map((i) => parseInt(c.slice(i, i + 2), 16));
  const ramp = Array.from({ length: BINS }, (_, k) => {
    const at = (k / (BINS - 1)) * (RAMP.length - 1), i = Math.min(Math.floor(at), RAMP.length - 2), f = at - i;
    const a = parse(RAMP[i]), b = parse(RAMP[i + 1]);
    return `rgb(${a.map((v, j) => Math.round(v + f * (b[j] - v))).join()})`;
  });
  const KINDS = { s1: "stress", s2: "stress", move: "motion", pressure: "stress" };
  const WORDS = { s1: say("largest principal stress"), s2: say("smallest principal stress"), move: say("displacement"), pressure: say("contact pressure") };
  function valuesOf(name) {
    if (name === "s1" || name === "s2") return step[name] || null;
    if (name === "pressure") return step.pressure || null;
    if (name !== "move") return null;
    return Float64Array.from({ length: count }, (_, b) => Math.hypot(step.motion[3 * b], step.motion[3 * b + 1]));
  }
  function recolour() {
    shade = valuesOf(view.colour);
    range = [Infinity, -Infinity];
    if (shade) for (const v of shade) if (Number.isFinite(v)) { range[0] = Math.min(range[0], v); range[1] = Math.max(range[1], v); }
    if (!(range[0] < range[1])) range = [Number.isFinite(range[0]) ? range[0] : 0, (Number.isFinite(range[0]) ? range[0] : 0) + 1];
    bigStress = 0;
    if (step.s2) for (let b = 0; b < count; b++) bigStress = Math.max(bigStress, Math.abs(step.s1[b]) || 0, Math.abs(step.s2[b]) || 0);
    legend();
  }
  /* compression is dark at the small (negative) end: dark always means more */
  const binOf = (v) => {
    let f = (v - range[0]) / (range[1] - range[0]);
    if (view.colour !== "s2") f = 1 - f;
    return Math.max(0, Math.min(BINS - 1, Math.round(f * (BINS - 1))));
  };

  /* drawing */
  function trace(b) {
    let first = true;
    for (let i = bodies.start[b]; i < bodies.start[b + 1]; i++) {
      if (ends.has(i)) { pen.closePath(); first = true; continue; }
      if (first) pen.moveTo(X(moved[2 * i]), Y(moved[2 * i + 1])); else pen.lineTo(X(moved[2 * i]), Y(moved[2 * i + 1]));
      first = false;
    }
  }
  function fillBodies(shown) {
    const groups = new Map();
    const onBodies = shade && view.colour !== "pressure";
    for (const b of shown) {
      if (bodies.kind[b] === "fixed") continue;
      const value = onBodies ? shade[b] : NaN;
      const colour = Number.isFinite(value) ? ramp[binOf(value)] : look[bodies.kind[b]] || look.block;
      if (!groups.has(colour)) groups.set(colour, []);
      groups.get(colour).push(b);
    }
    for (const [colour, members] of groups) {
      pen.fillStyle = colour; pen.beginPath(); members.forEach(trace); pen.fill();
    }
    pen.strokeStyle = look.edge; pen.lineWidth = shown.length > 3000 ? 0.3 : 0.8;
    pen.beginPath(); for (const b of shown) if (bodies.kind[b] !== "fixed") trace(b); pen.stroke();
  }
  function hatch(shown) {
    for (const b of shown) {
      if (bodies.kind[b] !== "fixed") continue;
      pen.save(); pen.beginPath(); trace(b); pen.fillStyle = "#fff"; pen.fill(); pen.clip();
      pen.strokeStyle = look.hatch; pen.lineWidth = 1; pen.beginPath();
      const x0 = Math.max(-height, X(boxes[4 * b])), x1 = Math.min(width + height, X(boxes[4 * b + 2]));
      const y0 = Math.max(-20, Y(boxes[4 * b + 3])), y1 = Math.min(height + 20, Y(boxes[4 * b + 1])), tall = y1 - y0;
      for (let x = x0 - tall; x < x1; x += 8) { pen.moveTo(x, y1); pen.lineTo(x + tall, y0); }
      pen.stroke(); pen.restore();
      pen.strokeStyle = look.hatch; pen.beginPath(); trace(b); pen.stroke();
    }
  }
  const end = (k, e, side) => {
    const i = 4 * k + 2 * e, m = side === "a" ? step.moved_a : step.moved_b, s = view.scale;
    return [X(pieces.ends[i] + s * m[i]), Y(pieces.ends[i + 1] + s * m[i + 1])];
  };
  function middle(k, e) { const a = end(k, e, "a"), b = end(k, e, "b"); return [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]; }
  function strokePieces(keep, colour, lineWidth, dash) {
    const short = typical * view.zoom < 14; /* dashes cannot be seen on joints this short */
    pen.strokeStyle = colour; pen.lineWidth = lineWidth; pen.setLineDash(short ? [] : dash); pen.beginPath();
    for (let k = 0; k < pieceCount; k++) if (keep(k)) {
      const p = middle(k, 0), q = middle(k, 1);
      if (Math.max(p[0], q[0]) < 0 || Math.min(p[0], q[0]) > width || Math.max(p[1], q[1]) < 0 || Math.min(p[1], q[1]) > height) continue;
      pen.moveTo(...p); pen.lineTo(...q);
    }
    pen.stroke(); pen.setLineDash([]);
  }
  function drawJoints() {
    const thin = pieceCount * Math.min(1, 60 / (view.zoom * data.size / Math.max(width, 1) + 1)) > 12000 ? 0.5 : 1;
    if (view.colour === "pressure" && shade) {
      for (let bin = 0; bin < BINS; bin += 4) {
        strokePieces((k) => step.state[k] !== 0 && Math.floor(binOf(shade[k]) / 4) * 4 === bin, ramp[bin], 4 * thin, []);
      }
    }
    if (!view.states || !step.state) return;
    pen.fillStyle = look.gap; pen.strokeStyle = look.open; pen.lineWidth = 0.8 * thin;
    pen.beginPath();
    for (let k = 0; k < pieceCount; k++) if (step.state[k] === 0) {
      const p = end(k, 0, "a"), q = end(k, 1, "a"), r = end(k, 1, "b"), s = end(k, 0, "b");
      pen.moveTo(...p); pen.lineTo(...q); pen.lineTo(...r); pen.lineTo(...s); pen.closePath();
    }
    pen.fill(); pen.stroke();
    if (view.colour !== "pressure" && typical * view.zoom >= 10) strokePieces((k) => step.state[k] === 1, look.stick, 1.2 * thin, []);
    strokePieces((k) => step.state[k] === 2, look.slip, 2.8 * thin, [6, 3]);
    strokePieces((k) => step.state[k] === 3, look.crushed, 3.2 * thin, []);
  }
  function drawCrosses(shown) {
    if (!view.crosses || !step.s2 || !(bigStress > 0)) return;
    for (const [sign, colour, dash] of [[-1, look.compression, []], [1, look.tension, [4, 2]]]) {
      pen.strokeStyle = colour; pen.setLineDash(dash); pen.lineWidth = shown.length > 1500 ? 1.2 : 2.4;
      pen.beginPath();
      for (const b of shown) {
        const x = X(bodies.centre[2 * b] + view.scale * step.motion[3 * b]), y = Y(bodies.centre[2 * b + 1] + view.scale * step.motion[3 * b + 1]);
        for (const [stress, turn] of [[step.s1[b], 0], [step.s2[b], Math.PI / 2]]) {
          if (!(sign * stress > 0.01 * bigStress)) continue;
          const half = 0.6 * typical * view.zoom * Math.abs(stress) / bigStress, angle = step.angle[b] + turn;
          pen.moveTo(x - half * Math.cos(angle), y + half * Math.sin(angle)); pen.lineTo(x + half * Math.cos(angle), y - half * Math.sin(angle));
        }
      }
      pen.stroke(); pen.setLineDash([]);
    }
  }
  function drawPicked() {
    if (!view.picked) return;
    pen.strokeStyle = "#000"; pen.lineWidth = 3; pen.beginPath();
    if (view.picked.body !== undefined) trace(view.picked.body);
    else { const p = middle(view.picked.piece, 0), q = middle(view.picked.piece, 1); pen.moveTo(...p); pen.lineTo(...q); pen.lineWidth = 6; }
    pen.stroke();
  }
  function paint(quick = false) {
    const ratio = window.devicePixelRatio || 1;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const shown = [];
    for (let b = 0; b < count; b++) if (inside(b)) shown.push(b);
    hatch(shown); fillBodies(shown);
    if (!quick) { drawJoints(); drawCrosses(shown); }
    drawPicked();
    view.painted = (view.painted || 0) + 1;
  }

  /* words */
  function legend() {
    const item = (colour, word, style = "solid") => `<span><i style="border-color:${colour};border-top-style:${style}"></i>${say(word)}</span>`;
    const parts = [];
    if (view.colour !== "none" && shade) {
      const stops = ramp.filter((_, k) => k % 6 === 0 || k === BINS - 1);
      const order = view.colour === "s2" ? stops : [...stops].reverse(), kind = KINDS[view.colour], wide = Math.max(Math.abs(range[0]), Math.abs(range[1]));
      const low = told(range[0], kind, wide), high = told(range[1], kind, wide);
      parts.push(`<span>${WORDS[view.colour]} ${low}<i class="bar" style="background:linear-gradient(90deg,${order.join()})"></i>${high}</span>`);
    } else if (view.colour !== "none") parts.push(`<span>${say("not in this step")}: ${WORDS[view.colour]}</span>`);
    if (view.states && step.state) parts.push(item(look.stick, "sticks"), item(look.slip, "slips", "dashed"), item(look.open, "open"));
    if (view.states && step.state && step.state.includes(3)) parts.push(item(look.crushed, "crushed"));
    if (view.crosses && step.s2) parts.push(item(look.compression, "compression"), item(look.tension, "tension", "dashed"));
    $("legend").innerHTML = parts.join("");
  }
  const escaped = (text) => text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
  const row = (name, value, kind) => `<div><dt>${say(name)}</dt><dd data-name="${name}" data-value="${value}">${told(value, kind, beside[kind])}</dd></div>`;
  function inform() {
    const box = $("info"), picked = view.picked;
    if (!picked) { box.textContent = say("Click a block or a joint to read its numbers."); return; }
    if (picked.body !== undefined) {
      const b = picked.body, rows = [];
      if (data.mechanism) {
        rows.push(row("velocity x", step.motion[3 * b], "m/s"), row("velocity y", step.motion[3 * b + 1], "m/s"), row("spin", step.motion[3 * b + 2], "rad/s"));
      } else {
        rows.push(row("moves x", step.motion[3 * b], "motion"), row("moves y", step.motion[3 * b + 1], "motion"), row("turns", step.motion[3 * b + 2], "rotation"));
      }
      if (step.s1 && Number.isFinite(step.s1[b])) rows.push(row("largest stress", step.s1[b], "stress"), row("smallest stress", step.s2[b], "stress"));
      box.innerHTML = `<b>${escaped(bodies.name[b])}</b>${say(bodies.kind[b])}<dl>${rows.join("")}</dl>`;
      return;
    }
    const k = picked.piece, j = pieces.face[k], rows = [];
    if (step.N) {
      rows.push(row("normal force N", step.N[j], "force"), row("shear force V", step.V[j], "force"), row("eccentricity", step.eccentricity[j], "length"));
      rows.push(row("open part", 100 * step.open_share[j], "%"), row("length", joints.length[j], "length"));
      rows.push(row("pressure here", step.pressure[k], "stress"), row("force here", step.t_n[k], "force"), row("friction here", step.t_t[k], "force"));
      rows.push(row("gap here", step.gap[k], "motion"), row("slip here", step.slip[k], "motion"));
    }
    const name = (b) => (b < 0 ? say("a fixed point") : escaped(bodies.name[b]));
    const state = step.state ? `${say("here it")} <em>${step.state[k] ? STATES[step.state[k]] : say("is open")}</em>` : "";
    box.innerHTML = `<b>${say("joint")} ${name(joints.a[j])} – ${name(joints.b[j])}</b>${state}<dl>${rows.join("")}</dl>`;
  }

  /* picking: a joint within a few pixels wins over the block under the finger */
  function pick(px, py, reach) {
    let best = reach, piece = -1;
    for (let k = 0; k < pieceCount; k++) {
      const [ax, ay] = middle(k, 0), [bx, by] = middle(k, 1), dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy;
      const t = square > 0 ? Math.max(0, Math.min(1, ((px - ax) * dx + (py - ay) * dy) / square)) : 0;
      const away = Math.hypot(px - ax - t * dx, py - ay - t * dy);
      if (away < best) { best = away; piece = k; }
    }
    if (piece >= 0) return { piece };
    const x = view.x + (px - width / 2) / view.zoom, y = view.y - (py - height / 2) / view.zoom;
    for (let b = count - 1; b >= 0; b--) {
      if (x < boxes[4 * b] || x > boxes[4 * b + 2] || y < boxes[4 * b + 1] || y > boxes[4 * b + 3]) continue;
      let odd = false;
      for (let i = bodies.start[b]; i < bodies.start[b + 1] - 1; i++) {
        if (ends.has(i)) continue;
        const x0 = moved[2 * i], y0 = moved[2 * i + 1], x1 = moved[2 * i + 2], y1 = moved[2 * i + 3];
        if (y0 > y !== y1 > y && x < x0 + ((y - y0) / (y1 - y0)) * (x1 - x0)) odd = !odd;
      }
      if (odd) return { body: b };
    }
    return null;
  }
  function choose(picked) {
    view.picked = picked; inform(); draw();
    const j = picked && picked.body === undefined ? pieces.face[picked.piece] : -1;
    const of = !picked ? [] : j < 0 ? [picked.body] : [joints.a[j], joints.b[j]];
    document.dispatchEvent(new CustomEvent("concio-picked", { detail: of }));
  }

  /* controls */
  const scaleOf = (at) => (at / 100) ** 2 * data.scale;
  function setScale(value) {
    view.scale = value; $("scale-text").textContent = `× ${digits(value)}`;
    place(); drawMoving();
  }
  function setStep(k) {
    view.step = k; step = stepAt(k);
    const most = (...arrays) => arrays.reduce((top, array) => (array || []).reduce((a, v) => (Math.abs(v) > a ? Math.abs(v) : a), top), 0);
    beside = { force: most(step.N, step.V), motion: most(step.motion), stress: most(step.s1, step.s2), length: data.size, rotation: most(step.motion) / data.size };
    $("step").value = k; $("step-text").textContent = step.label;
    place(); recolour(); inform(); draw();
  }
  function zoomAt(px, py, factor) {
    const x = view.x + (px - width / 2) / view.zoom, y = view.y - (py - height / 2) / view.zoom;
    view.zoom = Math.max(1e-3 * width / data.size, Math.min(1e5 * width / data.size, view.zoom * factor));
    view.x = x - (px - width / 2) / view.zoom; view.y = y + (py - height / 2) / view.zoom; drawMoving();
  }
  $("scale").addEventListener("input", (e) => setScale(scaleOf(Number(e.target.value))));
  $("step").addEventListener("input", (e) => setStep(Number(e.target.value)));
  $("colour").addEventListener("change", (e) => { view.colour = e.target.value; recolour(); draw(); });
  $("states").addEventListener("change", (e) => { view.states = e.target.checked; legend(); draw(); });
  $("crosses").addEventListener("change", (e) => { view.crosses = e.target.checked; legend(); draw(); });
  $("zoom-in").addEventListener("click", () => zoomAt(width / 2, height / 2, 1.5));
  $("zoom-out").addEventListener("click", () => zoomAt(width / 2, height / 2, 1 / 1.5));
  $("fit").addEventListener("click", () => { fit(); draw(); });
  canvas.addEventListener("wheel", (e) => {
    if (!e.ctrlKey && !e.metaKey) return; /* the page scrolls; a pinch on a touchpad counts as ctrl */
    e.preventDefault(); zoomAt(e.offsetX, e.offsetY, Math.exp(-e.deltaY * (e.deltaMode ? 0.05 : 0.0015)));
  }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const by = 40 / view.zoom, moves = { ArrowLeft: [-by, 0], ArrowRight: [by, 0], ArrowUp: [0, by], ArrowDown: [0, -by] };
    if (moves[e.key]) { view.x += moves[e.key][0]; view.y += moves[e.key][1]; draw(); }
    else if (e.key === "+") zoomAt(width / 2, height / 2, 1.25);
    else if (e.key === "-") zoomAt(width / 2, height / 2, 0.8);
    else if (e.key === "0") { fit(); draw(); }
    else return;
    e.preventDefault();
  });
  const fingers = new Map();
  let travelled = 0;
  canvas.addEventListener("pointerdown", (e) => {
    try { canvas.setPointerCapture(e.pointerId); } catch { /* a pointer made by a script cannot be captured */ }
    fingers.set(e.pointerId, [e.offsetX, e.offsetY]); if (fingers.size === 1) travelled = 0;
  });
  canvas.addEventListener("pointermove", (e) => {
    const old = fingers.get(e.pointerId);
    if (!old) return;
    const now = [e.offsetX, e.offsetY];
    travelled += Math.hypot(now[0] - old[0], now[1] - old[1]);
    if (fingers.size === 1) { view.x -= (now[0] - old[0]) / view.zoom; view.y += (now[1] - old[1]) / view.zoom; drawMoving(); }
    else {
      const other = [...fingers.entries()].find(([id]) => id !== e.pointerId)[1];
      const before = Math.hypot(old[0] - other[0], old[1] - other[1]), after = Math.hypot(now[0] - other[0], now[1] - other[1]);
      if (before > 0) zoomAt((now[0] + other[0]) / 2, (now[1] + other[1]) / 2, after / before);
    }
    fingers.set(e.pointerId, now);
  });
  const lift = (e) => {
    if (!fingers.delete(e.pointerId) || e.type !== "pointerup" || travelled > 6) return;
    choose(pick(e.offsetX, e.offsetY, e.pointerType === "touch" ? 12 : 6));
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);

  function resize() {
    const ratio = window.devicePixelRatio || 1, first = width === 0, old = width;
    width = canvas.clientWidth;
    const wanted = Math.round(Math.min(Math.max(180, width * tallness() + 110), Math.max(260, 0.75 * window.innerHeight)));
    canvas.style.height = `${wanted}px`; height = wanted;
    canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio);
    if (first || !old) fit(); else view.zoom *= width / old;
    draw();
  }

  /* start */
  if (count > LARGE && data.steps.some((s) => s.s2)) {
    view.crosses = false; view.colour = "s2";
    $("crosses").checked = false; $("colour").value = "s2";
  }
  $("step").max = data.steps.length - 1;
  if (data.steps.length < 2) $("step-label").hidden = true;
  if (data.steps.length < 2) $("step-label").style.display = "none";
  setStep(view.step); setScale(data.scale);
  resize();
  /* in the next frame: changing the height while the observer reports would make it report again at once */
  new ResizeObserver(() => requestAnimationFrame(() => { if (canvas.clientWidth !== width) resize(); })).observe(canvas);
  window.concioNames = { names: bodies.name, choose: (body) => choose({ body }), node: canvas };
  window.concio = { view, data, bodies, pieces, joints, stepAt, setStep, setScale, choose, pick, paint, X, Y, middle };
})();
