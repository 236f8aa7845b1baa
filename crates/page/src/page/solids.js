// The symbols of joints in space: lists of paths relative to the point of the joint, px. Each path has its class; a shaded path also
// has the percentage of its colour. Sizes are in half lengths of a hinge, as in the pictures.

const CYLINDERS = { hinge: [0.5, 1], sleeve: [0.5, 1.3], screw: [0.5, 1.3], 'left-screw': [0.5, 1.3], disc: [1, 0.3] };
const BALLS = { ball: 0.55, 'rod-end': 0.41, weld: 0.4, cross: 0.3, teeth: 0.3 };
const FORK_ARM = 1.4;

const polygon = (points, isOpen) => points.map(([x, y], k) => `${k ? 'L' : 'M'}${x.toFixed(2)} ${y.toFixed(2)}`).join('') + (isOpen ? '' : 'Z');
const along = (count, point) => Array.from({ length: count + 1 }, (_, k) => point(k / count));
const circlePath = ([x, y], r) => `M${x + r} ${y}A${r} ${r} 0 1 1 ${x - r} ${y}A${r} ${r} 0 1 1 ${x + r} ${y}`;

// `see(n, c, a)` maps coordinates along the normal, across, and along the axis, in half lengths of a hinge, to the picture (px) and to
// the nearness. `unit` is half the length of a hinge, px. `away` is the direction away from the moving body in the picture.
function solidPaths(look, see, unit, away) {
  const cylinder = CYLINDERS[look];
  const paths = [];
  if (look === 'hinge') paths.push(['axis-line', linePath(see(0, 0, -2.1), see(0, 0, 2.1))]);
  if (cylinder) paths.push(...cylinderPaths(see, cylinder, unit));
  if (look.endsWith('screw')) paths.push(['edge', threadPath(see, cylinder, look === 'screw' ? 1 : -1)]);
  if (look === 'slide') paths.push(...blockPaths(see, [0.8, 1.3], 0));
  if (look === 'plate') paths.push(...blockPaths(see, [2.4, 0.08], -0.3));
  if (look === 'fork') {
    paths.push(['fork', polygon(along(16, s => see(FORK_ARM * Math.sin(Math.PI * s), 0, FORK_ARM * Math.cos(Math.PI * s))), true)]);
    for (const end of [see(0, 0, -FORK_ARM), see(0, 0, FORK_ARM)]) paths.push(['arm', linePath([0, 0], end)], ...ballPaths(end, 0.24 * unit));
  }
  if (look === 'teeth') paths.push(['arrow', linePath(see(0, 0, -0.9), see(0, 0, 0.9))]);
  if (look === 'ring') paths.push(['fork', circlePath([0, 0], 0.9 * unit)]);
  if (look === 'pushed') paths.push(['arrow', arrowBetween(see(1.5, 0, -1.6), see(1.5, 0, 1.6))]);
  if (look === 'turned') {
    const point = s => see(1.15 * Math.cos(2 * Math.PI * s), 1.15 * Math.sin(2 * Math.PI * s), 1.7);
    paths.push(['arc', polygon(along(23, s => point(0.72 * s)), true)], ['arrow', arrowBetween(point(0.66), point(0.78))]);
  }
  if (look === 'center-of-mass') {
    const r = 0.33 * unit;
    paths.push(['mass', circlePath([0, 0], r)], ['mass-filled', `M0 0V${-r}A${r} ${r} 0 0 1 ${r} 0ZM0 0V${r}A${r} ${r} 0 0 1 ${-r} 0Z`]);
  }
  if (BALLS[look]) paths.push(...ballPaths([0, 0], BALLS[look] * unit));
  if (away && look === 'fork') paths.push(['ground-line', groundPath(see(FORK_ARM, 0, 0), null, see(1, 0, 0), unit)]);
  else if (away) paths.push(['ground-line', groundPath([0, 0], look === 'disc' ? see(1, 0, 0) : cylinder ? see(0, 0, 1) : null, away, unit)]);
  return paths;
}

