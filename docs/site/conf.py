"""The documentation site: the README and the pages of docs/, and the reference of the Python API.

`make docs` builds it. The source folder is the whole checkout, so that every link of these pages
works in the site as it does in the checkout.
"""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]
os.environ["JAX_ENABLE_X64"] = "1"

import tomllib

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

project = PROJECT["name"]
author = PROJECT["authors"][0]["name"]
release = version = PROJECT["version"]

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.viewcode", "site_pages"]
root_doc = "README"
include_patterns = ["*.md", "docs/**"]
# Folders without pages: they are not searched.
exclude_patterns = [".*", "build", "tests", "docs/site/*.py"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}

myst_heading_anchors = 4
# A single backtick means code in the docstrings, as it does in Markdown.
default_role = "literal"

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True}
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
toc_object_entries = False

html_theme = "furo"
html_title = f"shadefit {release}"
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
