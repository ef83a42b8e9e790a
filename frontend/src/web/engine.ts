// The files of the engine: from the page itself, from the host, or as an earlier visit kept them.

/** What the page says about the engine, as the builder wrote it. */
export interface Engine {
  /** Changes with every file. */
  readonly build: string;
  /** What Pyodide asks of its lock file. */
  readonly lock: { readonly info: Readonly<Record<string, string>>; readonly packages: Readonly<Record<string, never>> };
  /** Names, places next to the page, and packed sizes [bytes]. */
  readonly files: readonly EngineFile[];
}

export interface EngineFile {
  readonly name: string;
  /** Empty where the page contains the file. */
  readonly url: string;
  readonly size: number;
}

/** The place of the mark that archives are prepared. */
const PREPARED = "engine/prepared";

/** Python itself. */
const MACHINE = "pyodide.asm.wasm";

export type Files = Record<string, ArrayBuffer>;

/** The files, and whether a visit that is now prepared could start faster; `machine`: where the worker itself gets the
 * machine code of Python, which the browser keeps compiled there.
 */
export interface Found {
  readonly files: Files;
  readonly prepare: boolean;
  readonly machine: string | null;
}

/** All files, unpacked; `progress` gets the bytes received so far, and their number. */
export async function engineFiles(engine: Engine, progress: (bytes: number, all: number) => void): Promise<Found> {
  const all = engine.files.reduce((sum, file) => sum + file.size, 0);
  let bytes = 0;
  const received = (more: number): void => progress((bytes += more), all);
  const cache = await kept(engine.build);
  const before = await cache?.match(PREPARED);
  const machine = before && navigator.serviceWorker?.controller ? engine.files.find(({ name }) => name === MACHINE)! : null;
  const wanted = engine.files.filter((file) => file !== machine);
  const contents = await Promise.all(
    wanted.map(async (file) => unpacked(file.url ? await fetched(file, cache, received) : contained(file, received))),
  );
  const files = Object.fromEntries(wanted.map((file, k) => [file.name, contents[k]!]));
  const prepare = cache !== null && !before && engine.files.every((file) => file.url);
  return { files, prepare, machine: machine && new URL(machine.url, location.href).href };
}

/** Keep archives for the next visit: they replace those of the same names. */
export async function keepPrepared(engine: Engine, prepared: Files): Promise<void> {
  const cache = await kept(engine.build);
  for (const file of engine.files) {
    const content = prepared[file.name];
    if (content) await cache?.put(file.url, new Response(content));
  }
  if (!("site.zip" in prepared)) return;
  const machine = engine.files.find(({ name }) => name === MACHINE)!;
  const packed = await cache?.match(machine.url);
  const headers = { "content-type": "application/wasm" };
  if (packed) await cache?.put(machine.url, new Response(await unpacked(await packed.arrayBuffer()), { headers }));
  await cache?.put(PREPARED, new Response("1")); // the last one
}

/** The store of earlier visits; none in a frame without an origin of its own. */
async function kept(build: string): Promise<Cache | null> {
  try {
    return await caches.open(`linkwork ${new URL("./", location.href).pathname} ${build}`);
  } catch {
    return null;
  }
}

async function fetched(file: EngineFile, cache: Cache | null, received: (bytes: number) => void): Promise<ArrayBuffer> {
  const before = await cache?.match(file.url);
  const response = before ?? (await fetch(file.url));
  if (!response.ok || response.body === null) throw new Error(`${file.url} cannot be read (${response.status})`);
  if (!before) await cache?.put(file.url, response.clone()).catch(() => undefined);
  const count = new TransformStream<Uint8Array, Uint8Array>({
    transform(chunk, to) {
      received(chunk.byteLength);
      to.enqueue(chunk);
    },
  });
  return await new Response(response.body.pipeThrough(count)).arrayBuffer();
}

function contained(file: EngineFile, received: (bytes: number) => void): ArrayBuffer {
  const element = document.getElementById(`linkwork-${file.name}`)!;
  const code = atob(element.textContent ?? "");
  element.remove();
  const bytes = new Uint8Array(code.length);
  for (let k = 0; k < code.length; k += 1) bytes[k] = code.charCodeAt(k);
  received(bytes.length);
  return bytes.buffer;
}

/** Some hosts unpack files themselves: the first bytes tell. */
async function unpacked(content: ArrayBuffer): Promise<ArrayBuffer> {
  const [first, second] = new Uint8Array(content, 0, 2);
  if (first !== 0x1f || second !== 0x8b) return content;
  const stream = new Blob([content]).stream().pipeThrough(new DecompressionStream("gzip"));
  return await new Response(stream).arrayBuffer();
}
