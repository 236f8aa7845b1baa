// The symbols of springs, the ground and the joints in the plane, in pixels.

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

// The arrow of a driven length, beside its rod.
function drivePath([ax, ay], [bx, by], unit) {
  const [dx, dy] = [bx - ax, by - ay];
  const aside = (1.2 * unit) / (Math.hypot(dx, dy) || 1);
  return arrowPath(ax + 0.3 * dx + aside * dy, ay + 0.3 * dy - aside * dx, 0.4 * dx, 0.4 * dy);
}

// Hatching on the right-hand side of the line from a to b.
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

function linePath(a, b) {
  return `M${a[0]} ${a[1]}L${b[0]} ${b[1]}`;
}

// The bearing of a pin on the ground: a triangle on hatched ground below the point.
function support() {
  return [
    svg('path', { class: 'ground-body', d: 'M0 0L-13 22L13 22Z' }),
    svg('path', { class: 'ground-line', d: 'M-20 22L20 22' + hatching([20, 22], [-20, 22]).replace(/l[^M]*/g, 'l-7 7') }),
  ];
}

// The elements of a mark in the plane, drawn about its point.
function markElements(look) {
  if (look === 'support') return support();
  return [look === 'weld' ? svg('circle', { class: 'weld', r: 4 }) : svg('circle', { class: 'pin', r: 5.5 })];
}
