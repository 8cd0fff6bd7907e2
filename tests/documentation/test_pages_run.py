"""Blocks of pages that teach run as they are written, from an empty folder."""

import os
import re
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import bem_adhesion.study.model
import md_reference.study.model
from contact_study.study.examples import example
from tests.commands import main
from tests.documentation.test_pages import PAGES, SHELL, blocks

# Not the sphere and rubber, which are large.
TUTORIALS = {"quickstart", "tutorial_own_surface", "tutorial_ensemble", "tutorial_inference", "tutorial_theory"}
HOWTOS = {"howto_bodies", "howto_cluster", "howto_export", "howto_force_curves", "howto_heights", "howto_run"}
RUN = [page for page in PAGES if page.stem in {"README", *HOWTOS, *TUTORIALS}]
# What makes an environment; the tests are in one.
_ENVIRONMENT = re.compile(r"^(?:pip install|git clone|make) .*\n", re.MULTILINE)
_SMALL = ["--surface.size", "120 angstrom", "--surface.shape", "48, 48", "--loading.path", "0.2 GPa, 1 GPa"]


def prepare(page, folder):
    """What a page takes for granted."""
    if page.stem in ("tutorial_own_surface", "howto_heights", "README"):
        heights = gaussian_filter(np.random.default_rng(1).standard_normal((64, 64)), 3, mode="wrap")
        np.save(folder / "afm.npy", 10 * heights / heights.std())
    if page.stem in ("howto_cluster", "howto_export", "howto_heights", "howto_run"):
        (folder / "study.toml").write_text(example("first"))
    if page.stem == "howto_force_curves":
        small = ["--surface.shape", "48, 48", "-o", str(folder / "sphere.nc")]
        (folder / "sphere.toml").write_text(example("sphere"))
        assert main(bem_adhesion.study.model.MODEL, [str(folder / "sphere.toml"), *small]) == 0
        (folder / "jkr_test.csv").write_text("displacement (nm), force (nN), radius (nm)\n0, -1, 2\n1, 1, 3\n")
    if page.stem == "tutorial_inference":  # its curve
        example_of_curve = Path(__file__).parents[2] / "examples" / "infer_adhesion.py"
        in_shell(f"cd {folder} && python {example_of_curve}", folder, PYTHONPATH=str(Path(__file__).parents[2]))
    arguments = [str(folder / "study.toml"), "--workers", "1", *_SMALL]
    arguments += ["--interaction.well_depth_ratio", "1,8", "--surface.seed", "1,2"]
    if page.stem == "howto_export":
        assert main(bem_adhesion.study.model.MODEL, [*arguments, "-o", str(folder / "bem.nc")]) == 0
        atoms = ["--output.atoms", "surface", "-o", str(folder / "md.nc")]
        assert main(md_reference.study.model.MODEL, [*arguments, *atoms]) == 0


def in_shell(text, folder, **variables):
    """Run lines as Bash does; what they leave in the background ends with them."""
    script = "set -e\ntrap 'kill $(jobs -p) 2> /dev/null || true' EXIT\n" + _ENVIRONMENT.sub("", text)
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "MPLBACKEND": "Agg", **variables}
    done = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, f"{text}\n{done.stderr}"


@pytest.mark.validation
@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
@pytest.mark.filterwarnings("default")  # of coarse grids: the pages are about other things
def test_a_page_runs_as_it_is_written(page, tmp_path, monkeypatch):
    prepare(page, tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plt, "show", lambda: None)
    names = {}
    for block in blocks(page):
        text = block.text.replace("--nworkers 8", "--nworkers 2")  # fewer workers than a cluster has
        if block.reason:
            continue
        if block.language == "python":
            exec(text, names)
        elif "SLURM_ARRAY_TASK_ID" in text:
            for task in ("1", "2"):
                in_shell(text, tmp_path, SLURM_ARRAY_TASK_ID=task)
        elif block.language in SHELL:
            in_shell(text, tmp_path)
    plt.close("all")
    assert any(tmp_path.iterdir())


def test_what_no_test_runs_says_why():
    assert {(page.stem, block.reason) for page in PAGES for block in blocks(page) if block.reason} == {
        ("howto_cluster", "it needs Slurm")
    }
