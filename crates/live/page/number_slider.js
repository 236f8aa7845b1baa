// A slider under a clicked number.

const STEPS = 400;

class NumberSlider {
  constructor(editor, box) {
    this.editor = editor;
    this.box = box;
    this.input = box.querySelector('input');
    this.written = null;
    this.input.addEventListener('input', () => this.slid());
    this.input.addEventListener('change', () => this.settle());
    this.input.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      this.close();
      this.editor.area.focus();
    });
  }

  openAt(offset) {
    this.close();
    const { area, text } = this.editor;
    if (area.selectionStart !== area.selectionEnd) return;
    let found = null;
    follow(tokens(text), (token, role) => {
      if (token.kind === 'number' && role === 'value' && token.from <= offset && offset <= token.to) found = token;
    });
    const value = found ? Number(found.text.replace(/_/g, '')) : NaN;
    if (!Number.isFinite(value)) return;
    this.from = found.from;
    this.to = found.to;
    // The slider covers 0 to twice the number; for the number 0, it covers −1 to 1. Counts stay whole numbers.
    const size = Math.abs(value) || 1;
    this.low = value === 0 ? -1 : value - size;
    this.step = (2 * size) / STEPS;
    this.decimals = Math.min(12, Math.max(decimalsOf(found.text), Math.ceil(-Math.log10(this.step))));
    this.whole = /^[+-]?[\d_]+$/.test(found.text) && isCount(text, found.from);
    this.input.min = '0';
    this.input.max = String(STEPS);
    this.input.value = String(Math.round((value - this.low) / this.step));
    this.input.setAttribute('aria-valuetext', found.text);
    this.box.hidden = false;
    this.place();
  }

  slid() {
    const value = this.low + Number(this.input.value) * this.step;
    const written = this.whole ? String(Math.max(2, Math.round(value))) : number(value, this.decimals);
    this.written = written;
    this.editor.slide(this.from, this.to, written);
    this.input.setAttribute('aria-valuetext', written);
  }

  // Enters the number in the text and keeps the slider open.
  settle() {
    const { written, from, to } = this;
    if (written === null) return;
    this.written = null;
    this.editor.settle(from, to, written);
    this.to = from + written.length;
    this.box.hidden = false;
    this.place();
    this.input.focus();
  }

  place() {
    if (this.box.hidden) return;
    const at = this.editor.rectangle(this.from);
    this.box.style.left = `${Math.max(0, Math.min(at.left, this.editor.colours.clientWidth - this.box.offsetWidth))}px`;
    this.box.style.top = `${at.bottom + 2}px`;
  }

  focus() {
    if (!this.box.hidden) this.input.focus();
  }

  close() {
    if (this.written !== null) {
      const { written, from, to } = this;
      this.written = null;
      this.editor.settle(from, to, written);
    }
    this.box.hidden = true;
  }
}

const decimalsOf = (text) => (/\.(\d*)/.exec(text) || ['', ''])[1].length;

// The number as text without trailing zeros.
function number(value, decimals) {
  if (Math.abs(value) >= 1e12 || (value !== 0 && Math.abs(value) < 1e-9)) return String(Number(value.toPrecision(6)));
  const text = value.toFixed(decimals);
  return text.includes('.') ? text.replace(/\.?0+$/, '') : text;
}

// Whether the number at `from` is a count, as in `points = 361`.
const isCount = (text, from) => /(^|[\s{,])points\s*=\s*$/.test(text.slice(Math.max(0, from - 40), from));
