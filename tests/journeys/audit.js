/* Contrast of every text, labels of every control, names of every button: what is wrong with the page as it is shown. */
(() => {
  const bad = [], parse = (c) => (c.match(/[\d.]+/g) || [0, 0, 0, 0]).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((v) => v / 255).map((v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = (e) => { for (; e; e = e.parentElement) { const c = parse(getComputedStyle(e).backgroundColor);
    if (c.length < 4 || c[3] > 0) return c; } return [255, 255, 255]; };
  for (const e of document.querySelectorAll('header *, main *, .banner *, dialog[open] *')) {
    const box = e.getBoundingClientRect(), style = getComputedStyle(e);
    if (!box.width || !box.height || style.visibility === 'hidden' || e.closest('svg') || e.closest('.hidden')) continue;
    const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()) || e.matches('input, textarea, select');
    if (own && !e.disabled) {
      const a = light(parse(style.color)), b = light(behind(e)), ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      if (ratio < 4.5) bad.push(`contrast ${ratio.toFixed(2)}: ${e.tagName} ${e.textContent.slice(0, 40)}`);
    }
    if (e.matches('input, textarea, select') && !(e.labels && e.labels.length) && !e.getAttribute('aria-label')) bad.push(`no label: ${e.outerHTML.slice(0, 90)}`);
    if (e.matches('button, a, summary') && !(e.textContent.trim() || e.getAttribute('aria-label'))) bad.push(`no name: ${e.outerHTML.slice(0, 90)}`);
    if (e.matches('img, iframe') && !(e.alt || e.title)) bad.push(`no name: ${e.outerHTML.slice(0, 90)}`);
  }
  const ids = [...document.querySelectorAll('[id]')].map((e) => e.id);
  return bad.concat(ids.filter((id, k) => ids.indexOf(id) !== k).map((id) => `twice: ${id}`));
})()
