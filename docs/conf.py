"""The documentation site: the pages of this folder, the examples as a gallery, and the library's face."""

import warnings

import contact_study

project = "bem-adhesion"
author = "The bem-adhesion developers"
project_copyright = f"2026, {author}"
release = contact_study.__version__

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
    "sphinx-mathjax-offline",  # the site needs no network
]
root_doc = "index"
exclude_patterns = ["_build", "gallery/**.ipynb", "gallery/**.py", "gallery/**.md5", "sg_execution_times.rst"]
html_theme = "furo"
html_title = "bem-adhesion"
templates_path = ["templates"]

myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]

numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "write_computation_times": False,
    "show_signature": False,
    "min_reported_time": 1e9,
    # An example that fails must fail the build.
    "abort_on_example_error": True,
    "run_stale_examples": True,
    "remove_config_comments": True,
}

# Examples draw with pyplot, of which the gallery takes the figures; on a machine without a display nothing is shown.
warnings.filterwarnings("ignore", message="FigureCanvasAgg is non-interactive")
