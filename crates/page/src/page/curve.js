// A curve as a path: through all rows, or through the smallest and largest values of each pixel if there are many rows.

// The path through the rows from `first` to `last`, with gaps at missing values.
// `across()` returns the horizontal coordinates of these rows as text.
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

// The path through the first, smallest, largest and last value of each pixel.
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

// A small curve through at most `points` rows.
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
