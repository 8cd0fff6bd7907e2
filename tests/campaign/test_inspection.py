import matplotlib.image
import numpy as np
import pytest
import xarray as xr

from contact_study.start import bem_adhesion
from tests.campaign.toy_study import run

MAP = """
[surface]
kind = "file"
path = "map.npy"
size = ["4 nm", "8 nm"]
height_unit = "pm"
detrend = "tilt"
fill = "harmonic"
[material]
youngs_modulus = "77.2 GPa"
poissons_ratio = 0.42
[interaction]
law = "hard_wall"
[loading]
path = ["0.1 GPa"]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    y, x = np.arange(32) / 32, np.arange(64) / 64
    heights = 50 * np.cos(6 * np.pi * y[:, None]) + 30 * np.cos(10 * np.pi * x[None, :]) + 0 * x
    heights[3, 5] = np.nan
    np.save(tmp_path / "map.npy", heights)
    (tmp_path / "study.toml").write_text(MAP)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def inspect(*arguments):
    return bem_adhesion(["inspect", *arguments])


KEYS = ("--surface.size", "4 nm, 8 nm", "--surface.height_unit", "pm", "--surface.fill", "harmonic")


def test_a_map_is_looked_at_and_nothing_run(folder, capsys):
    assert inspect("map.npy", *KEYS) == 0
    said = capsys.readouterr()
    assert said.err == ""
    lines = said.out.splitlines()
    # sqrt((50² + 30²) / 2) = 41.23 but for the one that is filled
    words = {0: ["pm, surface.height_unit"], 1: ["32 x 64 points", "0.0488 % filled"], 2: ["h_rms 41.2"]}
    words[-1] = ["map.inspect.png", "map.inspect.csv"]
    assert all(word in lines[number] for number, expected in words.items() for word in expected), lines
    assert {path.name for path in folder.iterdir()} == {"map.npy", "study.toml", *words[-1]}
    assert matplotlib.image.imread(folder / "map.inspect.png").shape[1] > 800
    table = np.genfromtxt(folder / "map.inspect.csv", delimiter=",", names=True)
    variance = np.sum(table["C_m4"] * table["waves"]) * (2 * np.pi) ** 2 / 32e-18
    assert np.sqrt(variance) == pytest.approx(41.23e-12, abs=0, rel=1e-3)


@pytest.mark.validation
def test_the_surface_of_a_study_is_looked_at(folder, study, capsys):
    assert inspect("study.toml", "-o", "looked.pdf") == 0
    said = capsys.readouterr().out
    assert "16 x 16 points" in said
    assert "first of 2 surfaces" in said
    assert (folder / "looked.pdf").read_bytes()[:4] == b"%PDF"
    (folder / "study.toml").write_text(MAP)
    assert inspect("study.toml", "--surface.edges", "mirror") == 0
    assert "64 x 128 points" in capsys.readouterr().out
    flat = '[surface]\nkind = "flat"\nsize = "8 nm"\nshape = [8, 8]\n[material]'
    (folder / "study.toml").write_text(flat + MAP.split("[material]")[1])
    assert inspect("study.toml") == 0
    assert "h_rms 0 pm" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (("nowhere.npy",), "nowhere.npy does not exist"),
        ((".",), "inspect: . is a folder"),
        (("map.npy",), "surface.size"),
        (("map.npy", *KEYS, "--loading.unload", "true"), "loading.unload"),
        (("map.npy", *KEYS, "-o", "map.npy"), "map.npy"),
        (("map.npy", *KEYS, "-o", "nowhere.xyz"), "xyz"),
        (("study.toml", "map.npy"), "map.npy"),
        ((), "FILE"),
    ],
)
def test_bad_input_is_one_line(folder, capsys, arguments, culprit):
    before = (folder / "map.npy").read_bytes()
    assert inspect(*arguments) == 1
    said = capsys.readouterr().err
    assert culprit in said
    assert said.count("\n") == 1
    assert (folder / "map.npy").read_bytes() == before


def test_a_run_says_and_keeps_what_it_took(folder, capsys):
    assert run("study.toml", "-o", "out.nc") == 0
    said = capsys.readouterr().err
    assert said.index("32 x 64 points") < said.index("[1/1]")
    dataset = xr.load_dataset(folder / "out.nc")
    found = [float(dataset[f"surface_{name}"]) for name in ("points_y", "points_x", "size_y", "size_x")]
    assert [*found, float(dataset.filled_fraction)] == pytest.approx([32, 64, 4e-9, 8e-9, 1 / 2048], abs=0, rel=1e-9)
    assert dataset.power_spectrum.dims == dataset.spectrum_wavevector.dims == ("spectrum_wavevector",)
    peaks = np.sort(dataset.spectrum_wavevector.values[np.argsort(dataset.power_spectrum.values)[-2:]])
    # Three waves on 4 nm and five on 8 nm, each in a band of an eighth of an octave (9 %).
    assert peaks == pytest.approx(2 * np.pi * np.array([5 / 8e-9, 3 / 4e-9]), abs=0, rel=0.1)
