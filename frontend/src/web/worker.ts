// The worker: Python, compiled to WebAssembly, with a workbench that answers the page.

import type { Engine, Files, LateFile } from "./engine";
import type { Kept } from "./keeping";
import { Late } from "./late";
import { release } from "./memory";
import { forgetSnapshot, keepSnapshot, keptSnapshot, snapshotOf, type Memory } from "./snapshot";
import { StoredZip, type Stored } from "./stored_zip";

/** From the page: the start, then requests as JSON. */
export interface Start {
  readonly engine: Engine;
  readonly files: Files;
  readonly late: readonly LateFile[];
  readonly fragment: string;
  readonly kept: Kept | null;
  /** The name of the cache that keeps Python's memory for later visits, if there is one. */
  readonly store: string | null;
  /** The address of Python's machine code, if the browser keeps it compiled. */
  readonly machine: string | null;
}

/** To the page: events as JSON, or one of these. */
export interface Doing {
  readonly doing: string;
  /** The part of the start that is done, from 0 to 1. */
  readonly done: number;
}
export interface Failed {
  readonly failed: string;
}
/** The start from a snapshot has failed: another worker without it begins again with these requests. */
export interface Again {
  readonly again: string[];
}

interface PyFunction {
  (...given: unknown[]): unknown;
  callPromising(...given: unknown[]): Promise<unknown>;
}

/** Files that stay where they are: they are read part by part. */
interface OutsideFiles {
  reader: { readAsArrayBuffer(part: Stored | Late): ArrayBuffer };
}

interface FileSystem {
  readonly filesystems: { readonly WORKERFS: OutsideFiles };
  readonly ErrnoError: new (number: number) => Error;
  mount(kind: object, options: { blobs: readonly { name: string; data: Stored | Late }[] }, place: string): void;
}

interface Python extends Memory {
  runPython(code: string): unknown;
  registerJsModule(name: string, module: object): void;
  globals: { get(name: string): PyFunction };
  FS: FileSystem;
}

declare const loadPyodide: (options: object) => Promise<Python>;
declare const self: {
  onmessage: (message: MessageEvent<Start | string>) => void;
  postMessage(message: string | Doing | Failed | Again): void;
  fetch: (url: URL | string) => Promise<Response>;
  /** Of Emscripten: begins before Python does. */
  _createPyodideModule: (settings: object) => Promise<object>;
};

/** Pyodide asks for its files under this address; nothing leaves the worker. */
const HOME = "https://linkwork.invalid/";

const PACKAGES = "/lib/python3.13/site-packages";

/** Machine code of NumPy that is loaded before Python starts: only thus it has the same addresses at every visit. */
const LIBRARIES = /^numpy\/(_core\/_multiarray_umath|linalg\/_umath_linalg)\..*\.so$/;

/** Emscripten's number of the error of a file that cannot be read. */
const INPUT_OUTPUT = 29;

/** For a start from a snapshot, on a busy machine [ms]. */
const PATIENCE = 20_000;

const IMPORT = `
from pyodide.ffi import can_run_sync, run_sync

from linkwork import example_text, loads
from linkwork.app.live.session import BrowserDesk


def solve_task(task, **options):
    from linkwork.synthesis.solvers.solving import solve_task as solve

    return solve(task, **options)


def suggesting():
    from linkwork.synthesis import suggesting as found

    return found
`;

/** What a first cycle imports and prepares is part of the snapshot, too. */
const REHEARSE = `
import gc

desk = BrowserDesk(loads, example_text, lambda event: None, lambda: (), solve_task)
desk.begin("#example=four-bar")
del desk
gc.collect()
`;

const BEGIN = `
from linkwork_page import take, tell, turn


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, solve_task, pause, suggesting)
begin, work = desk.begin, desk.work
`;

let messages: string[] = [];
let work: (() => Promise<unknown>) | null = null;
let busy = false;
/** Where a snapshot is kept from which this worker has started. */
let restored: Cache | null = null;

