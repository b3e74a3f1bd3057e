"""How Sphinx makes the documentation site: `make docs`.

Its source folder is the repository, so that the pages read the same here and on a Git host.
"""

from __future__ import annotations

from typing import Any

import spectral_tv

project = "Spectral TV"
author = "Spectral TV maintainers"
version = release = spectral_tv.__version__
language = "en"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
]
root_doc = "docs/site/index"
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs/**"]
exclude_patterns = [
    ".*", "addon", "demo", "dist", "docs/site/extra", "python", "rust", "target", "tests", "tools",
]  # fmt: skip
show_warning_types = True

myst_heading_anchors = 4
nb_execution_mode = "force"
nb_execution_timeout = 600
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_output_stderr = "remove"  # bars of progress
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # what would come from the network

default_role = "py:obj"
toc_object_entries_show_parents = "hide"
autodoc_typehints = "none"  # docstrings have the types
autodoc_member_order = "groupwise"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

html_theme = "pydata_sphinx_theme"
html_title = "Spectral TV"
html_extra_path = ["extra"]
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 8,
    "navigation_with_keys": True,
    "show_prev_next": True,
    "footer_start": ["copyright"],
    "footer_end": [],
    "back_to_top_button": True,
}
copyright = "Spectral TV maintainers; GPL-3.0-or-later"


def setup(app: Any) -> None:
    """Have docstrings read as they are: a bar is no sign of reStructuredText there."""

    def escape(
        _app: Any, _what: str, _name: str, _obj: Any, _options: Any, lines: list[str]
    ) -> None:
        lines[:] = [line.replace("|", r"\|") for line in lines]

    app.connect("autodoc-process-docstring", escape)
