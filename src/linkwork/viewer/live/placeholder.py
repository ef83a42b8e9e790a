"""PLACEHOLDER for the front end: a page that connects and shows the title, nothing more.

To be replaced by the bundled front end; only ``PAGES`` is used from outside.
"""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["PAGES"]

_HTML = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>Linkwork</title>
<link rel="icon" href="data:,">
<h1 id="title">Linkwork</h1>
<p id="state" role="status">Connecting …</p>
<script src="live.js"></script>
</html>
"""

_SCRIPT = """\
"use strict";
const say = (id, text) => { document.getElementById(id).textContent = text; };
const socket = new WebSocket(
  `ws://${location.host}/live`, ["linkwork", `token.${location.hash.slice(1)}`]);
socket.onmessage = (message) => {
  const event = JSON.parse(message.data);
  if (event.kind === "file_state") say("title", event.title);
  if (event.kind === "motion_found") say("state", `${event.rows - event.missing} positions`);
  if (event.kind === "cannot_close") say("state", `cannot close: a gap of ${event.gap} remains`);
  if (event.kind === "refused") say("state", event.message);
};
socket.onclose = () => {
  if (document.getElementById("state").textContent.startsWith("Connecting"))
    say("state", "Refused: open the address that the command linkwork view printed.");
};
"""

#: What may be asked for by path: media type and content.
PAGES: Mapping[str, tuple[str, bytes]] = {
    "/": ("text/html; charset=utf-8", _HTML.encode()),
    "/live.js": ("text/javascript; charset=utf-8", _SCRIPT.encode()),
}
