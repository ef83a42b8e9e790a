// The dialog that hands the mechanism on: a link, its QR code, and HTML for other pages.

import type { LinkMade } from "../messages";
import { html } from "../svg";
import type { Desk } from "./asking";

/** Key of the typed address in localStorage. */
const KEPT = "linkwork-app";
const COPIED = 2000; // milliseconds

let own = "";

/** Links lead to this page itself: no address is asked for. */
export function setAppUrl(address: string): void {
  own = address.replace(/#.*$/s, "");
}

/** The address of the app that links lead to; empty if none is known. */
export function appUrl(): string {
  return own || kept();
}

/** Storage may be forbidden, as in a sandboxed frame. */
function kept(): string {
  try {
    return localStorage.getItem(KEPT) ?? "";
  } catch {
    return "";
  }
}

function keep(address: string): void {
  try {
    localStorage.setItem(KEPT, address);
  } catch {
    // it is asked for again next time
  }
}

export class LinkDialog {
  private readonly element = html("dialog", { class: "lw-share", "aria-labelledby": "lw-share-title" });
  private readonly address = html("label", {}, undefined, "Address of a Linkwork app");
  private readonly app: HTMLInputElement;
  private readonly link: HTMLTextAreaElement;
  private readonly embed: HTMLTextAreaElement;
  private readonly code = html("div", { class: "lw-code" });
  private readonly note = html("p", { class: "lw-lead", role: "status" });

  constructor(private readonly desk: Pick<Desk, "ask">) {
    html("h2", { id: "lw-share-title" }, this.element, "Share this file");
    html("p", { class: "lw-lead" }, this.element, "The link contains the whole file, after the #: browsers do not send that part to a server.");
    this.element.append(this.address);
    this.app = html("input", { type: "text", inputmode: "url", autocomplete: "url", spellcheck: "false", placeholder: "https://…" }, this.address);
    this.app.addEventListener("change", () => this.renew());
    this.link = this.copied("Link");
    this.embed = this.copied("HTML for a course page");
    this.element.append(this.code, this.note);
    const close = html("button", { type: "button" }, this.element, "Close");
    close.addEventListener("click", () => this.element.close());
  }

  get opened(): boolean {
    return this.element.open;
  }

  /** Open the dialog in a page, and ask for the link. */
  open(page: Element): void {
    page.append(this.element);
    this.address.hidden = own !== "";
    this.app.value = appUrl();
    this.element.showModal();
    this.renew();
  }

  /** Ask for the link again if the dialog is open. */
  renew(): void {
    if (this.opened) this.desk.ask({ kind: "make_link", app: this.app.value.trim() });
  }

  show({ link, embed, qr, note }: LinkMade): void {
    fill(this.link, link);
    fill(this.embed, embed);
    if (link && !own) keep(this.app.value.trim()); // an address that was accepted, or none
    this.code.replaceChildren();
    if (qr) {
      // as a picture, which can be saved
      html("img", { src: `data:image/svg+xml,${encodeURIComponent(qr)}`, alt: "QR code of the link" }, this.code);
    }
    const part = "Without an address this is the last part of a link: linkwork view \"#…\" and lw.load read it.";
    this.note.textContent = note || (embed ? "" : part);
  }

  /** Show why there is no link. */
  refuse(message: string): void {
    this.show({ kind: "link_made", answers: null, link: "", embed: "", qr: "", note: message });
  }

  /** A text to copy, with its button. */
  private copied(name: string): HTMLTextAreaElement {
    const box = html("div", { class: "lw-copied" }, this.element);
    const area = html("textarea", { rows: 3, readonly: "", spellcheck: "false" }, html("label", {}, box, name));
    area.addEventListener("focus", () => area.select());
    const button = html("button", { type: "button", "aria-live": "polite", "aria-label": `Copy: ${name}` }, box, "Copy");
    button.addEventListener("click", () => {
      void copy(area).then((done) => {
        button.textContent = done ? "Copied" : "Press Ctrl+C";
        setTimeout(() => (button.textContent = "Copy"), COPIED);
      });
    });
    return area;
  }
}

/** Show a text with its button; hide both if it is empty. */
function fill(area: HTMLTextAreaElement, text: string): void {
  area.value = text;
  area.closest<HTMLElement>(".lw-copied")!.hidden = !text;
}

/** Copy a text, also where the clipboard is forbidden; otherwise select it. */
async function copy(area: HTMLTextAreaElement): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(area.value);
    return true;
  } catch {
    area.select();
    return document.execCommand("copy");
  }
}
