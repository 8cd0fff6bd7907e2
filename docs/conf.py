"""The documentation site: the pages of this folder, the examples as a gallery, and the library's face."""

import tempfile
import tomllib
import warnings
from pathlib import Path

import contact_study
from contact_study.explore.static_page import write_static_page

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


def write_explored(app, exception):
    """Write the page that docs/howto_explore.md shows: the paper's quick study, loaded and unloaded."""
    if exception is not None or app.builder.format != "html":
        return
    study = tomllib.loads(Path(app.srcdir, "../data/yang2008_quick.toml").read_text(encoding="utf-8"))
    study["loading"]["unload"] = True
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the grid of the quick study is coarse
        contact_study.run(study, output=Path(folder, "bem.nc"))
        write_static_page([Path(folder, "bem.nc")], Path(app.outdir, "yang2008_explored.html"))


def setup(app):
    """Connect what the build writes beside the pages."""
    app.connect("build-finished", write_explored)
