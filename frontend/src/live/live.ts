// The entry point of the live page.

import { html } from "../svg";
import { LivePage } from "./live_page";

const element = document.getElementById("linkwork")!;
element.replaceChildren(html("p", { class: "lw-wait", role: "status" }, undefined, "Connecting …"));
new LivePage(element);
