// The state of a page in its address, so that a link shows the same row, zoom, curves and view.

function readState(hash) {
  const state = { row: null, zoom: null, charts: [], units: 'scene', view: null, arrows: null, paths: null, forces: true, showPaths: true };
  const numbers = text => text.split(',').map(Number);
  for (const [key, value] of new URLSearchParams(hash.replace(/^#/, ''))) {
    if (key === 'at' && Number.isFinite(Number(value))) state.at = Number(value);
    else if (key === 'zoom' && numbers(value).length === 2 && numbers(value).every(Number.isFinite)) state.zoom = numbers(value);
    else if (key === 'check' && /^\d+$/.test(value)) state.check = value;
    else if (key === 'units' && value === 'si') state.units = 'si';
    else if (key === 'view' && numbers(value).length === 2 && numbers(value).every(Number.isFinite)) state.view = numbers(value);
    else if (key === 'forces' && value === 'off') state.forces = false;
    else if (key === 'paths' && value === 'off') state.showPaths = false;
    else if (/^chart[123]$/.test(key)) {
      const [group, ...columns] = value.split('\u001f');
      state.charts[Number(key[5]) - 1] = { group, columns, isChosen: true };
    }
  }
  return state;
}

function writeState(state, run, row) {
  const params = new URLSearchParams();
  if (run.axis && row > 0) params.set('at', run.axis.values[row]);
  if (state.zoom) params.set('zoom', state.zoom.join(','));
  if (state.units === 'si') params.set('units', 'si');
  if (state.view) params.set('view', state.view.map(v => v.toFixed(3)).join(','));
  if (state.forces === false) params.set('forces', 'off');
  if (state.showPaths === false) params.set('paths', 'off');
  state.charts.forEach((chart, k) => { if (chart && chart.isChosen) params.set(`chart${k + 1}`, [chart.group, ...chart.columns].join('\u001f')); });
  return String(params);
}
