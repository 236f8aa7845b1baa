// The keys of the format, from the schema that the program itself gives.

class Schema {
  constructor(schema) { this.root = schema; }

  // The alternatives of a schema, without their grouping.
  static alternatives(node) {
    if (!node || typeof node !== 'object') return [];
    const grouped = [...(node.anyOf || []), ...(node.oneOf || [])].filter((one) => one.type || one.anyOf || one.oneOf || one.enum);
    const own = node.type || node.enum ? [node] : [];
    return [...own, ...grouped.flatMap((one) => Schema.alternatives(one))];
  }

  // The tables that stand at a path; `inSpace` chooses the first step among scenes in the plane and in space.
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

  // What may be written as a key at a place: { name, doc, example }, those that begin with its word first.
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

  // The words that may be written as the value of a key, such as `mm`.
  wordsAt(place, inSpace) {
    const nodes = this.at([...place.path, ...place.key], inSpace);
    return nodes.flatMap((node) => node.enum || []).map((name) => ({ name: `"${name}"`, doc: '', example: '' }));
  }

  // What a key means: the description of the last key of a path, or nothing.
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

  // What a key means, in a line.
  static sentence({ name, doc, example }) { return `${name}: ${doc}${example ? ` Example: ${example}` : ''}`; }

  static words(key) {
    const example = key.examples && key.examples.length ? inToml(key.examples[0]) : '';
    return { doc: key.description || '', example };
  }
}

// A value as TOML writes it in a line.
function inToml(value) {
  if (Array.isArray(value)) return `[${value.map(inToml).join(', ')}]`;
  if (value && typeof value === 'object') {
    return `{ ${Object.entries(value).map(([key, one]) => `${key} = ${inToml(one)}`).join(', ')} }`;
  }
  return JSON.stringify(value);
}
