// The menu of other formats that the visitor can download.

import type { Exported } from "../messages";
import { html } from "../svg";
import type { Desk } from "./asking";

interface Format {
  readonly format: string;
  readonly text: string;
}

const FORMATS: readonly Format[] = [
  { format: "toml", text: "Mechanism file (TOML)" },
  { format: "svg", text: "Picture (SVG)" },
  { format: "png", text: "Picture (PNG)" },
  { format: "csv", text: "Table (CSV)" },
  { format: "xlsx", text: "Workbook (XLSX)" },
  { format: "html", text: "Offline page (HTML)" },
  { format: "gif", text: "Film (GIF)" },
  { format: "mp4", text: "Film (MP4)" },
];

/** Pixels of the longer side of a PNG picture. */
const PIXELS = 2400;

export class ExportMenu {
  readonly element = html("details", { class: "lw-menu" });
  /** The PNG picture is drawn by the browser from an SVG picture. */
  private drawn = false;

  constructor(
    private readonly desk: Desk,
    private readonly row: () => number | null,
    private readonly done: (text: string) => void,
  ) {
    html("summary", { role: "button", "aria-haspopup": "menu", title: "Download in another format" }, this.element, "Export");
    const list = html("div", { class: "lw-menu-list", role: "menu" }, this.element);
    for (const { format, text } of FORMATS) {
      const item = html("button", { type: "button", role: "menuitem", "data-format": format }, list, text);
      item.addEventListener("click", () => this.ask(format));
    }
    // Before the keys of the drawing.
    window.addEventListener("keydown", (event) => this.key(event), { capture: true });
    document.addEventListener("pointerdown", (event) => {
      if (!this.element.contains(event.target as Node)) this.element.open = false;
    });
  }

  /** A file has arrived: the browser saves it. */
  async show(file: Exported): Promise<void> {
    const bytes = Uint8Array.from(atob(file.content), (letter) => letter.charCodeAt(0));
    let blob = new Blob([bytes], { type: file.media_type });
    let { name } = file;
    if (this.drawn && file.media_type === "image/svg+xml") {
      this.drawn = false;
      blob = await pictureOf(new TextDecoder().decode(bytes));
      name = name.replace(/svg$/, "png");
    }
    download(blob, name);
    const notices = file.notices.length ? ` Values only: ${file.notices.join("; ")}.` : "";
    this.done(`Downloaded as ${name}.${notices}`);
  }

  private ask(format: string): void {
    this.element.open = false;
    this.drawn = format === "png";
    const dark = getComputedStyle(this.element).colorScheme === "dark";
    this.desk.ask({ kind: "export", format: this.drawn ? "svg" : format, row: this.row(), dark });
  }

  private key(event: KeyboardEvent): void {
    if (!this.element.contains(event.target as Node)) return;
    const items = [...this.element.querySelectorAll<HTMLButtonElement>("button")];
    const at = items.indexOf(document.activeElement as HTMLButtonElement);
    const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (event.key === "Escape") {
      this.element.open = false;
      this.element.querySelector("summary")!.focus();
    } else if (by !== undefined) {
      this.element.open = true;
      items[(at + by + items.length) % items.length]!.focus();
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

/** A picture of an SVG text, as PNG with the colour of the page behind it. */
async function pictureOf(text: string): Promise<Blob> {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const scale = PIXELS / Math.max(image.width, image.height);
  const canvas = html("canvas", { width: Math.round(scale * image.width), height: Math.round(scale * image.height) });
  const brush = canvas.getContext("2d")!;
  const page = document.querySelector(".lw");
  brush.fillStyle = page ? getComputedStyle(page).backgroundColor : "white";
  brush.fillRect(0, 0, canvas.width, canvas.height);
  brush.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((found, lost) =>
    canvas.toBlob((blob) => (blob ? found(blob) : lost(new Error("no picture"))), "image/png"),
  );
}

function download(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  const link = html("a", { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
