// The list of keys that are allowed at the cursor.

const LONGEST_LIST = 12;

class Completion {
  constructor(editor, list) {
    this.editor = editor;
    this.list = list;
    this.choices = [];
    this.chosen = 0;
    this.list.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      const item = event.target.closest('[role=option]');
      if (item) this.accept([...this.list.children].indexOf(item));
    });
  }

  get isOpen() { return !this.list.hidden; }

  // Shows the fitting keys. Before the first letter of a word it shows them only if `asked`.
  update(asked) {
    const { editor } = this;
    const at = editor.area.selectionStart;
    this.close();
    if (!editor.schema || at !== editor.area.selectionEnd) return;
    const place = placeAt(editor.text, at);
    if (!place || !(asked || place.word)) return;
    const follows = /^[\p{L}\p{N}_-]/u.test(editor.text.slice(at));
    if (follows) return;
    const found = place.valued ? editor.schema.wordsAt(place, editor.inSpace) : editor.schema.keysAt(place, editor.inSpace);
    const choices = found.filter((one) => one.name !== place.word).slice(0, LONGEST_LIST);
    const isWhole = found.some((one) => one.name === place.word);
    if (!choices.length || (place.valued && !asked) || (isWhole && !asked)) return;
    this.choices = choices;
    this.from = place.from;
    this.to = at;
    this.list.replaceChildren(...choices.map((choice) => this.item(choice)));
    this.list.hidden = false;
    this.choose(0);
    this.place();
  }

  item(choice) {
    const item = document.createElement('li');
    item.setAttribute('role', 'option');
    const name = document.createElement('b');
    name.textContent = choice.name;
    const doc = document.createElement('span');
    doc.textContent = choice.doc;
    item.append(name, doc);
    return item;
  }

  place() {
    if (!this.isOpen) return;
    const at = this.editor.rectangle(this.from);
    const box = this.editor.colours;
    const below = at.bottom + this.list.offsetHeight <= box.clientHeight || at.top < this.list.offsetHeight;
    this.list.style.left = `${Math.max(0, Math.min(at.left, box.clientWidth - this.list.offsetWidth))}px`;
    this.list.style.top = `${below ? at.bottom : at.top - this.list.offsetHeight}px`;
  }

  choose(k) {
    this.chosen = (k + this.choices.length) % this.choices.length;
    [...this.list.children].forEach((item, i) => item.setAttribute('aria-selected', String(i === this.chosen)));
    this.list.children[this.chosen].scrollIntoView({ block: 'nearest' });
    this.editor.showHint();
  }

  // The meaning of the chosen key.
  get meaning() { return Schema.sentence(this.choices[this.chosen]); }

  accept(k) {
    const { name } = this.choices[k];
    const { from, to } = this;
    this.close();
    this.editor.type(from, to, name);
    this.close();
  }

  close() { this.list.hidden = true; }

  // Handles a pressed key; returns whether the list used it.
  keyDown(event) {
    if (!this.isOpen) return false;
    const acts = {
      ArrowDown: () => this.choose(this.chosen + 1),
      ArrowUp: () => this.choose(this.chosen - 1),
      Enter: () => this.accept(this.chosen),
      Tab: () => this.accept(this.chosen),
      Escape: () => {
        this.close();
        this.editor.showHint();
      },
    };
    const act = Object.hasOwn(acts, event.key) ? acts[event.key] : null;
    if (!act) return false;
    event.preventDefault();
    act();
    return true;
  }
}
