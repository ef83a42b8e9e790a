// A file of the visitor, chosen or dropped on the page: it is opened, or imported from another program.

import type { FileState, LiveRequest, TaskState } from "../messages";
import { html } from "../svg";

/** More is not read in a page [bytes]. */
export const LARGEST = 1_790_000;

interface Desk {
  readonly ask: (request: LiveRequest) => void;
  readonly file: () => FileState | TaskState | null;
}

interface Page {
  /** Whether the page is in sight; the other one takes the files otherwise. */
  readonly shown: () => boolean;
  readonly refuse: (message: string) => void;
}

export class Opening {
  constructor(
    private readonly desk: Desk,
    private readonly page: Page,
  ) {
    for (const kind of ["dragover", "drop"] as const) window.addEventListener(kind, (event) => this.dropped(event));
    window.addEventListener("dragleave", (event) => event.relatedTarget === null && mark(false));
  }

  /** Let the visitor choose a file. */
  pick(): void {
    const input = html("input", { type: "file", accept: ".toml,.pmks,.txt,.json,.linkage2,.pyslvs,.ggb,.dxf,.mjcf,.xml,.urdf" });
    input.addEventListener("change", () => input.files?.[0] && void this.open(input.files[0].name, input.files[0]));
    input.click();
  }

  private dropped(event: DragEvent): void {
    const data = event.dataTransfer;
    const text = ["text/uri-list", "text/plain"].find((type) => data?.types.includes(type));
    const files = data?.types.includes("Files") ?? false;
    const field = event.target instanceof Element && event.target.matches("input, textarea");
    if (!data || !this.page.shown() || (!files && (!text || field))) return;
    event.preventDefault(); // the browser would leave the page and show the file
    mark(event.type === "dragover");
    if (event.type === "dragover") return;
    if (data.files.length > 1) this.page.refuse(`${data.files.length} files were dropped: drop one.`);
    else if (data.files.length) void this.open(data.files[0]!.name, data.files[0]!);
    else if (!files) void this.open("dropped text", new Blob([data.getData(text!).trim()]));
  }

  private async open(name: string, content: Blob): Promise<void> {
    if (content.size > LARGEST) {
      this.page.refuse(`${name} has ${(content.size / 1e6).toFixed(1)} MB: at most 1.7 MB are read in a page. Use the command linkwork import.`);
      return;
    }
    let code: string;
    try {
      code = await inBase64(content);
    } catch {
      this.page.refuse(`${name} cannot be read: it may be a folder, or have been moved.`);
      return;
    }
    const state = this.desk.file();
    const unsaved = state?.unsaved ?? false;
    if (unsaved && !confirm(`Changes of ${state!.file} are not saved. Discard them, if ${name} can be opened?`)) return;
    this.desk.ask({ kind: "open_file", name: name.slice(-200), content: code, discard: unsaved });
  }
}

/** Show that a file can be dropped. */
function mark(on: boolean): void {
  document.body.classList.toggle("lw-dropping", on);
}

function inBase64(content: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.addEventListener("load", () => resolve(String(reader.result).replace(/^[^,]*,?/, "")));
    reader.addEventListener("error", () => reject(reader.error!));
    reader.readAsDataURL(content);
  });
}
