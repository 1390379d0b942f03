"use strict";
/* What the views in the plane and in space have in common: faults are shown, arrays are unpacked, words are translated. */
const base = (() => {
  const $ = (id) => document.getElementById(id);
  const complain = (text) => { const box = $("errors"); box.hidden = false; box.textContent += text + "\n"; };
  window.addEventListener("error", (e) => { if (!/ResizeObserver/.test(e.message)) complain(`${e.message} (line ${e.lineno})`); });

  const TYPES = { f4: Float32Array, f8: Float64Array, i4: Int32Array, u1: Uint8Array };
  const unpack = (packed) => {
    const text = atob(packed.data), bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    return new TYPES[packed.type](bytes.buffer);
  };
  const unpacked = (record) => {
    const found = {};
    for (const [key, value] of Object.entries(record)) found[key] = value && value.data !== undefined ? unpack(value) : value;
    return found;
  };

  const data = JSON.parse($("data").textContent);
  const said = data.said || {}, say = (word) => said[word] ?? word; /* another language than English */
  const written = (number) => (data.said ? number.replace(".", ",") : number);
  if (data.left_out) complain(`${say("Steps left out of this view to keep the file small")}: ${data.left_out}`);
  return { $, unpack, unpacked, data, say, written };
})();
