"""Surfaces drawn from a tabulated power spectrum, alone or below the long waves of a map."""

import numpy as np
import pytest
import xarray as xr
from scipy.special import erf

import contact_study
from contact_study import make_study, realise
from contact_study.inputs.errors import InputError
from tests.study.test_study import TABLE

Q = np.array([1e5, 3e6, 1e9])
C = 1e-26 * 3**-3.6 * np.array([1.0, 1.0, (1e9 / 3e6) ** -3.6])
STUDY = {**TABLE, "interaction": {"law": "hard_wall"}, "loading": {"path": ["1 MPa"]}}
CELL = {"size": "20 um, 10 um", "shape": [128, 96]}


def surface_of(folder, **keys):
    rows = [f"{q:.17g}, {c:.17g}\n" for q, c in zip(Q, C, strict=True)]
    (folder / "psd.csv").write_text("".join(["q (1/m), C (m^4)\n", *rows]))
    study = make_study({**STUDY, "surface": {"kind": "spectrum", "spectrum_path": "psd.csv", **keys}}, folder)
    return realise(study.cases[0]), study.cases[0].scales, study


def test_the_mean_power_of_surfaces_is_that_of_the_file_within_cell_and_grid(tmp_path):
    power = np.zeros((128, 49))
    seeds = 60
    for seed in range(seeds):
        surface, scales, _ = surface_of(tmp_path, seed=seed, **CELL)
        power += np.abs(np.fft.rfft2(surface.sampled) / surface.sampled.size) ** 2 / seeds
    q = surface.grid.wavenumber
    carried = 2 * np.pi / 10e-6 * 47  # 96 points on 10 um carry 47 waves, 128 on 20 um twice as long ones
    carried = min(carried, 2 * np.pi / 20e-6 * 63)
    inside = (q > 0) & (q <= carried * (1 + 1e-9))
    law = C[0] * np.maximum(q / 3e6, 1) ** -3.6 * (2 * np.pi) ** 2 / (20e-6 * 10e-6)
    # Some 2 500 amplitudes of 60 samples each: the mean ratio is known to 0.3 %, the scatter of one is 1/sqrt(60).
    ratio = power[inside] / law[inside]
    assert ratio.mean() == pytest.approx(1, abs=0.01)
    assert ratio.std() == pytest.approx(60**-0.5, rel=0.1)
    assert power[~inside].max() < 1e-20 * power.max()
    assert np.sum(scales.spectrum.variances) == pytest.approx(
        np.sum(surface.grid.multiplicity * inside * law), rel=1e-9
    )


def test_a_seed_keeps_its_long_waves_on_a_finer_grid(tmp_path):
    coarse, *_ = surface_of(tmp_path, seed=5, **CELL)
    fine, *_ = surface_of(tmp_path, seed=5, size="20 um, 10 um", shape=[256, 192])
    waves = [np.fft.rfft2(one.sampled)[:40, :20] / one.sampled.size for one in (coarse, fine)]
    np.testing.assert_allclose(waves[0], waves[1], atol=1e-12 * np.abs(waves[0]).max())


def test_long_waves_of_a_map_short_ones_of_the_spectrum(tmp_path):
    map_of, *_ = surface_of(tmp_path, seed=7, size="20 um", shape=[64, 64])
    np.save(tmp_path / "afm.npy", map_of.sampled)
    keys = {"size": "20 um", "shape": [256, 256], "path": "afm.npy", "lowpass": "1 um"}
    surface, scales, study = surface_of(tmp_path, seed=1, **keys)
    other, *_ = surface_of(tmp_path, seed=2, **keys)
    alone, *_ = surface_of(tmp_path, seed=1, size="20 um", shape=[256, 256])
    of_map, one, two, free = (
        np.fft.rfft2(x)[:32, :32] / x.size for x in (map_of.sampled, surface.sampled, other.sampled, alone.sampled)
    )
    mode = np.hypot(*np.meshgrid(np.arange(32), np.arange(32), indexing="ij"))
    long, small = (mode > 0) & (mode < 20.01), 1e-9 * np.abs(of_map).max()  # 20 waves of 1 um on 20 um
    np.testing.assert_allclose(one[long], of_map[long], atol=small)
    np.testing.assert_allclose(two[long], of_map[long], atol=small)
    np.testing.assert_allclose(one[mode > 20.01], free[mode > 20.01], atol=small)
    assert np.abs(one - two)[mode > 20.01].min() > 0
    assert scales.rms_slope == pytest.approx(surface.rms_slope, rel=1e-9)
    assert study.cases[0].height_maps == {"afm.npy": tmp_path / "afm.npy"}
    # Four points a wave are the default.
    default, *_ = surface_of(tmp_path, seed=1, **{**keys, "lowpass": f"{80 / 64} um"})
    same, *_ = surface_of(tmp_path, seed=1, **{name: keys[name] for name in ("size", "shape", "path")})
    # The map's short waves go by one transform more.
    np.testing.assert_allclose(default.sampled, same.sampled, atol=1e-12 * same.rms_height)


