/* names of blocks in the tables: a click shows the block in the view, and a block picked in the view marks its names */
(() => {
  "use strict";
  const shown = window.concioNames; /* { names, choose(number), node } of the view */
  if (!shown) return;
  const numbers = new Map(shown.names.map((name, b) => [name, b])), cells = new Map();
  for (const cell of document.querySelectorAll("#tables td, #verdict td")) {
    if (!cell.hasAttribute("translate")) continue;
    const parts = cell.textContent.split(" | ").map((name) => numbers.get(name.trim()));
    if (!parts.length || parts.includes(undefined)) continue;
    cell.textContent.split(" | ").forEach((name, k) => {
      if (k === 0) cell.textContent = ""; else cell.append(" | ");
      const b = parts[k], button = document.createElement("button");
      button.type = "button"; button.className = "found"; button.textContent = name;
      button.addEventListener("click", () => { shown.choose(b); shown.node.scrollIntoView({ block: "center", behavior: "smooth" }); });
      cell.append(button);
      if (!cells.has(b)) cells.set(b, []);
      cells.get(b).push(button);
    });
  }
  document.addEventListener("concio-picked", (e) => {
    document.querySelectorAll("button.found.picked").forEach((button) => button.classList.remove("picked"));
    e.detail.forEach((b) => (cells.get(b) || []).forEach((button) => button.classList.add("picked")));
  });
})();
