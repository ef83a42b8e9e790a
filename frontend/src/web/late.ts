// A file that most visits do without: it is loaded when Python reads it first, which waits for it.

import type { LateFile } from "./engine";

/** Of workers only. */
declare const FileReaderSync: new () => { readAsArrayBuffer(content: Blob): ArrayBuffer };

/** What is loaded once. */
class Content {
  private bytes: ArrayBuffer | null = null;

  constructor(
    private readonly file: LateFile,
    private readonly store: Cache | null,
    private readonly failed: () => Error,
  ) {}

  /** All bytes; Python cannot wait otherwise, so the worker does. */
  get(): ArrayBuffer {
    return (this.bytes ??= typeof this.file.content === "string" ? this.fetched(this.file.content) : new FileReaderSync().readAsArrayBuffer(this.file.content));
  }

  private fetched(url: string): ArrayBuffer {
    const request = new XMLHttpRequest();
    request.open("GET", url, false);
    request.responseType = "arraybuffer";
    try {
      request.send();
    } catch {
      throw this.failed(); // without a network
    }
    const bytes = request.response as ArrayBuffer | null;
    if (request.status !== 200 || bytes?.byteLength !== this.file.size) throw this.failed();
    // the next visit needs no network for it
    this.store?.put(url, new Response(bytes.slice(0))).catch(() => undefined);
    return bytes;
  }
}

/** The file, or a part of it. */
export class Late {
  private constructor(
    private readonly content: Content,
    private readonly start: number,
    private readonly end: number,
  ) {}

  /** `store` keeps it for later visits; `failed` makes the error of a file that cannot be read. */
  static of(file: LateFile, store: Cache | null, failed: () => Error): Late {
    return new Late(new Content(file, store, failed), 0, file.size);
  }

  get size(): number {
    return this.end - this.start;
  }

  slice(from: number, to: number): Late {
    return new Late(this.content, this.start + from, Math.min(this.start + to, this.end));
  }

  read(): ArrayBuffer {
    return this.content.get().slice(this.start, this.end);
  }
}
