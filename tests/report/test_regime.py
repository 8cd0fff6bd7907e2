"""Regime numbers: of a wave in closed form, and of the paper's system."""

import numpy as np
import pytest

from contact_study.physics.solids import HalfSpace, Layer
from contact_study.report.align.regime import compute_regime, roughness
from contact_study.study.case import realise
from tests.report.synthetic import SEEDED, SINGLE, STUDY, read, study

PAPER = (
    STUDY.replace('"416 angstrom"', '"1040 angstrom"')
    .replace('"7 angstrom"', '"10 angstrom"')
    .replace("[24, 24]", "[64, 64]")
    .replace("roll_off_mode = 2", "roll_off_mode = 3")
    .replace("cutoff_mode = 6", "cutoff_mode = 12")
    .replace("[1, 8]", "[1, 4, 8]")
)


def of_case(text, solid=None):
    case = study(text).cases[0]
    surface = realise(case)
    return roughness(surface.heights(surface.shape), surface.size, solid or case.solid)


def test_roughness_of_a_wave():
    height, size, shape = 2e-10, (3e-8, 2e-8), (9, 15)
    q = 2 * np.pi * 2 / size[1]
    wave = np.broadcast_to(height * np.cos(q * np.arange(shape[1]) * size[1] / shape[1]), shape)
    found = roughness(wave, size, HalfSpace(7.0))
    # A cosine that the grid holds exactly: rounding only.
    assert found.rms_height == pytest.approx(height / np.sqrt(2), rel=1e-13)
    assert found.rms_slope == pytest.approx(height * q / np.sqrt(2), rel=1e-13)
    assert found.rms_laplacian == pytest.approx(height * q**2 / np.sqrt(2), rel=1e-13)
    layer = Layer(7.0, 0.3, 1e-9)
    for own, stiffness in ((found, q / 2), (roughness(wave, size, layer), float(layer.stiffness(q)) / 7.0)):
        # ½ <w K w>/E* and √<(K w)²>/E*, with <w²> = h²/2; K = E* q / 2 of a half-space.
        assert own.conformal_energy == pytest.approx(stiffness * height**2 / 4, rel=1e-13)
        assert own.conformal_stress == pytest.approx(stiffness * height / np.sqrt(2), rel=1e-13)
    angle = np.linspace(0, 2 * np.pi, 16384, endpoint=False)
    exact = np.mean(np.sqrt(1 + (height * q * np.sin(angle)) ** 2))
    # The mean over fifteen points of a smooth periodic function is exact far beyond this.
    assert found.area_factor == pytest.approx(exact, rel=1e-8)


def test_paper_system(tmp_path):
    regime = compute_regime(read(tmp_path, PAPER))
    # Of the ensemble 0.30, 0.76, 1.21; one surface's curvature scatters by some per cent, the cube root by a third.
    np.testing.assert_allclose(regime["tabor_parameter"], [0.30, 0.76, 1.21], rtol=0.03)
    np.testing.assert_allclose(regime["process_zone"], [41e-10, 10.3e-10, 5.13e-10], rtol=0.01)
    np.testing.assert_allclose(regime["pixel_over_process_zone"] * regime["process_zone"], 1040e-10 / 64, rtol=1e-12)
    # Ensemble: U_full = 5.353 J/m², S = 1.0334.
    theta = 0.692 * np.array([1, 4, 8]) * 1.0334 / 5.353
    np.testing.assert_allclose(regime["adhesion_over_elastic_energy"], theta, rtol=0.06)
    for name, variable in regime.data_vars.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name


def test_without_sweep_and_without_roughness(tmp_path):
    own = ("rms_height", "roll_off_mode", "cutoff_mode", "normalisation")
    flat = "\n".join(line for line in SINGLE.replace("self_affine", "flat").splitlines() if not line.startswith(own))
    regime = compute_regime(read(tmp_path, flat))
    assert regime["process_zone"].dims == ()
    assert np.isfinite(regime["process_zone"])
    assert np.isnan(regime["tabor_parameter"])


def test_the_surface_is_said_to_be_of_the_first_seed(tmp_path):
    text = SEEDED.replace("[1, 2, 3]", "[3, 2]")
    regime = compute_regime(read(tmp_path, text))
    assert float(regime["rms_slope"][0]) == pytest.approx(of_case(text).rms_slope, rel=1e-12)
    assert regime["rms_slope"].attrs["long_name"].endswith("first seed")
    assert not regime["process_zone"].attrs["long_name"].endswith("first seed")


def test_full_contact_with_a_layer_is_that_of_its_stiffness(tmp_path):
    thin = STUDY + '[elasticity]\nkind = "layer"\nthickness = "10.4 angstrom"\n'
    plain, layered = (compute_regime(read(tmp_path, text)) for text in (STUDY, thin))
    surfaces = of_case(thin, HalfSpace(1.0)), of_case(thin)
    for name, own in (("energy", "conformal_energy"), ("stress_over_peak", "conformal_stress")):
        half_space, layer = (getattr(surface, own) for surface in surfaces)
        assert layer / half_space > 3
        ratio = layered[f"full_contact_{name}"] / plain[f"full_contact_{name}"]
        np.testing.assert_allclose(ratio, layer / half_space, rtol=1e-10)
    np.testing.assert_allclose(layered["process_zone"], plain["process_zone"], rtol=1e-12)
