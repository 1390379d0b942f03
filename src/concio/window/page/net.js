/* Requests to the program behind the page. A request that fails says why in the words of the program. */
export const page = sessionStorage.getItem("page") || crypto.randomUUID();
sessionStorage.setItem("page", page);

export class Refused extends Error {
  constructor(said) { super(said.what); this.said = said; }
  get text() { return [this.said.where, this.said.what].filter(Boolean).join(": ") + (this.said.hint ? ` → ${this.said.hint}` : ""); }
}

async function answered(response) {
  const found = await response.json();
  if (found.error && (!response.ok || !("state" in found))) throw new Refused(found.error);
  return found;
}

export async function call(name, told = {}) {
  return answered(await fetch(`api/${name}`, {
    method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ page, ...told }),
  }));
}

export async function drop(file) {
  return answered(await fetch("drop", {
    method: "POST", headers: { "X-Name": encodeURIComponent(file.name), "X-Page": page }, body: file,
  }));
}

export function goodbye() {
  fetch("api/bye", { method: "POST", keepalive: true, headers: { "Content-Type": "application/json" }, body: JSON.stringify({ page }) }).catch(() => {});
}
