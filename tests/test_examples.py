"""Every example runs as its first lines say, and ends in a figure."""

import runpy
from pathlib import Path

import matplotlib
import matplotlib.image
import matplotlib.pyplot as plt
import numpy as np
import pytest

# Coarser grids have attractions of longer range, which reach the rim.
pytestmark = [
    pytest.mark.validation,
    pytest.mark.filterwarnings("ignore:grid too coarse", "ignore:elasticity.boundary"),
]

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").rglob("*.py"))
# Sizes at which an example takes seconds.
SMALLER = {
    "many_measurements": ("points=1024", "points=256"),
    "jkr_sphere": ("points = 60e-9, 288", "points = 60e-9, 64"),
    "cantilever": ("[48, 48]", "[24, 24]"),
    "jkr_test": ("[80, 80]", "[48, 48]"),
    "hysteresis_loop": ("320, 25", "64, 8"),
    "ensemble": ("samples = 12", "samples = 2"),
    "atoms_beside_continuum": ("poisson, well, r0 = 64", "poisson, well, r0 = 32"),
    "leakage": ("[128, 128]", "[64, 64]"),
    "uncertain_inputs": ("draws = 32", "draws = 10"),
    "sheet": ('"1.5 eV", "100 eV", "1500 eV"', '"1.5 eV", "100 eV"'),
    "line_contact": ("points, extent = 512", "points, extent = 128"),
    "viscoelastic_pull_off": ("1e-5, 8", "1e-5, 2"),
    "rubber_probe": ("[54, 54]", "[27, 27]"),
    "pictures": ("[192, 192]", "[96, 96]"),
    "edge_gaps": ("1e-6, 2048, (1, 2, 3)", "1e-6, 256, (1, 2)"),
    "rough_probe": ("(0.0, 0.2, 0.4), 144", "(0.4,), 80"),
    "rough_loops": ("(0.6, 1.1, 1.6, 2.1, 2.6), 128", "(0.6, 1.1), 40"),
    "area_coefficient": ("1e-6, 1024, (1, 2, 3)", "1e-6, 256, (1, 2)"),
    "stickiness": ("128, (1, 2, 3, 4), 1e9", "64, (1, 2), 1e9"),
    "percolation": ("256, range(1, 33)", "128, range(1, 3)"),
    "texture_for_pull_off": ('"maxfun": 20', '"maxfun": 3'),
    "hysteresis_mesh": ("(48, 72, 108, 162)", "(24, 32)"),
}
LONGER = {"texture_for_pull_off": 70}  # lines


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.stem)
def test_example_draws_its_figure(example, tmp_path, monkeypatch):
    source = example.read_text()
    assert source.count("\n") <= (80 if example.parent.name == "published" else LONGER.get(example.stem, 40))
    whole, smaller = SMALLER.get(example.stem, ("", ""))
    assert whole in source
    monkeypatch.chdir(tmp_path)
    script = tmp_path / example.name
    script.write_text(source.replace(whole, smaller) if whole else source)
    with matplotlib.rc_context():
        runpy.run_path(str(script), run_name="__main__")
    plt.close("all")
    pixels = matplotlib.image.imread(f"{example.stem}.png")[..., :3]
    assert min(pixels.shape[:2]) > 400
    assert len(np.unique(np.round(pixels.reshape(-1, 3), 1), axis=0)) > 5  # more than black and white
    assert 0.5 < np.mean(pixels) < 0.99
