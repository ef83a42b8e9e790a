"""Formulas as MathML: browsers draw it without a script or a font from elsewhere."""

from __future__ import annotations

from html import escape
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util.math import get_node_equation_number

__all__ = ["setup"]


def setup(app: Sphinx) -> None:
    """Make ``html_math_renderer = "mathml"`` known."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    """A formula on its own line, with its number on the right."""
    number = get_node_equation_number(translator, node) if node["number"] else ""
    ids = "".join(f' id="{escape(name)}"' for name in node["ids"][:1])
    shown = f'<span class="eqno">({number})</span>' if number else ""
    formula = tex2mathml(node.astext(), as_block=True)
    translator.body.append(f'<div class="math-block"{ids} tabindex="0">{formula}{shown}</div>\n')
    raise nodes.SkipNode
