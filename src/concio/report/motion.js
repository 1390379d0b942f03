"use strict";
// Plays the frames of a motion on a canvas: bodies true to scale, a slider, a button. No library.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const say = (word) => (data.said || {})[word] ?? word;
  const canvas = document.getElementById("film");
  const slider = document.getElementById("frame");
  const button = document.getElementById("play");
  const word = document.getElementById("word");
  const [low, high] = data.box;
  const colours = {elastic: "#DCC9A3", rigid: "#C9CDD2", fixed: "#EEEAE2"};
  let now = 0, playing = false, begun = 0, from = 0;

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth;
    const scale = width / (high[0] - low[0]);
    const height = Math.max(120, Math.min((high[1] - low[1]) * scale, 0.6 * window.innerHeight));
    const size = Math.min(scale, height / (high[1] - low[1]));
    canvas.style.height = `${height}px`;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const left = (width - (high[0] - low[0]) * size) / 2;
    const x = (v) => left + (v - low[0]) * size;
    const y = (v) => height - (v - low[1]) * size;
    const bodies = data.frames[now];
    for (const fixed of [true, false]) {
      for (let b = 0; b < bodies.length; b++) {
        if ((data.kinds[b] === "fixed") !== fixed) continue;
        pen.beginPath();
        for (const ring of bodies[b]) {
          for (let i = 0; i < ring.length; i += 2) {
            if (i === 0) pen.moveTo(x(ring[0]), y(ring[1])); else pen.lineTo(x(ring[i]), y(ring[i + 1]));
          }
          pen.closePath();
        }
        pen.fillStyle = colours[data.kinds[b]];
        pen.fill("evenodd");
        pen.lineWidth = fixed ? 0.6 : 0.9;
        pen.strokeStyle = fixed ? "#B9B2A4" : "#5B5346";
        pen.stroke();
      }
    }
    word.textContent = data.words[now];
    slider.value = String(now);
  }

  function step(time) {
    if (!playing) return;
    const at = from + (time - begun) / 1000 * data.rate;
    if (at >= data.at[data.at.length - 1]) { now = data.at.length - 1; stop(); draw(); return; }
    while (now + 1 < data.at.length && data.at[now + 1] <= at) now++;
    draw();
    window.requestAnimationFrame(step);
  }

  function stop() { playing = false; button.textContent = say("Play"); button.setAttribute("aria-pressed", "false"); }

  button.addEventListener("click", () => {
    if (playing) { stop(); return; }
    if (now === data.at.length - 1) now = 0;
    playing = true;
    button.textContent = say("Pause");
    button.setAttribute("aria-pressed", "true");
    window.requestAnimationFrame((time) => { begun = time; from = data.at[now]; step(time); });
  });
  slider.max = String(data.frames.length - 1);
  slider.addEventListener("input", () => { stop(); now = Number(slider.value); draw(); });
  window.addEventListener("resize", draw);
  draw();
})();
