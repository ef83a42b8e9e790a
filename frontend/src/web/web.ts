// The entry point of the page that solves in the browser alone.

import { setAppUrl } from "../live/link";
import { chooseEarly, offerStart, type Chosen } from "../live/starting";
import { html } from "../svg";
import { openPages } from "../task/opened";
import { engineFiles, type Engine } from "./engine";
import { keptWork } from "./keeping";
import { WorkerConnection } from "./worker_connection";

/** The part of the start that loading its files takes. */
const LOADED = 0.3;

const element = document.getElementById("linkwork")!;
const wait = html("div", { class: "lw-wait", role: "status" });
const doing = html("p", {}, wait);
const bar = html("progress", { max: "1", value: "0", "aria-label": "Loading" }, wait);

element.replaceChildren(wait);
doing.textContent = "Loading Linkwork …";
window.addEventListener("hashchange", () => location.reload());
if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", begin);
else begin();

function begin(): void {
  const engine = JSON.parse(document.getElementById("linkwork-engine")!.textContent!) as Engine;
  const loads = engine.files.some((file) => file.url);
  if (loads && self.origin === "null") {
    // from a disk or in a frame without an origin nothing can be fetched: the page that contains all
    location.replace(`linkwork.html${location.hash}`);
    return;
  }
  if (/^(https?|file):/.test(location.href)) setAppUrl(location.href);
  // while the engine loads; it finds in the address what is chosen before it begins
  if (!location.hash.slice(1) && keptWork() === null) offerStart(choose);
  let connection!: WorkerConnection;
  openPages(element, (hooks) => (connection = new WorkerConnection(hooks)));
  engineFiles(engine, (bytes, all) => {
    bar.value = LOADED * Math.min(1, bytes / all); // prepared archives are larger
    doing.textContent = `Loading the engine: ${mega(Math.min(bytes, all))} of ${mega(all)} MB. Everything is computed in this browser.`;
  }).then(
    (found) =>
      connection.start(engine, found, (what) => {
        doing.textContent = what.doing;
        bar.value = what.done;
      }),
    (error: unknown) => {
      bar.remove();
      wait.setAttribute("role", "alert");
      doing.textContent = `The engine cannot be loaded: ${String(error)}. Check the connection, then reload this page.`;
    },
  );
  if (loads) keepForOffline();
}

function choose(name: string, of: Chosen["of"]): void {
  chooseEarly({ name, of });
  try {
    history.replaceState(null, "", `#${of}=${encodeURIComponent(name)}`);
  } catch {
    // a frame without an address of its own: the program asks what was chosen
  }
}

/** On a host, the next visit needs no network. */
function keepForOffline(): void {
  try {
    navigator.serviceWorker?.register("sw.js").catch(() => undefined);
  } catch {
    // no service worker in a frame without an origin of its own
  }
}

function mega(bytes: number): string {
  return (bytes / 1e6).toFixed(1);
}
