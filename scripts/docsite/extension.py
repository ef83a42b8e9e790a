"""Directives and roles of the site, and where its cross-references lead.

* ``{terminal}``: commands, run while the site is built, with their output;
* ``{mechanism} NAME``: a mechanism file, shown and checked;
* ``{live} NAME``: a mechanism that moves in the page;
* ``{equations} 25-27``: equations by number;
* ``{open}`text <NAME; O2 A=38>```: a link that opens a mechanism,
  moving, and in the app if the site has one.
"""

from __future__ import annotations

import builtins
import importlib.util
import inspect
import re
import sys
from html import escape
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.docutils import ReferenceRole, SphinxDirective
from sphinx.util.inspect import stringify_signature

import linkwork as lw
from linkwork.core.foundation.errors import internal_members
from scripts.docsite import mathml, text_files
from scripts.docsite.api_page import ALIASES, is_built_by_users, public_names
from scripts.docsite.commands_run import commands_of, run_command
from scripts.docsite.equation_lines import equation_lines
from scripts.docsite.live_pages import Opened, opened

__all__ = ["setup"]

#: Packages whose types may appear in signatures; the site has no pages about them.
_FOREIGN = {"numpy", "pandas", "xarray", "matplotlib", *sys.stdlib_module_names}
_FOREIGN_SHORT = {"np", "Any", "Path", *ALIASES, *dir(builtins)}
_ENTRY = re.compile(r"(?P<names>\w+(?:, \w+)*) :(?P<type>.*)$")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register everything with Sphinx."""
    app.add_config_value("linkwork_app", False, "env")
    app.add_directive("terminal", Terminal)
    app.add_directive("mechanism", MechanismFile)
    app.add_directive("live", Live)
    app.add_directive("equations", Equations)
    app.add_role("open", Open())
    app.connect("missing-reference", _resolve_python)
    app.connect("autodoc-process-signature", _public_signature)
    # before napoleon reads the docstring
    app.connect("autodoc-process-docstring", _without_internal, priority=400)
    app.connect("html-page-context", _plain_parameter_lists)
    app.connect("build-finished", text_files.write_index)
    mathml.setup(app)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


class _OnPage(SphinxDirective):  # type: ignore[misc]  # its types come with an extra
    """What all directives know: the folder of the page, and the way to the root of the site."""

    @property
    def folder(self) -> Path:
        return Path(self.env.doc2path(self.env.docname)).parent

    def show(self, source: str, sliders: tuple[str, ...] = ()) -> Opened:
        site, app = Path(self.env.app.outdir), self.config.linkwork_app
        return opened(source, self.folder, site, sliders=sliders, app=app)

    @property
    def up(self) -> str:
        depth: int = self.env.docname.count("/")
        return "../" * depth


class Terminal(_OnPage):
    """Commands with their output; another exit code than expected fails the build."""

    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {
        "exit": directives.nonnegative_int,
        "lines": directives.positive_int,
    }

    def run(self) -> list[nodes.Node]:
        expected = self.options.get("exit", 0)
        shown: list[str] = []
        for command in commands_of("\n".join(self.content)):
            done = run_command(command, self.folder)
            if done.code != expected:
                raise self.error(f"{command!r} ended with {done.code}: {done.output}")
            shown += [f"$ {command}", *self._cut(done.output.rstrip("\n").split("\n"))]
        text = "\n".join(line.rstrip() for line in shown).rstrip()
        return [nodes.literal_block(text, text, language="console", classes=["terminal"])]

    def _cut(self, lines: list[str]) -> list[str]:
        most = self.options.get("lines", len(lines))
        return lines if len(lines) <= most else [*lines[:most], f"… {len(lines) - most} more lines"]


class Equations(_OnPage):
    """Equations by their numbers, from the page of all equations."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        page = Path(self.env.srcdir) / "equations.md"
        self.env.note_dependency(str(page))
        try:
            text = equation_lines(page.read_text(encoding="utf-8"), self.arguments[0])
        except LookupError as error:
            raise self.error(str(error)) from None
        return [nodes.literal_block(text, text, language="text", classes=["equations"])]


class MechanismFile(_OnPage):
    """A mechanism file; one that cannot be read, or has no position, fails the build."""

    has_content = True
    required_arguments = 1
    option_spec: ClassVar[dict[str, Any]] = {
        "live": directives.flag,
        "fails": directives.flag,
        "sliders": directives.unchanged,
    }

    def run(self) -> list[nodes.Node]:
        name, text = self.arguments[0], "\n".join(self.content) + "\n"
        mechanism = lw.loads(text)
        found = mechanism.solve().status is lw.Status.CONVERGED
        if found == ("fails" in self.options):
            raise self.error(f"{name}: {mechanism.solve().status.value}")
        block = nodes.literal_block(text, text, language="toml")
        caption = nodes.caption(name, "", nodes.literal(name, name))
        shown = nodes.container("", caption, block, literal_block=True)
        shown["classes"].append("literal-block-wrapper")
        if "live" not in self.options:
            return [shown]
        sliders = tuple(filter(None, self.options.get("sliders", "").split(", ")))
        return [shown, frame(self.show(name, sliders), self.up)]


