// A ZIP archive whose files are not compressed: they stay in it, and are read when they are needed.

import { release } from "./memory";

/** Of workers only. */
declare const FileReaderSync: new () => { readAsArrayBuffer(content: Blob): ArrayBuffer };

const END = 22; // bytes of the end record, without a comment
const LOCAL = 30; // bytes in front of a file's name and its content, without extra fields

/** An archive; in its own memory many files are read faster, outside they take none. */
export class StoredZip {
  private memory: ArrayBuffer | null = null;

  constructor(readonly outside: Blob) {}

  async bringIn(): Promise<void> {
    this.memory = await this.outside.arrayBuffer();
  }

  leaveOutside(): void {
    if (this.memory) release(this.memory);
    this.memory = null;
  }

  read(start: number, end: number): ArrayBuffer {
    return this.memory?.slice(start, end) ?? new FileReaderSync().readAsArrayBuffer(this.outside.slice(start, end));
  }

  /** All files by name. */
  async entries(): Promise<Map<string, Stored>> {
    const { size } = this.outside;
    const end = new DataView(await this.outside.slice(size - END).arrayBuffer());
    const bytes = await this.outside.slice(end.getUint32(16, true), size - END).arrayBuffer();
    const directory = new DataView(bytes);
    const found = new Map<string, Stored>();
    for (let at = 0; at < bytes.byteLength; ) {
      const [length, nameLength] = [directory.getUint32(at + 24, true), directory.getUint16(at + 28, true)];
      const start = directory.getUint32(at + 42, true) + LOCAL + nameLength;
      const name = new TextDecoder().decode(new Uint8Array(bytes, at + 46, nameLength));
      found.set(name, new Stored(this, start, start + length));
      at += 46 + nameLength + directory.getUint16(at + 30, true) + directory.getUint16(at + 32, true);
    }
    return found;
  }
}

/** A file of an archive, or a part of it. */
export class Stored {
  constructor(
    private readonly archive: StoredZip,
    private readonly start: number,
    private readonly end: number,
  ) {}

  get size(): number {
    return this.end - this.start;
  }

  slice(from: number, to: number): Stored {
    return new Stored(this.archive, this.start + from, Math.min(this.start + to, this.end));
  }

  read(): ArrayBuffer {
    return this.archive.read(this.start, this.end);
  }
}
