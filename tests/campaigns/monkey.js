// What a monkey at the live page watches and finds; an object of functions.
({
  /** Counts the requests without answer, and keeps the last state of the file. */
  watch() {
    const Own = window.WebSocket;
    const seen = (window.seen = { pending: new Map(), state: null, heard: 0, mistakes: [] });
    window.WebSocket = class extends Own {
      constructor(...all) {
        super(...all);
        this.addEventListener("message", (message) => {
          const event = JSON.parse(message.data);
          seen.heard = performance.now();
          if (event.kind === "file_state") seen.state = event;
          if (event.kind === "refused" && event.message.includes("error in Linkwork")) seen.mistakes.push(event.message);
          if (event.answers === null || event.kind === "working") return;
          for (const id of [...seen.pending.keys()]) if (id <= event.answers) seen.pending.delete(id);
        });
      }
      send(text) {
        const request = JSON.parse(text);
        // the width of the sheet needs no answer
        if (request.kind !== "set_sheet") seen.pending.set(request.id, request.kind);
        seen.heard = performance.now();
        super.send(text);
      }
    };
  },

  quiet: () => window.seen.pending.size === 0 && performance.now() - window.seen.heard > 100,

  /** Middles and names of things that can be clicked, but for those whose names begin with `without`. */
  things([kind, without]) {
    const not = new RegExp(`^(${without})`);
    return [...document.querySelectorAll(kind)].flatMap((one) => {
      const { x, y, width, height } = one.getBoundingClientRect();
      const name = (one.getAttribute("aria-label") || one.textContent || "").trim();
      const at = [x + width / 2, y + height / 2];
      if (!width || one.disabled || not.test(name)) return [];
      const top = document.elementFromPoint(...at);
      return top && (one === top || one.contains(top)) ? [[...at, name.slice(0, 40)]] : [];
    });
  },

  /** Another entry of a list, or another place on a slider. */
  choose([x, y, share]) {
    const one = document.elementFromPoint(x, y);
    if (one instanceof HTMLSelectElement) one.selectedIndex = Math.floor(share * one.options.length);
    else if (one instanceof HTMLInputElement) one.value = String(Number(one.min) + share * (one.max - one.min));
    for (const kind of ["input", "change"]) one?.dispatchEvent(new Event(kind, { bubbles: true }));
  },

  write(text) {
    const area = document.querySelector(".lw-build textarea");
    area.value = text;
    [...document.querySelectorAll(".lw-build button")].find((one) => one.textContent === "Use this text").click();
  },

  undo: () => document.querySelector('.lw-bar button[aria-label^="Undo"]').click(),

  /** What is drawn: the displayed row, the points by number, and whether anything can be done. */
  shown() {
    const row = document.querySelector(".lw[data-row]")?.dataset.row;
    const handles = [...document.querySelectorAll(".lw-handles .lw-handle")];
    return {
      row: row === undefined ? null : Number(row),
      edited: document.querySelector(".lw-drawing")?.classList.contains("lw-edited") ?? false,
      points: handles.map((one) => [Number(one.dataset.point), Number(one.getAttribute("cx")), -Number(one.getAttribute("cy"))]),
      elsewhere: document.querySelector(".lw-look[aria-pressed=true]") !== null,
      mistakes: window.seen.mistakes.splice(0),
      lost: document.querySelector(".lw-lost") !== null,
      able: [...document.querySelectorAll("button, textarea")].filter((one) => !one.disabled).length,
    };
  },
})
