// Selects the groups and the curves that the charts show first.

const CHARTS = 3;

// By command: groups with their units, the most useful for this command first.
const FIRST_GROUPS = {
  kinematics: ['Bodies|rad', 'Bodies|rad/s', 'Coordinates|m', 'Points|m', 'Points|m/s', 'Bodies|rad/s2', 'Transmission angles|rad'],
  statics: ['Reactions, magnitudes|N', 'Actuator forces|N m', 'Actuator forces|N', 'Reactions, components|N', 'Shaking force|N', 'Loads|N'],
  kinetostatics: ['Reactions, magnitudes|N', 'Actuator forces|N m', 'Actuator forces|N', 'Reactions, components|N', 'Bodies|rad/s2', 'Coordinates|m/s2', 'Power and energy|W'],
  simulate: ['Coordinates|rad/s', 'Coordinates|m/s', 'Reactions, magnitudes|N', 'Energies and states|J', 'Coordinates|rad', 'Coordinates|m', 'Power and energy|J'],
  validate: ['Reactions, magnitudes|N', 'Reactions, components|N', 'Coordinates|rad/s', 'Actuator forces|N m', 'Actuator forces|N', 'Bodies|rad', 'Bodies|rad/s', 'Coordinates|m', 'Energies and states|J'],
  reduce: ['Generalised inertia|kg m2', 'Generalised inertia|kg', 'Half its slope, ½m′|kg m2/rad', 'Half its slope, ½m′|kg/m', 'Reaction coefficients a|kg m', 'Reaction coefficients a|kg'],
};

function firstGroup(run, number) {
  const groups = [...run.groups.values()];
  let preferred = (FIRST_GROUPS[run.description.command] || []).map(key => run.groups.get(key)).filter(g => g && g.columns.some(varies));
  // Components are shown only if there are no magnitudes.
  if (preferred.some(g => g.title === 'Reactions, magnitudes')) preferred = preferred.filter(g => g.title !== 'Reactions, components');
  const rest = groups.filter(g => !preferred.includes(g));
  const order = [...preferred, ...rest.filter(g => g.columns.some(varies)), ...rest.filter(g => !g.columns.some(varies))];
  return order[number] || null;
}

// Whether two columns are equal within rounding, as those of a point that two bodies share.
function isAlike(one, other) {
  if (one.slot === other.slot) return true;
  const [low, high] = extentOf(one);
  const step = Math.max(1, Math.floor(one.values.length / 40));
  for (let k = 0; k < one.values.length; k += step) if (!(Math.abs(one.values[k] - other.values[k]) <= 1e-9 * (high - low))) return false;
  return true;
}

// The columns that vary most; of equal columns, the first.
function firstColumns(group) {
  const span = column => { const [low, high] = extentOf(column); return Number.isFinite(high - low) ? high - low : 0; };
  const distinct = [];
  for (const column of group.columns) if (!distinct.some(other => isAlike(column, other))) distinct.push(column);
  const largest = [...distinct].sort((a, b) => span(b) - span(a)).slice(0, MAX_CURVES).filter((c, k) => k === 0 || varies(c));
  return distinct.filter(c => largest.includes(c));
}

function createCharts(state, units, actions) {
  const charts = Array.from({ length: CHARTS }, (_, k) => createChart(k, state, units, actions));
  const root = el('div', { class: 'charts' }, charts.map(c => c.root));
  return {
    root,
    show: run => { for (const chart of charts) run.axis ? chart.show(run) : (chart.root.hidden = true); },
    move: row => { for (const chart of charts) chart.move(row); },
    draw: () => { for (const chart of charts) chart.draw(); },
    // Adds a column to the first chart of its unit that has room; without such a chart, to the last chart.
    add: column => {
      const alike = charts.filter(c => !c.root.hidden && c.unit() === column.unit);
      (alike.find(c => c.count() < MAX_CURVES) || alike[0] || charts.filter(c => !c.root.hidden).pop()).add(column);
    },
  };
}
