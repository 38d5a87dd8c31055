"""How Sphinx builds the site: `make docs`."""

import os
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

import decision  # noqa: E402
import uncertainty_pictures  # noqa: E402

import extrados.decks.explain  # noqa: E402
import extrados.decks.glossary  # noqa: E402
import extrados.decks.manual  # noqa: E402
import extrados.results.explain  # noqa: E402
import extrados.results.manual  # noqa: E402

#: The references that decks.md and results.md include, made from the tables and models
MADE = ROOT / "docs" / "_made"
MADE.mkdir(exist_ok=True)
decks = extrados.decks.manual.manual(extrados.decks.explain.facts())
results = extrados.results.manual.manual(extrados.results.explain.everything())
(MADE / "decks.md").write_text(decks, encoding="utf-8")
(MADE / "results.md").write_text(results, encoding="utf-8")
(MADE / "glossary.md").write_text(extrados.decks.glossary.table(), encoding="utf-8")
decision.write(MADE)
uncertainty_pictures.write(MADE)

project = "extrados"
author = copyright = "the authors of extrados"
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx_copybutton", "drawings"]
exclude_patterns = ["_made", "paper"]
source_suffix = {".md": "myst-nb"}
myst_heading_anchors = 4
autodoc_typehints = "none"
default_role = "code"  # what a docstring has in single backquotes
html_theme = "furo"
html_title = f"extrados {version}"
html_show_sourcelink = False
html_static_path = ["_static"]
html_css_files = ["gallery.css"]
# Notebooks run anew at each build; an error in one is an error of the build
nb_execution_mode = "off" if os.environ.get("EXTRADOS_QUICK_DOCS") else "force"
suppress_warnings = ["myst-nb.lexer"] if os.environ.get("EXTRADOS_QUICK_DOCS") else []  # cells have a lexer once they have run
nb_execution_raise_on_error = True
nb_execution_timeout = 1800
nb_execution_in_temp = True
nb_merge_streams = True
