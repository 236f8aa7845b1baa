// The keys of the scene format, from the JSON schema of the program.

class Schema {
  constructor(schema) { this.root = schema; }

  // All alternatives of a schema as a flat list.
  static alternatives(node) {
    if (!node || typeof node !== 'object') return [];
    const grouped = [...(node.anyOf || []), ...(node.oneOf || [])].filter((one) => one.type || one.anyOf || one.oneOf || one.enum);
    const own = node.type || node.enum ? [node] : [];
    return [...own, ...grouped.flatMap((one) => Schema.alternatives(one))];
  }

  // The schemas at a path. `inSpace` selects the schema of scenes in space instead of the one in the plane.
  at(path, inSpace) {
    let nodes = Schema.alternatives(this.root.anyOf[inSpace ? 1 : 0]);
    for (const key of path) {
      nodes = nodes.flatMap((node) => {
        if (key === '[]') return Schema.alternatives(node.items);
        if (node.properties && Object.hasOwn(node.properties, key)) return Schema.alternatives(node.properties[key]);
        return Schema.alternatives(node.additionalProperties);
      });
    }
    return nodes;
  }

  // The allowed keys at a place as { name, doc, example }. Keys that start with the word at the place come first.
  keysAt(place, inSpace) {
    const tables = this.at(place.path, inSpace).filter((node) => node.type === 'object');
    const fits = (node) => [...place.keys].every((key) => node.additionalProperties || Object.hasOwn(node.properties || {}, key));
    const fitting = tables.filter(fits);
    const known = new Map();
    for (const node of fitting.length ? fitting : tables) {
      for (const [name, key] of Object.entries(node.properties || {})) {
        if (!place.keys.has(name) && !known.has(name)) known.set(name, { name, ...Schema.words(key) });
      }
    }
    const word = place.word.toLowerCase();
    const rank = (name) => (name.toLowerCase().startsWith(word) ? 0 : name.toLowerCase().includes(word) ? 1 : 2);
    return [...known.values()].filter((key) => rank(key.name) < 2).sort((a, b) => rank(a.name) - rank(b.name));
  }

  // The allowed words as values of a key, such as `mm`.
  wordsAt(place, inSpace) {
    const nodes = this.at([...place.path, ...place.key], inSpace);
    return nodes.flatMap((node) => node.enum || []).map((name) => ({ name: `"${name}"`, doc: '', example: '' }));
  }

  // The description of the last key of a path, or null.
  describe(path, inSpace) {
    if (!path.length) return null;
    const name = path[path.length - 1];
    for (const node of this.at(path.slice(0, -1), inSpace)) {
      if (node.properties && Object.hasOwn(node.properties, name)) return { name, ...Schema.words(node.properties[name]) };
    }
    for (const node of this.at(path.slice(0, -1), inSpace)) {
      if (typeof node.additionalProperties === 'object') return { name, ...Schema.words(node.additionalProperties) };
    }
    return null;
  }

  // The meaning of a key in one line.
  static sentence({ name, doc, example }) { return `${name}: ${doc}${example ? ` Example: ${example}` : ''}`; }

  static words(key) {
    const example = key.examples && key.examples.length ? inToml(key.examples[0]) : '';
    return { doc: key.description || '', example };
  }
}

// A value in one line of TOML.
function inToml(value) {
  if (Array.isArray(value)) return `[${value.map(inToml).join(', ')}]`;
  if (value && typeof value === 'object') {
    return `{ ${Object.entries(value).map(([key, one]) => `${key} = ${inToml(one)}`).join(', ')} }`;
  }
  return JSON.stringify(value);
}
