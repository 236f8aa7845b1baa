// One chart: some columns of one unit over the axis, with the cursor of the row, peaks, zoom and read-out.

const CHART_HEIGHT = 190;
const PAD = { left: 66, right: 16, top: 10, bottom: 36 };
const MAX_CURVES = 6;

function createChart(number, state, units, actions) {
  const picture = svg('svg', { class: 'chart', role: 'img', tabindex: 0, height: CHART_HEIGHT });
  const chooser = el('select', { class: 'group', 'aria-label': `quantities of chart ${number + 1}`, onchange: () => choose(chooser.value) });
  const legend = el('ul', { class: 'legend' });
  const picker = el('details', { class: 'picker' }, el('summary', {}, 'curves'));
  const pickerList = el('div', { class: 'picker-list' });
  picker.append(pickerList);
  const save = el('button', { type: 'button', class: 'quiet', title: 'this chart as an SVG file', onclick: () => actions.saveSvg(picture, `chart-${number + 1}`) }, 'SVG ↓');
  const root = el('section', { class: 'card chart-card', 'aria-label': `chart ${number + 1}` }, el('div', { class: 'chart-head' }, chooser, picker, save), legend, picture);

  let run = null;
  let group = null;
  let columns = [];
  let width = 0;
  let row = 0;
  let scales = null;
  let cursor = null;
  let dots = [];
  let readouts = [];

  function show(newRun) {
    run = newRun;
    chooser.replaceChildren(...[...run.groups.values()].map(g => el('option', { value: g.key }, `${g.title}${g.unit ? ` (${units.of(g.unit).name})` : ''}`)));
    const own = state.charts[number];
    const wanted = own && run.groups.get(own.group);
    group = wanted || firstGroup(run, number);
    const kept = wanted && own.columns ? own.columns.map(key => run.byKey.get(key)).filter(c => c && c.unit === group.unit) : [];
    root.hidden = !group;
    if (!group) return;
    columns = kept.length ? kept : firstColumns(group);
    remember();
    build();
  }

  function remember() {
    const before = state.charts[number];
    state.charts[number] = { group: group.key, columns: columns.map(c => c.key), isChosen: Boolean(before && before.isChosen) };
  }

  function choose(key) {
    group = run.groups.get(key);
    columns = firstColumns(group);
    picker.open = false;
    remember();
    build();
    actions.changed();
  }

  // Adds a column of any group, as the table of peaks asks for.
  function add(column) {
    if (!group || column.unit !== group.unit) {
      group = [...run.groups.values()].find(g => g.columns.includes(column));
      columns = [];
    }
    if (!columns.includes(column)) columns = [...columns.slice(0, MAX_CURVES - 1), column];
    remember();
    build();
    actions.changed();
  }

  function build() {
    chooser.value = group.key;
    fillPicker();
    legend.replaceChildren();
    readouts = columns.map((column, k) => {
      const value = el('span', { class: 'value' });
      legend.append(el('li', { title: column.description || column.key }, el('span', { class: `swatch paint-${k}` }), el('span', { class: 'name' }, column.label), value));
      return value;
    });
    draw();
  }

  function fillPicker() {
    const all = [...new Set([...columns, ...group.columns])];
    pickerList.replaceChildren(...all.map(column => {
      const box = el('input', { type: 'checkbox', onchange: () => toggle(column, box.checked) });
      box.checked = columns.includes(column);
      return el('label', { title: column.description }, box, ' ', column.label);
    }));
    setText(picker.firstChild, `${columns.length} of ${all.length} curves`);
    picker.hidden = all.length < 2;
  }

  function toggle(column, isOn) {
    columns = isOn ? [...columns, column].slice(-MAX_CURVES) : columns.filter(c => c !== column);
    remember();
    build();
    actions.changed();
  }

  // The rows that the zoom shows.
  function shownRows() {
    const values = run.axis.values;
    if (!state.zoom) return [0, run.rows - 1];
    const ends = state.zoom.map(at => run.rowAt(at)).sort((a, b) => a - b);
    return values.length && ends[0] !== ends[1] ? [Math.max(0, ends[0] - 1), Math.min(run.rows - 1, ends[1] + 1)] : [0, run.rows - 1];
  }

  function draw() {
    picture.replaceChildren();
    width = picture.clientWidth || 560;
    picture.setAttribute('viewBox', `0 0 ${width} ${CHART_HEIGHT}`);
    const { factor } = units.of(group.unit);
    const axisUnit = units.of(run.axis.unit);
    const rows = shownRows();
    const [xFrom, xTo] = state.zoom || [Math.min(run.axis.values[0], run.axis.values[run.rows - 1]), Math.max(run.axis.values[0], run.axis.values[run.rows - 1])];
    let [low, high] = [Infinity, -Infinity];
    for (const column of columns) {
      for (let k = rows[0]; k <= rows[1]; k++) {
        const v = column.values[k];
        if (v < low && Number.isFinite(v)) low = v;
        if (v > high && Number.isFinite(v)) high = v;
      }
      const ends = state.zoom || !column.peak ? [] : [column.peak.min.value, column.peak.max.value].filter(Number.isFinite);
      low = Math.min(low, ...ends);
      high = Math.max(high, ...ends);
    }
    if (!(low <= high)) [low, high] = [0, 1];
    // What is constant but for rounding is a straight line.
    const size = Math.max(Math.abs(low), Math.abs(high));
    if (high - low <= 1e-9 * size || high === low) [low, high] = [low - 0.5 * (size || 1), high + 0.5 * (size || 1)];
    const room = 0.06 * (high - low);
    [low, high] = [low - room, high + room];
    const toX = x => PAD.left + ((x - xFrom) / (xTo - xFrom || 1)) * (width - PAD.left - PAD.right);
    const toY = y => CHART_HEIGHT - PAD.bottom - ((y - low) / (high - low)) * (CHART_HEIGHT - PAD.top - PAD.bottom);
    scales = { toX, toY, xFrom, xTo, toAxis: px => xFrom + ((px - PAD.left) / (width - PAD.left - PAD.right)) * (xTo - xFrom) };
    picture.append(axes({ low, high, xFrom, xTo, factor, axisUnit, toX, toY }));
    const clip = svg('svg', { x: PAD.left, y: 0, width: Math.max(1, width - PAD.left - PAD.right), height: CHART_HEIGHT - PAD.bottom + 2, viewBox: `${PAD.left} 0 ${Math.max(1, width - PAD.left - PAD.right)} ${CHART_HEIGHT - PAD.bottom + 2}` });
    columns.forEach((column, k) => clip.append(svg('path', { class: `curve paint-${k}`, d: curvePath(run.axis.values, column.values, rows, toX, toY, width) })));
    picture.append(clip);
    columns.forEach((column, k) => picture.append(peakMarks(column, k)));
    cursor = svg('path', { class: 'cursor', d: `M0 ${PAD.top}V${CHART_HEIGHT - PAD.bottom}` });
    dots = columns.map((_, k) => svg('circle', { class: `dot paint-${k}`, r: 4 }));
    picture.append(cursor, dots);
    picture.setAttribute('aria-label', describe());
    move(row);
  }

  function axes({ low, high, xFrom, xTo, factor, axisUnit, toX, toY }) {
    const group = svg('g', { class: 'axes', 'aria-hidden': 'true' });
    const ys = ticks(low * factor, high * factor, 4, false);
    for (const value of ys.values) {
      const y = toY(value / factor);
      group.append(svg('path', { class: Math.abs(value) < 1e-12 * Math.max(1, Math.abs(high * factor)) ? 'zero' : 'gridline', d: `M${PAD.left} ${y}H${width - PAD.right}` }));
      group.append(svg('text', { x: PAD.left - 8, y: y + 4, 'text-anchor': 'end' }, tickText(value, ys.decimals)));
    }
    const isDegrees = axisUnit.name === '°';
    const xs = ticks(xFrom * axisUnit.factor, xTo * axisUnit.factor, Math.max(2, Math.floor(width / 85)), isDegrees);
    for (const value of xs.values) {
      const x = toX(value / axisUnit.factor);
      group.append(svg('path', { class: 'gridline', d: `M${x} ${PAD.top}V${CHART_HEIGHT - PAD.bottom}` }));
      group.append(svg('text', { x, y: CHART_HEIGHT - PAD.bottom + 16, 'text-anchor': 'middle' }, tickText(value, xs.decimals) + (isDegrees ? '°' : '')));
    }
    const unit = axisUnit.name && !isDegrees ? ` (${axisUnit.name})` : '';
    group.append(svg('text', { class: 'axis-name', x: width - PAD.right, y: CHART_HEIGHT - 4, 'text-anchor': 'end' }, run.axis.label + unit));
    return group;
  }

  // Rings at the peaks, which may be between rows.
  function peakMarks(column, k) {
    const marks = svg('g', { 'aria-hidden': 'true' });
    if (!column.peak || !varies(column)) return marks;
    for (const { value, at } of [column.peak.min, column.peak.max]) {
      if (!Number.isFinite(value) || at < scales.xFrom || at > scales.xTo) continue;
      marks.append(svg('circle', { class: `peak paint-${k}`, cx: scales.toX(at), cy: scales.toY(value), r: 3.2 }));
    }
    return marks;
  }

  // The extremes in words.
  function describe() {
    const one = column => {
      const peak = column.peak;
      const [low, high] = peak ? [peak.min.value, peak.max.value] : extentOf(column);
      const places = peak ? [` at ${units.text(peak.min.at, run.axis.unit, 4)}`, ` at ${units.text(peak.max.at, run.axis.unit, 4)}`] : ['', ''];
      return `${column.label} from ${units.text(low, column.unit)}${places[0]} to ${units.text(high, column.unit)}${places[1]}`;
    };
    return `Chart over ${run.axis.label}: ${columns.map(one).join('; ')}`;
  }

  function move(newRow) {
    row = newRow;
    if (!scales || !columns.length) return;
    const x = scales.toX(run.axis.values[row]);
    const isIn = x >= PAD.left - 0.5 && x <= width - PAD.right + 0.5;
    cursor.setAttribute('transform', `translate(${isIn ? x : -100} 0)`);
    for (let k = 0; k < columns.length; k++) {
      const value = columns[k].values[row];
      const y = Number.isFinite(value) && isIn ? scales.toY(value) : -100;
      dots[k].setAttribute('cx', x);
      dots[k].setAttribute('cy', Math.max(-100, Math.min(CHART_HEIGHT + 100, y)));
      setText(readouts[k], units.text(value, columns[k].unit));
    }
  }

  chartPointer(picture, {
    axisAt: px => (scales ? scales.toAxis(px) : 0),
    hover: at => actions.move(run.rowAt(at)),
    zoom: actions.zoom,
    bounds: () => [PAD.left, width - PAD.right],
  });
  new ResizeObserver(() => { if (run && group && picture.clientWidth && picture.clientWidth !== width) draw(); }).observe(picture);
  return { root, show, move, draw: () => { if (run && group) draw(); }, add, unit: () => group && group.unit, count: () => columns.length };
}

