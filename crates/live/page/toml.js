// Tokens of a scene. They cover as much of TOML as colours, number sliders, and the table at the cursor need.

const TOKEN = new RegExp([
  '(?<comment>#[^\\n]*)',
  '(?<string>"""[\\s\\S]*?(?:"""|$)|\'\'\'[\\s\\S]*?(?:\'\'\'|$)|"(?:\\\\.|[^"\\\\\\n])*"?|\'[^\'\\n]*\'?)',
  '(?<newline>\\r?\\n)',
  '(?<space>[ \\t\\r]+)',
  '(?<number>[+-]?(?:\\d[\\d_]*)(?:\\.[\\d_]+)?(?:[eE][+-]?\\d+)?(?![\\p{L}\\p{N}_-]))',
  '(?<word>[\\p{L}\\p{N}_\\-\u2032\u2019]+)',
  '(?<mark>[^])',
].join('|'), 'gu');

// All tokens as { kind, from, to, text }, contiguous and in their order.
function tokens(text) {
  const found = [];
  for (const match of text.matchAll(TOKEN)) {
    const kind = Object.keys(match.groups).find((name) => match.groups[name] !== undefined);
    found.push({ kind, from: match.index, to: match.index + match[0].length, text: match[0] });
  }
  return found;
}

const unquoted = (token) => (token.kind === 'string' ? token.text.replace(/^['"]+|['"]+$/g, '') : token.text);

// Calls `each(token, role, place)` for every token, with its role ('header', 'key', 'value' or '') and its place
// { path: the keys of its table, keys: the keys so far in this table, key: the current key }.
function follow(all, each) {
  const table = (path) => ({ kind: 'table', path, keys: new Set(), key: [], valued: false });
  let root = table([]);
  let header = null;
  let frames = [root];
  for (const token of all) {
    const frame = frames[frames.length - 1];
    const names = token.kind === 'word' || token.kind === 'string' || token.kind === 'number';
    let role = '';
    if (header) role = names ? 'header' : '';
    else if (names) role = frame.kind !== 'array' && !frame.valued ? 'key' : 'value';
    each(token, role, frame, header);
    if (header) {
      if (names) header.push(unquoted(token));
      const ends = token.kind === 'newline' || (token.kind === 'mark' && token.text === ']');
      if (ends) {
        root = table(header);
        frames = [root];
        header = null;
      }
      continue;
    }
    if (token.kind === 'newline' && frames.length === 1) {
      frame.key = [];
      frame.valued = false;
    } else if (role === 'key') {
      // The number token of a dotted key such as 1.5 is added as one key.
      frame.key.push(unquoted(token));
    } else if (token.kind === 'mark') {
      mark(token.text, frames, () => { header = []; });
    }
  }
  return frames[frames.length - 1];
}

function mark(text, frames, startHeader) {
  const frame = frames[frames.length - 1];
  const below = () => [...frame.path, ...(frame.kind === 'array' ? ['[]'] : frame.key)];
  if (text === '=' && frame.kind !== 'array') {
    frame.valued = true;
    if (frame.key.length) frame.keys.add(frame.key[0]);
  } else if (text === ',' && frame.kind === 'inline') {
    frame.key = [];
    frame.valued = false;
  } else if (text === '{' && (frame.valued || frame.kind === 'array')) {
    frames.push({ kind: 'inline', path: below(), keys: new Set(), key: [], valued: false });
  } else if (text === '[') {
    if (frame.kind === 'table' && !frame.valued) {
      if (!frame.key.length) startHeader();
    } else frames.push({ kind: 'array', path: below(), keys: new Set(), key: [], valued: true });
  } else if ((text === '}' && frame.kind === 'inline') || (text === ']' && frame.kind === 'array')) {
    frames.pop();
  }
}

// The place of an offset in the text: { path, keys, key, valued, word, from, inHeader }. `word` is the text from `from` to the offset.
function placeAt(text, offset) {
  const before = tokens(text.slice(0, offset));
  const last = before[before.length - 1];
  if (last && last.kind === 'comment') return null;
  let header = null;
  const frame = follow(before, (token, role, _, open) => { header = role === 'header' || open ? open : null; });
  const isWord = last && (last.kind === 'word' || last.kind === 'number');
  const word = isWord ? last.text : '';
  const place = { path: frame.path, keys: frame.keys, key: [...frame.key], valued: frame.valued, word, from: offset - word.length };
  if (header && !(last.kind === 'mark' && last.text === ']')) {
    const path = isWord ? header.slice(0, -1) : header;
    return { ...place, path, keys: new Set(), key: [], valued: false, inHeader: true };
  }
  if (isWord && !frame.valued && frame.kind !== 'array') place.key.pop();
  if (!frame.valued) place.path = [...frame.path, ...place.key];
  if (last && last.kind === 'string' && !/^(""".*"""|'''.*'''|".*"|'.*')$/s.test(last.text)) return null;
  return { ...place, inHeader: false };
}
