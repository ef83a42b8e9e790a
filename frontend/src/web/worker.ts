// The worker: Python, compiled to WebAssembly, with a workbench that answers the page.

import type { Engine, Files } from "./engine";
import type { Kept } from "./keeping";

/** From the page: the start, then requests as JSON. */
export interface Start {
  readonly engine: Engine;
  readonly files: Files;
  readonly fragment: string;
  readonly kept: Kept | null;
}

/** To the page: events as JSON, or one of these. */
export interface Doing {
  readonly doing: string;
}
export interface Failed {
  readonly failed: string;
}

interface PyFunction {
  (...given: unknown[]): unknown;
  callPromising(...given: unknown[]): Promise<unknown>;
}

interface Python {
  unpackArchive(content: ArrayBuffer, format: string, options: { extractDir: string }): void;
  runPythonAsync(code: string): Promise<unknown>;
  registerJsModule(name: string, module: object): void;
  globals: { get(name: string): PyFunction };
}

declare const loadPyodide: (options: object) => Promise<Python>;
declare const self: {
  onmessage: (message: MessageEvent<Start | string>) => void;
  postMessage(message: string | Doing | Failed): void;
  fetch: unknown;
};

/** Pyodide asks for its files under this address; nothing leaves the worker. */
const HOME = "https://linkwork.invalid/";

const PACKAGES = "/lib/python3.13/site-packages";

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

async function start({ engine, files, fragment, kept }: Start): Promise<void> {
  say("Starting Python …");
  self.fetch = (url: URL | string) => Promise.resolve(own(String(url), files));
  const python = await loadPyodide({ indexURL: HOME, lockFileContents: engine.lock, packageBaseUrl: HOME });
  say("Loading the solver …");
  python.unpackArchive(files["site.zip"]!, "zip", { extractDir: PACKAGES });
  for (const name of Object.keys(files)) delete files[name];
  const take = (): string[] => messages.splice(0);
  python.registerJsModule("linkwork_page", { take, tell: (event: string) => self.postMessage(event), turn });
  await python.runPythonAsync(BEGIN);
  say("Solving …");
  const [begin, one] = [python.globals.get("begin"), python.globals.get("work")];
  begin(fragment, kept?.name ?? "", kept?.saved ?? "", kept?.text ?? "");
  // with stack switching, long work lets newer messages in
  work = "Suspending" in WebAssembly ? () => one.callPromising() : () => Promise.resolve(one());
  await answer();
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

function say(doing: string): void {
  self.postMessage({ doing });
}
