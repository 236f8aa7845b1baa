// Elements of the document. What comes from a scene is always text, never markup.

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

// Sets the text of an element where it has changed: a text node is not replaced at every move.
function setText(element, text) {
  if (element.firstChild) {
    if (element.firstChild.nodeValue !== text) element.firstChild.nodeValue = text;
  } else element.textContent = text;
}

// Work that can wait until what is seen is drawn. `done()` is a promise that nothing waits any more.
function createLater() {
  const tasks = new Map();
  let waiting = null;
  const whenIdle = act => (window.requestIdleCallback ? requestIdleCallback(act, { timeout: 300 }) : setTimeout(act, 20));
  function act(finish) {
    const begun = performance.now();
    for (const [name, task] of tasks) {
      // A task that is not done in its share goes on the next time.
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
    // `task(isLate)` is whether it is done; it may leave the rest to another time when it is late. Of one name only the newest is done.
    add(name, task) {
      tasks.delete(name);
      tasks.set(name, task);
      waiting ??= new Promise(finish => whenIdle(() => act(finish)));
    },
    done: () => waiting || Promise.resolve(),
  };
}

// The children of an element, made anew only where what they say has changed.
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
