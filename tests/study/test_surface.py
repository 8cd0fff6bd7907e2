"""Surfaces: one height function for all models, whatever the grid."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.study.test_study import changed


def case(**keys):
    return make_study(changed("surface", **keys)).cases[0]


def test_more_points_refine_the_same_surface():
    size = ["1040 angstrom", "520 angstrom"]
    surface = realise(case(size=size, cutoff_mode=5))
    coarse = surface.heights((64, 62))
    # Shared points agree to rounding of heights of order rms_height = 1e-9.
    np.testing.assert_allclose(surface.heights((128, 186))[::2, ::3], coarse, atol=1e-22)
    assert surface.heights((33, 35)).std() == pytest.approx(coarse.std(), abs=0, rel=1e-12)
    assert coarse.mean() == pytest.approx(0, abs=1e-22)
    # Whatever the shape, but not the seed.
    same, other = (realise(case(size=size, cutoff_mode=5, shape=[81, 100], seed=seed)) for seed in (1, 2))
    np.testing.assert_array_equal(same.heights((64, 62)), coarse)
    assert not np.allclose(other.heights((64, 62)), coarse, atol=1e-11)


def test_larger_cutoff_keeps_the_long_waves():
    """Amplitudes are drawn in order of |q|; normalisation to the spectrum scales all by one common factor."""
    heights = [realise(case(cutoff_mode=mode)).heights((64, 64)) for mode in (8, 16)]
    short, long = (np.abs(np.fft.rfft2(one))[:6, :6].ravel()[1:] for one in heights)
    np.testing.assert_allclose(long / short, long[0] / short[0], rtol=1e-9)


def test_ensemble_has_the_spectrum_asked_for():
    """Mean square height and slope over seeds against expectation, within four standard errors."""
    assert realise(case(normalisation="realised")).rms_height == pytest.approx(10e-10, abs=0, rel=1e-12)
    surfaces = [realise(case(seed=seed)) for seed in range(200)]
    squares = np.array([surface.rms_height**2 for surface in surfaces])
    error = squares.std(ddof=1) / np.sqrt(len(squares))
    assert abs(squares.mean() - 1e-18) < 4 * error
    slopes = np.array([surface.rms_slope**2 for surface in surfaces])
    error = slopes.std(ddof=1) / np.sqrt(len(slopes))
    # The discrete modes up to the cutoff are not the integral: a few per cent at 12 modes.
    assert abs(slopes.mean() - surfaces[0].spectrum.rms_slope ** 2) < 4 * error + 0.05 * slopes.mean()


def test_wave_and_sphere_and_plane():
    wave = realise(case(kind="wavy", amplitude="1 nm", modes=[2, 0], shape=[64, 32]))
    y = np.arange(64) / 64
    np.testing.assert_allclose(wave.heights((64, 32)), 1e-9 * np.cos(4 * np.pi * y)[:, None] + np.zeros(32), atol=1e-22)
    sphere = realise(case(kind="sphere", radius="1 um", size="104 nm"))
    heights = sphere.heights((64, 64))
    assert np.unravel_index(heights.argmax(), heights.shape) == (32, 32)
    dx = 104e-9 / 64
    curvature = (heights[32, 33] + heights[32, 31] - 2 * heights[32, 32]) / dx**2
    assert curvature == pytest.approx(-1e6, rel=1e-9)  # differences of 1e-13 of heights of 1e-9
    # The mean of the paraboloid over a rectangle is zero; that of the points is (d_y² + d_x²)/12R below it, the error
    # of the trapezoidal rule.
    rectangle = realise(case(kind="sphere", radius="1 um", size=["104 nm", "52 nm"])).heights((64, 32))
    dy, dx = 104e-9 / 64, 52e-9 / 32
    assert rectangle.mean() == pytest.approx(-(dy**2 + dx**2) / (12 * 1e-6), abs=0, rel=1e-9)
    assert np.all(realise(case(kind="flat")).heights((5, 6)) == 0)


@pytest.fixture
def bumps():
    return realise(case(shape=[24, 20], cutoff_mode=4)).heights((24, 20))


def map_case(tmp_path, heights, dims, axes=None, **coordinates):
    """The case of a NetCDF map; ``axes`` are attributes that name the axes of the dimensions."""
    kinds = {name: {"units": "nm"} | ({"axis": axes[name]} if axes else {}) for name in coordinates}
    coordinates = {name: (name, np.asarray(values), kinds[name]) for name, values in coordinates.items()}
    xr.Dataset({"height": (dims, heights, {"units": "m"})}, coordinates).to_netcdf(tmp_path / "map.nc")
    table = changed("surface", kind="file", path="map.nc")
    del table["surface"]["shape"]
    if coordinates:
        del table["surface"]["size"]
    table["interaction"] = {"law": "hard_wall"}
    return make_study(table, tmp_path).cases[0]


Y, X = np.arange(24.0), 0.5 * np.arange(20.0)


@pytest.mark.parametrize(
    ("turn", "dims", "given"),
    [
        (lambda h: h[::-1, ::-1], ("y", "x"), {"y": Y[::-1], "x": X[::-1]}),
        (lambda h: h[:, ::-1].T, ("x", "y"), {"y": Y, "x": X[::-1]}),
        (lambda h: h.T, ("u", "v"), {"u": X, "v": Y, "axes": {"u": "X", "v": "Y"}}),
        # Three decimals, and single precision.
        (lambda h: h, ("y", "x"), {"y": Y, "x": np.round(X / 3, 3).astype(np.float32)}),
        (lambda h: h.T, ("x", "y"), {}),
    ],
    ids=["both", "turned", "axes", "rounded", "bare"],
)
def test_dimensions_and_directions_of_coordinates(tmp_path, bumps, turn, dims, given):
    surface = realise(map_case(tmp_path, turn(bumps), dims, **given))
    assert surface.shape == (24, 20)
    if given:
        x = 10e-9 / 3 if dims == ("y", "x") and given["x"].dtype == np.float32 else 10e-9
        np.testing.assert_allclose(surface.size, (24e-9, x), rtol=1e-3 if x < 10e-9 else 1e-12)
    np.testing.assert_allclose(surface.heights((24, 20)), bumps - bumps.mean(), atol=1e-22)


@pytest.mark.parametrize("x", [[*range(19), 19.5], np.zeros(20), [*range(19), np.nan]])
def test_uneven_coordinates_are_refused(tmp_path, bumps, x):
    with pytest.raises(InputError, match=r"coordinate x .* not evenly spaced"):
        realise(map_case(tmp_path, bumps, ("y", "x"), y=np.arange(24.0), x=x))


@pytest.mark.parametrize(
    ("content", "culprit"),
    [
        (None, "does not exist"),
        (400, "cannot be read"),  # of a truncated NetCDF file
        (np.full((8, 8), np.nan), "no finite numbers: all of its heights are missing"),
        (np.zeros(8), r"line scan \(8 points\)"),
        (np.zeros((3, 8)), "expected at least 4 x 4"),
        (np.ones((8, 8)) * 1j, "holds complex numbers; expected heights"),
    ],
)
def test_unusable_height_maps(tmp_path, bumps, content, culprit):
    path = tmp_path / ("map.nc" if isinstance(content, int) else "map.npy")
    if isinstance(content, int):
        xr.Dataset({"height": (("y", "x"), bumps)}).to_netcdf(path)
        path.write_bytes(path.read_bytes()[:content])
    elif content is not None:
        np.save(path, content)
    chosen = dataclasses.replace(case(kind="file", path=path.name), directory=tmp_path)
    with pytest.raises(InputError, match=culprit) as failure:
        realise(chosen)
    assert path.name in str(failure.value)
    assert "\n" not in str(failure.value)
