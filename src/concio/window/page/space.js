/* Blocks in space: WebGL with parallel lines of sight; what is clicked is found by rays, with the point and the face. */
const LENGTHS = { front: [0, 0], side: [Math.PI / 2, 0], plan: [0, Math.PI / 2 - 1e-4], corner: [-0.7, 0.45] };
export const camera = { turn: -0.7, lift: 0.45, centre: [0, 0, 0], unit: 0.01, size: [1, 1], cut: { axis: 2, share: 1, sign: 1 } };
const TONES = { block: [0.953, 0.933, 0.894], rigid: [0.894, 0.894, 0.894], fixed: [0.79, 0.77, 0.73], mortar: [0.867, 0.835, 0.776] };
let model = null, gl = null, programs = null, buffers = null, canvas = null;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

export function axes() {
  const ct = Math.cos(camera.turn), st = Math.sin(camera.turn), cl = Math.cos(camera.lift), sl = Math.sin(camera.lift);
  return { right: [ct, st, 0], up: [-st * sl, ct * sl, cl], back: [st * cl, -ct * cl, sl] };
}

/* a point of space in pixels of the picture */
export function project(p) {
  const { right, up } = axes(), r = minus(p, camera.centre);
  return [camera.size[0] / 2 + dot(r, right) / camera.unit, camera.size[1] / 2 - dot(r, up) / camera.unit];
}
/* a way of space in pixels, for arrows: shorter where it is seen end on */
export function along(way) { const { right, up } = axes(); return [dot(way, right), -dot(way, up)]; }
export const towards = (way) => dot(way, axes().back);

export function look(name) { [camera.turn, camera.lift] = LENGTHS[name]; }
export function turn(dx, dy) { camera.turn -= 0.008 * dx; camera.lift = Math.max(-1.57, Math.min(1.57, camera.lift + 0.008 * dy)); }
export function shift(dx, dy) {
  const { right, up } = axes();
  camera.centre = camera.centre.map((v, k) => v - camera.unit * (dx * right[k] - dy * up[k]));
}

export function fitSpace(shown) {
  const { right, up, back } = axes(), points = shown.bodies.flatMap((b) => b.vertices || []);
  const range = (d) => points.reduce(([low, high], p) => { const v = dot(p, d); return [Math.min(low, v), Math.max(high, v)]; }, [Infinity, -Infinity]);
  const [r, u, b] = [right, up, back].map(range), middle = [r, u, b].map(([low, high]) => (low + high) / 2);
  camera.centre = [0, 1, 2].map((k) => middle[0] * right[k] + middle[1] * up[k] + middle[2] * back[k]);
  camera.unit = Math.max((r[1] - r[0]) / (camera.size[0] || 1), (u[1] - u[0]) / (camera.size[1] || 1), 1e-9) * 1.25;
}

/* --- what is drawn --- */
function program(vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `precision highp float;\n${text}`); gl.compileShader(shader); gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  return made;
}
const VERTEX = `attribute vec3 point, normal, colour; uniform mat4 matrix; varying vec3 place, up, tone;
  void main() { place = point; up = normal; tone = colour; gl_Position = matrix * vec4(point, 1.0); }`;
const FRAGMENT = `varying vec3 place, up, tone; uniform vec3 light, cut; uniform float lit, edge;
  void main() { if (dot(place, cut) > edge) discard; float bright = mix(1.0, 0.6 + 0.4 * abs(dot(normalize(up), light)), lit); gl_FragColor = vec4(tone * bright, 1.0); }`;

export function setModel(shown, into) {
  canvas = into;
  if (!gl) {
    gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
    if (gl) programs = program(VERTEX, FRAGMENT);
  }
  const triangles = [], low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  shown.bodies.forEach((body, index) => {
    for (const p of body.vertices) p.forEach((v, k) => { low[k] = Math.min(low[k], v); high[k] = Math.max(high[k], v); });
    for (const [a, b, c, face] of body.triangles) triangles.push({ index, face, corners: [a, b, c] });
  });
  model = { shown, triangles, low, high };
  pose(null);
}

/* the corners of every body, moved by a rigid motion each: ux, uy, uz, rx, ry, rz about its centroid, times a scale */
export function pose(motion, scale = 1) {
  model.at = model.shown.bodies.map((body, b) => body.vertices.map((p) => {
    if (!motion) return p;
    const m = motion.slice(6 * b, 6 * b + 6).map((v) => scale * v), r = minus(p, body.centre), w = cross(m.slice(3), r);
    return [p[0] + m[0] + w[0], p[1] + m[1] + w[1], p[2] + m[2] + w[2]];
  }));
  for (const one of model.triangles) {
    one.at = one.corners.map((c) => model.at[one.index][c]);
    const n = cross(minus(one.at[1], one.at[0]), minus(one.at[2], one.at[0])), long = Math.hypot(...n) || 1;
    one.normal = n.map((v) => v / long);
  }
  buffers = null;
}
export const cornersOf = (index, face) => model.shown.bodies[index].faces[face].map((v) => model.at[index][v]);
export const middleOf = (points) => [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);

function cut() {
  const { axis, share, sign } = camera.cut, way = [0, 0, 0], reach = model.high[axis] - model.low[axis];
  way[axis] = sign;
  const at = sign > 0 ? model.low[axis] + share * reach : model.high[axis] - share * reach;
  return { way, edge: sign * at + (share >= 1 ? 10 * reach + 1 : 1e-9 * reach) };
}

const toneOf = (body, on) => (on ? [1, 0.87, 0.45] : TONES[body.kind === "fixed" ? "fixed" : body.kind === "rigid" ? "rigid" : body.role === "mortar" ? "mortar" : "block"]);

