"""How Sphinx builds the site: `make docs`."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

project = "extrados"
author = copyright = "the authors of extrados"
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 4
autodoc_typehints = "none"
default_role = "code"  # what a docstring has in single backquotes
html_theme = "furo"
html_title = f"extrados {version}"
html_show_sourcelink = False
