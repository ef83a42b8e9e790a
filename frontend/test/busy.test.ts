import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

class Element {
  hidden = false;
  style = { setProperty: (): void => undefined };
  classList = { add: (): void => undefined, remove: (): void => undefined };
  private attributes = new Map<string, string>();
  setAttribute(name: string, value: string): void {
    if (name === "hidden") this.hidden = true;
    this.attributes.set(name, value);
  }
  getAttribute(name: string): string | null {
    return this.attributes.get(name) ?? null;
  }
  removeAttribute(name: string): void {
    this.attributes.delete(name);
  }
}

describe("the sign of work", () => {
  beforeEach(() => {
    vi.useFakeTimers();
    vi.stubGlobal("document", { createElement: () => new Element() });
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  it("appears when an answer takes long, and goes with it", async () => {
    const { Busy, SOON } = await import("../src/live/busy");
    const busy = new Busy();
    busy.asked(1);
    vi.advanceTimersByTime(SOON - 1);
    expect(busy.element.hidden).toBe(true);
    vi.advanceTimersByTime(2);
    expect(busy.element.hidden).toBe(false);
    busy.answered(null);
    expect(busy.element.hidden).toBe(false);
    busy.asked(2);
    busy.answered(1);
    expect(busy.element.hidden).toBe(false);
    busy.answered(2);
    expect(busy.element.hidden).toBe(true);
  });

  it("takes an answer for requests before it too", async () => {
    const { Busy, SOON } = await import("../src/live/busy");
    const busy = new Busy();
    for (const id of [1, 2, 3]) busy.asked(id);
    busy.answered(3);
    vi.advanceTimersByTime(SOON + 1);
    expect(busy.element.hidden).toBe(true);
  });
});
