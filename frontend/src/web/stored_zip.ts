// Reads a ZIP archive whose files are not compressed.

export interface Entry {
  readonly name: string;
  /** A part of the archive, not a copy. */
  readonly content: Uint8Array;
}

const END = 22; // bytes of the end record, without a comment

export function* storedEntries(archive: ArrayBuffer): Generator<Entry> {
  const data = new DataView(archive);
  const end = archive.byteLength - END;
  let at = data.getUint32(end + 16, true);
  for (let k = data.getUint16(end + 10, true); k > 0; k -= 1) {
    const [size, nameLength] = [data.getUint32(at + 24, true), data.getUint16(at + 28, true)];
    const local = data.getUint32(at + 42, true);
    const start = local + 30 + data.getUint16(local + 26, true) + data.getUint16(local + 28, true);
    const name = new TextDecoder().decode(new Uint8Array(archive, at + 46, nameLength));
    yield { name, content: new Uint8Array(archive, start, size) };
    at += 46 + nameLength + data.getUint16(at + 30, true) + data.getUint16(at + 32, true);
  }
}
