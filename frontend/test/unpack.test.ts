import { describe, expect, it } from "vitest";
import { deflateRawSync } from "node:zlib";
import { dense, inflated, unpacked, wholeNumbers } from "../src/unpack";

const base64 = (bytes: number[]): string => Buffer.from(bytes).toString("base64");

describe("packed columns", () => {
  it("reads zigzag integers of seven bits a byte", () => {
    expect(wholeNumbers(Uint8Array.from([0, 1, 2, 3, 0x80, 1, 0xff, 0x7f]))).toEqual([0, -1, 1, -2, 64, -8192]);
  });

  it("reads integers beyond 32 bits", () => {
    // 2^40 as zigzag 2^41: five groups of zeros, then 2^41 / 2^35 = 64.
    expect(wholeNumbers(Uint8Array.from([0x80, 0x80, 0x80, 0x80, 0x80, 64]))).toEqual([2 ** 40]);
  });

  it("adds differences up as often as they were taken", () => {
    // 1, 4, 9, 16 has first differences 1, 3, 5, 7 and second 1, 2, 2, 2.
    const column = { step: 0.5, order: 2, content: base64([2, 4, 4, 4]), gaps: [] };
    expect(Array.from(dense(column))).toEqual([0.5, 2, 4.5, 8]);
  });

  it("reads plain floats as they are", () => {
    const floats = new Float64Array([0.1, -1e300, 3]);
    const content = Buffer.from(floats.buffer).toString("base64");
    expect(Array.from(dense({ step: 1, order: -1, content, gaps: [] }))).toEqual([0.1, -1e300, 3]);
  });

  it("reads floats of four bytes", () => {
    const content = Buffer.from(new Float32Array([0.5, -3, 1e30]).buffer).toString("base64");
    expect(Array.from(dense({ step: 1, order: -2, content, gaps: [] }))).toEqual([0.5, -3, Math.fround(1e30)]);
  });

  it("leaves rows without a position open", () => {
    const column = { step: 1, order: 0, content: base64([2, 4]), gaps: [] };
    expect(Array.from(unpacked(column, [true, false, true]))).toEqual([1, NaN, 2]);
  });

  it("has no number in gaps", () => {
    const column = { step: 1, order: 1, content: base64([2, 2, 2]), gaps: [1] };
    expect(Array.from(unpacked(column, [true, false, true, true]))).toEqual([1, NaN, NaN, 3]);
  });

  it("inflates what zlib deflated", async () => {
    const text = '{"title":"θ₁₂ – four-bar"}';
    expect(await inflated(deflateRawSync(Buffer.from(text)).toString("base64"))).toBe(text);
  });
});
