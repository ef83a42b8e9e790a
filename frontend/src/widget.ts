// The notebook widget; anywidget requires a default export with `render`.

import css from "./linkwork.css";
import { mount, type PageData } from "./mount";
import { Slowly } from "./slowly";

/** The part of anywidget's model that is used. */
export interface Model {
  get(name: string): unknown;
  set(name: string, value: unknown): void;
  save_changes(): void;
  on(event: string, told: () => void): void;
  off(event: string, told: () => void): void;
}

/** Minimum interval of row updates to Python while the motion plays [ms]. */
const TELL_EVERY = 100;

// A notebook cell is narrower than a window, and independent of its width.
const FIT = `
:host { display: block; container-type: inline-size; }
.lw { min-height: 0; padding: 10px 12px; border: 1px solid var(--line); border-radius: 12px; }
.lw-stage { position: static; height: 520px; }
.lw-side { max-height: 520px; overflow-y: auto; }
.lw-side > * { flex: none; }
@container (max-width: 720px) {
  .lw { display: block; }
  .lw-side { display: flex; }
  .lw-stage { height: auto; padding-bottom: 14px; }
  .lw-canvas { height: 360px; flex: none; }
  .lw-side { max-height: none; }
}
`;

function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  const page = model.get("page") as PageData;
  const inside = shadow(el);
  const tell = new Slowly(TELL_EVERY, () => model.save_changes());
  let following = true; // what is shown follows the model, not the other way about
  const mounted = mount(inside, page, {
    still: true,
    embedded: true,
    row: (motion, row) => {
      if (following) return;
      following = true;
      model.set("configuration", page.motions[motion]!.name);
      model.set("row", row);
      following = false;
      tell.soon();
    },
  });
  following = false;
  const follow = (): void => {
    if (following) return;
    following = true;
    mounted.goTo(numberOf(page, model), model.get("row") as number);
    following = false;
  };
  follow();
  model.on("change:configuration", follow);
  model.on("change:row", follow);
  const bare = wornBy(inside.querySelector<HTMLElement>(".lw")!);
  return () => {
    model.off("change:configuration", follow);
    model.off("change:row", follow);
    bare();
    tell.stop();
    mounted.destroy();
  };
}

/** A shadow tree, which separates the styles of notebook and widget. */
function shadow(el: HTMLElement): HTMLElement {
  const host = document.createElement("div");
  host.dataset.lmSuppressShortcuts = "true"; // JupyterLab leaves our keys to us
  el.replaceChildren(host);
  const tree = host.attachShadow({ mode: "open" });
  const style = document.createElement("style");
  style.textContent = css + FIT;
  const inside = document.createElement("div");
  tree.append(style, inside);
  return inside;
}

function numberOf(page: PageData, model: Model): number {
  const name = model.get("configuration");
  return Math.max(0, page.motions.findIndex((motion) => motion.name === name));
}

/** Follow the light or dark theme of the notebook if defined, otherwise of the system. */
function wornBy(root: HTMLElement): () => void {
  const { dataset, classList } = document.body;
  const dress = (): void => {
    if (dataset.jpThemeLight === "true" || classList.contains("vscode-light")) root.dataset.theme = "light";
    if (dataset.jpThemeLight === "false" || classList.contains("vscode-dark")) root.dataset.theme = "dark";
  };
  dress();
  const watching = new MutationObserver(dress);
  watching.observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-light", "class"] });
  return () => watching.disconnect();
}

export default { render };
