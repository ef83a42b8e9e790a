// The entry point of the live page of linkwork view.

import { html } from "../svg";
import { Connection } from "./connection";
import { LivePage } from "./live_page";

const element = document.getElementById("linkwork")!;
element.replaceChildren(html("p", { class: "lw-wait", role: "status" }, undefined, "Connecting …"));
new LivePage(element, (hooks) => new Connection(hooks));
