"""How Sphinx builds the site; ``docs.site.stage`` makes what it reads."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1]))

project = "fixedpipe"
copyright = "the fixedpipe authors, MIT licence"
root_doc = "index"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "docs.site.sphinx_extension"]
exclude_patterns = ["doctrees"]
# Notebooks show what they have saved: tests/project/test_notebooks.py runs them.
nb_execution_mode = "off"
myst_enable_extensions = ["colon_fence", "html_image"]
myst_heading_anchors = 6
# "code:" is a file of the repository: docs.site.sphinx_extension leads to its page.
myst_url_schemes = ("http", "https", "mailto", "code")
smartquotes = False
highlight_language = "text"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
python_use_unqualified_type_names = True
napoleon_google_docstring = False
# Types are in the signatures, most of them of numpy or of modules without a page here.
nitpick_ignore_regex = [("py:.*", ".*")]
html_theme = "furo"
html_title = "fixedpipe"
html_static_path = [str(HERE / "static")]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
# A summary is fetched, and a page that was opened from a file may not fetch.
html_show_search_summary = False
html_use_index = True
