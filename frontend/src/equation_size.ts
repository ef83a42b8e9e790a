// Equations in the width of their column: long ones become smaller before they have to be scrolled.

/** The smallest part of the usual size. */
const LEAST = 0.55;

/** All equations of a box in one size at which the longest fits. */
export function fitEquations(box: HTMLElement): void {
  const lines = [...box.querySelectorAll<HTMLElement>(".lw-equation math")];
  for (const line of lines) line.style.fontSize = "";
  const shares = lines.map(({ parentElement }) => parentElement!.clientWidth / Math.max(1, parentElement!.scrollWidth));
  const share = Math.max(LEAST, Math.min(1, ...shares));
  if (share < 1) for (const line of lines) line.style.fontSize = `${Math.floor(100 * share)}%`;
}

/** Keep them so while the box changes its width. */
export function keepFitted(box: HTMLElement, signal: AbortSignal): void {
  // in the next frame: what changes within this one would be observed again
  const observer = new ResizeObserver(() => requestAnimationFrame(() => fitEquations(box)));
  observer.observe(box);
  signal.addEventListener("abort", () => observer.disconnect());
}
