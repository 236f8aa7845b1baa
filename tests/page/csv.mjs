// Reads tables in the CSV format of the commands.

import { readFileSync } from 'node:fs';

function fields(line) {
  const all = [''];
  let isQuoted = false;
  for (const c of line) {
    if (c === '"') isQuoted = !isQuoted;
    else if (c === ',' && !isQuoted) all.push('');
    else all[all.length - 1] += c;
  }
  return all;
}

// Header and rows; an empty field is NaN.
export function parse(text) {
  const [header, ...rows] = text.trim().split('\n').map(fields);
  const number = field => (field === '' ? NaN : Number(field.replace('inf', 'Infinity')));
  return { header, rows: rows.map(row => row.map(number)) };
}

export const read = path => parse(readFileSync(path, 'utf8'));