export function paint(selected, ratio = Math.min(devicePixelRatio || 1, 2)) {
  camera.size = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = Math.max(1, Math.round(camera.size[0] * ratio)); canvas.height = Math.max(1, Math.round(camera.size[1] * ratio));
  if (!gl) return painter(selected, ratio);
  const { right, up, back } = axes(), [w, h] = camera.size, s = 2 / camera.unit, c = camera.centre;
  const deep = 1 / (Math.hypot(...minus(model.high, model.low)) * 2 + Math.hypot(...minus(c, model.low)) + 1e-9);
  const rows = [right.map((v) => v * s / w), up.map((v) => v * s / h), back.map((v) => -v * deep)];
  const matrix = new Float32Array(16);
  rows.forEach((row, i) => { for (let k = 0; k < 3; k++) matrix[4 * k + i] = row[k]; matrix[12 + i] = -dot(row, c); });
  matrix[15] = 1;
  buffers ??= filled();
  tinted(selected);
  gl.viewport(0, 0, canvas.width, canvas.height); gl.clearColor(0, 0, 0, 0); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST); gl.useProgram(programs);
  const place = (name) => gl.getUniformLocation(programs, name), { way, edge } = cut();
  gl.uniformMatrix4fv(place("matrix"), false, matrix); gl.uniform3fv(place("light"), back.map((v, k) => v * 0.8 + up[k] * 0.5 + right[k] * 0.3));
  gl.uniform3fv(place("cut"), way); gl.uniform1f(place("edge"), edge);
  gl.enable(gl.POLYGON_OFFSET_FILL); gl.polygonOffset(1, 1);
  gl.uniform1f(place("lit"), 1); strip(buffers.solid, gl.TRIANGLES);
  gl.disable(gl.POLYGON_OFFSET_FILL);
  gl.uniform1f(place("lit"), 0); strip(buffers.lines, gl.LINES);
}

function filled() {
  const solid = { points: [], normals: [] }, lines = { points: [], normals: [], tones: [] };
  for (const one of model.triangles) for (const p of one.at) { solid.points.push(...p); solid.normals.push(...one.normal); }
  model.shown.bodies.forEach((body, b) => { for (const [i, j] of body.edges) { lines.points.push(...model.at[b][i], ...model.at[b][j]); lines.normals.push(0, 0, 1, 0, 0, 1); lines.tones.push(0.35, 0.32, 0.28, 0.35, 0.32, 0.28); } });
  return { solid: { ...sent(solid.points, solid.normals), tones: null }, lines: { ...sent(lines.points, lines.normals), tones: buffer(lines.tones) } };
}
const sent = (points, normals) => ({ count: points.length / 3, points: buffer(points), normals: buffer(normals) });
function buffer(values) {
  const made = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, made); gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
  return made;
}
function tinted(selected) {
  const tones = model.triangles.flatMap((one) => { const tone = toneOf(model.shown.bodies[one.index], selected.has(one.index)); return [...tone, ...tone, ...tone]; });
  if (buffers.solid.tones) gl.deleteBuffer(buffers.solid.tones);
  buffers.solid.tones = buffer(tones);
}
function strip(set, kind) {
  for (const [name, from] of [["point", set.points], ["normal", set.normals], ["colour", set.tones]]) {
    const at = gl.getAttribLocation(programs, name);
    if (at < 0) continue;
    gl.bindBuffer(gl.ARRAY_BUFFER, from); gl.enableVertexAttribArray(at); gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 0, 0);
  }
  gl.drawArrays(kind, 0, set.count);
}

/* without WebGL: triangles from the farthest to the nearest */
function painter(selected, ratio) {
  const pen = canvas.getContext("2d"), { back } = axes(), { way, edge } = cut();
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const sorted = model.triangles.map((one) => [dot(middleOf(one.at), back), one]).sort((a, b) => a[0] - b[0]);
  for (const [, one] of sorted) {
    if (dot(one.normal, back) < 0 || dot(middleOf(one.at), way) > edge) continue;
    const bright = 0.6 + 0.4 * dot(one.normal, back), tone = toneOf(model.shown.bodies[one.index], selected.has(one.index));
    pen.beginPath();
    one.at.map(project).forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.closePath();
    pen.fillStyle = pen.strokeStyle = `rgb(${tone.map((v) => Math.round(255 * v * bright)).join()})`;
    pen.fill(); pen.stroke();
  }
}

/* what is under a place of the picture [px]: the nearest triangle that is not cut away */
export function hit(x, y) {
  const { right, up, back } = axes(), { way, edge } = cut();
  const a = (x - camera.size[0] / 2) * camera.unit, b = (camera.size[1] / 2 - y) * camera.unit;
  const from = camera.centre.map((v, k) => v + a * right[k] + b * up[k]);
  let best = null;
  for (const one of model.triangles) {
    const [p, q, r] = one.at, e = minus(q, p), f = minus(r, p), h = cross(back, f), det = dot(e, h);
    if (Math.abs(det) < 1e-18) continue;
    const s = minus(from, p), u = dot(s, h) / det, k = cross(s, e), v = dot(back, k) / det;
    if (u < 0 || v < 0 || u + v > 1) continue;
    const depth = -dot(f, k) / det, at = from.map((c, i) => c - depth * back[i]);
    if (dot(at, way) > edge || (best && depth >= best.depth)) continue;
    best = { depth, index: one.index, face: one.face, at, normal: one.normal };
  }
  return best;
}

/* the next visible face of a body, for the keyboard; the first looks up most */
export function facesOf(index) {
  const body = model.shown.bodies[index], normals = new Map(model.triangles.filter((t) => t.index === index).map((t) => [t.face, t.normal]));
  return body.faces.map((_, k) => k).filter((k) => normals.has(k)).sort((a, b) => normals.get(b)[2] - normals.get(a)[2]);
}
