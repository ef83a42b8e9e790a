// The entry of the live page: what the program tells is shown, what is done is asked.

import { html } from "../svg";
import { LivePage } from "./live_page";

const element = document.getElementById("linkwork")!;
element.replaceChildren(html("p", { class: "lw-wait", role: "status" }, undefined, "Connecting …"));
new LivePage(element);
