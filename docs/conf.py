"""How the documentation is built: ``make docs``. Its tutorials are run, and its numbers read from
figures/, whenever it is.
"""

import os
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))
# the command line of this environment and nobody's terminal, for the tutorials
os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
os.environ |= {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "PYTHONWARNINGS": "ignore"}
os.environ |= {"COLUMNS": "90", "TTY_COMPATIBLE": "0"}
os.environ["FINGERPAD"] = str(HERE.parent)

from published import fill_pages  # noqa: E402 (beside this file)

fill_pages()

project, author, language = "fingerpad", "The fingerpad developers", "en"
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_design",
]
extensions += ["docstrings", "mathml", "streams", "written"]  # of docs/_ext
exclude_patterns = ["_build", "_ext", "requirements.*"]
templates_path, html_static_path, html_css_files = [], ["_static"], ["pages.css"]
html_theme, html_title = "furo", "fingerpad"
html_theme_options = {"sidebar_hide_name": False, "navigation_with_keys": True}
html_extra_path = ["../figures/studies/explorer.html"]
html_copy_source = html_show_sphinx = html_show_copyright = False
math_numfig = False

nitpicky = True
# types of signatures have no entry of their own; what pages refer to, tests/test_docs.py looks for
nitpick_ignore_regex = [("py:.*", r".*")]

myst_enable_extensions = ["colon_fence", "dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 3

nb_execution_mode = "force"
nb_execution_in_temp = nb_execution_raise_on_error = nb_merge_streams = True
nb_execution_timeout, nb_ipywidgets_js = 300, {}
nb_render_image_options = {"alt": "what the lines above draw"}

autodoc_member_order, autodoc_typehints = "bysource", "signature"
autodoc_default_options = {"members": True, "undoc-members": False, "show-inheritance": False}
napoleon_use_rtype, napoleon_use_ivar = False, True
python_maximum_signature_line_length = 90
suppress_warnings = ["config.cache"]
