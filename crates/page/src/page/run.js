// A run: its description with the columns as arrays, what belongs in one chart, and rows by their place on the axis.

function createRun(description, numbers) {
  const d = typeof description === 'string' ? JSON.parse(description) : description;
  if (d.format !== 'dwell-page-3') throw new Error(`a page of the format ${d.format} is unknown to this script`);
  const rows = d.rows;
  const slot = k => numbers.subarray(k * rows, (k + 1) * rows);
  const columns = d.columns.map((column, index) => ({ ...column, index, values: slot(column.slot), peak: null, extent: null }));
  const end = ([value, at]) => ({ value: Number(value), at: Number(at) });
  for (const peak of d.peaks) {
    columns[peak.column].peak = { min: end(peak.min), max: end(peak.max), error: peak.error === null ? null : Number(peak.error) };
  }
  const axis = d.axis === null || d.axis === undefined ? null : columns[d.axis];
  const run = { description: d, rows, columns, axis, slot, groups: groupsOf(columns, axis), byKey: new Map(columns.map(c => [c.key, c])) };
  // What tables and choices are made of: two runs of one shape differ in numbers only.
  run.shape = [d.command, d.axis, ...d.columns.map(c => `${c.key}|${c.label}|${c.unit}|${c.group}|${c.description}`)].join('\n');
  // The rows from the first to the last on the screen, as they are written in curves. All charts have one axis.
  let places = { of: '', across: [] };
  run.places = ([first, last], toX, scale) => {
    const of = [first, last, scale].join();
    if (places.of !== of) places = { of, across: Array.from(axis.values.subarray(first, last + 1), at => tenth(toX(at))) };
    return places.across;
  };
  run.rowAt = at => rowAt(axis, rows, at);
  return run;
}

// Whether the command says that a column is zero but for rounding.
const isRounding = column => Boolean(column.peak) && column.peak.min.value === 0 && column.peak.max.value === 0;

// The smallest and the largest value of a column in its rows; of one that is rounding zero.
function extentOf(column) {
  if (!column.extent && isRounding(column)) column.extent = [0, 0];
  if (!column.extent) {
    let low = Infinity;
    let high = -Infinity;
    for (const value of column.values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
    column.extent = [low, high];
  }
  return column.extent;
}

// Whether a column changes by more than rounding.
function varies(column) {
  const [low, high] = extentOf(column);
  return high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high));
}

// Columns of one group and one unit, in their order. The axis and the time are no curves.
function groupsOf(columns, axis) {
  const groups = new Map();
  for (const column of columns) {
    if (column === axis || column.group === 'Time') continue;
    const key = `${column.group}|${column.unit}`;
    if (!groups.has(key)) groups.set(key, { key, title: column.group || 'Results', unit: column.unit, columns: [] });
    groups.get(key).columns.push(column);
  }
  return groups;
}

// The row that is nearest to a value of the axis.
function rowAt(axis, rows, at) {
  if (!axis || rows === 0) return 0;
  const values = axis.values;
  const rising = values[rows - 1] >= values[0];
  let low = 0;
  let high = rows - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (values[middle] <= at === rising) low = middle;
    else high = middle;
  }
  return Math.abs(values[low] - at) <= Math.abs(values[high] - at) ? low : high;
}
