// The service worker: the page and its engine without a network, after the first visit.

declare const self: {
  addEventListener(kind: "install" | "activate" | "fetch", hear: (event: WorkerEvent) => void): void;
  skipWaiting(): Promise<void>;
  readonly location: Location;
};
interface WorkerEvent {
  readonly request: Request;
  waitUntil(work: Promise<unknown>): void;
  respondWith(answer: Promise<Response>): void;
}
/** Written by the builder in front of this script. */
declare const LINKWORK_BUILD: string;

/** One for each folder of a host, as the page names it. */
const OURS = `linkwork ${new URL("./", self.location.href).pathname} `;
const NAME = `${OURS}${LINKWORK_BUILD}`;
const PAGE = "./";

self.addEventListener("install", (event) => {
  const pages = caches.open(NAME).then((cache) => cache.add(PAGE));
  event.waitUntil(pages.then(() => self.skipWaiting()));
});

self.addEventListener("activate", (event) => {
  const older = async (): Promise<void> => {
    const names = (await caches.keys()).filter((name) => name.startsWith(OURS) && name !== NAME);
    await Promise.all(names.map((name) => caches.delete(name)));
  };
  event.waitUntil(older());
});

self.addEventListener("fetch", (event) => {
  if (event.request.method !== "GET" || new URL(event.request.url).origin !== self.location.origin) return;
  event.respondWith(answer(event.request));
});

/** The network first, for pages: a new version is seen at once. The engine's files never change. */
async function answer(request: Request): Promise<Response> {
  const kept = await caches.open(NAME);
  const options = { ignoreVary: true };
  if (request.mode !== "navigate") return (await kept.match(request, options)) ?? fetch(request);
  try {
    return await fetch(request);
  } catch {
    return (await kept.match(request, options)) ?? (await kept.match(PAGE)) ?? Response.error();
  }
}
export {};
