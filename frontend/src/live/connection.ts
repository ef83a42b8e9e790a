// The connection to a program on this machine, by a WebSocket.

import type { LiveEvent, LiveRequest } from "../messages";
import type { Transport, TransportHooks } from "./transport";

/** The program's close code for a second page. */
const OCCUPIED = 4009;

export class Connection implements Transport {
  private readonly socket: WebSocket;
  private heard = false;
  private count = 0;

  constructor(hooks: TransportHooks) {
    const token = location.hash.slice(1);
    this.socket = new WebSocket(`ws://${location.host}/live`, ["linkwork", `token.${token}`]);
    this.socket.addEventListener("message", (message) => {
      this.heard = true;
      hooks.event(JSON.parse(String(message.data)) as LiveEvent);
    });
    this.socket.addEventListener("close", (event) => hooks.lost(this.why(event.code)));
  }

  /** Send a request; returns the id repeated by its answers. */
  ask(request: LiveRequest): number {
    const id = ++this.count;
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ ...request, id }));
    return id;
  }

  private why(code: number): string {
    if (code === OCCUPIED) {
      return "Another page shows this file already. Close that page, then reload this page.";
    }
    if (!this.heard) {
      return "Not connected. Open the full address that linkwork view printed; the address changes with every start.";
    }
    return "The connection is lost: linkwork view has ended, or the computer was asleep. Unsaved changes are kept. Start the command again, or reload this page.";
  }
}