def test_runs_and_theories_take_it_and_a_changed_map_is_refused_on_resume(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    map_of, *_ = surface_of(tmp_path, seed=7, size="20 um", shape=[16, 16])
    keys = {"kind": "spectrum", "spectrum_path": "psd.csv", "size": "20 um", "shape": [24, 24]}
    theory = contact_study.run({**STUDY, "surface": keys, "theory": {"flows": "none"}}, "theory")
    _, scales, made = surface_of(tmp_path, size="20 um", shape=[24, 24])
    # Without adhesion A/A0 = erf(p / √2 σ), σ the stress deviation of full contact (Persson 2001); the steps in ln q of
    # the theory are worth 1e-4.
    deviation = scales.full_contact_stress(made.cases[0].solid)
    area = float(theory["relative_contact_area"].sel(theory="persson@analytic").squeeze())
    assert area == pytest.approx(erf(1e6 / (2**0.5 * deviation)), rel=3e-4)
    np.save("afm.npy", map_of.sampled)
    study = {**STUDY, "surface": {**keys, "path": "afm.npy"}}
    run = contact_study.run(study, output="bem.nc")
    assert "sha256:" in run.attrs["height_maps"]
    assert run.attrs["height_maps"].endswith("afm.npy")
    np.save("afm.npy", 1.1 * map_of.sampled)
    with pytest.raises(InputError, match=r"the map afm.npy has changed"):
        contact_study.run(study, output="bem.nc", resume=True)


def test_the_spectrum_of_several_measurements_moves_between_its_bounds(tmp_path):
    wide = np.array([1.5, np.nan, 6.0])  # of ln C no bounds in a gap
    bounds = {"power_spectrum_lower": ("wavevector", C / wide), "power_spectrum_upper": ("wavevector", C * wide)}
    measured = xr.Dataset({"power_spectrum": ("wavevector", C, {"units": "m4"}), **bounds})
    measured.assign_coords(wavevector=("wavevector", Q, {"units": "m-1"})).to_netcdf(tmp_path / "psd.nc")
    keys = {"kind": "spectrum", "spectrum_path": "psd.nc", **CELL}
    normal = {"draws": 64, "surface.spectrum_bound": {"distribution": "normal", "mean": 0, "error": 0.5}}
    study = make_study({**STUDY, "surface": keys, "uncertainty": normal}, tmp_path)
    between = np.log(3e6 / 1e5) / np.log(1e9 / 1e5)
    logarithm = np.log([1.5, 1.5 ** (1 - between) * 6**between, 6.0])
    shifts = np.array([np.log(case.surface.table.density / C) / logarithm for case in study.cases])
    np.testing.assert_allclose(shifts, shifts[:, :1] * np.ones(3), atol=1e-9)
    np.testing.assert_allclose(shifts[0], 0, atol=1e-12)
    # The deviation of 64 Sobol points: two standard errors of a mean are one bound away.
    assert shifts[1:, 0].std() == pytest.approx(0.5, rel=0.05)
    lower = make_study({**STUDY, "surface": {**keys, "spectrum_bound": -1}}, tmp_path)
    np.testing.assert_allclose(lower.cases[0].surface.table.density[[0, 2]], (C / wide)[[0, 2]], rtol=1e-12)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({**CELL, "spectrum_bound": 1}, r"surface\.spectrum_bound = 1: needs bounds of C\(q\) at each q"),
        ({"seed": 3}, r"missing key surface\.size: kind = \"spectrum\" needs it, or a map"),
        ({**CELL, "detrend": "tilt"}, r"surface\.detrend: belongs to a measured map, surface\.path"),
        (
            {**CELL, "shortest_wave": "0.1 um"},
            r"surface\.shortest_wave = 1e-07 m: .* carries waves down to 3\.175e-07 m",
        ),
        ({**CELL, "size": "1 nm"}, r"between which no wave fits surface\.size"),
        ({**CELL, "wavevectors": [1e6, 1e7]}, r"surface\.spectrum_path and surface\.wavevectors: give the file or"),
        ({"size": "20 um", "shape": [32, 32], "path": "afm.npy"}, r"use more than 64 points on 2e-05 m"),
        (
            {"size": "20 um", "shape": [99, 99], "path": "afm.npy", "shortest_wave": "1 um", "lowpass": "0.7 um"},
            r"surface\.spectrum_path: has no waves below the map's, 7e-07 m",
        ),
    ],
)
def test_keys_that_do_not_belong_together(tmp_path, keys, message):
    np.save(tmp_path / "afm.npy", np.random.default_rng(1).standard_normal((128, 128)) * 1e-8)
    with pytest.raises(InputError, match=message):
        surface_of(tmp_path, **keys)


def test_the_other_body_may_be_drawn_too(tmp_path):
    surface_of(tmp_path, **CELL)
    other = {"kind": "spectrum", "spectrum_path": "psd.csv", "seed": 2}
    study = make_study({**STUDY, "surface": {"kind": "flat", **CELL}, "counterface": other}, tmp_path)
    # Independent bodies of one spectrum: each has its expected rms height within the scatter of few long waves.
    assert realise(study.cases[0]).rms_height == pytest.approx(study.cases[0].scales.rms_height, rel=0.3)
