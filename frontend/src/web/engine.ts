// The files of the engine: from the page itself, from the host, or as an earlier visit kept them.

/** What the page says about the engine, as the builder wrote it. */
export interface Engine {
  /** Changes with every file. */
  readonly build: string;
  /** What Pyodide asks of its lock file. */
  readonly lock: { readonly info: Readonly<Record<string, string>>; readonly packages: Readonly<Record<string, never>> };
  /** Names, places next to the page, and packed sizes [bytes]. */
  readonly files: readonly EngineFile[];
  /** Data of Linkwork that are loaded when they are read first. */
  readonly late: readonly EngineFile[];
}

export interface EngineFile {
  readonly name: string;
  /** Empty where the page contains the file. */
  readonly url: string;
  readonly size: number;
}

/** Python itself. */
const MACHINE = "pyodide.asm.wasm";

const KINDS: Readonly<Record<string, string>> = { js: "text/javascript", wasm: "application/wasm" };

/** A file that is loaded when it is read first: its content where the page contains it, otherwise its address. */
export interface LateFile {
  readonly name: string;
  readonly size: number;
  readonly content: Blob | string;
}

/** Contents by name; a browser keeps them outside the page's process. */
export type Files = Readonly<Record<string, Blob>>;

/** The unpacked files; `store`: the name of the cache that keeps them for later visits, if there is one; `machine`: where
 * the worker itself gets the machine code of Python, which the browser keeps compiled there.
 */
export interface Found {
  readonly files: Files;
  readonly late: readonly LateFile[];
  readonly store: string | null;
  readonly machine: string | null;
}

/** All files, unpacked; `progress` gets the bytes received so far, and their number. */
export async function engineFiles(engine: Engine, progress: (bytes: number, all: number) => void): Promise<Found> {
  const all = engine.files.reduce((sum, file) => sum + file.size, 0);
  let bytes = 0;
  const received = (more: number): void => progress((bytes += more), all);
  const store = engine.files.every((file) => file.url) ? `linkwork ${new URL("./", location.href).pathname} ${engine.build}` : "";
  const cache = store ? await opened(store) : null;
  const machine = new URL(engine.files.find(({ name }) => name === MACHINE)!.url, location.href).href;
  const streamed = cache && navigator.serviceWorker?.controller && (await cache.match(machine));
  const contents = await Promise.all(engine.files.map((file) => (file.url ? fetched(file, cache, received) : contained(file, received))));
  const files = Object.fromEntries(engine.files.map((file, k) => [file.name, contents[k]!]));
  const late = await Promise.all(engine.late.map(async (file) => ({ name: file.name, size: file.size, content: file.url ? new URL(file.url, location.href).href : await contained(file) })));
  return { files, late, store: cache && store, machine: streamed ? machine : null };
}

/** The store of earlier visits; none in a frame without an origin of its own. */
async function opened(store: string): Promise<Cache | null> {
  try {
    return await caches.open(store);
  } catch {
    return null;
  }
}

async function fetched(file: EngineFile, cache: Cache | null, received: (bytes: number) => void): Promise<Blob> {
  const before = await cache?.match(file.url);
  if (before) {
    received(file.size);
    return await before.blob();
  }
  const response = await fetch(file.url);
  if (!response.ok || response.body === null) throw new Error(`${file.url} cannot be read (${response.status})`);
  const count = new TransformStream<Uint8Array, Uint8Array>({
    transform(chunk, to) {
      received(chunk.byteLength);
      to.enqueue(chunk);
    },
  });
  const content = await unpacked(await new Response(response.body.pipeThrough(count)).blob(), file.name);
  await cache?.put(file.url, new Response(content)).catch(() => undefined);
  return content;
}

async function contained(file: EngineFile, received?: (bytes: number) => void): Promise<Blob> {
  const element = document.getElementById(`linkwork-${file.name}`)!;
  const code = atob(element.textContent ?? "");
  element.remove();
  const bytes = new Uint8Array(code.length);
  for (let k = 0; k < code.length; k += 1) bytes[k] = code.charCodeAt(k);
  received?.(bytes.length);
  return await unpacked(new Blob([bytes]), file.name);
}

/** Some hosts unpack files themselves: the first bytes tell. */
async function unpacked(content: Blob, name: string): Promise<Blob> {
  const type = KINDS[name.split(".").pop()!] ?? "application/octet-stream";
  const [first, second] = new Uint8Array(await content.slice(0, 2).arrayBuffer());
  if (first !== 0x1f || second !== 0x8b) return content.slice(0, content.size, type);
  const stream = content.stream().pipeThrough(new DecompressionStream("gzip"));
  return await new Response(stream, { headers: { "content-type": type } }).blob();
}
