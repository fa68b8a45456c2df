"""Sphinx over the pages as they stand in the repository: `make docs` builds, warnings are errors.

The source folder is the repository, so that links between docs/, README and generated/ hold here as on a Git host.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from wmrgen import __version__  # noqa: E402

project = "wmrgen"
author = "the wmrgen authors"
version = release = __version__
language = "en"

root_doc = "docs/index"
include_patterns = ["docs/**", "*.md", "tests/README.md", "generated/errata.md", "generated/*/*.md"]
exclude_patterns = [".*", "build", "dist", "docs/conf.py"]
html_theme = "furo"
html_title = "wmrgen"
html_show_sphinx = False
html_copy_source = False

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4
nitpicky = True
