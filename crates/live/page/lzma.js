// Unpacks LZMA (https://www.7-zip.org/sdk.html, lzma-specification.txt). Browsers unpack only gzip, whose window of 32 kB is too
// short to find copies of generic functions. Variables have the names of the specification.

const LZMA_HALF = 1024;
const lzmaChances = (count) => new Uint16Array(count).fill(LZMA_HALF);

// The content of a `.lzma` file, which consists of properties, size of the dictionary, size of the content, and a range-coded stream.
function unpackLzma(packed) {
  const header = new DataView(packed.buffer, packed.byteOffset, 13);
  const size = Number(header.getBigUint64(5, true));
  // The build writes no files of unknown size (2⁶⁴ − 1).
  if (!(size <= 1e9)) throw new Error('the module is not packed as it should be');
  const out = new Uint8Array(size);
  const stream = lzmaStream(packed, header.getUint8(0), out);
  while (stream.place() < size) stream.step();
  return out;
}

// The range decoder, which decodes bits with their probabilities.
function lzmaRange(packed, start) {
  let at = start;
  let range = 0xffffffff;
  let code = 0;
  for (let k = 0; k < 5; k++) code = ((code << 8) | packed[at++]) >>> 0;
  const refill = () => {
    if (range >= 0x1000000) return;
    range = (range << 8) >>> 0;
    code = ((code << 8) | packed[at++]) >>> 0;
  };
  // A bit that is 0 with the probability chances[k] / 2048.
  function bit(chances, k) {
    const chance = chances[k];
    const bound = Math.imul(range >>> 11, chance) >>> 0;
    let is = 0;
    if (code < bound) {
      range = bound;
      chances[k] = chance + ((2048 - chance) >>> 5);
    } else {
      range = (range - bound) >>> 0;
      code = (code - bound) >>> 0;
      chances[k] = chance - (chance >>> 5);
      is = 1;
    }
    if (range < 0x1000000) {
      range = (range << 8) >>> 0;
      code = ((code << 8) | packed[at++]) >>> 0;
    }
    return is;
  }
  // Bits that are 0 or 1 with equal probability.
  function plain(count) {
    let value = 0;
    for (let k = 0; k < count; k++) {
      range >>>= 1;
      const is = code >= range ? 1 : 0;
      if (is) code = (code - range) >>> 0;
      value = (value << 1) | is;
      refill();
    }
    return value;
  }
  // A number of `count` bits; the probability of each depends on the bits before it. `tree` starts with the highest bit, `reversed` with
  // the lowest.
  function tree(chances, from, count) {
    let node = 1;
    for (let k = 0; k < count; k++) node = (node << 1) | bit(chances, from + node);
    return node - (1 << count);
  }
  function reversed(chances, from, count) {
    let node = 1;
    let value = 0;
    for (let k = 0; k < count; k++) {
      const is = bit(chances, from + node);
      node = (node << 1) | is;
      value |= is << k;
    }
    return value;
  }
  return { bit, plain, tree, reversed };
}

// The lengths of matches, at least 2.
function lzmaLengths({ bit, tree }) {
  const [choice, low, middle, high] = [2, 128, 128, 256].map(lzmaChances);
  return (posState) => {
    if (!bit(choice, 0)) return 2 + tree(low, posState << 3, 3);
    if (!bit(choice, 1)) return 10 + tree(middle, posState << 3, 3);
    return 18 + tree(high, 0, 8);
  };
}

function lzmaStream(packed, properties, out) {
  const [lc, lp, pb] = [properties % 9, Math.floor(properties / 9) % 5, Math.floor(properties / 45)];
  const range = lzmaRange(packed, 13);
  const { bit } = range;
  const literals = lzmaChances(0x300 << (lc + lp));
  const [isMatch, isRep0Long] = [192, 192].map(lzmaChances);
  const [isRep, isRepG0, isRepG1, isRepG2] = [12, 12, 12, 12].map(lzmaChances);
  const [slots, near, aligned] = [256, 128, 16].map(lzmaChances);
  const [matchLength, repLength] = [lzmaLengths(range), lzmaLengths(range)];
  const reps = [0, 0, 0, 0];
  let state = 0;
  let place = 0;

  function literal() {
    const before = place ? out[place - 1] : 0;
    const from = 0x300 * (((place & ((1 << lp) - 1)) << lc) + (before >> (8 - lc)));
    let symbol = 1;
    if (state >= 7) {
      // After a match, the next byte probably differs from the byte that follows the copied ones.
      let match = out[place - reps[0] - 1];
      do {
        const expected = (match >> 7) & 1;
        match <<= 1;
        const is = bit(literals, from + ((1 + expected) << 8) + symbol);
        symbol = (symbol << 1) | is;
        if (expected !== is) break;
      } while (symbol < 0x100);
    }
    while (symbol < 0x100) symbol = (symbol << 1) | bit(literals, from + symbol);
    out[place++] = symbol;
    state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
  }

  // The distance back to the start of a match, minus one.
  function distance(length) {
    const slot = range.tree(slots, Math.min(length - 2, 3) << 6, 6);
    if (slot < 4) return slot;
    const count = (slot >> 1) - 1;
    const base = (2 | (slot & 1)) << count;
    if (slot < 14) return base + range.reversed(near, base - slot, count);
    return base + range.plain(count - 4) * 16 + range.reversed(aligned, 0, 4);
  }

  // The index of one of the last four distances, which becomes the first of them.
  function repeated() {
    const which = !bit(isRepG0, state) ? 0 : !bit(isRepG1, state) ? 1 : !bit(isRepG2, state) ? 2 : 3;
    const one = reps[which];
    for (let k = which; k > 0; k--) reps[k] = reps[k - 1];
    reps[0] = one;
    return which;
  }

  function step() {
    const posState = place & ((1 << pb) - 1);
    if (!bit(isMatch, (state << 4) + posState)) return literal();
    let length;
    if (bit(isRep, state)) {
      if (repeated() === 0 && !bit(isRep0Long, (state << 4) + posState)) {
        state = state < 7 ? 9 : 11;
        length = 1;
      } else {
        length = repLength(posState);
        state = state < 7 ? 8 : 11;
      }
    } else {
      length = matchLength(posState);
      for (let k = 3; k > 0; k--) reps[k] = reps[k - 1];
      reps[0] = distance(length);
      state = state < 7 ? 7 : 10;
    }
    for (let from = place - reps[0] - 1; length > 0; length--) out[place++] = out[from++];
  }
  return { step, place: () => place };
}
