"""Every example runs as its first lines say, and ends in a figure."""

import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))
# Sizes at which an example takes seconds.
SMALLER = {
    "jkr_sphere": ["--points", "64"],
    "hysteresis_loop": ["--points", "64", "--steps", "8"],
    "ensemble": ["--samples", "2"],
    "atoms_beside_continuum": ["--atoms", "32"],
}


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example_draws_its_figure(example, tmp_path):
    assert f"python examples/{example.name} -o {example.stem}.png" in example.read_text()
    figure = tmp_path / f"{example.stem}.png"
    command = [sys.executable, "-W", "error", str(example), "-o", str(figure), *SMALLER.get(example.stem, [])]
    subprocess.run(command, check=True, cwd=tmp_path, env={"MPLBACKEND": "Agg", "PATH": ""})
    pixels = matplotlib.image.imread(figure)[..., :3]
    assert min(pixels.shape[:2]) > 400
    # Something is drawn, in more than black and white.
    assert len(np.unique(np.round(pixels.reshape(-1, 3), 1), axis=0)) > 5
    assert 0.5 < np.mean(pixels) < 0.99
