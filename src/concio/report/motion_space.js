"use strict";
// Plays a motion in space on a canvas: faces sorted by depth, dragged to turn, wheel to come nearer. No library.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const say = (word) => (data.said || {})[word] ?? word, told = (v) => { const text = v.toPrecision(4); return data.said ? text.replace(".", ",") : text; };
  const [canvas, slider, button, word, speed, chart, picked] =
    ["film", "frame", "play", "word", "speed", "history", "picked"].map((id) => document.getElementById(id));
  const bodies = data.bodies, frames = data.frames, last = frames.length - 1;
  const middle = [0, 1, 2].map((c) => (data.low[c] + data.high[c]) / 2);
  const reach = Math.hypot(...[0, 1, 2].map((c) => data.high[c] - data.low[c])) || 1;
  const ink = {elastic: [220, 201, 163], rigid: [201, 205, 210], fixed: [222, 218, 209]};
  let now = 0, playing = false, begun = 0, from = 0, turn = -0.7, lift = 0.45, near = 1, chosen = data.first, shapes = [];

  /* where the points of a body are seen: right, up, towards the eye */
  function seen(b, frame) {
    const p = frame.slice(12 * b, 12 * b + 12), points = bodies[b].points, found = new Float64Array(points.length);
    const c = Math.cos(turn), s = Math.sin(turn), cl = Math.cos(lift), sl = Math.sin(lift);
    for (let i = 0; i < points.length; i += 3) {
      const [x, y, z] = [0, 1, 2].map((k) => p[k] + p[3 + 3 * k] * points[i] + p[4 + 3 * k] * points[i + 1] + p[5 + 3 * k] * points[i + 2] - middle[k]);
      found[i] = c * x + s * y; found[i + 1] = -s * sl * x + c * sl * y + cl * z; found[i + 2] = s * cl * x - c * cl * y + sl * z;
    }
    return found;
  }

  function size(box, high) {
    const ratio = window.devicePixelRatio || 1, width = box.clientWidth;
    box.style.height = `${high}px`;
    box.width = Math.round(width * ratio); box.height = Math.round(high * ratio);
    const pen = box.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, high);
    return [pen, width];
  }

  function draw() {
    const high = Math.max(220, Math.min(0.62 * window.innerHeight, 0.7 * canvas.clientWidth));
    const [pen, width] = size(canvas, high), scale = near * Math.min(width, high) / reach;
    const faces = [];
    for (let b = 0; b < bodies.length; b++) {
      const at = seen(b, frames[now]);
      for (const ring of bodies[b].faces) {
        let area = 0, depth = 0;
        for (let i = 0; i < ring.length; i++) {
          const p = 3 * ring[i], q = 3 * ring[(i + 1) % ring.length];
          area += at[p] * at[q + 1] - at[p + 1] * at[q]; depth += at[p + 2];
        }
        if (area <= 0) continue;
        let other = 0;
        for (let i = 0; i < ring.length; i++) {
          const p = 3 * ring[i], q = 3 * ring[(i + 1) % ring.length];
          other += Math.hypot(at[p + 1] * at[q + 2] - at[p + 2] * at[q + 1], at[p + 2] * at[q] - at[p] * at[q + 2]);
        }
        faces.push({b, ring, at, depth: bodies[b].kind === "fixed" ? depth / ring.length - 1e3 * reach : depth / ring.length, light: area / (area + 0.6 * other)});
      }
    }
    faces.sort((one, two) => one.depth - two.depth);
    shapes = [];
    for (const face of faces) {
      const path = new Path2D();
      face.ring.forEach((k, i) => {
        const x = width / 2 + scale * face.at[3 * k], y = high / 2 - scale * face.at[3 * k + 1];
        if (i) path.lineTo(x, y); else path.moveTo(x, y);
      });
      path.closePath();
      const tone = 0.78 + 0.22 * face.light, colour = (face.b === chosen ? [232, 190, 120] : ink[bodies[face.b].kind]).map((v) => Math.round(v * tone));
      pen.fillStyle = `rgb(${colour})`; pen.fill(path);
      pen.lineWidth = 0.8; pen.strokeStyle = bodies[face.b].kind === "fixed" ? "#B9B2A4" : "#5B5346"; pen.stroke(path);
      shapes.push({b: face.b, path});
    }
    word.textContent = data.words[now];
    slider.value = String(now);
    slider.setAttribute("aria-valuetext", data.words[now]);
    history();
  }

  /* displacement and rotation of the block that was picked, over the whole motion */
  function history() {
    const [pen, width] = size(chart, 150), b = chosen, first = frames[0];
    const away = frames.map((f) => 1e3 * Math.hypot(...[0, 1, 2].map((k) => f[12 * b + k] - first[12 * b + k])));
    const turned = data.turned.map((row) => row[b]), span = data.at[last] - data.at[0] || 1, left = 8, right = width - 8;
    const x = (k) => left + (right - left) * (data.at[k] - data.at[0]) / span;
    const line = (values, most, colour) => {
      pen.beginPath();
      values.forEach((v, k) => { const y = 138 - 112 * (most > 0 ? v / most : 0); if (k) pen.lineTo(x(k), y); else pen.moveTo(x(k), y); });
      pen.strokeStyle = colour; pen.lineWidth = 1.4; pen.stroke();
    };
    const most = [Math.max(...away), Math.max(...turned)];
    pen.strokeStyle = "#C9C4BA"; pen.lineWidth = 1; pen.strokeRect(left, 20, right - left, 120);
    line(away, most[0], "#8C4A1F"); line(turned, most[1], "#2F5D8A");
    pen.beginPath(); pen.moveTo(x(now), 20); pen.lineTo(x(now), 140); pen.strokeStyle = "#5B5346"; pen.stroke();
    pen.font = "12px sans-serif";
    pen.fillStyle = "#8C4A1F"; pen.fillText(`${say("moved")}: ${told(away[now])} mm, ${say("at most")} ${told(most[0])} mm`, left, 14);
    const text = `${say("turned")}: ${told(turned[now])}°, ${say("at most")} ${told(most[1])}°`;
    pen.fillStyle = "#2F5D8A"; pen.fillText(text, right - pen.measureText(text).width, 14);
    picked.value = String(b);
  }

  function step(time) {
    if (!playing) return;
    const at = from + (time - begun) / 1000 * data.rate * Number(speed.value);
    if (at >= data.at[last]) { now = last; stop(); draw(); return; }
    let k = now;
    while (k < last && data.at[k + 1] <= at) k++;
    if (k !== now) { now = k; draw(); }
    window.requestAnimationFrame(step);
  }
  const stop = () => { playing = false; button.textContent = say("Play"); button.setAttribute("aria-pressed", "false"); };
  const start = () => window.requestAnimationFrame((time) => { begun = time; from = data.at[now]; step(time); });
  button.addEventListener("click", () => {
    if (playing) { stop(); return; }
    if (now === last) now = 0;
    playing = true; button.textContent = say("Pause"); button.setAttribute("aria-pressed", "true");
    start();
  });
  speed.addEventListener("change", () => { if (playing) { playing = false; window.requestAnimationFrame(() => { playing = true; start(); }); } });
  slider.max = String(last);
  slider.addEventListener("input", () => { stop(); now = Number(slider.value); draw(); });
  bodies.forEach((body, b) => {
    if (body.kind === "fixed") return;
    const option = document.createElement("option");
    option.value = String(b); option.textContent = body.name; picked.append(option);
  });
  picked.addEventListener("change", () => { chosen = Number(picked.value); draw(); });
  let held = null, moved = false;
  canvas.addEventListener("pointerdown", (e) => { held = [e.clientX, e.clientY]; moved = false; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener("pointermove", (e) => {
    if (!held) return;
    const [dx, dy] = [e.clientX - held[0], e.clientY - held[1]];
    if (Math.hypot(dx, dy) > 3) moved = true;
    if (!moved) return;
    turn -= 0.008 * dx; lift = Math.max(-0.2, Math.min(1.57, lift + 0.008 * dy)); held = [e.clientX, e.clientY]; draw();
  });
  canvas.addEventListener("pointerup", (e) => {
    if (!moved && held) {
      const box = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1, pen = canvas.getContext("2d");
      const hit = [...shapes].reverse().find((one) => pen.isPointInPath(one.path, (e.clientX - box.left) * ratio, (e.clientY - box.top) * ratio));
      if (hit && bodies[hit.b].kind !== "fixed") { chosen = hit.b; draw(); }
    }
    held = null;
  });
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); near *= Math.exp(-0.001 * e.deltaY); draw(); }, {passive: false});
  window.addEventListener("resize", draw);
  draw();
})();
