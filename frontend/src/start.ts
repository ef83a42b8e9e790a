// Mounts the front end of an offline page, which contains its data.

import { mount, type Hooks, type Mounted, type PageData } from "./mount";
import { inflated } from "./unpack";

declare global {
  interface Window {
    /** For scripts that control the page. */
    linkwork: Mounted;
  }
}

/** The data in an element of the page. */
export async function contained<T>(id: string): Promise<T> {
  const holder = document.getElementById(id)!;
  const content = holder.textContent ?? "";
  return JSON.parse(holder.dataset.encoding === "json" ? content : await inflated(content)) as T;
}

/** Mount the page; then add to it. */
export function start(more: (data: PageData) => Promise<void> | void = () => {}, hooks: Hooks = {}): void {
  const place = document.getElementById("linkwork")!;
  const run = async (): Promise<void> => {
    const data = await contained<PageData>("linkwork-data");
    window.linkwork = mount(place, data, hooks);
    await more(data);
  };
  run().catch((error: unknown) => {
    place.textContent = `This page cannot be shown: ${String(error)}`;
    throw error;
  });
}
