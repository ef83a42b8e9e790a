// Another mechanism in place of the present one: the library, or a blank sheet.

import { libraryOf } from "../begin/library";
import { StartPage, type StartHooks } from "../begin/start_page";
import type { FileState, TaskState } from "../messages";
import type { Desk } from "./asking";

/** The start page in sight; it may be there before the program that opens what is chosen. */
let current: StartPage | null = null;
/** What had the focus before. */
let before: Element | null = null;

/** What was chosen on the start page. */
export interface Chosen {
  readonly name: string;
  readonly of: "example" | "task";
}

/** What was chosen before there was a program to open it. */
let chosen: Chosen | null = null;

/** Show the start page, or let another function open what is chosen on it, or was chosen already. */
export function offerStart(open: (name: string, of: Chosen["of"]) => void, hooksOf: Pick<StartHooks, "file" | "close"> = {}): void {
  const { close } = hooksOf;
  const hooks = { open, ...hooksOf };
  const early = chosen;
  chosen = null;
  if (early !== null && !close) {
    open(early.name, early.of);
    return;
  }
  if (current !== null && !close) {
    current.hooks = hooks;
    return;
  }
  leaveStart();
  current = new StartPage(libraryOf(document), hooks);
  before = document.activeElement;
  document.body.append(current.element);
  for (const page of document.querySelectorAll<HTMLElement>("#linkwork, #linkwork-task")) page.inert = true;
}

/** Keep a choice for the program that is being loaded. */
export function chooseEarly(early: Chosen): void {
  chosen = early;
  leaveStart();
}

/** Say something on the start page, if it covers the place where messages are. */
export function noteAtStart(text: string): void {
  current?.note(text);
}

export function leaveStart(): void {
  if (current === null) return;
  current.destroy();
  current = null;
  for (const page of document.querySelectorAll<HTMLElement>("#linkwork, #linkwork-task")) page.inert = false;
  if (before instanceof HTMLElement) before.focus();
}

export class Starting {
  constructor(
    private readonly desk: Pick<Desk, "ask"> & { readonly file: () => FileState | TaskState | null },
    private readonly pick: () => void,
  ) {}

  /** Offer the library; `back`: the present file may stay. */
  offer(back: boolean): void {
    offerStart((name, of) => this.open(name, of), { file: this.pick, ...(back ? { close: leaveStart } : {}) });
  }

  private open(name: string, of: Chosen["of"]): void {
    const state: FileState | TaskState | null = this.desk.file(); // none before the first file is open
    const unsaved = state?.unsaved ?? false;
    const discard = unsaved && confirm(`Changes of ${state!.file} are not saved. Discard them?`);
    if (unsaved && !discard) return;
    leaveStart();
    this.desk.ask({ kind: of === "task" ? "open_task" : "open_example", name, discard });
  }
}