// The lateral surface, the visible end face, and the pin in it.
function cylinderPaths(see, [radius, half], unit) {
  const axis = see(0, 0, 1);
  const sign = axis[2] < 0 ? -1 : 1;
  const seen = Math.min(1, Math.hypot(axis[0], axis[1]) / unit);
  const [ux, uy] = seen > 1e-6 ? [(sign * axis[0]) / (unit * seen), (sign * axis[1]) / (unit * seen)] : [1, 0];
  const [ax, ay, width] = [ux * half * seen * unit, uy * half * seen * unit, radius * unit];
  const depth = Math.max(width * Math.sqrt(1 - seen * seen), 0.01);
  const [nx, ny] = [-uy * width, ux * width];
  const arc = (part, x, y) => `A${part * depth} ${part * width} ${(Math.atan2(uy, ux) * 180) / Math.PI} 0 1 ${x} ${y}`;
  const end = part => `M${ax + part * nx} ${ay + part * ny}${arc(part, ax - part * nx, ay - part * ny)}${arc(part, ax + part * nx, ay + part * ny)}`;
  const side = `M${ax + nx} ${ay + ny}L${-ax + nx} ${-ay + ny}${arc(1, -ax - nx, -ay - ny)}L${ax - nx} ${ay - ny}${arc(1, ax + nx, ay + ny)}Z`;
  return seen < 0.999 ? [['solid', side, 28], ['solid', end(1), 10], ['dark', end(0.35)]] : [['solid', side, 28]];
}

// The visible part of a thread.
function threadPath(see, [radius, half], hand) {
  let d = '';
  let isOn = false;
  for (let k = 0; k <= 90; k++) {
    const [sin, cos] = [hand * Math.sin((k * Math.PI) / 15), Math.cos((k * Math.PI) / 15)];
    const [x, y] = see(radius * cos, radius * sin, half * (k / 45 - 1));
    const isSeen = see(cos, sin, 0)[2] > 0;
    if (isSeen) d += `${isOn ? 'L' : 'M'}${x.toFixed(2)} ${y.toFixed(2)}`;
    isOn = isSeen;
  }
  return d;
}

// The faces of a box that face the viewer.
function blockPaths(see, [half, length], foot) {
  const sizes = [half, half, length];
  const paths = [];
  for (let k = 0; k < 3; k++) {
    for (const sign of [-1, 1]) {
      const unit = [0, 0, 0];
      unit[k] = sign;
      const facing = see(...unit)[2];
      if (facing < 1e-3) continue;
      const corner = ([s, t]) => {
        const p = [0, 0, foot];
        [sign, s, t].forEach((part, i) => { p[(k + i) % 3] += part * sizes[(k + i) % 3]; });
        return see(...p);
      };
      paths.push(['solid', polygon([[-1, -1], [1, -1], [1, 1], [-1, 1]].map(corner)), Math.round(55 - 30 * facing)]);
    }
  }
  return paths;
}

// A ball with highlights.
function ballPaths([x, y], r) {
  const lights = [[0.12, 0.72, 38], [0.22, 0.48, 20], [0.3, 0.22, 3]];
  return [['ball', circlePath([x, y], r), 55], ...lights.map(([by, size, part]) => ['ball light', circlePath([x - by * r, y - by * r], size * r), part])];
}

function arrowBetween(a, b) {
  return arrowPath(a[0], a[1], b[0] - a[0], b[1] - a[1]);
}

// Hatched ground at a joint along a direction, on the side away from the moving body.
function groundPath([x, y], direction, away, unit) {
  const isSeen = direction && Math.hypot(direction[0], direction[1]) > 0.4 * unit;
  const [u, v] = isSeen ? direction : [1, 0];
  const length = Math.hypot(u, v);
  let [nx, ny] = [-v / length, u / length];
  const side = nx * away[0] + ny * away[1];
  // If the body is on neither side, the ground is drawn below.
  const isLevel = Math.abs(side) < 0.2 * Math.max(unit, Math.hypot(away[0], away[1]));
  if (isLevel ? ny < 0 : side < 0) [nx, ny] = [-nx, -ny];
  return groundLine([x + 0.5 * unit * nx, y + 0.5 * unit * ny], [nx, ny], 1.1 * unit);
}

// A line hatched on the side of its normal.
function groundLine([x, y], [nx, ny], half) {
  const [a, b] = [[x - half * ny, y + half * nx], [x + half * ny, y - half * nx]];
  return linePath(a, b) + hatching(a, b);
}

// A hatched wall across the end of a guide. If the view is along the guide, the wall is drawn below it.
function wallPath(at, [u, v], seen, unit) {
  const length = Math.hypot(u, v);
  return seen < 0.4 ? groundPath(at, null, [0, 1], unit) : groundLine(at, [u / length, v / length], 0.8 * unit);
}

// Hatched ground beside a block that slides on it from a to b.
function railPath(a, b, seen, unit) {
  if (seen < 0.4) return groundPath([0, 0], null, [0, 1], unit);
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  let [nx, ny] = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
  if (ny < 0) [nx, ny] = [-nx, -ny];
  return groundLine([0.5 * (a[0] + b[0]) + 0.88 * unit * nx, 0.5 * (a[1] + b[1]) + 0.88 * unit * ny], [nx, ny], 0.5 * length);
}
