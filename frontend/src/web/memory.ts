/** Give memory back at once, by sending it nowhere: a worker at rest may not collect garbage for a long time. */
export function release(buffer: ArrayBuffer): void {
  const { port1, port2 } = new MessageChannel();
  port1.postMessage(null, [buffer]);
  port1.close();
  port2.close();
}
