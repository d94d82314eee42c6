"""Sphinx configuration for `make docs`. The reference of commands, Python and cells is generated from the code."""

import inspect
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from made_pages import write_pages  # noqa: E402

import brushsvg  # noqa: E402

write_pages(HERE / "reference")

project = "brushsvg"
author = "The brushsvg authors"
copyright = author
version = release = brushsvg.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"brushsvg {version}"
html_show_copyright = html_show_sphinx = False
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
nitpicky = False


def _plain(app, what, name, obj, options, lines):
    """Docstrings are written for `help()`: their lines stay as they are, and nothing in them is markup."""
    text = inspect.cleandoc("\n".join(lines)).splitlines()
    lines[:] = [f"| {line.replace('*', chr(92) + '*').replace('|', chr(92) + '|')}" if line else "" for line in text]


def setup(app):
    app.connect("autodoc-process-docstring", _plain)
