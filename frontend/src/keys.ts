// The keys of a page: declared with what they do, pressed, and listed.

import { html } from "./svg";

export interface Command {
  /** Values of `KeyboardEvent.key`; letters in lower case. */
  readonly keys: readonly string[];
  /** What it does, on the list. */
  readonly does: string;
  readonly act: (event: KeyboardEvent) => void;
  /** Whether it can be done now. */
  readonly when?: () => boolean;
  /** Together with Ctrl, or Cmd. */
  readonly ctrl?: boolean;
}

type Listed = Pick<Command, "keys" | "does" | "ctrl">;

const NAMES: Readonly<Record<string, string>> = {
  " ": "Space", ArrowRight: "→", ArrowLeft: "←", ArrowUp: "↑", ArrowDown: "↓", PageDown: "Page ↓", PageUp: "Page ↑", Escape: "Esc",
};

/** The declared keys by group, in the order of the list. */
const declared = new Map<string, readonly Listed[]>();

/** Put keys on the list, in place of those of the same group. */
export function declareKeys(group: string, commands: readonly Listed[]): void {
  declared.set(group, commands);
}

/** Do what a key is for; false if it has no use now. */
export function press(commands: readonly Command[], event: KeyboardEvent): boolean {
  if (event.altKey) return false;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const ctrl = event.ctrlKey || event.metaKey;
  const found = commands.find((one) => one.keys.includes(key) && (one.ctrl ?? false) === ctrl && (one.when?.() ?? true));
  if (!found) return false;
  event.preventDefault();
  found.act(event);
  return true;
}

/** Show all keys in a dialog over a page. */
export function showKeys(page: Element): void {
  const dialog = html("dialog", { class: "lw-keys", "aria-labelledby": "lw-keys-title" }, page);
  const head = html("header", {}, dialog);
  html("h2", { id: "lw-keys-title" }, head, "Keys");
  // at the top: the list begins in sight where it gets the focus
  const close = html("button", { type: "button", autofocus: "" }, head, "Close");
  close.addEventListener("click", () => dialog.close());
  const groups = html("div", { class: "lw-keys-groups" }, dialog);
  for (const [group, commands] of declared) {
    const box = html("section", {}, groups);
    html("h3", {}, box, group);
    const list = html("dl", {}, box);
    for (const { keys, does, ctrl } of commands) {
      const term = html("dt", {}, list);
      for (const key of keys) html("kbd", {}, term, `${ctrl ? "Ctrl+" : ""}${NAMES[key] ?? (key.length === 1 ? key.toUpperCase() : key)}`);
      html("dd", {}, list, does);
    }
  }
  dialog.addEventListener("close", () => dialog.remove());
  dialog.showModal();
}
