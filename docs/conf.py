"""Settings of the documentation site: `make docs` runs Sphinx, and a warning ends it."""

import sys
from pathlib import Path

import rigidfluid

sys.path.insert(0, str(Path(__file__).parent))

project = "rigidfluid"
release = version = rigidfluid.__version__
html_title = f"rigidfluid {release}"
copyright = "the rigidfluid authors, MIT licence"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "site_tools.api",
    "site_tools.outside",
    "site_tools.docstrings",
]
exclude_patterns = ["site_tools", "page_tools", "pages"]

html_theme = "furo"
html_static_path = ["site_tools/static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 6  # those of GitHub, which links of the pages name
copybutton_exclude = ".linenos, .gp"

default_role = "py:obj"  # a name in single backticks is code, and a link where the site has it
python_use_unqualified_type_names = True
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_type_aliases = {"FloatArray": "FloatArray", "IntArray": "IntArray", "BoolArray": "BoolArray"}
autodoc_default_options = {"members": True, "inherited-members": False}
napoleon_google_docstring = False
napoleon_use_rtype = False
