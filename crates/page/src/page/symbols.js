// The symbols of joints, springs and the ground, in pixels.

// A zigzag from one point to another.
function springPath([ax, ay], [bx, by], half) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy) || 1;
  const [nx, ny] = [(-dy / length) * half, (dx / length) * half];
  let path = `M${ax} ${ay}L${ax + 0.15 * dx} ${ay + 0.15 * dy}`;
  for (let k = 0; k < 14; k++) {
    const s = 0.15 + (0.7 * (k + 0.5)) / 14;
    const sign = k % 2 ? -1 : 1;
    path += `L${ax + s * dx + sign * nx} ${ay + s * dy + sign * ny}`;
  }
  return `${path}L${ax + 0.85 * dx} ${ay + 0.85 * dy}L${bx} ${by}`;
}

// A damper: a rod into a cup.
function damperPath([ax, ay], [bx, by], half) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy) || 1;
  const [nx, ny] = [(-dy / length) * half, (dx / length) * half];
  const at = (s, side) => `${ax + s * dx + side * nx} ${ay + s * dy + side * ny}`;
  return `M${at(0, 0)}L${at(0.4, 0)}M${at(0.62, 1)}L${at(0.4, 1)}L${at(0.4, -1)}L${at(0.62, -1)}` + `M${at(0.52, 0.7)}L${at(0.52, -0.7)}M${at(0.52, 0)}L${at(1, 0)}`;
}

// Strokes on the right of a line of the ground, seen along it.
function hatching([ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const length = Math.hypot(dx, dy) || 1;
  const [ux, uy] = [dx / length, dy / length];
  const count = Math.min(200, Math.floor(length / 9));
  let path = '';
  for (let k = 0; k <= count; k++) {
    const [x, y] = [ax + ux * 9 * k, ay + uy * 9 * k];
    // In pixels y points down, so right is the other normal.
    path += `M${x} ${y}l${-uy * 7 - ux * 6} ${ux * 7 - uy * 6}`;
  }
  return path;
}

// A pin of the ground: a triangle on hatched ground below the point.
function groundPin() {
  return [
    svg('path', { class: 'ground-body', d: 'M0 0L-13 22L13 22Z' }),
    svg('path', { class: 'ground-line', d: 'M-20 22L20 22' + hatching([20, 22], [-20, 22]).replace(/l[^M]*/g, 'l-7 7') }),
    svg('circle', { class: 'pin', r: 5.5 }),
  ];
}

// The hatched ground below a joint in space.
function groundMark() {
  return svg('path', { class: 'ground-line', d: 'M-15 17H15M-12 17l-6 6M-5 17l-6 6M2 17l-6 6M9 17l-6 6' });
}

// The elements of a mark, drawn about its point. Axes in space are drawn by `markPath`.
function markElements(look) {
  switch (look) {
    case 'ground-pin': return groundPin();
    case 'pin': return [svg('circle', { class: 'pin', r: 5.5 })];
    case 'weld': return [svg('circle', { class: 'weld', r: 4 })];
    case 'ball': return [svg('circle', { class: 'ball', r: 7.5 }), svg('path', { class: 'ball-line', d: 'M-7.5 0A7.5 3 0 0 0 7.5 0' })];
    case 'center-of-mass': return [svg('circle', { class: 'mass', r: 4.5 }), svg('path', { class: 'mass-filled', d: 'M0 0V-4.5A4.5 4.5 0 0 1 4.5 0ZM0 0V4.5A4.5 4.5 0 0 1 -4.5 0Z' })];
    case 'universal': return [svg('path', { class: 'axis-mark' }), svg('path', { class: 'cross', d: 'M-7 0H7M0 -7V7' }), svg('circle', { class: 'weld', r: 2.5 })];
    case 'teeth': return [svg('path', { class: 'axis-mark' }), svg('circle', { class: 'weld', r: 3 })];
    default: return [svg('path', { class: 'axis-line' }), svg('path', { class: 'axis-mark' })];
  }
}

// Half a length and half a width of symbols along an axis, px.
const AXIS_SIZES = { hinge: [13, 6.5], sleeve: [19, 6.5], slide: [16, 9], universal: [14, 0.1], planar: [4, 16], teeth: [14, 0.1] };

// A cylinder or block along an axis that is seen as (x, y) of a unit vector, so that it is short where it is seen from its end.
function axisPath(look, [x, y]) {
  const [half, width] = AXIS_SIZES[look];
  const seen = Math.min(1, Math.hypot(x, y));
  const [ux, uy] = seen > 1e-6 ? [x / seen, y / seen] : [1, 0];
  const [ax, ay] = [ux * half * seen, uy * half * seen];
  const depth = Math.max(width * Math.sqrt(1 - seen * seen), 0.01);
  const angle = (Math.atan2(uy, ux) * 180) / Math.PI;
  const [nx, ny] = [-uy * width, ux * width];
  if (look === 'slide') {
    // The near end of a block is a rectangle.
    return `M${ax + nx} ${ay + ny}L${-ax + nx} ${-ay + ny}L${-ax - nx} ${-ay - ny}L${ax - nx} ${ay - ny}Z`;
  }
  return `M${ax + nx} ${ay + ny}L${-ax + nx} ${-ay + ny}A${depth} ${width} ${angle} 0 1 ${-ax - nx} ${-ay - ny}L${ax - nx} ${ay - ny}` +
    `A${depth} ${width} ${angle} 0 1 ${ax + nx} ${ay + ny}A${depth} ${width} ${angle} 0 1 ${ax - nx} ${ay - ny}`;
}
