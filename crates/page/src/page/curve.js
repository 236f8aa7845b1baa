// A curve as a path: all of its rows, or the smallest and largest of each pixel where these are many.

// Through the rows from `first` to `last`; a gap where there is no value.
// `across()` are the places of the rows along the axis, written.
function curvePath(xs, ys, [first, last], toX, toY, width, across) {
  const count = last - first + 1;
  if (count > 3 * width) return denseCurve(xs, ys, [first, last], toX, toY);
  const places = across();
  let d = '';
  let isOpen = false;
  for (let k = first; k <= last; k++) {
    const y = ys[k];
    if (!Number.isFinite(y)) {
      isOpen = false;
      continue;
    }
    d += `${isOpen ? 'L' : 'M'}${places[k - first]} ${tenth(toY(y))}`;
    isOpen = true;
  }
  return d;
}

// In each pixel the first value, the smallest, the largest and the last one.
function denseCurve(xs, ys, [first, last], toX, toY) {
  let d = '';
  let pixel = null;
  let isOpen = false;
  let low = 0;
  let high = 0;
  let end = 0;
  const close = () => {
    if (pixel === null) return;
    d += `L${pixel} ${tenth(toY(low))}L${pixel} ${tenth(toY(high))}L${pixel} ${tenth(toY(end))}`;
    pixel = null;
  };
  for (let k = first; k <= last; k++) {
    const y = ys[k];
    if (!Number.isFinite(y)) {
      close();
      isOpen = false;
      continue;
    }
    const x = Math.round(toX(xs[k]));
    if (x !== pixel) {
      close();
      d += `${isOpen ? 'L' : 'M'}${x} ${tenth(toY(y))}`;
      [pixel, low, high, isOpen] = [x, y, y, true];
    }
    if (y < low) low = y;
    if (y > high) high = y;
    end = y;
  }
  close();
  return d;
}

// A curve in little, of at most so many points.
function sparkline(values, width, height, [low, high], points = 90) {
  const span = high - low || 1;
  const last = values.length - 1;
  let d = '';
  let isOpen = false;
  const count = Math.min(points, values.length);
  for (let k = 0; k < count; k++) {
    const value = values[Math.round((k * last) / Math.max(1, count - 1))];
    if (!Number.isFinite(value)) {
      isOpen = false;
      continue;
    }
    const x = (k / Math.max(1, count - 1)) * width;
    d += `${isOpen ? 'L' : 'M'}${tenth(x)} ${tenth(height - 1.5 - ((value - low) / span) * (height - 3))}`;
    isOpen = true;
  }
  return d;
}
