"""Sphinx over the pages as they stand in the repository: `make docs` builds them, warnings are errors.

The source folder is the repository, so that links between docs/, README and generated/ hold here as on a Git host.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from sphinx.addnodes import pending_xref  # noqa: E402

from wmrgen import __version__ as release  # noqa: E402

project = "wmrgen"
version = release
language = "en"
root_doc = "docs/index"
include_patterns = [
    "docs/**",
    "*.md",
    "tests/*.md",
    "examples/README.md",
    "generated/*.md",
    "generated/*/*.md",
]
exclude_patterns = [".*", "build", "dist", "tests/*/**", "docs/conf.py"]

extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_enable_extensions = ["dollarmath", "html_image"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4
default_role = "code"  # single backticks in docstrings
autodoc_member_order = "bysource"
# Bases and defaults as they are written; annotations are text of the signature.
autodoc_preserve_defaults = True
nitpicky = True

# Types of annotations are those of other packages, or of ours that nobody needs to know.
nitpick_ignore_regex = [("py:class", r".*"), ("py:.*", r"(?!wmrgen).*")]

html_theme = "furo"
html_title = f"wmrgen {release}"
html_show_copyright = False
html_copy_source = False
# Formulas by the KaTeX that reports have too, in the place of MathJax, which Sphinx would fetch.
html_static_path = ["../templates/html/katex", "formulas.js", "site.css"]
html_css_files = ["katex.min.css", "site.css"]
mathjax_path = "katex.min.js"
html_js_files = [("formulas.js", {"defer": "defer", "priority": 900})]

# Pages that the sidebar does not list: the gallery links to the reports, other pages to the rest.
UNLISTED = re.compile(r"generated/.+/.+|tests/.+|docs/(benchmarks_laboratory|misra)|examples/README")


def unlisted(app: Any, document: Any) -> None:
    """Mark pages that no table of contents lists, so that Sphinx does not warn about them."""
    name = app.env.docname
    if UNLISTED.fullmatch(name):
        app.env.metadata[name]["orphan"] = True


def folders(app: Any, document: Any) -> None:
    """A link to a folder of the repository, which a Git host shows, is its name here."""
    for link in list(document.findall(pending_xref)):
        if link["reftype"] == "myst" and (Path(document["source"]).parent / link["reftarget"]).is_dir():
            link.replace_self(link.children)


def inline_math(app: Any, name: str, source: list[str]) -> None:
    """Git hosts write formulas in tables between dollars and backticks, MyST between dollars."""
    source[0] = re.sub(r"\$`([^`\n]+)`\$", r"$\1$", source[0])


def setup(app: Any) -> None:
    app.connect("source-read", inline_math)
    app.connect("doctree-read", folders)
    app.connect("doctree-read", unlisted)
