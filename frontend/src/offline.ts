// The entry point of the offline page, which contains its data.

import { mount, type Mounted, type PageData } from "./mount";
import { inflated } from "./unpack";

declare global {
  interface Window {
    /** For scripts that control the page. */
    linkwork: Mounted;
  }
}

async function start(): Promise<void> {
  const holder = document.getElementById("linkwork-data")!;
  const content = holder.textContent ?? "";
  const text = holder.dataset.encoding === "json" ? content : await inflated(content);
  window.linkwork = mount(document.getElementById("linkwork")!, JSON.parse(text) as PageData);
}

start().catch((error: unknown) => {
  document.getElementById("linkwork")!.textContent = `This page cannot be shown: ${String(error)}`;
  throw error;
});
