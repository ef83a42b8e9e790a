// The way of requests and events between the page and the program, wherever the program runs.

import type { LiveEvent, LiveRequest } from "../messages";

export interface TransportHooks {
  readonly event: (event: LiveEvent) => void;
  /** The program is gone; nothing more will be answered. */
  readonly lost: (message: string) => void;
}

export interface Transport {
  /** Send a request; returns the id repeated by its answers. */
  ask(request: LiveRequest): number;
}

/** Connects a page to its program. */
export type Connect = (hooks: TransportHooks) => Transport;
