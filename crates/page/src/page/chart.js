// One chart: columns of one unit over the axis, with the cursor at the current row, peaks, zoom and read-out.

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
  const save = el('button', { type: 'button', class: 'quiet saves', title: 'this chart as an SVG file', onclick: () => actions.saveSvg(picture, `chart-${number + 1}`) }, 'SVG ↓');
  const root = el('section', { class: 'card chart-card', 'aria-label': `chart ${number + 1}` }, el('div', { class: 'chart-head' }, chooser, picker, save), legend, picture);

  let run = null;
  let group = null;
  let columns = [];
  let width = 0;
  let row = 0;
  let scales = null;
  let shape = null;
  let dots = [];
  let readouts = [];
  const frame = { x: svg('g', { class: 'axes', 'aria-hidden': 'true' }), y: svg('g', { class: 'axes', 'aria-hidden': 'true' }) };
  const renewed = { x: createRenewed(frame.x), y: createRenewed(frame.y) };
  const clip = svg('svg', { y: 0, height: CHART_HEIGHT - PAD.bottom + 2 });
  const peaks = svg('g', { 'aria-hidden': 'true' });
  const cursor = svg('path', { class: 'cursor', d: `M0 ${PAD.top}V${CHART_HEIGHT - PAD.bottom}` });
  const dotted = svg('g', {});
  picture.append(frame.x, frame.y, clip, peaks, cursor, dotted);

  function show(newRun) {
    run = newRun;
    const own = state.charts[number];
    // If only the numbers of the run differ, the same curves are drawn with the new numbers.
    if (group && shape === shapeNow()) {
      group = run.groups.get(group.key);
      columns = columns.map(column => run.columns[column.index]);
      return draw();
    }
    chooser.replaceChildren(...[...run.groups.values()].map(g => el('option', { value: g.key }, `${g.title}${g.unit ? ` (${units.of(g.unit).name})` : ''}`)));
    // Only a chart that the user has changed keeps its curves in a new run; other charts show the default curves of the new command.
    const wanted = own && own.isChosen && run.groups.get(own.group);
    group = wanted || firstGroup(run, number);
    const kept = wanted && own.columns ? own.columns.map(key => run.byKey.get(key)).filter(c => c && c.unit === group.unit) : [];
    root.hidden = !group;
    if (!group) return;
    columns = kept.length ? kept : firstColumns(group);
    remember();
    build();
    shape = shapeNow();
  }

  // The contents of the menu, the legend and the curves, as text.
  function shapeNow() {
    const own = state.charts[number];
    return [run.shape, units.of('m').name, units.of('rad').name, own && own.group, ...((own && own.columns) || [])].join('\n');
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

  // Adds a column of any group, as requested in the table of peaks.
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
    clip.replaceChildren(...columns.map((_, k) => svg('path', { class: `curve paint-${k}` })));
    dots = columns.map((_, k) => svg('circle', { class: `dot paint-${k}`, r: 4 }));
    dotted.replaceChildren(...dots);
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
      const box = el('input', { type: 'checkbox', onchange: () => toggle(run.columns[column.index], box.checked) });
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

  // The first and the last row within the zoom.
  function shownRows() {
    const values = run.axis.values;
    if (!state.zoom) return [0, run.rows - 1];
    const ends = state.zoom.map(at => run.rowAt(at)).sort((a, b) => a - b);
    return values.length && ends[0] !== ends[1] ? [Math.max(0, ends[0] - 1), Math.min(run.rows - 1, ends[1] + 1)] : [0, run.rows - 1];
  }

  function draw() {
    // A ResizeObserver tracks the width: reading it at each draw would force a layout of the whole page.
    if (!width) setWidth(picture.clientWidth || 560);
    const { factor } = units.of(group.unit);
    const axisUnit = units.of(run.axis.unit);
    const rows = shownRows();
    const [xFrom, xTo] = state.zoom || [Math.min(run.axis.values[0], run.axis.values[run.rows - 1]), Math.max(run.axis.values[0], run.axis.values[run.rows - 1])];
    let [low, high] = [Infinity, -Infinity];
    for (const column of columns) {
      if (isRounding(column)) {
        [low, high] = [Math.min(low, 0), Math.max(high, 0)];
        continue;
      }
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
    // Columns that are constant within rounding appear as straight lines.
    const size = Math.max(Math.abs(low), Math.abs(high));
    if (high - low <= 1e-9 * size) [low, high] = [low - 0.5 * (size || 1), high + 0.5 * (size || 1)];
    const room = 0.06 * (high - low);
    [low, high] = [low - room, high + room];
    const toX = x => PAD.left + ((x - xFrom) / (xTo - xFrom || 1)) * (width - PAD.left - PAD.right);
    const toY = y => CHART_HEIGHT - PAD.bottom - ((y - low) / (high - low)) * (CHART_HEIGHT - PAD.top - PAD.bottom);
    scales = { toX, toY, xFrom, xTo, toAxis: px => xFrom + ((px - PAD.left) / (width - PAD.left - PAD.right)) * (xTo - xFrom) };
    drawAxes({ low, high, xFrom, xTo, factor, axisUnit, toX, toY });
    const across = () => run.places(rows, toX, [xFrom, xTo, width].join());
    columns.forEach((column, k) => clip.children[k].setAttribute('d', curvePath(run.axis.values, column.values, rows, toX, toY, width, across)));
    markPeaks();
    picture.setAttribute('aria-label', describe());
    move(row);
  }

  function setWidth(newWidth) {
    width = newWidth;
    picture.setAttribute('viewBox', `0 0 ${width} ${CHART_HEIGHT}`);
    const inside = Math.max(1, width - PAD.left - PAD.right);
    clip.setAttribute('x', PAD.left);
    clip.setAttribute('width', inside);
    clip.setAttribute('viewBox', `${PAD.left} 0 ${inside} ${CHART_HEIGHT - PAD.bottom + 2}`);
  }

  function drawAxes({ low, high, xFrom, xTo, factor, axisUnit, toX, toY }) {
    renewed.y([low, high, factor, width].join(), () => {
      const ys = ticks(low * factor, high * factor, 4, false);
      return ys.values.flatMap(value => {
        const y = toY(value / factor);
        return [
          svg('path', { class: Math.abs(value) < 1e-12 * Math.max(1, Math.abs(high * factor)) ? 'zero' : 'gridline', d: `M${PAD.left} ${y}H${width - PAD.right}` }),
          svg('text', { x: PAD.left - 8, y: y + 4, 'text-anchor': 'end' }, tickText(value, ys.decimals)),
        ];
      });
    });
    renewed.x([xFrom, xTo, axisUnit.name, axisUnit.factor, width, run.axis.label].join(), () => {
      const isDegrees = axisUnit.name === '°';
      const xs = ticks(xFrom * axisUnit.factor, xTo * axisUnit.factor, Math.max(2, Math.floor(width / 85)), isDegrees);
      const lines = xs.values.flatMap(value => {
        const x = toX(value / axisUnit.factor);
        return [
          svg('path', { class: 'gridline', d: `M${x} ${PAD.top}V${CHART_HEIGHT - PAD.bottom}` }),
          svg('text', { x, y: CHART_HEIGHT - PAD.bottom + 16, 'text-anchor': 'middle' }, tickText(value, xs.decimals) + (isDegrees ? '°' : '')),
        ];
      });
      const unit = axisUnit.name && !isDegrees ? ` (${axisUnit.name})` : '';
      return [...lines, svg('text', { class: 'axis-name', x: width - PAD.right, y: CHART_HEIGHT - 4, 'text-anchor': 'end' }, run.axis.label + unit)];
    });
  }

  // Draws rings at the peaks, which may lie between rows.
  function markPeaks() {
    let count = 0;
    const mark = ({ value, at }, k) => {
      if (!Number.isFinite(value) || at < scales.xFrom || at > scales.xTo) return;
      const ring = peaks.children[count] || peaks.appendChild(svg('circle', { r: 3.2 }));
      count += 1;
      ring.setAttribute('class', `peak paint-${k}`);
      ring.setAttribute('cx', scales.toX(at));
      ring.setAttribute('cy', scales.toY(value));
    };
    columns.forEach((column, k) => {
      if (column.peak && varies(column)) [column.peak.min, column.peak.max].forEach(end => mark(end, k));
    });
    while (peaks.children.length > count) peaks.lastChild.remove();
  }

  // Describes the extrema in words, for screen readers.
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
  new ResizeObserver(([{ contentRect }]) => {
    const newWidth = Math.round(contentRect.width);
    if (!newWidth || newWidth === width) return;
    setWidth(newWidth);
    if (run && group) draw();
  }).observe(picture);
  return { root, show, move, draw: () => { if (run && group) draw(); }, add, unit: () => group && group.unit, count: () => columns.length };
}

// Hovering moves the row, dragging zooms, and a double click shows the whole axis.
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
