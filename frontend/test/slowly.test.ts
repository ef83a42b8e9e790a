import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { Slowly } from "../src/slowly";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

test("calls close together are one, and the last is not lost", () => {
  let acted = 0;
  const told = new Slowly(100, () => acted++);
  for (let k = 0; k < 12; k++) {
    told.soon();
    vi.advanceTimersByTime(30); // 360 ms in all
  }
  expect(acted).toBe(3);
  told.soon();
  vi.advanceTimersByTime(100);
  expect(acted).toBe(4);
});

test("stopping does at once what is still to be done, and nothing twice", () => {
  let acted = 0;
  const told = new Slowly(100, () => acted++);
  told.stop();
  expect(acted).toBe(0);
  told.soon();
  told.stop();
  expect(acted).toBe(1);
  vi.advanceTimersByTime(1000);
  expect(acted).toBe(1);
});
