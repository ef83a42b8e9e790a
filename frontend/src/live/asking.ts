// What every panel can do: ask the program, and know the file as it is.

import type { FileState, LiveRequest } from "../messages";

export interface Desk {
  /** Ask once. */
  readonly ask: (request: LiveRequest) => void;
  /** Ask often, as from a slider: only the latest is worth an answer. */
  readonly latest: (request: LiveRequest) => void;
  /** The file as the program told it last. */
  readonly file: () => FileState;
  /** The values of the inputs that are shown. */
  readonly here: () => Record<string, number>;
  /** Every quantity in the row that is shown. */
  readonly values: () => Readonly<Record<string, number>>;
}
