// Downloads: all data and peaks as CSV, a picture as SVG.

function saveText(text, name, type) {
  const link = el('a', { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const csvField = text => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);

// The format of the tables of the commands: headings `name [unit]`, then rows in SI units with the fewest digits that restore every bit.
function dataCsv(run) {
  const number = v => (Number.isNaN(v) ? '' : v === Infinity ? 'inf' : v === -Infinity ? '-inf' : Object.is(v, -0) ? '-0' : String(v));
  const lines = [run.columns.map(c => csvField(c.unit ? `${c.key} [${c.unit}]` : c.key)).join(',')];
  for (let k = 0; k < run.rows; k++) lines.push(run.columns.map(c => number(c.values[k])).join(','));
  return lines.join('\n') + '\n';
}

function peaksCsv(run, columns) {
  const at = run.axis ? `${run.axis.key} [${run.axis.unit}]` : '';
  const line = c => [csvField(c.key), c.unit, ...(c.peak ? [c.peak.min.value, c.peak.min.at, c.peak.max.value, c.peak.max.at] : ['', '', '', ''])].join(',');
  return [`quantity,unit,min,min at ${at},max,max at ${at}`, ...columns.map(line)].join('\n') + '\n';
}

const KEPT_STYLES = ['fill', 'fill-opacity', 'stroke', 'stroke-width', 'stroke-dasharray', 'stroke-linejoin', 'stroke-linecap', 'stroke-opacity', 'font-size', 'font-family', 'font-weight', 'display', 'paint-order', 'vector-effect', 'opacity'];

// A stand-alone picture: the computed style of each element becomes attributes.
function svgText(picture) {
  const copy = picture.cloneNode(true);
  const all = [picture, ...picture.querySelectorAll('*')];
  [copy, ...copy.querySelectorAll('*')].forEach((element, k) => {
    const style = getComputedStyle(all[k]);
    for (const name of KEPT_STYLES) {
      const value = style.getPropertyValue(name);
      if (value) element.setAttribute(name, value);
    }
    for (const name of ['class', 'tabindex', 'style', 'data-body', 'data-arrow']) element.removeAttribute(name);
  });
  const [, , width, height] = picture.getAttribute('viewBox').split(' ');
  copy.setAttribute('xmlns', SVG);
  copy.setAttribute('width', width);
  copy.setAttribute('height', height);
  copy.prepend(svg('rect', { width, height, fill: getComputedStyle(document.body).getPropertyValue('--card') }));
  return new XMLSerializer().serializeToString(copy);
}
