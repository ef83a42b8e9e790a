// The one connection with the program, and what is said over it.

import type { LiveEvent, LiveRequest } from "../messages";

/** The program's close code for a second page. */
const OCCUPIED = 4009;

export interface ConnectionHooks {
  readonly event: (event: LiveEvent) => void;
  readonly lost: (message: string) => void;
}

export class Connection {
  private readonly socket: WebSocket;
  private heard = false;
  private count = 0;

  constructor(hooks: ConnectionHooks) {
    const token = location.hash.slice(1);
    this.socket = new WebSocket(`ws://${location.host}/live`, ["linkwork", `token.${token}`]);
    this.socket.addEventListener("message", (message) => {
      this.heard = true;
      hooks.event(JSON.parse(String(message.data)) as LiveEvent);
    });
    this.socket.addEventListener("close", (event) => hooks.lost(this.why(event.code)));
  }

  /** Ask, and get the number that the answers repeat. */
  ask(request: LiveRequest): number {
    const id = ++this.count;
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ ...request, id }));
    return id;
  }

  private why(code: number): string {
    if (code === OCCUPIED) {
      return "Another page shows this file already. Close that one, then load this one again.";
    }
    if (!this.heard) {
      return "Not connected. Open the whole address that the command linkwork view printed; it is new every time.";
    }
    return "The connection is lost: the command linkwork view has ended, or the machine slept. What was not saved is kept; start the command again, or load this page again.";
  }
}
