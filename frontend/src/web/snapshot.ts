// Python's memory after its start, kept for later visits: they begin where the start ended.

import { release } from "./memory";

/** What a snapshot needs of Pyodide. */
export interface Memory {
  /** The whole memory behind a head. */
  makeMemorySnapshot(): Uint8Array<ArrayBuffer>;
  readonly _module: {
    readonly HEAPU8: Uint8Array;
    readonly LDSO: { readonly loadedLibsByName: object };
    _sbrk(more: number): number;
  };
}

/** A place of its own in the store of the engine's files. */
const PLACE = "https://linkwork.invalid/snapshot";

/** Tells the browser, of which another version may lay out memory differently, and the length. */
const MARK = "linkwork-snapshot";

const PART = 1 << 20; // bytes written at a time
const PAGE = 1 << 16; // bytes of WebAssembly's memory grow by this

/** The snapshot that an earlier visit kept. */
export async function keptSnapshot(store: Cache): Promise<Uint8Array<ArrayBuffer> | null> {
  const found = await store.match(PLACE);
  if (!found) return null;
  const snapshot = new Uint8Array(await found.arrayBuffer());
  return found.headers.get(MARK) === mark(snapshot) ? snapshot : null;
}

/** The memory as it is now, as far as it is used; none if Python has loaded machine code other than `libraries`: it would
 * be missing from the memory's tables at a later start.
 */
export function snapshotOf(python: Memory, libraries: readonly string[]): Uint8Array<ArrayBuffer> | null {
  const { HEAPU8, LDSO } = python._module;
  if (Object.keys(LDSO.loadedLibsByName).some((name) => name !== "__main__" && !libraries.includes(name))) return null;
  const whole = python.makeMemorySnapshot();
  const unused = HEAPU8.length - Math.ceil(python._module._sbrk(0) / PAGE) * PAGE;
  return whole.subarray(0, whole.length - unused);
}

/** Keep a snapshot, which is gone here afterwards; where there is no room for it, nothing is kept. */
export async function keepSnapshot(store: Cache, snapshot: Uint8Array<ArrayBuffer>): Promise<void> {
  let at = 0;
  const parts = new ReadableStream<Uint8Array>({
    pull(to) {
      if (at < snapshot.length) to.enqueue(snapshot.subarray(at, (at += PART)));
      else to.close();
    },
  });
  await store.put(PLACE, new Response(parts, { headers: { [MARK]: mark(snapshot) } })).catch(() => undefined);
  release(snapshot.buffer);
}

function mark({ length }: Uint8Array): string {
  return `${length} ${navigator.userAgent}`;
}

export async function forgetSnapshot(store: Cache): Promise<void> {
  await store.delete(PLACE);
}
