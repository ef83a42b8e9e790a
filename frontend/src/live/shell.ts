// What the pages of a mechanism and of a task have in common: requests and their answers, notices, and the bar.

import type { FileState, LiveEvent, LiveRequest, TaskState } from "../messages";
import { Bar } from "./bar";
import { Busy } from "./busy";
import { Latest } from "./latest";
import { Notices, type Choices } from "./notices";
import { Opening } from "./opening";
import { leaveStart, noteAtStart, Starting } from "./starting";
import type { Transport } from "./transport";

export interface ShellHooks {
  /** The last received state of the file. */
  readonly file: () => FileState | TaskState | null;
  /** Show the file as it is after a refusal: fields may contain something else. */
  readonly restore: () => void;
  /** Events that answer a request, so that the next of a drag can be sent. */
  readonly answers: ReadonlySet<LiveEvent["kind"]>;
  /** What a request of a drag becomes when it is sent. */
  readonly dragged?: (request: LiveRequest) => LiveRequest;
}

export class Shell {
  readonly notices = new Notices();
  readonly busy = new Busy();
  readonly bar: Bar;
  readonly starting: Starting;
  private readonly opening: Opening;
  private readonly latest: Latest<LiveRequest>;
  private gone = false;

  constructor(
    private readonly transport: () => Transport,
    private readonly hooks: ShellHooks,
  ) {
    const desk = { ask: (request: LiveRequest) => this.ask(request), file: hooks.file };
    this.latest = new Latest((request) => this.background(hooks.dragged?.(request) ?? request));
    this.opening = new Opening(desk, { shown: () => this.bar.element.checkVisibility(), refuse: (message) => this.refuse(message) });
    this.starting = new Starting(desk, () => this.opening.pick());
    this.bar = new Bar(desk, () => this.starting.offer(true));
    document.body.append(this.busy.element);
  }

  /** Send a request of the visitor, who has read the messages before. */
  ask(request: LiveRequest): number {
    if (this.gone) return 0; // the message that says so stays
    this.latest.clear();
    this.notices.clear();
    return this.background(request);
  }

  /** Send one of many requests of a drag: only the latest needs an answer. */
  drag(request: LiveRequest): void {
    this.latest.put(request);
  }

  /** Send a request that the visitor has not made: messages stay. */
  background(request: LiveRequest): number {
    if (this.gone) return 0; // nobody answers
    const id = this.transport().ask(request);
    this.busy.asked(id);
    return id;
  }

  /** Show an event that both pages show; each page shows its own first. */
  told(event: LiveEvent): void {
    switch (event.kind) {
      case "working":
        this.busy.progress(event.fraction);
        return; // it goes on
      case "refused":
        if (this.bar.link.opened) this.bar.link.refuse(event.message);
        else this.refuse(event.message, /overwrite/.test(event.message) ? this.decisions() : {});
        this.hooks.restore();
        break;
      case "problems_found":
        this.notices.problems(event, event.where === this.hooks.file()?.file ? "" : event.where);
        noteAtStart(this.notices.text);
        this.hooks.restore();
        break;
      case "file_changed":
        this.notices.changed(event, this.decisions());
        break;
      case "link_made":
        this.bar.link.show(event);
        break;
      case "file_opened":
        leaveStart();
        this.notices.opened(event);
        break;
      case "saved":
        this.notices.done(`Saved in ${event.file}.`);
        break;
    }
    this.busy.answered(event.answers);
    if (this.hooks.answers.has(event.kind)) this.latest.answered(event.answers);
  }

  /** The program is gone: what is shown stays, and nothing can be asked. */
  lost(message: string, element: Element, panels: Element): void {
    this.gone = true;
    this.latest.clear();
    this.busy.stop();
    this.bar.close();
    element.classList.add("lw-lost");
    for (const one of panels.querySelectorAll<HTMLInputElement>("input, button:not([role=tab]), select, textarea")) one.disabled = true;
    this.notices.say(message, { Reload: () => location.reload() }, false);
  }

  private refuse(message: string, choices: Choices = {}): void {
    this.notices.say(message, choices);
    noteAtStart(message);
  }

  private decisions(): Record<string, () => void> {
    return { Reload: () => this.ask({ kind: "reload" }), Overwrite: () => this.ask({ kind: "save", overwrite: true }) };
  }
}
