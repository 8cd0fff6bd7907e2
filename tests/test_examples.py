"""Every example runs as its first lines say, and ends in a figure."""

import re
import runpy
import sys
from pathlib import Path

import matplotlib
import matplotlib.image
import matplotlib.pyplot as plt
import numpy as np
import pytest

from contact_study.command_line.examples import example

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))
# Sizes at which an example takes seconds.
SMALLER = {
    "jkr_sphere": ["--points", "64"],
    "hysteresis_loop": ["--points", "64", "--steps", "8"],
    "ensemble": ["--samples", "2"],
    "atoms_beside_continuum": ["--atoms", "32"],
    "pictures": ["--points", "96"],
}


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example_draws_its_figure(example, tmp_path, monkeypatch):
    assert f"python examples/{example.name} -o {example.stem}.png" in example.read_text()
    figure = tmp_path / f"{example.stem}.png"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(example), "-o", str(figure), *SMALLER.get(example.stem, [])])
    with matplotlib.rc_context():
        runpy.run_path(str(example), run_name="__main__")
    plt.close("all")
    pixels = matplotlib.image.imread(figure)[..., :3]
    assert min(pixels.shape[:2]) > 400
    # Something is drawn, in more than black and white.
    assert len(np.unique(np.round(pixels.reshape(-1, 3), 1), axis=0)) > 5
    assert 0.5 < np.mean(pixels) < 0.99


def test_python_of_the_readme_runs(tmp_path, monkeypatch):
    readme = (EXAMPLES[0].parent.parent / "README.md").read_text()
    (block,) = re.findall(r"```python\n(.*?)```", readme, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    Path("study.toml").write_text(example("first").replace("[100, 100]", "[32, 32]").replace("[0.1, 1, 4]", "[1, 4]"))
    exec(block, names := {})
    plt.close("all")
    assert names["result"].relative_contact_area.sizes == {"well_depth_ratio": 2, "step": 6}
    assert Path("contact_area.png").is_file()
