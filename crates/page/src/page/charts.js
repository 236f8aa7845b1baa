// Which charts are shown first, and with which curves.

const CHARTS = 3;

// By command: groups with their units in the order in which they answer what it is asked for.
const FIRST_GROUPS = {
  kinematics: ['Bodies|rad', 'Bodies|rad/s', 'Coordinates|m', 'Points|m', 'Points|m/s', 'Bodies|rad/s2', 'Transmission angles|rad'],
  statics: ['Reactions, magnitudes|N', 'Actuator forces|N m', 'Actuator forces|N', 'Reactions, components|N', 'Shaking force|N', 'Loads|N'],
  kinetostatics: ['Reactions, magnitudes|N', 'Actuator forces|N m', 'Actuator forces|N', 'Reactions, components|N', 'Bodies|rad/s2', 'Coordinates|m/s2', 'Power and energy|W'],
  simulate: ['Coordinates|rad', 'Coordinates|m', 'Energies and states|J', 'Reactions, magnitudes|N', 'Coordinates|rad/s', 'Power and energy|J'],
  validate: ['Coordinates|rad', 'Reactions, magnitudes|N', 'Actuator forces|N m', 'Actuator forces|N', 'Energies and states|J', 'Bodies|rad', 'Bodies|rad/s', 'Coordinates|m'],
  reduce: ['Generalised inertia|kg m2', 'Generalised inertia|kg', 'Half its slope, ½m′|kg m2/rad', 'Half its slope, ½m′|kg/m', 'Reaction coefficients a|kg m', 'Reaction coefficients a|kg'],
};

function firstGroup(run, number) {
  const groups = [...run.groups.values()];
  const preferred = (FIRST_GROUPS[run.description.command] || []).map(key => run.groups.get(key)).filter(g => g && g.columns.some(varies));
  const rest = groups.filter(g => !preferred.includes(g));
  const order = [...preferred, ...rest.filter(g => g.columns.some(varies)), ...rest.filter(g => !g.columns.some(varies))];
  return order[number] || null;
}

// Those that vary most, of equal ones the first.
function firstColumns(group) {
  const span = column => { const [low, high] = extentOf(column); return Number.isFinite(high - low) ? high - low : 0; };
  const seen = new Set();
  const distinct = group.columns.filter(c => !seen.has(c.slot) && seen.add(c.slot));
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
    // To the first chart of its unit that has room, or the last one.
    add: column => {
      const alike = charts.filter(c => !c.root.hidden && c.unit() === column.unit);
      (alike.find(c => c.count() < MAX_CURVES) || alike[0] || charts.filter(c => !c.root.hidden).pop()).add(column);
    },
  };
}
