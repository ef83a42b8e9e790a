// The worker: Python, compiled to WebAssembly, with a workbench that answers the page.

import type { Engine, Files } from "./engine";
import type { Kept } from "./keeping";
import { storedEntries } from "./stored_zip";

/** From the page: the start, then requests as JSON. */
export interface Start {
  readonly engine: Engine;
  readonly files: Files;
  readonly fragment: string;
  readonly kept: Kept | null;
  /** Whether the page can keep archives for its next start. */
  readonly prepare: boolean;
  /** The address of Python's machine code, if it is not among the files. */
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
/** Archives by name that start faster. */
export interface Prepared {
  readonly prepared: Files;
}

interface PyFunction {
  (...given: unknown[]): unknown;
  callPromising(...given: unknown[]): Promise<unknown>;
}

/** Files in memory; `canOwn`: the content is not copied. */
interface FileSystem {
  mkdirTree(path: string): void;
  readFile(path: string): Uint8Array;
  unlink(path: string): void;
  writeFile(path: string, content: Uint8Array, options?: { canOwn: boolean }): void;
}

interface Python {
  runPythonAsync(code: string): Promise<unknown>;
  registerJsModule(name: string, module: object): void;
  globals: { get(name: string): PyFunction };
  FS: FileSystem;
}

declare const loadPyodide: (options: object) => Promise<Python>;
declare const self: {
  onmessage: (message: MessageEvent<Start | string>) => void;
  postMessage(message: string | Doing | Failed | Prepared, transfer?: ArrayBuffer[]): void;
  fetch: (url: URL | string) => Promise<Response>;
};

/** Pyodide asks for its files under this address; nothing leaves the worker. */
const HOME = "https://linkwork.invalid/";

const PACKAGES = "/lib/python3.13/site-packages";

const ARCHIVES = ["python_stdlib.zip", "site.zip"];
const PACKED = "/tmp/site.zip";
const PREPARED = "/tmp/prepared.zip";

/** Time without requests before archives are prepared [ms]. */
const REST = 3000;

const BEGIN = `
from linkwork_page import take, tell, turn
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, pause)
begin, work = desk.begin, desk.work
`;

const PREPARE = `
from pathlib import Path

from linkwork.viewer.live.bytecode import with_bytecode

STDLIB = Path("/lib/python313.zip")

steps = {
    "python_stdlib.zip": with_bytecode(STDLIB, STDLIB, Path("${PREPARED}")),
    "site.zip": with_bytecode(Path("${PACKED}"), Path("${PACKAGES}"), Path("${PREPARED}")),
}


def prepare(name):
    return next(steps[name], 0) is None
`;

let messages: string[] = [];
let work: (() => Promise<unknown>) | null = null;
let busy = false;

self.onmessage = ({ data }) => {
  if (typeof data === "string") {
    messages.push(data);
    void answer();
  } else {
    start(data).catch((error: unknown) => self.postMessage({ failed: String(error) }));
  }
};

async function start({ engine, files, fragment, kept, prepare, machine }: Start): Promise<void> {
  say("Starting Python …", 0.35);
  const { fetch } = self;
  self.fetch = async (url: URL | string) => (machine && String(url).endsWith(".wasm") ? fetch(machine) : own(String(url), files));
  const python = await loadPyodide({ indexURL: HOME, lockFileContents: engine.lock, packageBaseUrl: HOME });
  say("Loading the solver …", 0.7);
  for (const { name, content } of storedEntries(files["site.zip"]!)) {
    const path = `${PACKAGES}/${name}`;
    python.FS.mkdirTree(path.slice(0, path.lastIndexOf("/")));
    python.FS.writeFile(path, content, { canOwn: true });
  }
  if (prepare) python.FS.writeFile(PACKED, new Uint8Array(files["site.zip"]!), { canOwn: true });
  for (const name of Object.keys(files)) delete files[name];
  const take = (): string[] => messages.splice(0);
  python.registerJsModule("linkwork_page", { take, tell: (event: string) => self.postMessage(event), turn });
  await python.runPythonAsync(BEGIN);
  say("Solving …", 0.9);
  const [begin, one] = [python.globals.get("begin"), python.globals.get("work")];
  begin(fragment, kept?.name ?? "", kept?.saved ?? "", kept?.text ?? "");
  // with stack switching, long work lets newer messages in
  work = "Suspending" in WebAssembly ? () => one.callPromising() : () => Promise.resolve(one());
  await answer();
  if (prepare) await prepareArchives(python);
}

/** Write archives with compiled modules, a module at a time while nothing is asked. */
async function prepareArchives(python: Python): Promise<void> {
  await new Promise((done) => setTimeout(done, REST));
  await python.runPythonAsync(PREPARE);
  const step = python.globals.get("prepare");
  const names = [...ARCHIVES];
  const goOn = (): void => {
    const [name] = names;
    if (name === undefined) python.FS.unlink(PACKED);
    else if (busy) setTimeout(goOn, REST);
    else {
      if (!step(name)) {
        const content = python.FS.readFile(PREPARED).buffer as ArrayBuffer;
        python.FS.unlink(PREPARED);
        self.postMessage({ prepared: { [name]: content } }, [content]);
        names.shift();
      }
      setTimeout(goOn);
    }
  };
  goOn();
}

/** Answer all requests, one at a time. */
async function answer(): Promise<void> {
  if (busy || work === null) return;
  busy = true;
  try {
    while (await work()) await turn();
  } catch (error) {
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

function own(url: string, files: Files): Response {
  const name = url.slice(HOME.length);
  const kind = name.endsWith(".wasm") ? "application/wasm" : "application/octet-stream";
  const content = url.startsWith(HOME) ? files[name] : undefined;
  return content ? new Response(content, { headers: { "content-type": kind } }) : new Response(null, { status: 404 });
}

function say(doing: string, done: number): void {
  self.postMessage({ doing, done });
}
