"""What the scripts about moving atoms make of their runs."""

import numpy as np
import pytest
import xarray as xr

from research import driven_loops, temperature


def test_loop_of_a_motion_that_sticks_on_its_way_up(tmp_path):
    """No stress on the way down; on the way up 2 GPa of tension up to 5 Å: 2 GPa times the way is left behind."""
    end, frames = 1e-10 * np.array([8.0, 6.0, 4.0, 2.0, 4.0, 6.0, 8.0]), driven_loops.FRAMES
    start = np.concatenate([[end[0] + 1e-10], end[:-1]])
    distance = start[:, None] + (end - start)[:, None] * (np.arange(frames) + 1) / frames
    stress = np.where((distance > start[:, None] + 1e-15) & (distance < 5.05e-10), -2e9, 0.0)
    steps = {"iterations": ("step", np.full(end.size, 10))}
    root = xr.Dataset(steps, {"well_depth_ratio": [4.0], "applied_gap": ("step", end)})
    series = xr.Dataset({"mean_pressure": (("well_depth_ratio", "step", "frame"), stress[None])})
    (loop,) = driven_loops.loops_of(root, series)
    assert (loop.ratio, loop.steps, loop.pull_off) == (4, 70, 2e9)
    assert loop.down.sum() == 1 + 3 * frames
    assert loop.contact(down=False) == pytest.approx(4.8e-10)  # frames stand 0.4 Å apart
    assert np.isnan(loop.contact(down=True))
    # From 2 to 4.8 Å, and trapezoids reach half a frame further at both ends.
    assert loop.dissipated == pytest.approx(2e9 * 2.8e-10, rel=0.15)
    driven_loops.write({"0 K": [loop]}, tmp_path / "loops.csv")
    assert driven_loops.main(["--from", str(tmp_path / "loops.csv"), "-o", str(tmp_path / "loops.png")]) == 0
    np.testing.assert_allclose(driven_loops.read(tmp_path / "loops.csv")["0 K"][0].stress, loop.stress, rtol=1e-5)


def test_largest_lateral_move_is_against_the_mean():
    x, y = np.zeros((2, 4, 4)), np.full((2, 4, 4), 7.0)
    x[0, 1, 2], y[0, 1, 2] = 3.2, 7.0
    fields = {f"lateral_displacement_{name}": (("case", "y", "x"), field) for name, field in (("x", x), ("y", y))}
    np.testing.assert_allclose(temperature.largest_move(xr.Dataset(fields)), [3.0, 0.0])
