// Unsaved work, which survives closing and reloading the page.

import type { FileState, TaskState } from "../messages";

/** A file as the page was left: its text when it was saved, and its text with all changes. */
export interface Kept {
  readonly name: string;
  readonly saved: string;
  readonly text: string;
}

/** One place for each address, since a link opens a mechanism of its own. */
const place = (): string => `linkwork ${location.pathname}${location.hash}`;

/** The unsaved work of this address. */
export function keptWork(): Kept | null {
  try {
    const found = JSON.parse(localStorage.getItem(place()) ?? "null") as Kept | null;
    return found && [found.name, found.saved, found.text].every((part) => typeof part === "string") ? found : null;
  } catch {
    return null; // no storage here, as in a sandboxed frame
  }
}

/** Keep the work of this address while it is unsaved; returns whether that was possible. */
export function keep(state: FileState | TaskState, saved: string): boolean {
  try {
    if (!state.unsaved) localStorage.removeItem(place());
    else localStorage.setItem(place(), JSON.stringify({ name: state.file, saved, text: state.text } satisfies Kept));
    return true;
  } catch {
    return false;
  }
}
