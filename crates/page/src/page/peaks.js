// The largest values as buttons, and the table of all peaks with their positions, sparklines and links to these positions.

const CHIPS = 6;
// Units of the buttons, the most useful first.
const CHIP_UNITS = ['N', 'N m', 'W', 'kg m2', 'm/s2', 'm/s', 'rad/s2', 'rad/s', 'J', 'm', 'rad'];

function createPeaks(units, actions, later) {
  const chips = el('div', { class: 'chips' });
  const chipCard = card('Largest', 'largest', chips);
  const filter = el('input', { type: 'search', placeholder: 'filter', 'aria-label': 'filter quantities', oninput: () => sift() });
  const copy = el('button', { type: 'button', class: 'saves', onclick: () => actions.copyPeaks() }, 'copy as CSV');
  const all = el('button', { type: 'button', class: 'saves', onclick: () => actions.saveData() }, 'all data, CSV ↓');
  const body = el('tbody');
  const note = el('p', { class: 'note' });
  const head = el('thead', {}, el('tr', {}, ['quantity', 'curve', 'min', 'at', 'max', 'at', 'now'].map((t, k) => el('th', { scope: 'col', class: k > 1 ? 'number' : null }, t))));
  const tableCard = card(null, 'peaks', el('div', { class: 'card-head' }, el('h2', {}, 'Peaks'), el('div', { class: 'tools' }, filter, copy, all)), note, el('div', { class: 'wide' }, el('table', { class: 'peaks' }, head, body)));
  let run = null;
  let shape = null;
  let rows = [];
  let row = 0;
  const seen = new Set();
  const byLine = new Map();
  const watcher = new IntersectionObserver(entries => {
    for (const entry of entries) {
      const own = byLine.get(entry.target);
      if (!own) continue;
      if (entry.isIntersecting) { seen.add(own); now(own); } else seen.delete(own);
    }
  }, { rootMargin: '400px' });
  // All rows are visible in print.
  window.addEventListener('beforeprint', () => rows.forEach(now));

  function show(newRun) {
    run = newRun;
    row = Math.min(row, Math.max(0, run.rows - 1));
    tableCard.hidden = !run.axis;
    setText(note, [run.description.peaks_note, run.description.rows_note].filter(Boolean).join(' '));
    note.hidden = !note.textContent;
    if (run.shape === shape) {
      for (const own of rows) [own.column, own.isOld] = [run.columns[own.column.index], true];
      seen.forEach(now);
      // Fills the lines outside the visible part later.
      let k = 0;
      later.add('peaks', isLate => {
        while (k < rows.length && !isLate()) if (rows[k++].isOld) fill(rows[k - 1]);
        return k === rows.length;
      });
    } else build();
    showChips();
  }

  function build() {
    shape = run.shape;
    watcher.disconnect();
    seen.clear();
    byLine.clear();
    const listed = run.axis ? run.columns.filter(c => c !== run.axis && c.group !== 'Time') : [];
    rows = listed.map(line);
    rows.forEach(fill);
    body.replaceChildren(...rows.map(r => r.line));
    for (const r of rows) {
      byLine.set(r.line, r);
      watcher.observe(r.line);
    }
    sift();
  }

  // Creates the line of a column, without its numbers.
  function line(column) {
    const own = { column, isOld: true };
    const end = which => ({
      value: el('td', { class: 'number' }),
      jump: el('button', { type: 'button', class: 'jump', title: 'go there', onclick: () => actions.move(run.rowAt(own.column.peak[which].at)) }),
    });
    [own.min, own.max] = [end('min'), end('max')];
    own.curve = svg('path', {});
    own.unit = el('span', { class: 'unit' });
    own.value = el('td', { class: 'number now' });
    const name = el('button', { type: 'button', class: 'name', title: [column.description, 'add to a chart'].filter(Boolean).join(' · '), onclick: () => actions.addColumn(own.column) }, column.label);
    own.line = el('tr', {}, el('th', { scope: 'row' }, name, ' ', own.unit), el('td', {}, svg('svg', { class: 'spark', viewBox: '0 0 96 20', 'aria-hidden': 'true' }, own.curve)),
      [own.min, own.max].map(({ value, jump }) => [value, el('td', { class: 'number' }, jump)]), own.value);
    return own;
  }

  // Fills in the numbers, except the value in the current row, which is written only for visible lines.
  function fill(own) {
    own.isOld = false;
    const { column } = own;
    const { peak } = column;
    const isFlat = !varies(column);
    const { name, factor } = units.of(column.unit);
    setText(own.unit, name);
    own.curve.setAttribute('d', isFlat ? '' : sparkline(column.values, 96, 20, extentOf(column)));
    for (const which of ['min', 'max']) {
      const { value, jump } = own[which];
      setText(value, peak ? format(peak[which].value * factor) : '');
      jump.hidden = !peak || isFlat;
      if (!jump.hidden) setText(jump, units.text(peak[which].at, run.axis.unit, 5));
      if (peak && peak.error) value.title = `estimated error ${scientific(peak.error)} ${printedUnit(column.unit)}`;
      else if (value.title) value.removeAttribute('title');
    }
  }

  // The column with the largest value of each unit.
  function largestOfUnits() {
    const found = new Map();
    for (const column of run.columns) {
      if (!column.peak || column === run.axis || !CHIP_UNITS.includes(column.unit)) continue;
      const size = Math.max(Math.abs(column.peak.min.value), Math.abs(column.peak.max.value));
      const before = found.get(column.unit);
      if (size > (before ? before.size : 0) && Number.isFinite(size) && varies(column)) found.set(column.unit, { size, column });
    }
    return CHIP_UNITS.filter(unit => found.has(unit)).slice(0, CHIPS).map(unit => found.get(unit).column);
  }

  function showChips() {
    const chosen = largestOfUnits();
    chipCard.hidden = !run.axis || !chosen.length;
    while (chips.children.length > chosen.length) chips.lastChild.remove();
    while (chips.children.length < chosen.length) {
      const chip = el('button', { type: 'button', class: 'chip', onclick: () => actions.move(run.rowAt(chip.at)) }, el('span', { class: 'chip-name' }), el('strong'), el('span', { class: 'chip-at' }));
      chips.append(chip);
    }
    // Zero-width spaces allow a long name to break after a dot or an underscore.
    chosen.forEach((column, k) => {
      const chip = chips.children[k];
      const { min, max } = column.peak;
      const end = Math.abs(min.value) > Math.abs(max.value) ? min : max;
      chip.at = end.at;
      if (chip.title !== column.description) chip.title = column.description;
      [column.label.replace(/[._]/g, '$&\u200b'), units.text(end.value, column.unit), `at ${units.text(end.at, run.axis.unit, 5)}`].forEach((text, part) => setText(chip.children[part], text));
    });
  }

  function sift() {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const { column, line: tr } of rows) {
      const text = `${column.key} ${column.group} ${column.unit} ${column.description}`.toLowerCase();
      tr.hidden = !words.every(word => text.includes(word));
    }
  }

  function now(own) {
    if (own.isOld) fill(own);
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
    // The columns that the filter leaves.
    listed: () => rows.filter(r => !r.line.hidden).map(r => r.column),
  };
}
