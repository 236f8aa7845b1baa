// The largest values at a glance, and the table of all peaks with places, sparklines and jumps.

const CHIPS = 6;
// Units in the order in which their largest values are asked for.
const CHIP_UNITS = ['N', 'N m', 'W', 'kg m2', 'm/s2', 'm/s', 'rad/s2', 'rad/s', 'J', 'm', 'rad'];

function createPeaks(units, actions) {
  const chips = el('div', { class: 'chips' });
  const chipCard = card('Largest', 'largest', chips);
  const filter = el('input', { type: 'search', placeholder: 'filter', 'aria-label': 'filter quantities', oninput: () => sift() });
  const copy = el('button', { type: 'button', onclick: () => actions.copyPeaks() }, 'copy as CSV');
  const all = el('button', { type: 'button', onclick: () => actions.saveData() }, 'all data, CSV ↓');
  const body = el('tbody');
  const note = el('p', { class: 'note' });
  const head = el('thead', {}, el('tr', {}, ['quantity', 'curve', 'min', 'at', 'max', 'at', 'now'].map((t, k) => el('th', { scope: 'col', class: k > 1 ? 'number' : null }, t))));
  const tableCard = card(null, 'peaks', el('div', { class: 'card-head' }, el('h2', {}, 'Peaks'), el('div', { class: 'tools' }, filter, copy, all)), note, el('div', { class: 'wide' }, el('table', { class: 'peaks' }, head, body)));
  let run = null;
  let rows = [];
  let row = 0;
  const seen = new Set();
  const watcher = new IntersectionObserver(entries => {
    for (const entry of entries) {
      const own = rows.find(r => r.line === entry.target);
      if (!own) continue;
      if (entry.isIntersecting) { seen.add(own); now(own); } else seen.delete(own);
    }
  }, { rootMargin: '400px' });
  // On paper all of them are seen.
  window.addEventListener('beforeprint', () => rows.forEach(now));

  function show(newRun) {
    run = newRun;
    tableCard.hidden = !run.axis;
    const listed = run.axis ? run.columns.filter(c => c !== run.axis && c.group !== 'Time') : [];
    setText(note, [run.description.peaks_note, run.description.rows_note].filter(Boolean).join(' '));
    note.hidden = !note.textContent;
    watcher.disconnect();
    seen.clear();
    rows = listed.map(line);
    body.replaceChildren(...rows.map(r => r.line));
    for (const r of rows) watcher.observe(r.line);
    showChips();
    sift();
  }

  function jump(at) {
    return el('button', { type: 'button', class: 'jump', title: 'go there', onclick: () => actions.move(run.rowAt(at)) }, units.text(at, run.axis.unit, 5));
  }

  function line(column) {
    const { peak } = column;
    const isFlat = !varies(column);
    const curve = svg('svg', { class: 'spark', viewBox: '0 0 96 20', 'aria-hidden': 'true' });
    if (!isFlat) curve.append(svg('path', { d: sparkline(column.values, 96, 20, extentOf(column)) }));
    const value = el('td', { class: 'number now' });
    const error = peak && peak.error ? `estimated error ${scientific(peak.error)} ${printedUnit(column.unit)}` : null;
    const ends = peak ? [peak.min, peak.max].flatMap(({ value: v, at }) => [el('td', { class: 'number', title: error }, format(v * units.of(column.unit).factor)), el('td', { class: 'number' }, isFlat ? '' : jump(at))]) : Array.from({ length: 4 }, () => el('td'));
    const name = el('button', { type: 'button', class: 'name', title: [column.description, 'add to a chart'].filter(Boolean).join(' · '), onclick: () => actions.addColumn(column) }, column.label);
    const { name: unit } = units.of(column.unit);
    return { column, value, line: el('tr', {}, el('th', { scope: 'row' }, name, ' ', el('span', { class: 'unit' }, unit)), el('td', {}, curve), ends, value) };
  }

  function showChips() {
    const chosen = [];
    for (const unit of CHIP_UNITS) {
      const size = c => Math.max(Math.abs(c.peak.min.value), Math.abs(c.peak.max.value));
      const alike = run.columns.filter(c => c.peak && c.unit === unit && c !== run.axis && varies(c) && size(c) > 0 && Number.isFinite(size(c)));
      const [largest] = alike.sort((a, b) => size(b) - size(a));
      if (largest && chosen.length < CHIPS) chosen.push(largest);
    }
    chipCard.hidden = !run.axis || !chosen.length;
    chips.replaceChildren(...chosen.map(column => {
      const { min, max } = column.peak;
      const end = Math.abs(min.value) > Math.abs(max.value) ? min : max;
      const parts = [el('span', { class: 'chip-name' }, column.label), el('strong', {}, units.text(end.value, column.unit)), el('span', { class: 'chip-at' }, `at ${units.text(end.at, run.axis.unit, 5)}`)];
      return el('button', { type: 'button', class: 'chip', title: column.description, onclick: () => actions.move(run.rowAt(end.at)) }, parts);
    }));
  }

  function sift() {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const { column, line: tr } of rows) {
      const text = `${column.key} ${column.group} ${column.unit} ${column.description}`.toLowerCase();
      tr.hidden = !words.every(word => text.includes(word));
    }
  }

  function now(own) {
    const value = own.column.values[row];
    setText(own.value, format(value * units.of(own.column.unit).factor, 6));
    own.value.dataset.value = value;
  }

  return {
    chipCard,
    tableCard,
    show,
    move(newRow) {
      row = newRow;
      for (const own of seen) now(own);
    },
    // The rows that the filter leaves.
    listed: () => rows.filter(r => !r.line.hidden).map(r => r.column),
  };
}
