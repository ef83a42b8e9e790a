// The connection to a program in a worker of this page; it also saves and keeps the file.

import type { Transport, TransportHooks } from "../live/transport";
import type { FileState, LiveEvent, LiveRequest, TaskState } from "../messages";
import type { Engine, Found } from "./engine";
import { keep, keptWork } from "./keeping";
import { Saving } from "./saving";
import type { Again, Doing, Failed, Start } from "./worker";

export class WorkerConnection implements Transport {
  private readonly saving = new Saving();
  private worker: Worker | null = null;
  private readonly early: string[] = [];
  private count = 0;
  private file: FileState | TaskState | null = null;
  /** The text of the file as it was saved last, or opened. */
  private saved: string | null = null;

  constructor(private readonly hooks: TransportHooks) {}

  /** Start the worker; `doing` gets what it does until the first events arrive. */
  start(engine: Engine, found: Found, doing: (what: Doing) => void): void {
    const { "worker.js": script, ...files } = found.files;
    const url = URL.createObjectURL(script!);
    const worker = new Worker(url);
    this.worker = worker;
    worker.onmessage = ({ data }: MessageEvent<string | Doing | Failed | Again>) => {
      if (typeof data === "string") this.told(JSON.parse(data) as LiveEvent);
      else if ("doing" in data) doing(data);
      else if ("failed" in data) this.failed(data.failed);
      else {
        worker.terminate();
        this.early.push(...data.again);
        this.start(engine, found, doing);
      }
    };
    worker.onerror = (event) => this.failed(event.message);
    const kept = keptWork();
    this.saved = kept?.saved ?? null;
    const { late, store, machine } = found;
    worker.postMessage({ engine, files, late, fragment: location.hash, kept, store, machine } satisfies Start);
    for (const message of this.early.splice(0)) worker.postMessage(message);
  }

  ask(request: LiveRequest): number {
    const id = ++this.count;
    if (request.kind === "save" && this.file) void this.save(request, id, this.file);
    else this.send(request, id);
    return id;
  }

  private send(request: LiveRequest, id: number): void {
    const message = JSON.stringify({ ...request, id });
    if (this.worker) this.worker.postMessage(message);
    else this.early.push(message);
  }

  /** The program counts the file as saved once the visitor has it. */
  private async save(request: LiveRequest, id: number, state: FileState | TaskState): Promise<void> {
    const name = await this.saving.write(state.file, state.text);
    if (name === null) return;
    this.saved = state.text;
    this.send(request, id);
  }

  private told(event: LiveEvent): void {
    if (event.kind === "file_state" || event.kind === "task_state") {
      if (this.file?.file !== event.file && this.file !== null) this.saved = null;
      this.saved ??= event.text;
      // a change was on its way when the file was written
      if (!event.unsaved && this.file?.unsaved && this.file.file === event.file && event.text !== this.saved) void this.saving.write(event.file, event.text);
      if (!event.unsaved) this.saved = event.text;
      this.file = event;
      keep(event, this.saved);
    }
    this.hooks.event(event);
  }

  private failed(message: string): void {
    this.worker?.terminate();
    this.hooks.lost(`The engine has stopped: ${message.trim().split("\n").pop()!.slice(0, 300)} Reload the page; unsaved changes are kept.`);
  }
}
