// Text fields that show numbers of the file, and what is typed into them but not entered yet.

/** Remember what a text field contains before something is typed. */
export function begin(field: EventTarget | null): void {
  if (field instanceof HTMLInputElement && field.type === "text") field.dataset.begun = field.value;
}

/** Whether something typed but not entered was taken back. */
export function restored(field: EventTarget | null): boolean {
  if (!(field instanceof HTMLInputElement)) return false;
  const { begun } = field.dataset;
  if (begun === undefined || field.value === begun) return false;
  field.value = begun;
  return true;
}

/** Show a text, unless something is being typed. */
export function fill(field: HTMLInputElement, text: string): void {
  const typing = field === document.activeElement && field.dataset.begun !== undefined && field.value !== field.dataset.begun;
  if (typing) return;
  field.value = text;
  field.dataset.begun = text;
}
