import { expect, test } from "vitest";
import { symbolWidth, viewOf } from "../src/view_box";

test.each([[900, 5], [1440, 500], [800, 800], [390, 844]])("a view that fits symbols of its size is smaller: %d by %d px", (w, h) => {
  const size = symbolWidth({ x: 0, y: 0, width: 100 }, w, h) / 2;
  const box = [-0.55 * size, -0.55 * size, 0.55 * size, 0.55 * size]; // of a sketch much smaller than that
  expect(1.3 * viewOf(box, w, h).width).toBeLessThan(100); // also with room to draw on
});

test("symbols have the size of the view unless it is flat", () => {
  expect(symbolWidth({ x: 0, y: 0, width: 100 }, 400, 300)).toBeCloseTo(100);
  expect(symbolWidth({ x: 0, y: 0, width: 100 }, 400, 30)).toBeCloseTo(10);
});
