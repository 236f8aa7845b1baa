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

function card(title, id, ...children) {
  const heading = title ? el('h2', { id: id + '-title' }, title) : null;
  return el('section', { class: 'card', id, 'aria-labelledby': title ? id + '-title' : null }, heading, children);
}