// Hover moves the row; a drag zooms; a double click shows everything.
function chartPointer(picture, { axisAt, hover, zoom, bounds }) {
  let from = null;
  const band = svg('rect', { class: 'band', y: PAD.top, height: CHART_HEIGHT - PAD.top - PAD.bottom });
  const inside = event => {
    const [low, high] = bounds();
    return Math.max(low, Math.min(high, event.clientX - picture.getBoundingClientRect().left));
  };
  picture.addEventListener('pointerdown', event => {
    if (event.button !== 0) return;
    from = inside(event);
    picture.setPointerCapture(event.pointerId);
    hover(axisAt(from));
  });
  picture.addEventListener('pointermove', event => {
    const x = inside(event);
    hover(axisAt(x));
    if (from === null || event.pointerType === 'touch') return;
    if (Math.abs(x - from) < 6) return band.remove();
    band.setAttribute('x', Math.min(x, from));
    band.setAttribute('width', Math.abs(x - from));
    picture.append(band);
  });
  picture.addEventListener('pointerup', event => {
    const x = inside(event);
    band.remove();
    if (from !== null && Math.abs(x - from) >= 6 && event.pointerType !== 'touch') zoom([axisAt(from), axisAt(x)].sort((a, b) => a - b));
    from = null;
  });
  picture.addEventListener('pointercancel', () => {
    band.remove();
    from = null;
  });
  picture.addEventListener('dblclick', () => zoom(null));
}
