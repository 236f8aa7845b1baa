// Numbers: unpacks them exactly, and formats them in the selected units.

// Unpacks doubles from Base64 of a gzip stream: first the least significant bytes of all numbers, then the next bytes, and so on.
async function unpack(text) {
  const packed = Uint8Array.from(atob(text.trim()), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = bytes.length / 8;
  const numbers = new Float64Array(count);
  const into = new Uint8Array(numbers.buffer);
  for (let b = 0; b < 8; b++) for (let k = 0; k < count; k++) into[8 * k + b] = bytes[b * count + k];
  return numbers;
}

const POWERS = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };
const raised = text => [...String(text)].map(c => POWERS[c] || c).join('');

// A number with the given count of significant digits and the minus sign U+2212.
function format(value, digits = 5) {
  if (Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  if (value === 0) return '0';
  const power = Math.floor(Math.log10(Math.abs(value)));
  let text;
  if (power < -4 || power > 6) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    const short = mantissa.includes('.') ? mantissa.replace(/\.?0+$/, '') : mantissa;
    text = `${short}·10${raised(Number(exponent))}`;
  } else {
    text = value.toFixed(Math.max(0, digits - 1 - power));
    if (text.includes('.')) text = text.replace(/\.?0+$/, '');
    if (text === '-0' || text === '0') text = '0';
  }
  return text.replace('-', '−');
}

// A coordinate as text, rounded to a tenth of a pixel. Texts of coordinates within a picture are cached, because a curve has hundreds.
const TENTHS = [];
function tenth(value) {
  const tenths = Math.round(10 * value);
  if (!(tenths >= 0 && tenths < 20000)) return String(tenths / 10);
  return TENTHS[tenths] || (TENTHS[tenths] = String(tenths / 10));
}

const scientific = value => (value === 0 ? '0' : Number.isFinite(value) ? value.toExponential(1).replace('-', '−').replace('+', '') : String(value));

// A unit for display: `N m` becomes N·m, and `m/s2` becomes m/s².
const printedUnit = unit => unit.replace(/ /g, '·').replace(/([a-zA-Z])(\d)/g, (_, letter, power) => letter + raised(power));

// The units of a page: either the units of the scene, with degrees for angles as in the pictures, or SI units.
function createUnits(displayUnits) {
  const known = {};
  for (const { si, unit, factor } of displayUnits) known[si] = { unit, factor };
  if (!known.rad || known.rad.unit === 'rad' || known.rad.unit === 'deg') known.rad = { unit: '°', factor: 180 / Math.PI };
  if (!known.m) known.m = { unit: 'm', factor: 1 };
  return {
    mode: 'scene',
    // Name and factor of the displayed unit for an SI unit of the data.
    of(si) {
      const root = /^(rad|m)(\/s2?)?$/.exec(si);
      if (this.mode === 'si' || !root) return { name: printedUnit(si), factor: 1 };
      const { unit, factor } = known[root[1]];
      return { name: printedUnit(unit + (root[2] || '')), factor };
    },
    // A value with its unit.
    text(value, si, digits) {
      const { name, factor } = this.of(si);
      const space = name === '°' || name === '' ? '' : ' ';
      return format(value * factor, digits) + (Number.isFinite(value) ? space + name : '');
    },
    // Labels of the two modes.
    names() {
      const { rad, m } = known;
      return { scene: `${rad.unit}, ${m.unit}`, si: 'rad, m' };
    },
  };
}

// About `wanted` round numbers between two values, with the number of decimals that distinguishes them.
function ticks(from, to, wanted, isDegrees) {
  const span = to - from;
  if (!(span > 0) || !Number.isFinite(span)) return { values: [from], decimals: 2 };
  const rough = span / Math.max(1, wanted);
  const power = 10 ** Math.floor(Math.log10(rough));
  let step = [1, 2, 2.5, 5, 10].map(m => m * power).find(s => s >= rough * 0.999);
  if (isDegrees && span > 12) step = [5, 10, 15, 30, 45, 90, 180, 360].find(s => s >= rough * 0.999) || Math.ceil(rough / 360) * 360;
  const values = [];
  // The tolerance keeps ticks at both ends despite rounding.
  const first = Math.ceil(from / step - 1e-6);
  const last = Math.floor(to / step + 1e-6);
  for (let k = first; k <= last && values.length < 60; k++) values.push(k * step);
  // Enough decimals to print the step exactly: 2.5 needs one more than 2.
  let decimals = 0;
  while (decimals < 12 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6 * step * 10 ** decimals) decimals++;
  return { values, decimals };
}

function tickText(value, decimals) {
  if (decimals > 4 && value === 0) return '0';
  if (value !== 0 && (Math.abs(value) >= 1e6 || Math.abs(value) < 1e-4)) return format(value, 3);
  const text = value.toFixed(Math.min(decimals, 12));
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}