self.onmessage = ({ data }) => {
  if (typeof data === "string") {
    messages.push(data);
    void answer();
  } else {
    start(data).catch(async (error: unknown) => {
      if (restored) await startAgain(restored);
      else self.postMessage({ failed: String(error) });
    });
  }
};

async function start({ engine, files, late, fragment, kept, store, machine }: Start): Promise<void> {
  say("Starting Python …", 0.35);
  const cache = store === null ? null : await caches.open(store);
  const before = cache && (await keptSnapshot(cache));
  restored = before && cache;
  // Pyodide waits for ever where its machine code does not fit into the memory
  const patience = restored && setTimeout(startAgain, PATIENCE, restored);
  const site = new StoredZip(files["site.zip"]!);
  if (!before) await site.bringIn();
  const entries = await site.entries();
  const libraries = new Map([...entries].flatMap(([name, file]) => (LIBRARIES.test(name) ? [[`${PACKAGES}/${name}`, file]] : [])));
  const { fetch, _createPyodideModule: create } = self;
  self.fetch = async (url) => (machine && String(url).endsWith(".wasm") ? fetch(machine) : own(String(url), files, libraries));
  self._createPyodideModule = (settings) => create(Object.assign(settings, { dynamicLibraries: [...libraries.keys()] }));
  const python = await loadPyodide({
    ...{ indexURL: HOME, lockFileContents: engine.lock, packageBaseUrl: HOME },
    ...(before ? { _loadSnapshot: before } : { _makeSnapshot: cache !== null }),
  });
  const { WORKERFS } = python.FS.filesystems;
  WORKERFS.reader = { readAsArrayBuffer: (part) => part.read() };
  const lateFiles = late.map((file) => ({ name: file.name, data: Late.of(file, cache, () => new python.FS.ErrnoError(INPUT_OUTPUT)) }));
  python.FS.mount(WORKERFS, { blobs: [...[...entries].map(([name, data]) => ({ name, data })), ...lateFiles] }, PACKAGES);
  if (before) release(before.buffer);
  else {
    say("Loading the solver …", 0.7);
    python.runPython(IMPORT);
  }
  if (cache && !before) python.runPython(REHEARSE);
  const snapshot = cache && !before ? snapshotOf(python, [...libraries.keys()]) : null;
  const take = (): string[] => messages.splice(0);
  python.registerJsModule("linkwork_page", { take, tell: (event: string) => self.postMessage(event), turn });
  python.runPython(BEGIN);
  if (patience) clearTimeout(patience);
  say("Solving …", 0.9);
  const [begin, one] = [python.globals.get("begin"), python.globals.get("work")];
  begin(fragment, kept?.name ?? "", kept?.saved ?? "", kept?.text ?? "");
  // with stack switching, long work lets newer messages in
  work = "Suspending" in WebAssembly ? () => one.callPromising() : () => Promise.resolve(one());
  await answer();
  site.leaveOutside();
  if (cache && snapshot) await keepSnapshot(cache, snapshot);
}

/** Let another worker start without the snapshot. */
async function startAgain(store: Cache): Promise<void> {
  await forgetSnapshot(store);
  self.postMessage({ again: messages });
}

/** Answer all requests, one at a time. */
async function answer(): Promise<void> {
  if (busy || work === null) return;
  busy = true;
  try {
    while (await work()) await turn();
  } catch (error) {
    if (restored) await forgetSnapshot(restored);
    self.postMessage({ failed: String(error) });
  }
  busy = false;
}

/** Messages that have arrived are delivered before this is over. */
function turn(): Promise<void> {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => {
      port1.close();
      resolve();
    };
    port2.postMessage(null);
  });
}

function own(url: string, files: Files, libraries: ReadonlyMap<string, Stored>): Response {
  const name = url.slice(HOME.length);
  const content = files[name] ?? libraries.get(name)?.read();
  return content ? new Response(content) : new Response(null, { status: 404 });
}

function say(doing: string, done: number): void {
  self.postMessage({ doing, done });
}
