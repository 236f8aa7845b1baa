// Assertions of the tests.

export function expect(condition, message) {
  if (!condition) throw new Error(message);
}

export function same(found, expected, what) {
  expect(Object.is(found, expected), `${what}: ${JSON.stringify(found)} instead of ${JSON.stringify(expected)}`);
}

// The value of a number in the notation of the page.
export const printed = text => Number(text.replace(/−/g, '-').replace(/·10([⁻⁰-⁹¹²³]+)/, (_, power) => `e${[...power].map(c => '-0123456789'['⁻⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(c)]).join('')}`).replace(/[^\d.e-].*$/, ''));

export function near(found, expected, relative, what) {
  expect(Math.abs(found - expected) <= relative * Math.abs(expected) + 1e-300, `${what}: ${found} instead of ${expected}`);
}