class Live(_OnPage):
    """A mechanism of the library, or of a file of the page, that moves."""

    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar[dict[str, Any]] = {
        "sliders": directives.unchanged,
        "caption": directives.unchanged,
    }

    def run(self) -> list[nodes.Node]:
        sliders = tuple(filter(None, self.options.get("sliders", "").split(", ")))
        found = self.show(self.arguments[0], sliders)
        return [frame(found, self.up, self.options.get("caption", ""))]


def frame(found: Opened, up: str, caption: str = "") -> nodes.raw:
    """An offline page inside the page, and the links that open it alone and in the app."""
    links = f'<a href="{up}{escape(found.page)}">open it alone</a>'
    if found.app:
        links += f' · <a href="{up}{escape(found.app)}">edit it in the app</a>'
    text = escape(caption or found.title)
    html = (
        f'<figure class="live"><iframe src="{up}{escape(found.page)}" title="{escape(found.title)}"'
        ' loading="lazy" sandbox="allow-scripts allow-downloads"></iframe>'
        f"<figcaption>{text}: drag the crank, or {links}.</figcaption></figure>"
    )
    return nodes.raw("", html, format="html")


class Open(ReferenceRole):  # type: ignore[misc]  # its types come with an extra
    """A link to a mechanism: in the app, or to its offline page where the site has no app."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        site, app = Path(self.env.app.outdir), self.config.linkwork_app
        folder = Path(self.env.doc2path(self.env.docname)).parent
        found = opened(self.target, folder, site, app=app)
        up = "../" * self.env.docname.count("/")
        address = f"{up}{found.app or found.page}"
        return [nodes.reference("", self.title, refuri=address, classes=["opens"])], []


def _resolve_python(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, contnode: nodes.TextElement
) -> nodes.Node | None:
    """Where a name in a signature or docstring leads: to the public name, or to nothing.

    A private type of Linkwork stays unresolved, so that the strict build names it.
    """
    if node.get("refdomain") != "py":
        return None
    target: str = node["reftarget"]
    root, short = target.split(".")[0], target.split(".")[-1]
    if root in _FOREIGN or target in _FOREIGN_SHORT or short in _FOREIGN_SHORT:
        return contnode
    if node["reftype"] == "mod":
        known = root == "linkwork" and importlib.util.find_spec(target) is not None
        return contnode if known else None
    if node["reftype"] == "func" and root == "linkwork":
        return contnode  # a hint for readers of the source
    public = next((name for name in public_names() if name.rpartition(".")[2] == short), None)
    if public is None:
        return None
    domain = env.get_domain("py")
    return domain.resolve_xref(
        env, env.docname, app.builder, node["reftype"], f"linkwork.{public}", node, contnode
    )


def _public_signature(
    _app: Sphinx, what: str, _name: str, kind: Any, _options: object, text: str, returns: str
) -> tuple[str, str] | None:
    """No constructor for results; parameters of others without internal ones."""
    if what not in ("class", "exception"):
        return None
    if what == "exception" or not is_built_by_users(kind):
        return "", ""
    signature = inspect.signature(kind)
    hidden = internal_members(kind)
    shown = [own for own in signature.parameters.values() if own.name not in hidden]
    bare = signature.replace(parameters=shown, return_annotation=inspect.Signature.empty)
    return stringify_signature(bare, unqualified_typehints=True), ""


def _without_internal(
    _app: Sphinx, what: str, _name: str, kind: Any, _options: object, lines: list[str]
) -> None:
    """Leave internal fields out of the parameters of a class."""
    hidden = internal_members(kind) if what == "class" else frozenset()
    kept: list[str] = []
    dropping = False
    for line in lines:
        entry = _ENTRY.match(line)
        if entry:
            names = [name for name in entry["names"].split(", ") if name not in hidden]
            dropping = not names
            line = f"{', '.join(names)} :{entry['type']}"
        elif not line.startswith(" "):
            dropping = False
        if not dropping:
            kept.append(line)
    lines[:] = kept


def _plain_parameter_lists(
    _app: Sphinx, _page: str, _template: str, context: dict[str, Any], _tree: object
) -> None:
    """Parameters one below the other are no list of definitions, as Sphinx marks them."""
    if "body" in context:
        context["body"] = context["body"].replace("<dl>\n<dd><em", '<dl role="none">\n<dd><em')
