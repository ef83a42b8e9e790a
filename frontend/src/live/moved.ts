// The message about lengths that followed a point.

import type { PointMoved } from "../messages";

export function moved({ point, followed, stayed }: PointMoved): string {
  const parts = [`${point} was moved in the sketch.`];
  if (followed.length) parts.push(`${listed(followed)} followed.`);
  if (stayed.length) parts.push(`${listed(stayed)} stayed: given by a formula.`);
  return parts.join(" ");
}

function listed(names: readonly string[]): string {
  return names.length > 4 ? `${names.slice(0, 4).join(", ")} and ${names.length - 4} more lengths` : names.join(", ");
}
