// A run: its description, its columns as arrays, the groups of columns for charts, and the search for a row by a value of the axis.

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
  // The contents of tables and menus: two runs with the same shape differ only in numbers.
  run.shape = [d.command, d.axis, ...d.columns.map(c => `${c.key}|${c.label}|${c.unit}|${c.group}|${c.description}`)].join('\n');
  // Horizontal coordinates of the visible rows, as text in px. All charts share them, because they share the axis.
  let places = { of: '', across: [] };
  run.places = ([first, last], toX, scale) => {
    const of = [first, last, scale].join();
    if (places.of !== of) places = { of, across: Array.from(axis.values.subarray(first, last + 1), at => tenth(toX(at))) };
    return places.across;
  };
  run.rowAt = at => rowAt(axis, rows, at);
  return run;
}

// Whether the command reports that a column is zero within rounding.
const isRounding = column => Boolean(column.peak) && column.peak.min.value === 0 && column.peak.max.value === 0;

// The smallest and the largest value of a column over its rows; both are zero for a column that is zero within rounding.
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

// The columns by group and unit, in their order. The axis and the time are omitted.
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

// The row nearest to a value of the axis.
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
