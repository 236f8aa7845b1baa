// The text of the scene: a text area over a coloured copy of its text, in which errors are underlined.

// Kinds of tokens with a colour.
const COLOURED = new Set(['comment', 'header', 'key', 'string', 'number']);
// Longer texts (in characters) have no colours, completion or explanations, because a million elements crash the tab. The longest
// case has a quarter of this length.
const LONGEST_COLOURED = 50000;

class Editor {
  // `changed(text)` is called after every change.
  constructor(root, changed) {
    this.area = root.querySelector('textarea');
    this.colours = root.querySelector('pre');
    // The line feed gives an empty last line its height.
    this.colours.append('\n');
    this.hint = root.querySelector('[data-part=hint]');
    this.schema = null;
    this.messages = [];
    // The text while the slider of a number moves. It is shown and computed, and entered as an edit when the user releases the slider.
    this.sliding = null;
    this.changed = changed;
    this.completion = new Completion(this, root.querySelector('[data-part=completion]'));
    this.slider = new NumberSlider(this, root.querySelector('[data-part=slider]'));
    this.area.addEventListener('input', () => this.edited());
    this.area.addEventListener('scroll', () => this.scrolled());
    this.area.addEventListener('keydown', (event) => this.keyDown(event));
    this.area.addEventListener('click', () => this.slider.openAt(this.area.selectionStart));
    this.area.addEventListener('blur', () => this.completion.close());
    document.addEventListener('selectionchange', () => {
      if (document.activeElement === this.area) this.showHint();
    });
  }

  get text() { return this.sliding ?? this.area.value; }

  // Replaces the whole text without calling `changed`.
  open(text) {
    this.sliding = null;
    this.area.value = text;
    this.area.scrollTop = 0;
    this.area.setSelectionRange(0, 0);
    this.slider.close();
    this.completion.close();
    this.messages = [];
    this.draw();
  }

  edited() {
    this.slider.close();
    this.messages = [];
    this.draw();
    if (!this.isLong) this.completion.update(false);
    // The browser sends `selectionchange` only with its next frame.
    this.showHint();
    this.changed(this.text);
  }

  // Replaces a part of the text as typing would, so that the user can undo it.
  type(from, to, text) {
    this.area.focus();
    this.area.setSelectionRange(from, to);
    if (!document.execCommand('insertText', false, text)) {
      this.area.setRangeText(text, from, to, 'end');
      this.edited();
    }
  }

  // Shows the text with a part replaced, without editing it: `setRangeText` would clear the undo history of the browser.
  slide(from, to, text) {
    const typed = this.area.value;
    this.sliding = typed.slice(0, from) + text + typed.slice(to);
    this.messages = [];
    this.draw();
    this.changed(this.text);
  }

  // Enters the number of the slider as one undo step.
  settle(from, to, text) {
    if (this.sliding === null) return;
    this.sliding = null;
    if (this.area.value.slice(from, to) !== text) this.type(from, to, text);
    else this.edited();
  }

