// The page of whatever is open: of a mechanism, or of a task.

import { LivePage } from "../live/live_page";
import type { Connect, TransportHooks } from "../live/transport";
import type { LiveEvent } from "../messages";
import { html } from "../svg";
import { TaskPage } from "./task_page";

/** Events that both pages show. */
const SHARED = new Set<LiveEvent["kind"]>(["refused", "problems_found", "file_changed", "link_made", "saved", "working", "file_opened"]);

/** Both pages over one connection; the element is that of mechanisms. */
export function openPages(element: HTMLElement, connect: Connect): void {
  const aside = html("main", { id: "linkwork-task", hidden: "" });
  element.after(aside);
  let hooks!: TransportHooks;
  let task: TaskPage | null = null;
  let shown = false;
  const show = (on: boolean): void => {
    shown = on;
    aside.hidden = !on;
    element.hidden = on;
  };
  const transport = connect({
    event: (event: LiveEvent) => {
      if (event.kind === "task_state") {
        task ??= new TaskPage(aside, transport);
        show(true);
      } else if (event.kind === "file_state") show(false);
      // the other page has no use for it, but may have asked for it
      if (shown || !SHARED.has(event.kind)) task?.told(event);
      if (!shown || !SHARED.has(event.kind)) hooks.event(event);
    },
    lost: (message) => (shown ? task! : hooks).lost(message),
  });
  new LivePage(element, (own) => {
    hooks = own;
    return transport;
  });
}
