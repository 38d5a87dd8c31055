"""How Sphinx builds the site: `make docs`."""

import tomllib
from pathlib import Path

import extrados.decks.explain
import extrados.decks.manual
import extrados.results.explain
import extrados.results.manual

ROOT = Path(__file__).resolve().parents[1]
#: The references that decks.md and results.md include, made from the tables and models
MADE = ROOT / "docs" / "_made"
MADE.mkdir(exist_ok=True)
decks = extrados.decks.manual.manual(extrados.decks.explain.facts())
results = extrados.results.manual.manual(extrados.results.explain.everything())
(MADE / "decks.md").write_text(decks, encoding="utf-8")
(MADE / "results.md").write_text(results, encoding="utf-8")

project = "extrados"
author = copyright = "the authors of extrados"
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton"]
exclude_patterns = ["_made"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 4
autodoc_typehints = "none"
default_role = "code"  # what a docstring has in single backquotes
html_theme = "furo"
html_title = f"extrados {version}"
html_show_sourcelink = False
