// Elements of the document. Strings from a scene are always inserted as text, never as markup.

const SVG = 'http://www.w3.org/2000/svg';

function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children.flat(2)) {
    if (child !== null && child !== undefined) element.append(child);
  }
  return element;
}

function el(tag, attributes, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

function svg(tag, attributes, ...children) {
  return filled(document.createElementNS(SVG, tag), attributes, children);
}

// Sets the text of an element if it has changed. The text node itself is kept.
function setText(element, text) {
  if (element.firstChild) {
    if (element.firstChild.nodeValue !== text) element.firstChild.nodeValue = text;
  } else element.textContent = text;
}

// Deferred work, done after the visible parts are drawn. `done()` is a promise that resolves when no task is left.
function createLater() {
  const tasks = new Map();
  let waiting = null;
  const whenIdle = act => (window.requestIdleCallback ? requestIdleCallback(act, { timeout: 300 }) : setTimeout(act, 20));
  function act(finish) {
    const begun = performance.now();
    for (const [name, task] of tasks) {
      // An unfinished task continues in the next idle period.
      if (!task(() => performance.now() - begun > 8)) break;
      tasks.delete(name);
      if (performance.now() - begun > 8) break;
    }
    if (tasks.size) whenIdle(() => act(finish));
    else {
      waiting = null;
      finish();
    }
  }
  return {
    // `task(isLate)` returns true when it is finished; it may stop and return false once `isLate()` is true. A new task replaces
    // an old one of the same name.
    add(name, task) {
      tasks.delete(name);
      tasks.set(name, task);
      waiting ??= new Promise(finish => whenIdle(() => act(finish)));
    },
    done: () => waiting || Promise.resolve(),
  };
}

// A function that replaces the children of an element only if their signature has changed.
function createRenewed(element) {
  let before = null;
  return (signature, children) => {
    if (signature === before) return;
    before = signature;
    element.replaceChildren(...children());
  };
}

function card(title, id, ...children) {
  const heading = title ? el('h2', { id: id + '-title' }, title) : null;
  return el('section', { class: 'card', id, 'aria-labelledby': title ? id + '-title' : null }, heading, children);
}
