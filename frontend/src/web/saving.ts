// Saving to a file of the visitor: the file itself where the browser can write it, or a download.

interface Writable {
  write(text: string): Promise<void>;
  close(): Promise<void>;
}

interface FileHandle {
  readonly name: string;
  createWritable(): Promise<Writable>;
}

/** File System Access, in some browsers, and not in frames. */
type Picker = (options: { suggestedName: string }) => Promise<FileHandle>;

export class Saving {
  private handle: FileHandle | null = null;
  private name = "";

  /** Write the text; returns the name of the file, or null if the visitor decided otherwise. */
  async write(name: string, text: string): Promise<string | null> {
    const pick = (window as { showSaveFilePicker?: Picker }).showSaveFilePicker;
    if (pick === undefined || window.parent !== window) return download(name, text);
    if (name !== this.name) this.handle = null; // another file
    this.name = name;
    try {
      this.handle ??= await pick.call(window, { suggestedName: name });
      const file = await this.handle.createWritable();
      await file.write(text);
      await file.close();
      return this.handle.name;
    } catch (error) {
      this.handle = null;
      if (error instanceof DOMException && error.name === "AbortError") return null;
      return download(name, text);
    }
  }
}

function download(name: string, text: string): string {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "application/toml" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  return name;
}
