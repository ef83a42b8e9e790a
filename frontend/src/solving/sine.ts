// Sine and cosine as kernels/program/sine.py computes them: the same roundings in every browser.

const TWO_OVER_PI = 2 / Math.PI;
/** Added and taken away again, it leaves the nearest whole number. */
const WHOLE = 1.5 * 2 ** 52;
const MOST_QUARTERS = 2 ** 20;
// π/2 in three parts, of 33 bits each the first two
const PART_1 = 1.5707963267341256;
const PART_2 = 6.077100506303966e-11;
const PART_3 = 2.0222662487959506e-21;

/** The sine and the cosine of the last angle. */
export const turn = new Float64Array(2);

/** Leaves sine and cosine of an angle in `turn`; NaN far beyond a million. */
export function sinCos(x: number): void {
  const n = x * TWO_OVER_PI + WHOLE - WHOLE;
  let r = x - n * PART_1 - n * PART_2 - n * PART_3;
  if (!(Math.abs(n) <= MOST_QUARTERS)) r = NaN;
  const z = r * r;
  let s = -7.647163731819816e-13 + z * 2.8114572543455206e-15;
  s = 1.6059043836821613e-10 + z * s;
  s = -2.505210838544172e-8 + z * s;
  s = 2.7557319223985893e-6 + z * s;
  s = -0.0001984126984126984 + z * s;
  s = 0.008333333333333333 + z * s;
  s = -0.16666666666666666 + z * s;
  s = r + r * z * s;
  let p = 4.779477332387385e-14 + z * -1.5619206968586225e-16;
  p = -1.1470745597729725e-11 + z * p;
  p = 2.08767569878681e-9 + z * p;
  p = -2.755731922398589e-7 + z * p;
  p = 2.48015873015873e-5 + z * p;
  p = -0.001388888888888889 + z * p;
  p = 0.041666666666666664 + z * p;
  p = 1 - 0.5 * z + z * z * p;
  const q = n - 4 * (0.25 * n - 0.375 + WHOLE - WHOLE);
  const odd = q === 1 || q === 3;
  const u = odd ? p : s;
  const v = odd ? s : p;
  turn[0] = q >= 2 ? -u : u;
  turn[1] = q === 1 || q === 2 ? -v : v;
}
