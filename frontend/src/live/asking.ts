// The interface of panels to the program: send requests, read the state of the file.

import type { FileState, LiveRequest } from "../messages";

export interface Desk {
  /** Send a request. */
  readonly ask: (request: LiveRequest) => void;
  /** Send a request that the visitor has not made: messages stay. */
  readonly background: (request: LiveRequest) => void;
  /** Send frequent requests, as from a slider: only the latest needs an answer. */
  readonly latest: (request: LiveRequest) => void;
  /** The last received state of the file. */
  readonly file: () => FileState;
  /** The displayed input values. */
  readonly here: () => Record<string, number>;
  /** All quantities of the displayed row. */
  readonly values: () => Readonly<Record<string, number>>;
}
