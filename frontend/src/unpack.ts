// Unpacks columns packed by src/linkwork/app/pages/packing.py.

import type { PackedColumn } from "./page_data";

/** The order of a column of plain floats of eight or four bytes. */
const PLAIN = -1;
const SHORT = -2;

/** Built into new browsers. */
const native = (Uint8Array as unknown as { fromBase64?: (text: string) => Uint8Array }).fromBase64;

/** The bytes of a base64 text. */
export function bytesOf(base64: string): Uint8Array {
  if (native) return native.call(Uint8Array, base64);
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  return bytes;
}

/** Zigzag integers in groups of seven bits; exact up to 2^53. */
export function wholeNumbers(bytes: Uint8Array): number[] {
  const numbers: number[] = [];
  let number = 0;
  let weight = 1;
  for (const byte of bytes) {
    number += (byte & 0x7f) * weight;
    weight *= 128;
    if (byte < 0x80) {
      numbers.push(number % 2 === 0 ? number / 2 : -(number + 1) / 2);
      number = 0;
      weight = 1;
    }
  }
  return numbers;
}

/** Columns that were computed in the page. */
const computed = new WeakMap<PackedColumn, Float64Array>();

/** Numbers as a column, as they are. */
export function ready(numbers: Float64Array): PackedColumn {
  const column: PackedColumn = { step: 1, order: PLAIN, content: "", gaps: [] };
  computed.set(column, numbers);
  return column;
}

/** The numbers of the found rows, in order. */
export function dense(column: PackedColumn): Float64Array {
  const known = computed.get(column);
  if (known) return known;
  const bytes = bytesOf(column.content);
  if (column.order === PLAIN) return new Float64Array(bytes.buffer as ArrayBuffer);
  if (column.order === SHORT) return Float64Array.from(new Float32Array(bytes.buffer as ArrayBuffer));
  const whole = Float64Array.from(wholeNumbers(bytes));
  for (let again = 0; again < column.order; again++) {
    for (let k = 1; k < whole.length; k++) whole[k]! += whole[k - 1]!;
  }
  const numbers = whole.map((number) => number * column.step);
  for (const gap of column.gaps) numbers[gap] = NaN;
  return numbers;
}

/** The numbers of all rows, NaN where there is no position. */
export function unpacked(column: PackedColumn, found: readonly boolean[]): Float64Array {
  const numbers = dense(column);
  if (numbers.length === found.length) return numbers;
  const values = new Float64Array(found.length).fill(NaN);
  let k = 0;
  found.forEach((is, row) => {
    if (is) values[row] = numbers[k++] ?? NaN;
  });
  return values;
}

/** Text that was deflated without a header. */
export async function inflated(base64: string): Promise<string> {
  const stream = new Blob([bytesOf(base64) as BlobPart])
    .stream()
    .pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).text();
}
