// The entry of the offline page: its data stand in the page.

import { mount, type PageData } from "./mount";
import { inflated } from "./unpack";

async function start(): Promise<void> {
  const holder = document.getElementById("linkwork-data")!;
  const content = holder.textContent ?? "";
  const text = holder.dataset.encoding === "json" ? content : await inflated(content);
  mount(document.getElementById("linkwork")!, JSON.parse(text) as PageData);
}

start().catch((error: unknown) => {
  document.getElementById("linkwork")!.textContent = `This page cannot be shown: ${String(error)}`;
  throw error;
});
