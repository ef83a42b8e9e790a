"""Settings of the documentation site; scripts/docs runs Sphinx with them."""

from __future__ import annotations

import linkwork  # noqa: F401 - the pages need it: fail early, and name it

project = "Linkwork"
author = "Linkwork developers"
extensions = [
    "myst_nb",
    "sphinx_design",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "scripts.docsite.extension",
]
exclude_patterns = ["contributing/**", "images/**"]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "html_image"]
myst_heading_anchors = 4
nb_execution_mode = "force"
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_merge_streams = True
nb_ipywidgets_js: dict[str, object] = {}  # no script from another host

autodoc_typehints = "signature"
autodoc_member_order = "bysource"
toc_object_entries = False
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
napoleon_use_param = False  # types are in the signature; the text beside a name is English
napoleon_use_rtype = False
napoleon_use_ivar = False

html_theme = "pydata_sphinx_theme"
html_title = "Linkwork"
templates_path = ["_templates"]
html_static_path = ["_static"]
html_favicon = "_static/linkwork.svg"
html_css_files = ["linkwork.css"]
html_math_renderer = "mathml"  # in scripts/docsite/mathml.py: no script, no font
html_show_sourcelink = False
html_show_sphinx = False
html_theme_options = {
    "show_prev_next": True,
    "navigation_with_keys": False,
    "navbar_align": "left",
    "header_links_before_dropdown": 7,
    "show_toc_level": 2,
    "navigation_depth": 1,  # the side bar lists the index of the decisions, not every record
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
    "logo": {"text": "Linkwork", "alt_text": "Linkwork"},
}
