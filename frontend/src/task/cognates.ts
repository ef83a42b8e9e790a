// The cognates of a four-bar beside each other: three linkages with one coupler curve.

import type { CognateShown, CognatesFound } from "../messages";
import { html, say, svg } from "../svg";
import { boxAround, pairs, type Place } from "./geometry";
import { drawLinkage } from "./linkage_drawing";

const NONE = "Cognates are those of a four-bar with a coupler point: choose one in the list of designs.";
const [WIDTH, HEIGHT, AIR] = [200, 160, 20];

export class Cognates {
  readonly element = html("div", { class: "lw-t-cognates" });
  private readonly lead = html("p", { class: "lw-lead", role: "status" }, this.element);
  private readonly cards = html("div", { class: "lw-t-cards" }, this.element);

  constructor(private readonly choose: (index: number) => void) {}

  /** The cognates of a design; `none` tells why there are none. */
  show(found: CognatesFound | null, none = NONE): void {
    this.cards.replaceChildren();
    const some = (found?.cognates.length ?? 0) > 1;
    say(this.lead, some ? "Roberts' cognates: their points P follow one curve. All pictures have one scale." : none);
    if (!found || !some) return;
    const places = [...found.cognates.flatMap(({ points }) => Object.values(points)), ...found.curve.flatMap(pairs)];
    const box = boxAround(places)!;
    const scale = Math.min((WIDTH - 2 * AIR) / (box[2] - box[0] || 1), (HEIGHT - 2 * AIR) / (box[3] - box[1] || 1));
    const [cx, cy] = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
    const project = ([x, y]: Place): Place => [WIDTH / 2 + (x - cx) * scale, HEIGHT / 2 - (y - cy) * scale];
    found.cognates.forEach((one, k) => this.card(one, found, k, project));
  }

  private card(one: CognateShown, found: CognatesFound, k: number, project: (place: Place) => Place): void {
    const card = html("button", { type: "button", class: `lw-t-card${one.sound ? "" : " lw-t-refused"}`, "aria-pressed": String(one.index === found.design) }, this.cards);
    card.disabled = one.index < 0;
    const picture = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "aria-hidden": "true" }, card);
    for (const piece of found.curve) {
      const line = pairs(piece).map(project);
      svg("path", { d: `M${line.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}`, class: "lw-t-curve" }, picture);
    }
    const at = (name: string): Place => one.points[name]!;
    const row = ["A", "B", "P"].flatMap((name) => [...at(name)]);
    const design = { fixed: [[at("A0")], [at("B0")]], guided: "P", lines: [null, null], design: { drive: one.drive } } as unknown as Parameters<typeof drawLinkage>[1];
    drawLinkage(picture, design, row, project);
    html("strong", {}, card, ["This design", "First cognate", "Second cognate"][k]!);
    html("span", {}, card, one.sound ? "without defects" : one.reason);
    card.addEventListener("click", () => this.choose(one.index));
  }
}
