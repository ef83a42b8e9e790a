// Number formats.

const MINUS = "\u2212";

/** A value to six significant digits, without an exponent if possible; values up to `rounding`
 * are 0. */
export function shortNumber(value: number, digits = 6, rounding = 0): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size <= rounding) return "0";
  if (size < 1e-9) return powerOfTen(value);
  if (size < 1e-4 || size >= 1e9) return powerOfTen(value, 4);
  const decimals = Math.min(6, Math.max(0, digits - 1 - Math.floor(Math.log10(size))));
  const text = value.toFixed(decimals);
  return withMinus(Number(text) === 0 ? text.replace("-", "") : text);
}

/** A value as m·10ⁿ, for residuals. */
export function powerOfTen(value: number, digits = 2): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const raised = String(Number(exponent)).replace(/[-0-9]/g, (sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]!);
  return withMinus(`${mantissa}·10${raised}`);
}

/** Smaller angles are shown as 0. */
export const LEAST_ANGLE = 1e-9;

/** A value with its unit: 60°, 12.5 mm. */
export function measured(value: number, unit: string): string {
  if (!Number.isFinite(value)) return "–";
  const text = shortNumber(value, 6, unit === "deg" || unit === "rad" ? LEAST_ANGLE : 0);
  if (unit === "deg") return `${trimmed(text)}°`;
  return unit ? `${text} ${unit}` : text;
}

/** A printed name: O2 as O₂. */
export function printedName(name: string): string {
  return name.replace(/^([\p{L}]+)([0-9]+)$/u, (_, letters: string, digits: string) => letters + digits.replace(/[0-9]/g, (d) => "₀₁₂₃₄₅₆₇₈₉"[Number(d)]!));
}

/** The largest number of so many significant digits that is not above a lower bound. */
export function roundedDown(value: number, digits: number): number {
  const near = Number(value.toPrecision(digits));
  const step = 10 ** (Math.floor(Math.log10(value)) - digits + 1);
  return near <= value ? near : Number((near - step).toPrecision(digits));
}

/** A number without trailing zeros. */
export function trimmed(text: string): string {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

function withMinus(text: string): string {
  return text.replace(/^-/, MINUS);
}

/** Round numbers between two values, approximately as many as requested. */
export function ticks(low: number, high: number, about: number): number[] {
  const rough = (high - low) / Math.max(1, about);
  // steps of rounding errors would never end
  if (!(rough > 1e-12 * Math.max(Math.abs(low), Math.abs(high)))) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((one) => one >= 0.6 * rough)!;
  const found: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9) + 0; k * step <= high + 1e-9 * step; k++) found.push(k * step + 0);
  return found;
}

/** Round angles in degrees between two values. */
export function degreeTicks(low: number, high: number, about: number): number[] {
  const rough = (high - low) / Math.max(1, about);
  const step = [1, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720, 1440].find((one) => one >= 0.8 * rough);
  if (step === undefined || rough < 0.5) return ticks(low, high, about);
  const found: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9) + 0; k * step <= high + 1e-9; k++) found.push(k * step + 0);
  return found;
}

/** A positive number rounded up to 1, 1.5, 2, … times a power of ten. */
export function roundUp(wanted: number): number {
  const power = 10 ** Math.floor(Math.log10(wanted));
  const steps = [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10];
  return steps.find((step) => step * power >= wanted * (1 - 1e-12))! * power;
}
