"""What the scripts about moving atoms make of their runs."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

from contact_study.command_line.verbs.init import example
from research import driven_loops, temperature


def series(end, stress, frames):
    """Root and trajectory of one case whose plane goes through ``end`` with a stress of its distance."""
    share = (np.arange(frames) + 1) / frames
    start = np.concatenate([[end[0] + 1e-10], end[:-1]])
    distance = start[:, None] + (end - start)[:, None] * share
    root = xr.Dataset(
        {"iterations": ("step", np.full(end.size, 10))}, {"well_depth_ratio": [4.0], "applied_gap": ("step", end)}
    )
    return root, xr.Dataset({"mean_pressure": (("well_depth_ratio", "step", "frame"), stress(distance, start)[None])})


def test_loop_of_a_motion_that_sticks_on_its_way_up():
    """No stress on the way down; on the way up 2 GPa of tension up to 5 Å: 2 GPa times the way is left behind."""
    end = 1e-10 * np.array([8.0, 6.0, 4.0, 2.0, 4.0, 6.0, 8.0])

    def stress(distance, start):
        up = distance > start[:, None] + 1e-15
        return np.where(up & (distance < 5.05e-10), -2e9, 0.0)

    (loop,) = driven_loops.loops_of(*series(end, stress, driven_loops.FRAMES))
    assert (loop.ratio, loop.steps, loop.pull_off) == (4, 70, 2e9)
    assert loop.down.sum() == 1 + 3 * driven_loops.FRAMES
    assert loop.contact(down=False) == pytest.approx(4.8e-10)  # frames stand 0.4 Å apart
    assert np.isnan(loop.contact(down=True))
    # From 2 to 4.8 Å, and trapezoids reach half a frame further at both ends.
    assert loop.dissipated == pytest.approx(2e9 * 2.8e-10, rel=0.15)


def test_loops_are_read_as_they_were_written(tmp_path, capsys):
    """To the six digits of the file; a temperature without one of the ratios leaves its cell empty."""
    end = 1e-10 * np.array([8.0, 4.0, 2.0, 4.0, 8.0])
    (loop,) = driven_loops.loops_of(*series(end, lambda distance, _: 1e19 * (3e-10 - distance), 5))
    assert loop.dissipated == pytest.approx(0.0, abs=1e-2 * 1e19 * (4e-10) ** 2)  # elastic
    other, path = dataclasses.replace(loop, ratio=8.0, steps=77), tmp_path / "loops.csv"
    driven_loops.write({"0 K": [loop, other], "300 K": [other]}, path)
    found = driven_loops.read(path)
    assert {name: [one.ratio for one in of] for name, of in found.items()} == {"0 K": [4.0, 8.0], "300 K": [8.0]}
    for name in ("stress", "distance", "down"):
        np.testing.assert_allclose(getattr(found["0 K"][0], name), getattr(loop, name), rtol=1e-5)
    assert driven_loops.main(["--from", str(path), "-o", str(tmp_path / "loops.png")]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "| time steps | 300 K |  | 77 |"
    assert (tmp_path / "loops.png").exists()


def test_largest_lateral_move_is_against_the_mean():
    x, y = np.zeros((2, 4, 4)), np.full((2, 4, 4), 7.0)
    x[0, 1, 2], y[0, 1, 2] = 3.2, 7.0
    fields = {f"lateral_displacement_{name}": (("case", "y", "x"), field) for name, field in (("x", x), ("y", y))}
    np.testing.assert_allclose(temperature.largest_move(xr.Dataset(fields)), [3.0, 0.0])


def test_temperature_prints_datasets_that_are_there(tmp_path, capsys):
    toml, dims = example("first"), ("well_depth_ratio", "step")

    def write(name, area, gap, errors, text):
        values = {"relative_contact_area": area, "mean_gap": gap, **errors}
        coords = {"well_depth_ratio": [1.0], "applied_pressure": ("step", [1e9])}
        data = {name: (dims, [[value]]) for name, value in values.items()}
        xr.Dataset(data, coords, {"study_toml": text}).to_netcdf(tmp_path / name)
        return str(tmp_path / name)

    cold = write("cold.nc", 0.4, 1e-10, {}, toml)
    errors = {"relative_contact_area_standard_error": 0.0012, "mean_gap_standard_error": 0.0031e-10}
    warm = toml.replace("[loading]", '[atomistic]\nmethod = "sampling"\ntemperature = "250 K"\n[loading]')
    assert temperature.main(["--from", cold, write("warm.nc", 0.38, 1.05e-10, errors, warm)]) == 0
    printed = capsys.readouterr().out
    for row in ("A, 250 K | 0.3800 ± 0.0012 |", "change | -5.0 % |", "ū (Å), 250 K | 1.0500 ± 0.0031"):
        assert f"| 1 | {row}" in printed
