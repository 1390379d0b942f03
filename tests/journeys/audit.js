/* What is wrong with the page as it is shown: contrast of every text, also in the picture (WCAG 1.4.3, 4.5 to 1), and of the
   rims of fields (1.4.11, 3 to 1); labels of every control, names of every button. */
(() => {
  const bad = [], parse = (c) => (c.match(/[\d.]+/g) || [0, 0, 0, 0]).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((v) => v / 255).map((v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = (e) => { for (; e; e = e.parentElement) { const c = parse(getComputedStyle(e).backgroundColor);
    if (c.length < 4 || c[3] > 0) return c; } return [255, 255, 255]; };
  const ratioOf = (one, other) => { const a = light(one), b = light(other); return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); };
  const look = (name) => { const probe = document.createElement('i'); probe.style.color = `var(--look-${name})`; document.body.append(probe);
    const found = parse(getComputedStyle(probe).color); probe.remove(); return found; };
  for (const e of document.querySelectorAll('#picture text')) {
    const style = getComputedStyle(e), halo = style.stroke !== 'none' && style.paintOrder.startsWith('stroke');
    const grounds = halo ? [parse(style.stroke)] : e.matches('.on-block') ? ['block', 'mortar', 'rigid', 'fixed'].map(look) : [behind(e.closest('#frame'))];
    const ratio = Math.min(...grounds.map((ground) => ratioOf(parse(style.fill), ground)));
    if (ratio < 4.5) bad.push(`contrast ${ratio.toFixed(2)}: in the picture ${e.textContent}`);
  }
  for (const e of document.querySelectorAll('header *, main *, .banner *, dialog[open] *')) {
    const box = e.getBoundingClientRect(), style = getComputedStyle(e);
    if (!box.width || !box.height || style.visibility === 'hidden' || e.closest('svg') || e.closest('.hidden')) continue;
    const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()) || e.matches('input, textarea, select');
    if (own && !e.disabled) {
      const ratio = ratioOf(parse(style.color), behind(e));
      if (ratio < 4.5) bad.push(`contrast ${ratio.toFixed(2)}: ${e.tagName} ${e.textContent.slice(0, 40)}`);
    }
    if (e.matches('input:not([type=checkbox], [type=range]), textarea, select') && !e.disabled) {
      const ratio = ratioOf(parse(style.borderTopColor), behind(e.parentElement));
      if (ratio < 3) bad.push(`rim ${ratio.toFixed(2)}: ${e.outerHTML.slice(0, 90)}`);
    }
    if (e.matches('input, textarea, select') && !(e.labels && e.labels.length) && !e.getAttribute('aria-label')) bad.push(`no label: ${e.outerHTML.slice(0, 90)}`);
    if (e.matches('button, a, summary') && !(e.textContent.trim() || e.getAttribute('aria-label'))) bad.push(`no name: ${e.outerHTML.slice(0, 90)}`);
    if (e.matches('img, iframe') && !(e.alt || e.title)) bad.push(`no name: ${e.outerHTML.slice(0, 90)}`);
  }
  const ids = [...document.querySelectorAll('[id]')].map((e) => e.id);
  return bad.concat(ids.filter((id, k) => ids.indexOf(id) !== k).map((id) => `twice: ${id}`));
})()