  // Whether the scene is in space, that is, whether it contains an array of three numbers.
  get inSpace() { return /=\s*\[\s*[-+\d.e_]+\s*,\s*[-+\d.e_]+\s*,\s*[-+\d.e_]+\s*\]/.test(this.text.replace(/#.*$/gm, '')); }

  show(messages) {
    const isPlain = (all) => all.every((message) => !message.labels.length);
    const isDrawn = isPlain(this.messages) && isPlain(messages);
    this.messages = messages;
    if (!isDrawn) this.draw();
    this.showHint();
  }

  get isLong() { return this.text.length > LONGEST_COLOURED; }

  draw() {
    this.paint(this.isLong ? [[this.text, '']] : this.parts());
    // The scroll event moves the colours with the text; reading the scroll position here would force a layout of the page.
    this.slider.place();
    this.completion.place();
  }

  // The text in pieces, each with its CSS classes.
  parts() {
    const marks = this.messages.flatMap((message) => message.labels.map((label) => ({ ...label, severity: message.severity })));
    const { text } = this;
    const parts = [];
    follow(tokens(text), (token, role) => {
      for (const [from, to] of cut(token, marks)) {
        const hit = marks.filter((mark) => mark.from < to && Math.max(mark.to, mark.from + 1) > from);
        const severity = hit.some((mark) => mark.severity === 'error') ? ' error' : hit.length ? ' warning' : '';
        const name = [role, token.kind].find((one) => COLOURED.has(one)) || '';
        const [last] = parts.slice(-1);
        // Neighbouring pieces with the same classes share one element, because every element costs layout and painting at each change.
        if (last && last[1] === name + severity) last[0] += text.slice(from, to);
        else parts.push([text.slice(from, to), name + severity]);
      }
    });
    return parts;
  }

  // Shows the pieces. Elements before and after the changed pieces are kept.
  paint(parts) {
    const spans = this.colours.children;
    const isSame = (span, [text, name]) => span.firstChild.nodeValue === text && span.className === name;
    let first = 0;
    while (first < spans.length && first < parts.length && isSame(spans[first], parts[first])) first += 1;
    let [end, last] = [spans.length, parts.length];
    while (end > first && last > first && isSame(spans[end - 1], parts[last - 1])) [end, last] = [end - 1, last - 1];
    const old = Array.from({ length: end - first }, (_, k) => spans[first + k]);
    const after = spans[end] || this.colours.lastChild;
    for (const span of old) span.remove();
    for (const [text, name] of parts.slice(first, last)) {
      const span = document.createElement('span');
      span.textContent = text;
      span.className = name;
      this.colours.insertBefore(span, after);
    }
  }

  scrolled() {
    this.colours.scrollTop = this.area.scrollTop;
    this.colours.scrollLeft = this.area.scrollLeft;
    this.slider.place();
    this.completion.place();
  }

  // The position of an offset on the screen, relative to the editor, px: left of the character there, or right of the one before it.
  rectangle(offset) {
    const own = this.colours.parentElement.getBoundingClientRect();
    for (const [at, side] of [[offset, 'left'], [offset - 1, 'right']]) {
      const found = this.characterBox(at);
      if (found && found.height) return { left: found[side] - own.left, top: found.top - own.top, bottom: found.bottom - own.top };
    }
    return { left: 0, top: 0, bottom: 20 };
  }

  characterBox(offset) {
    const walker = document.createTreeWalker(this.colours, NodeFilter.SHOW_TEXT);
    let left = offset;
    for (let node = walker.nextNode(); node && left >= 0; node = walker.nextNode()) {
      if (left < node.length) {
        const range = document.createRange();
        range.setStart(node, left);
        range.setEnd(node, left + 1);
        return range.getBoundingClientRect();
      }
      left -= node.length;
    }
    return null;
  }

  keyDown(event) {
    if (this.completion.keyDown(event)) return;
    if (event.key === 'Escape') this.slider.close();
    if (event.key === ' ' && event.ctrlKey) {
      event.preventDefault();
      this.completion.update(true);
      // Without a key to complete, the shortcut opens the slider of the number at the cursor.
      if (this.completion.isOpen) return;
      this.slider.openAt(this.area.selectionStart);
      this.slider.focus();
    }
  }

  // Shows the meaning of the key chosen in the list. Without a list, it shows the error at the cursor and the meaning of the key there.
  showHint() {
    if (this.completion.isOpen) {
      this.hint.className = '';
      this.hint.textContent = this.completion.meaning;
      return;
    }
    const at = this.area.selectionStart;
    const here = this.messages.find((m) => m.labels.some((l) => l.from <= at && at <= Math.max(l.to, l.from + 1)));
    const wrong = here ? [here.message, here.help].filter(Boolean).join('; ') : '';
    this.hint.className = here ? here.severity : '';
    this.hint.textContent = [wrong, this.meaningAt(at)].filter(Boolean).join('\n');
  }

  meaningAt(offset) {
    if (!this.schema || this.isLong) return '';
    // Extends the place to the end of the word at the cursor.
    const rest = /^[\p{L}\p{N}_-]*/u.exec(this.text.slice(offset))[0].length;
    const place = placeAt(this.text, offset + rest);
    if (!place) return '';
    const path = place.valued ? [...place.path, ...place.key] : [...place.path, ...(place.word ? [place.word] : [])];
    const key = this.schema.describe(path.filter((step, k) => k < path.length - 1 || step !== '[]'), this.inSpace);
    return key && key.doc ? Schema.sentence(key) : '';
  }

  select(label) {
    this.area.focus();
    this.area.setSelectionRange(label.from, Math.max(label.to, label.from));
    const line = this.text.slice(0, label.from).split('\n').length;
    const height = this.area.scrollHeight / this.text.split('\n').length;
    this.area.scrollTop = Math.max(0, (line - 6) * height);
    this.showHint();
  }
}

// Cuts a token at the ends of the marks.
function cut(token, marks) {
  const ends = new Set([token.from, token.to]);
  for (const mark of marks) {
    for (const end of [mark.from, Math.max(mark.to, mark.from + 1)]) {
      if (end > token.from && end < token.to) ends.add(end);
    }
  }
  const sorted = [...ends].sort((a, b) => a - b);
  return sorted.slice(1).map((end, k) => [sorted[k], end]);
}
