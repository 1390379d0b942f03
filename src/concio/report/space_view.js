/* The view in space of a report: WebGL, typed arrays, no library. Lengths in m, forces in kN. */
(() => {
  const { $, unpack, unpacked, data, say, written } = base;
  const look = data.look, bodies = unpacked(data.bodies), pieces = unpacked(data.pieces), joints = unpacked(data.joints), ties = unpacked(data.ties);
  const steps = data.steps.map(() => null);
  const stepAt = (k) => (steps[k] ??= stepOf(unpacked(data.steps[k])));
  const count = bodies.name.length, triangles = bodies.owner.length, cells = pieces.pair.length;
  const pairFace = unpack(data.pairs.face);
  pieces.face = pieces.pair.map((p) => pairFace[p]);
  /* a step: numbers of pairs spread over the pieces they are drawn with, faces of joints moved with their two bodies */
  function stepOf(found) {
    for (const key of ["state", "gap", "slip", "pressure"]) {
      const values = found[key];
      if (values && values.length === pairFace.length && found.pressure) { found[key] = new values.constructor(cells); for (let k = 0; k < cells; k++) found[key][k] = values[pieces.pair[k]]; }
    }
    for (const side of ["a", "b"]) {
      const moves = new Float32Array(9 * cells);
      for (let k = 0; k < cells; k++) {
        const b = joints[side][pieces.face[k]], m = 6 * b;
        for (let v = 9 * k; v < 9 * k + 9; v += 3) {
          const [x, y, z] = [0, 1, 2].map((c) => pieces.corner[v + c] - bodies.centre[3 * b + c]), [p, q, r] = [3, 4, 5].map((c) => found.motion[m + c]);
          moves[v] = found.motion[m] + q * z - r * y; moves[v + 1] = found.motion[m + 1] + r * x - p * z; moves[v + 2] = found.motion[m + 2] + p * y - q * x;
        }
      }
      found[`moved_${side}`] = moves;
    }
    return found;
  }
  const STATES = ["open", "sticks", "slips", "is crushed"].map(say), STATE_LOOK = ["open", "stick", "slip", "crushed"];
  const view = {
    turn: -0.7, lift: 0.45, x: 0, y: 0, z: 0, distance: 1, scale: data.scale, step: data.steps.length - 1, colour: "none",
    joints: true, forces: false, crosses: false, solid: 1, cut: [1, 1, 1], picked: null, playing: false, phase: 1,
  };
  const canvas = $("canvas");
  const gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) { $("no-webgl").hidden = false; canvas.hidden = true; return; }
  let step, shade = null, range = [0, 1], width = 1, height = 1, waiting = false;

  /* numbers, as in the plane */
  const digits = (v, beside = 0) => {
    if (!Number.isFinite(v)) return "–";
    const size = Math.abs(v);
    if (v === 0 || size <= 1e-6 * beside) return "0";
    if (size < 1e-4) return written(v.toExponential(2));
    const short = Number(v.toPrecision(4));
    return size >= 1e4 ? short.toLocaleString(document.documentElement.lang, { maximumFractionDigits: 0 }) : written(String(short));
  };
  const told = (v, kind, beside = 0) => {
    const [factor, symbol] = data.units[kind] || [1, kind];
    return `${digits(factor * v, factor * beside)} ${symbol}`;
  };

  /* colours */
  const RAMP = ["#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#fee838"];
  const parse = (c) => [1, 3, 5].map((i) => parseInt(c.slice(i, i + 2), 16) / 255);
  const ramp = (f) => {
    const at = Math.max(0, Math.min(1, f)) * (RAMP.length - 1), i = Math.min(Math.floor(at), RAMP.length - 2), g = at - i;
    const a = parse(RAMP[i]), b = parse(RAMP[i + 1]);
    return a.map((v, j) => v + g * (b[j] - v));
  };

  /* programs */
  const HEAD = `precision highp float;
    uniform mat4 matrix; uniform float scale; uniform vec3 cut_at; uniform vec3 cut_side;`;
  const BODY = [`${HEAD} attribute vec3 point, move, normal, colour; varying vec3 place, tone, up;
    void main() { place = point + scale * move; tone = colour; up = normal; gl_Position = matrix * vec4(place, 1.0); }`,
  `${HEAD} uniform vec3 light; uniform float alpha; uniform float lit; varying vec3 place, tone, up;
    void main() {
      if (any(greaterThan((place - cut_at) * cut_side, vec3(0.0)))) discard;
      float bright = mix(1.0, 0.62 + 0.38 * abs(dot(normalize(up), light)), lit);
      gl_FragColor = vec4(tone * bright, alpha);
    }`];
  /* a line is a strip as wide as it is asked for, whatever the distance; it comes nearer to the eye by "pull" [m], so that
     the edges of a block win over its own faces, and no edge farther away shines through them */
  const LINE = [`${HEAD} attribute vec3 point, move, other, other_move, colour; attribute float side;
    uniform vec2 size; uniform float wide; uniform float pull; uniform vec3 eye; varying vec3 place, tone;
    void main() {
      place = point + scale * move; tone = colour;
      vec4 p = matrix * vec4(place, 1.0), q = matrix * vec4(other + scale * other_move, 1.0);
      vec2 along = (q.xy / q.w - p.xy / p.w) * size;
      float far = length(along);
      vec2 across = far > 1e-9 ? vec2(-along.y, along.x) / far : vec2(0.0);
      vec4 nearer = matrix * vec4(place + pull * eye, 1.0);
      p.xy += across * side * wide / size * p.w; if (nearer.w > 0.0) p.z = nearer.z / nearer.w * p.w; gl_Position = p;
    }`,
  `${HEAD} varying vec3 place, tone;
    void main() { if (any(greaterThan((place - cut_at) * cut_side, vec3(0.0)))) discard; gl_FragColor = vec4(tone, 1.0); }`];
  const program = ([vertex, fragment]) => {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text); gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    const places = {};
    for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); i++) {
      const name = gl.getActiveUniform(made, i).name; places[name] = gl.getUniformLocation(made, name);
    }
    const inputs = {};
    for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_ATTRIBUTES); i++) {
      const name = gl.getActiveAttrib(made, i).name; inputs[name] = gl.getAttribLocation(made, name);
    }
    return { made, places, inputs };
  };
  const solid = program(BODY), line = program(LINE);

  /* a mesh: named arrays, as many entries as vertices */
  function mesh(vertices) { return { vertices, arrays: {} }; }
  function put(m, name, array, size) {
    const entry = m.arrays[name] ??= { buffer: gl.createBuffer(), size };
    gl.bindBuffer(gl.ARRAY_BUFFER, entry.buffer); gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
  }
  function paint(p, m, uniforms) {
    gl.useProgram(p.made);
    for (const [name, value] of Object.entries(uniforms)) {
      const at = p.places[name];
      if (at === undefined) continue;
      if (typeof value === "number") gl.uniform1f(at, value);
      else if (value.length === 16) gl.uniformMatrix4fv(at, false, value);
      else if (value.length === 2) gl.uniform2fv(at, value);
      else gl.uniform3fv(at, value);
    }
    for (const [name, at] of Object.entries(p.inputs)) {
      const entry = m.arrays[name];
      gl.bindBuffer(gl.ARRAY_BUFFER, entry.buffer); gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, entry.size, gl.FLOAT, false, 0, 0);
    }
    gl.drawArrays(gl.TRIANGLES, 0, m.vertices);
    for (const at of Object.values(p.inputs)) gl.disableVertexAttribArray(at);
  }

  /* blocks */
  const blocks = mesh(3 * triangles), edges = mesh(6 * bodies.edge_owner.length), faces = mesh(6 * cells);
  let forces = mesh(0), crosses = mesh(0), bars = mesh(0);
  const spread = (array, index, size) => {
    const out = new Float32Array(index.length * size);
    for (let i = 0; i < index.length; i++) for (let j = 0; j < size; j++) out[size * i + j] = array[size * index[i] + j];
    return out;
  };
  const flatNormals = (p) => {
    const out = new Float32Array(p.length);
    for (let i = 0; i < p.length; i += 9) {
      const u = [p[i + 3] - p[i], p[i + 4] - p[i + 1], p[i + 5] - p[i + 2]], v = [p[i + 6] - p[i], p[i + 7] - p[i + 1], p[i + 8] - p[i + 2]];
      const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], l = Math.hypot(...n) || 1;
      for (let k = 0; k < 9; k++) out[i + k] = n[k % 3] / l;
    }
    return out;
  };
  const identity = (start, total) => {
    const out = new Float32Array(3 * total);
    for (let i = 0; i < total; i++) { const id = start + i; out.set([(id & 255) / 255, ((id >> 8) & 255) / 255, ((id >> 16) & 255) / 255], 3 * i); }
    return out;
  };
  const thrice = (colours, owners) => {
    const out = new Float32Array(9 * owners.length);
    for (let i = 0; i < owners.length; i++) for (let k = 0; k < 3; k++) out.set(colours.subarray(3 * owners[i], 3 * owners[i] + 3), 9 * i + 3 * k);
    return out;
  };
  const corners = spread(bodies.point, bodies.triangle, 3);
  put(blocks, "point", corners, 3); put(blocks, "normal", flatNormals(corners), 3);
  const names = identity(1, count), cellIndex = Int32Array.from({ length: cells }, (_, k) => k);
  const blockNames = thrice(names, bodies.owner);
  /* a piece of a joint is drawn on the faces of both its blocks: closed they are one, open they face each other */
  const both = (array) => { const out = new Float32Array(2 * array.length); out.set(array); out.set(array, array.length); return out; };
  const cellNames = both(thrice(identity(1 + count, cells), cellIndex));
  put(faces, "point", both(pieces.corner), 3); put(faces, "normal", both(flatNormals(pieces.corner)), 3);
  /* each line is two triangles: begin, end, begin | begin, end, end */
  const ENDS = [0, 1, 0, 0, 1, 1], SIDES = [-1, 1, 1, 1, 1, -1];
  function strips(m, points, moves, colours) {
    const n = points.length / 6, at = (a, e) => { const o = new Float32Array(18 * n); for (let i = 0; i < n; i++) for (let k = 0; k < 6; k++) { const f = 6 * i + 3 * (e ? 1 - ENDS[k] : ENDS[k]); o.set(a.subarray(f, f + 3), 18 * i + 3 * k); } return o; };
    const tone = new Float32Array(18 * n), side = new Float32Array(6 * n);
    for (let i = 0; i < n; i++) for (let k = 0; k < 6; k++) { tone.set(colours.subarray(3 * i, 3 * i + 3), 18 * i + 3 * k); side[6 * i + k] = ENDS[k] ? -SIDES[k] : SIDES[k]; }
    m.vertices = 6 * n;
    put(m, "point", at(points, false), 3); put(m, "other", at(points, true), 3); put(m, "move", at(moves, false), 3);
    put(m, "other_move", at(moves, true), 3); put(m, "colour", tone, 3); put(m, "side", side, 1);
  }

  function placeBlocks() {
    put(blocks, "move", spread(step.move, bodies.triangle, 3), 3);
    const edgeTone = new Float32Array(3 * bodies.edge_owner.length), tone = parse(look.edge);
    for (let i = 0; i < bodies.edge_owner.length; i++) edgeTone.set(tone, 3 * i);
    strips(edges, spread(bodies.point, bodies.edge, 3), spread(step.move, bodies.edge, 3), edgeTone);
    const sides = both(step.moved_a);
    sides.set(step.moved_b, step.moved_b.length);
    put(faces, "move", sides, 3);
    const tones = new Float32Array(3 * cells);
    for (let k = 0; k < cells; k++) tones.set(parse(look[STATE_LOOK[step.state ? step.state[k] : 1]]), 3 * k);
    if (view.colour === "pressure" && step.pressure) {
      let most = 0; for (const v of step.pressure) if (v > most) most = v;
      for (let k = 0; k < cells; k++) tones.set(step.state[k] === 0 ? parse(look.open) : Number.isFinite(step.pressure[k]) ? ramp(1 - step.pressure[k] / (most || 1)) : parse(look.stick), 3 * k);
    }
    faces.tones = both(thrice(tones, cellIndex));
  }
  function placeForces() {
    const lines = [], moves = [], tones = [];
    if (step.force) {
      let most = 0; const n = step.N.length, size = (j) => Math.hypot(step.force[3 * j], step.force[3 * j + 1], step.force[3 * j + 2]);
      for (let j = 0; j < n; j++) most = Math.max(most, size(j));
      const reach = 0.6 * typical, tone = parse(look.compression), pull = parse(look.tension);
      for (let j = 0; j < n; j++) {
        const s = size(j); if (!(s > 1e-3 * most)) continue;
        for (const sign of [-1, 1]) {
          for (let e = 0; e < 2; e++) for (let c = 0; c < 3; c++) lines.push(step.at[3 * j + c] + e * sign * reach * step.force[3 * j + c] / most);
          const m = motionAt(joints.a[j], step.at.subarray(3 * j, 3 * j + 3)); moves.push(...m, ...m);
          tones.push(...(step.N[j] >= 0 ? tone : pull));
        }
      }
    }
    forces = mesh(0); strips(forces, Float32Array.from(lines), Float32Array.from(moves), Float32Array.from(tones));
  }
  /* ties, carried along by the bodies that they are fixed to */
  function placeTies() {
    const count = ties.name.length, moves = new Float32Array(6 * count), tones = new Float32Array(3 * count);
    for (let k = 0; k < 2 * count; k++) if (ties.body[k] >= 0) moves.set(motionAt(ties.body[k], ties.end.subarray(3 * k, 3 * k + 3)), 3 * k);
    for (let k = 0; k < count; k++) tones.set(parse(look.tension), 3 * k);
    bars = mesh(0); strips(bars, ties.end, moves, tones);
  }
  function placeCrosses() {
    const lines = [], moves = [], tones = [];
    if (step.stress) {
      let most = 0; for (const v of step.stress) if (Number.isFinite(v)) most = Math.max(most, Math.abs(v));
      for (let b = 0; b < count; b++) for (let k = 0; k < 3; k++) {
        const v = step.stress[3 * b + k]; if (!(Math.abs(v) > 0.01 * most)) continue;
        const half = 0.5 * typical * Math.abs(v) / most;
        for (const e of [-1, 1]) for (let c = 0; c < 3; c++) lines.push(bodies.centre[3 * b + c] + e * half * step.axes[9 * b + 3 * k + c]);
        const m = step.motion.subarray(6 * b, 6 * b + 3); moves.push(...m, ...m);
        tones.push(...parse(v < 0 ? look.compression : look.tension));
      }
    }
    crosses = mesh(0); strips(crosses, Float32Array.from(lines), Float32Array.from(moves), Float32Array.from(tones));
  }
  function motionAt(b, p) {
    const m = step.motion, r = [0, 1, 2].map((c) => p[c] - bodies.centre[3 * b + c]), w = [m[6 * b + 3], m[6 * b + 4], m[6 * b + 5]];
    return [m[6 * b] + w[1] * r[2] - w[2] * r[1], m[6 * b + 1] + w[2] * r[0] - w[0] * r[2], m[6 * b + 2] + w[0] * r[1] - w[1] * r[0]];
  }
  const free = [];
  for (let b = 0; b < count; b++) if (bodies.kind[b] !== "fixed") free.push(Math.cbrt(bodies.volume[b]));
  free.sort((a, b) => a - b);
  const typical = free[Math.floor(0.75 * (free.length - 1))] || data.size / 10;

  /* colours of blocks */
  const WORDS = { s1: say("largest principal stress"), s3: say("smallest principal stress"), move: say("displacement"), pressure: say("contact pressure") };
  const KINDS = { s1: "stress", s3: "stress", move: "motion", pressure: "stress" };
  function recolour() {
    const pick = view.colour;
    shade = null;
    if (pick === "move") shade = Float64Array.from({ length: count }, (_, b) => Math.hypot(step.motion[6 * b], step.motion[6 * b + 1], step.motion[6 * b + 2]));
    if ((pick === "s1" || pick === "s3") && step.stress) shade = Float64Array.from({ length: count }, (_, b) => step.stress[3 * b + (pick === "s1" ? 0 : 2)]);
    if (pick === "pressure" && step.pressure) shade = step.pressure;
    range = [Infinity, -Infinity];
    if (shade) for (const v of shade) if (Number.isFinite(v)) { range[0] = Math.min(range[0], v); range[1] = Math.max(range[1], v); }
    if (!(range[0] < range[1])) range = [Number.isFinite(range[0]) ? range[0] : 0, (Number.isFinite(range[0]) ? range[0] : 0) + 1];
    const tones = new Float32Array(3 * count);
    for (let b = 0; b < count; b++) {
      let tone = parse(look[bodies.kind[b]] || look.block);
      const v = shade && pick !== "pressure" ? shade[b] : NaN;
      if (Number.isFinite(v) && bodies.kind[b] !== "fixed") { const f = (v - range[0]) / (range[1] - range[0]); tone = ramp(pick === "s3" ? f : 1 - f); }
      if (view.picked && view.picked.body === b) tone = [1, 0.93, 0.55];
      tones.set(tone, 3 * b);
    }
    put(blocks, "colour", thrice(tones, bodies.owner), 3);
    legend();
  }
  function legend() {
    const parts = [];
    if (shade) {
      const steps = Array.from({ length: 9 }, (_, i) => `rgb(${ramp(view.colour === "s3" ? i / 8 : 1 - i / 8).map((c) => Math.round(255 * c)).join()})`);
      parts.push(`<span class="bar" style="background:linear-gradient(90deg,${steps.join()})"></span>${told(range[0], KINDS[view.colour])} ${say("to")} ${told(range[1], KINDS[view.colour])}, ${WORDS[view.colour]}`);
    }
    if (view.joints && step.state) {
      const held = new Set(step.state), words = data.mechanism && !step.pressure ? ["opens", "stays closed", "slides", "is crushed"].map(say) : STATES;
      for (const k of [0, 1, 2, 3]) if (held.has(k)) parts.push(`<span class="key" style="background:${look[STATE_LOOK[k]]}"></span>${say("joint")} ${words[k]}`);
    }
    if (view.crosses || view.forces) parts.push(`<span class="key" style="background:${look.compression}"></span>${say("compression")} <span class="key" style="background:${look.tension}"></span>${say("tension")}`);
    if (ties.name.length) parts.push(`<span class="key" style="background:${look.tension}"></span>${say("tie")}`);
    $("legend").innerHTML = parts.map((p) => `<span>${p}</span>`).join(" ");
  }

  /* camera */
  const multiply = (a, b) => { const o = new Float32Array(16); for (let i = 0; i < 4; i++) for (let j = 0; j < 4; j++) { let s = 0; for (let k = 0; k < 4; k++) s += a[4 * k + j] * b[4 * i + k]; o[4 * i + j] = s; } return o; };
  function axes() {
    const ct = Math.cos(view.turn), st = Math.sin(view.turn), cl = Math.cos(view.lift), sl = Math.sin(view.lift);
    return { right: [ct, st, 0], up: [-st * sl, ct * sl, cl], back: [st * cl, -ct * cl, sl] };
  }
  function camera() {
    const { right, up, back } = axes(), far = 6 * data.size + view.distance, near = view.distance / 200, f = 2.4;
    const eye = [0, 1, 2].map((c) => [view.x, view.y, view.z][c] + back[c] * view.distance);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const look = new Float32Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
    const aspect = width / height;
    const lens = new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0]);
    return multiply(lens, look);
  }
  /* all that is shown, moved as it is shown, fills the picture and stands in its middle */
  function fit() {
    const { right, up, back } = axes(), n = bodies.point.length, s = view.scale;
    const along = (i, d) => (bodies.point[i] + s * step.move[i]) * d[0] + (bodies.point[i + 1] + s * step.move[i + 1]) * d[1] + (bodies.point[i + 2] + s * step.move[i + 2]) * d[2];
    const middle = [right, up].map((d) => {
      let low = Infinity, high = -Infinity;
      for (let i = 0; i < n; i += 3) { const v = along(i, d); low = Math.min(low, v); high = Math.max(high, v); }
      return (low + high) / 2;
    });
    [view.x, view.y, view.z] = [0, 1, 2].map((c) => middle[0] * right[c] + middle[1] * up[c]);
    const aspect = width / height;
    let far = 0;
    for (let i = 0; i < n; i += 3) {
      const reach = Math.max(Math.abs(along(i, right) - middle[0]) / aspect, Math.abs(along(i, up) - middle[1]));
      far = Math.max(far, along(i, back) + 2.4 * 1.06 * reach);
    }
    view.distance = far || data.size;
  }

  /* drawing */
  const common = () => {
    const { back, up } = axes();
    return {
      matrix: camera(), scale: view.scale * view.phase, size: [width, height],
      cut_at: [0, 1, 2].map((c) => data.low[c] + view.cut[c] * (data.high[c] - data.low[c])), cut_side: view.cut.map((v) => (v < 1 ? 1 : 0)),
      light: [0, 1, 2].map((c) => 0.8 * back[c] + 0.6 * up[c]), eye: back,
    };
  };
  const draw = () => { if (!waiting) { waiting = true; requestAnimationFrame(() => { waiting = false; render(); }); } };
  function render() {
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(1, 1, 1, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT); gl.enable(gl.DEPTH_TEST);
    const u = common();
    if (view.joints) { put(faces, "colour", faces.tones, 3); paint(solid, faces, { ...u, alpha: 1, lit: 0 }); }
    if (view.crosses && crosses.vertices) paint(line, crosses, { ...u, wide: 2.6, pull: 0 });
    if (view.forces && forces.vertices) paint(line, forces, { ...u, wide: 3, pull: 0 });
    if (bars.vertices) paint(line, bars, { ...u, wide: 2.6, pull: 0 });
    const glass = view.solid < 1;
    if (glass) { gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA); gl.depthMask(false); }
    if (view.solid > 0) { gl.enable(gl.POLYGON_OFFSET_FILL); gl.polygonOffset(1.5, 2); paint(solid, blocks, { ...u, alpha: view.solid, lit: 1 }); gl.disable(gl.POLYGON_OFFSET_FILL); }
    if (glass) { gl.depthMask(true); gl.disable(gl.BLEND); }
    paint(line, edges, { ...u, wide: count > 1500 ? 0.8 : 1.3, pull: 2e-3 * typical });
    triad();
  }
  function triad() {
    const { right, up } = axes(), pen = $("triad").getContext("2d"), s = 26;
    pen.clearRect(0, 0, 80, 80); pen.lineWidth = 2; pen.font = "12px system-ui";
    [["x", "#B33"], ["y", "#2A2"], ["z", "#33B"]].forEach(([name, colour], c) => {
      const x = 40 + s * right[c], y = 40 - s * up[c];
      pen.strokeStyle = pen.fillStyle = colour; pen.beginPath(); pen.moveTo(40, 40); pen.lineTo(x, y); pen.stroke();
      pen.fillText(name, 40 + 1.3 * (x - 40) - 3, 40 + 1.3 * (y - 40) + 4);
    });
  }

  /* picking: everything drawn once more, its number as its colour */
  function pick(px, py) {
    const ratio = canvas.width / width, target = gl.createFramebuffer(), texture = gl.createTexture(), depth = gl.createRenderbuffer();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, canvas.width, canvas.height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    gl.bindRenderbuffer(gl.RENDERBUFFER, depth); gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT16, canvas.width, canvas.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    gl.viewport(0, 0, canvas.width, canvas.height); gl.clearColor(0, 0, 0, 0); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT); gl.enable(gl.DEPTH_TEST);
    const u = { ...common(), alpha: 1, lit: 0 };
    const shown = blocks.arrays.colour;
    blocks.arrays.colour = null; put(blocks, "colour", blockNames, 3);
    if (view.solid > 0.5) paint(solid, blocks, u);
    gl.deleteBuffer(blocks.arrays.colour.buffer); blocks.arrays.colour = shown;
    if (view.joints) { put(faces, "colour", cellNames, 3); paint(solid, faces, u); }
    else if (view.solid <= 0.5) { blocks.arrays.colour = null; put(blocks, "colour", blockNames, 3); paint(solid, blocks, u); gl.deleteBuffer(blocks.arrays.colour.buffer); blocks.arrays.colour = shown; }
    const pixel = new Uint8Array(4);
    gl.readPixels(Math.round(px * ratio), Math.round(canvas.height - py * ratio), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null); gl.deleteFramebuffer(target); gl.deleteTexture(texture); gl.deleteRenderbuffer(depth);
    const id = pixel[0] + 256 * pixel[1] + 65536 * pixel[2];
    if (!id) return null;
    return id <= count ? { body: id - 1 } : { cell: id - 1 - count };
  }
  function describe() {
    const p = view.picked, info = $("info");
    const text = (s) => { const d = document.createElement("span"); d.textContent = s; return d.innerHTML; };
    if (!p) { info.textContent = say("Click a block or a joint to read its numbers."); return; }
    const answer = !!step.pressure, rows = [];
    if (p.body !== undefined) {
      const b = p.body, m = step.motion.subarray(6 * b, 6 * b + 6);
      rows.push(`<b>${text(bodies.name[b])}</b> (${say(bodies.kind[b])}), ${say("volume")} ${digits(bodies.volume[b])} m³`);
      const kind = answer ? "motion" : say("m (direction only)");
      rows.push(`${say("moves")} x ${told(m[0], kind)}, y ${told(m[1], kind)}, z ${told(m[2], kind)}`);
      rows.push(`${say("turns about")} x ${digits(m[3])}, y ${digits(m[4])}, z ${digits(m[5])} rad`);
      if (step.stress && Number.isFinite(step.stress[3 * b])) rows.push(`${say("mean principal stresses")} ${[0, 1, 2].map((k) => told(step.stress[3 * b + k], "stress")).join(", ")}`);
    } else {
      const k = p.cell, j = pieces.face[k], pair = pieces.pair[k];
      rows.push(`${say("joint")} <b>${text(bodies.name[joints.a[j]])}</b> | <b>${text(bodies.name[joints.b[j]])}</b>, ${digits(joints.area[j])} m²`);
      if (answer) {
        rows.push(`N ${told(step.N[j], "force")}, V ${told(step.V[j], "force")}, ${digits(100 * step.open_share[j])} % ${say("open")}`);
        rows.push(`${say("contact point")} ${pair}: ${STATES[step.state[k]]}, ${say("pressure")} ${told(step.pressure[k], "stress")}, ${say("gap")} ${told(step.gap[k], "motion")}, ${say("slip")} ${told(step.slip[k], "motion")}`);
      } else if (step.state) rows.push(say(["opens", "stays closed", "slides"][step.state[k]]));
    }
    info.innerHTML = rows.join("<br>");
  }

  /* hands: one finger or button turns, two fingers or the right button move, ctrl and wheel, and pinch, come nearer */
  const fingers = new Map();
  let moved = 0;
  const shift = (dx, dy) => {
    const { right, up } = axes(), s = view.distance / (2.4 * height) * 2;
    view.x -= s * (dx * right[0] - dy * up[0]); view.y -= s * (dx * right[1] - dy * up[1]); view.z -= s * (dx * right[2] - dy * up[2]);
  };
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); fingers.set(e.pointerId, [e.offsetX, e.offsetY, e.button]); moved = 0; });
  canvas.addEventListener("pointermove", (e) => {
    const was = fingers.get(e.pointerId);
    if (!was) return;
    const dx = e.offsetX - was[0], dy = e.offsetY - was[1];
    moved += Math.abs(dx) + Math.abs(dy);
    if (fingers.size === 2) {
      const other = [...fingers].find(([id]) => id !== e.pointerId)[1];
      const before = Math.hypot(was[0] - other[0], was[1] - other[1]), after = Math.hypot(e.offsetX - other[0], e.offsetY - other[1]);
      if (before > 0 && after > 0) view.distance *= before / after;
      shift(dx / 2, dy / 2);
    } else if (was[2] === 2 || e.shiftKey) shift(dx, dy);
    else { view.turn -= 0.008 * dx; view.lift = Math.max(-1.57, Math.min(1.57, view.lift + 0.008 * dy)); }
    fingers.set(e.pointerId, [e.offsetX, e.offsetY, was[2]]);
    draw();
  });
  function choose(picked) {
    view.picked = picked; recolour(); describe(); draw();
    const j = picked && picked.body === undefined ? pieces.face[picked.cell] : -1;
    const of = !picked ? [] : j < 0 ? [picked.body] : [joints.a[j], joints.b[j]];
    document.dispatchEvent(new CustomEvent("concio-picked", { detail: of }));
  }
  const lift = (e) => {
    const was = fingers.get(e.pointerId); fingers.delete(e.pointerId);
    if (was && moved < 5 && was[2] !== 2 && e.type === "pointerup") choose(pick(e.offsetX, e.offsetY));
  };
  canvas.addEventListener("pointerup", lift); canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("wheel", (e) => { if (!e.ctrlKey && !e.metaKey) return; e.preventDefault(); view.distance *= Math.exp(0.0012 * e.deltaY); draw(); }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const keys = { ArrowLeft: () => (view.turn += 0.1), ArrowRight: () => (view.turn -= 0.1), ArrowUp: () => (view.lift = Math.min(1.57, view.lift + 0.1)), ArrowDown: () => (view.lift = Math.max(-1.57, view.lift - 0.1)), "+": () => (view.distance *= 0.87), "-": () => (view.distance /= 0.87), f: fit };
    if (keys[e.key]) { keys[e.key](); e.preventDefault(); draw(); }
  });

  /* controls */
  const listen = (id, event, act) => { const e = $(id); if (e) e.addEventListener(event, () => { act(e); draw(); }); };
  const VIEWS = { front: [0, 0], side: [Math.PI / 2, 0], plan: [0, 1.5707], corner: [-0.7, 0.45] };
  for (const [name, [turn, up]] of Object.entries(VIEWS)) listen(`to-${name}`, "click", () => { view.turn = turn; view.lift = up; fit(); });
  listen("zoom-in", "click", () => { view.distance *= 0.8; }); listen("zoom-out", "click", () => { view.distance /= 0.8; }); listen("fit", "click", fit);
  listen("colour", "change", (e) => { view.colour = e.value; if (e.value === "pressure") { view.joints = true; $("states").checked = true; view.solid = Math.min(view.solid, 0.15); $("solid").value = 100 * view.solid; } placeBlocks(); recolour(); });
  listen("states", "change", (e) => { view.joints = e.checked; legend(); });
  listen("forces", "change", (e) => { view.forces = e.checked; legend(); });
  listen("crosses", "change", (e) => { view.crosses = e.checked; legend(); });
  listen("solid", "input", (e) => { view.solid = e.value / 100; });
  ["x", "y", "z"].forEach((name, c) => listen(`cut-${name}`, "input", (e) => { view.cut[c] = e.value / 100; }));
  const scaleText = () => { $("scale-text").textContent = data.mechanism && !step.pressure ? "" : `× ${digits(view.scale)}`; };
  listen("scale", "input", (e) => { view.scale = data.scale * (e.value / 100) ** 2; scaleText(); });
  listen("step", "input", (e) => { view.step = Number(e.value); setStep(); });
  listen("play", "click", (e) => { view.playing = !view.playing; e.textContent = say(view.playing ? "stop" : "play"); if (view.playing) requestAnimationFrame(tick); else { view.phase = 1; } });
  let began = 0;
  function tick(now) {
    if (!view.playing) return;
    began = began || now;
    if (data.steps.length > 1) {
      const k = Math.floor((now - began) / 120) % data.steps.length;
      if (k !== view.step) { view.step = k; $("step").value = k; setStep(); }
    } else view.phase = 0.5 - 0.5 * Math.cos((now - began) / 700);
    render(); requestAnimationFrame(tick);
  }
  function setStep() {
    step = stepAt(view.step); placeBlocks(); placeForces(); placeCrosses(); placeTies(); recolour(); describe(); scaleText();
    if ($("step-text")) $("step-text").textContent = step.label;
  }
  function resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    width = canvas.clientWidth; height = canvas.clientHeight;
    canvas.width = Math.max(1, Math.round(width * ratio)); canvas.height = Math.max(1, Math.round(height * ratio));
    draw();
  }

  $("step-label").hidden = data.steps.length < 2;
  $("step").max = data.steps.length - 1; $("step").value = view.step;
  $("states").checked = view.joints;
  const mostStress = stepAt(view.step).stress ? Math.max(...[0].concat(Array.from(stepAt(view.step).stress).filter(Number.isFinite).map(Math.abs))) : 0;
  for (const name of ["s1", "s3"]) for (const o of $("colour").options) if (o.value === name && !(mostStress > 0)) o.disabled = true;
  for (const o of $("colour").options) if (o.value === "pressure" && !stepAt(view.step).pressure) o.disabled = true;
  $("forces-label").hidden = !stepAt(view.step).force; $("crosses-label").hidden = !(mostStress > 0);
  setStep(); resize(); fit(); draw();
  new ResizeObserver(() => requestAnimationFrame(resize)).observe(canvas);
  window.concioNames = { names: bodies.name, choose: (body) => choose({ body }), node: canvas };
  window.concioView = { view, draw, pick, render, fit, setStep };
})();
