"""Many measurements of one surface to one power spectrum: estimates, conversion, reliability, combination, command."""

import json
import zipfile

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import quad
from scipy.ndimage import grey_dilation
from scipy.special import gamma

import contact_study
from contact_study import measured_spectrum, plots
from contact_study.inputs.errors import InputError
from contact_study.physics.roughness.combination import combine_spectra, uncovered
from contact_study.physics.roughness.line_spectrum import isotropic_density
from contact_study.physics.roughness.measurement import (
    Bands,
    MeasuredSpectrum,
    Measurement,
    spectrum_of_measurement,
    tip_cutoff,
)
from contact_study.physics.roughness.spectrum import TabulatedSpectrum
from contact_study.physics.surfaces.drawn import drawn_surface, drawn_waves
from contact_study.start import bem_adhesion
from theory import read_spectrum

H = 0.8
LAW = TabulatedSpectrum([1e3, 1e11], [1e-17, 1e-17 * 1e8 ** (-2 - 2 * H)])


def piece(size, points, seed, cut=None):
    """A part of a random surface of the law, whose edges do not meet."""
    waves, variance = drawn_waves(LAW, (size, size), (points, points), None)
    return drawn_surface(waves, variance, (size, size), (points, points), seed).sampled[cut or ()]


@pytest.mark.parametrize("hurst", [0.2, 0.5, 0.8, 1.0])
def test_line_scans_of_power_laws_convert_exactly_and_the_rule_does_not(hurst):
    q = np.geomspace(1e5, 1e8, 31)
    law = 1e-30 * (q / 1e5) ** (-2 - 2 * hurst)
    ratio = np.sqrt(np.pi) * gamma(hurst + 0.5) / gamma(hurst + 1)  # of C_1D to q C, by the Abel integral
    np.testing.assert_allclose(isotropic_density(q, ratio * q * law, 0 * q), law, rtol=1e-6)
    # The power law is the smoothest curve, whatever the errors; bisection ends 1e-3 of the error away from it.
    np.testing.assert_allclose(isotropic_density(q, ratio * q * law, 0 * q + 0.01), law, rtol=1e-3)
    assert ratio / 2 == pytest.approx({0.2: 1.25, 0.5: 1.0, 0.8: 0.854, 1.0: 0.785}[hurst], abs=0.003)


def test_a_roll_off_converts_as_the_integral_says():
    q = np.geomspace(1e5, 1e8, 31)  # the roll-off is a wavevector of the curve

    def law(s):
        return np.maximum(s / 1e6, 1) ** (-2 - 2 * H)

    def along_a_line(q):
        kink = [np.arccosh(1e6 / q)] if q < 1e6 else None
        return 2 * quad(lambda t: law(q * np.cosh(t)) * q * np.cosh(t), 0, 16, limit=500, points=kink)[0]

    found = isotropic_density(q, np.array([along_a_line(one) for one in q]), 0 * q)
    np.testing.assert_allclose(found, law(q), rtol=2e-3)  # Gauss's rule in panels across the corners


def test_white_noise_keeps_its_level_with_and_without_a_window():
    rng = np.random.default_rng(1)
    noise = 1e-9 * rng.standard_normal((240, 320))
    found = spectrum_of_measurement(Measurement("map", noise, (2e-9, 1e-9), periodic=True))
    whole = Measurement("map", noise, (2e-9, 1e-9))
    level = 1e-18 * 2e-18 / (2 * np.pi) ** 2  # <h²> over the area of the plane of wavevectors
    for one, error in ((found, 0.05), (spectrum_of_measurement(whole), 0.1)):
        last = one.reliable.wavevector > 2e8  # some 4 000 waves, windowed 1 000: 1.6 and 3 %, three times
        weight = 1 / one.reliable.variance[last]
        assert np.average(np.log(one.reliable.density[last] / level), weights=weight) == pytest.approx(0, abs=error)


def test_lines_and_maps_of_one_surface_agree_within_their_bounds():
    inside, offsets = [], []
    for seed in range(12):
        parts = []
        for number, (size, line) in enumerate(
            [(1e-4, False), (1e-5, False), (2e-5, True), (4e-5, True), (1e-6, False)]
        ):
            heights = piece(size, 256, 10 * seed + number, np.s_[3, :128] if line else np.s_[:100, :128])
            parts.append(spectrum_of_measurement(Measurement("", heights, (size / 256,) * heights.ndim)))
        found = combine_spectra(parts)
        assert found.gaps == ()
        off = np.log(found.density / LAW.density_at(found.wavevectors))
        inside.append(np.abs(off) < 2 * found.error)
        lines, map_only = combine_spectra(parts[2:4]), combine_spectra(parts[:2])
        for one in (lines, map_only):
            same = (one.wavevectors > 2e6) & (one.wavevectors < 5e6)
            offsets.append(np.log(one.density[same] / LAW.density_at(one.wavevectors[same])).mean())
    # Bounds of two standard errors hold 95 %; those of few waves more.
    assert 0.92 < np.mean(np.concatenate(inside)) < 1
    by_lines, by_maps = np.array(offsets).reshape(-1, 2).T
    # Aliasing and leakage are worth some per cent; the scatter of 12 means is 7 % for lines.
    assert by_lines.mean() == pytest.approx(0, abs=0.2)
    assert by_maps.mean() == pytest.approx(0, abs=0.1)


def test_levelling_leaves_a_tilted_scan_alone_and_few_waves_out():
    heights = piece(1e-5, 256, 3, np.s_[5, :128])
    tilted = heights + 1e-6 * np.arange(128) / 128
    flat, tilt = (spectrum_of_measurement(Measurement("", one, (1e-5 / 256,))).reliable for one in (heights, tilted))
    # Differences turn a tilt into a constant, which the window takes to the first wave.
    np.testing.assert_allclose(tilt.density, flat.density, rtol=0.02)
    assert flat.wavevector[0] == pytest.approx(3 * 2 * np.pi / 5e-6, rel=0.01)  # of 127 differences
    assert flat.wavevector[-1] <= 2 * np.pi / (4 * 1e-5 / 256) * (1 + 1e-9)


def test_the_tip_hides_what_the_published_criterion_says():
    pytest.importorskip("SurfaceTopography")
    from SurfaceTopography import Topography

    step, radius = 1e-9, 10e-9
    heights = piece(256e-9, 256, 4)
    reach = np.arange(-11, 12) * step
    r2 = reach[:, None] ** 2 + reach**2
    ball = np.where(r2 < radius**2, np.sqrt(np.maximum(radius**2 - r2, 0)) - radius, -1.0)
    scanned = grey_dilation(heights, structure=ball)[8:248, 8:248]
    found = tip_cutoff(scanned, step, radius)
    library = Topography(scanned.T, (240e-9, 240e-9), unit="m").scanning_probe_reliability_cutoff(radius)
    assert 8e-9 < found < 120e-9
    assert 0 <= found - library <= 2.01 * step  # it interpolates to a root, this one is the stencil beyond
    assert tip_cutoff(scanned, step, 1e-11) == 0
    assert tip_cutoff(scanned, step, 1e-3) == pytest.approx(240e-9)
    one = spectrum_of_measurement(Measurement("", scanned, (step, step), tip_radius=radius))
    assert one.limit == "tip radius"
    assert one.reliable.wavevector.max() <= 2 * np.pi / found
    assert set(one.bands.reason[one.bands.wavevector > 2.1 * np.pi / found]) == {4}
    finer = spectrum_of_measurement(Measurement("", scanned, (step, step), radius, resolution=2 * found))
    assert finer.limit == "instrument resolution"


def part(q, density, variance):
    bands = Bands(np.array(q), np.array(density), np.array(variance), np.zeros(len(q), int))
    return MeasuredSpectrum(Measurement("", np.zeros(8), (1.0,)), bands, 0.0, "")


def test_measurements_are_weighted_by_waves_until_they_differ():
    q = 10 ** (np.arange(60, 70) / 10 + 0.05)
    law = q**-3.5
    agreeing = combine_spectra([part(q, law, 0 * q + 0.01), part(q * 1.1, (1.1 * q) ** -3.5, 0 * q + 0.04)])
    # On a power law waves at other places in a band change nothing.
    np.testing.assert_allclose(agreeing.density, agreeing.wavevectors**-3.5, rtol=1e-9)
    assert agreeing.spread == 0
    np.testing.assert_allclose(agreeing.error, (1 / 0.01 + 1 / 0.04) ** -0.5)
    # Two that differ by ln 2 everywhere: τ² is half of its square less the mean variance; weights become equal.
    differing = combine_spectra([part(q, law, 0 * q + 1e-6), part(q, 2 * law, 0 * q + 1e-4)])
    assert differing.spread**2 == pytest.approx(np.log(2) ** 2 / 2, rel=1e-3)
    np.testing.assert_allclose(differing.density, 2**0.5 * law, rtol=1e-3)
    np.testing.assert_allclose(differing.error, np.log(2) / 2, rtol=1e-3)
    # A band of one alone is as uncertain as measurements are elsewhere.
    longer = np.append(q, q[-1] * 10**0.1)
    alone = combine_spectra([part(q, law, 0 * q + 1e-6), part(longer, 2 * longer**-3.5, 0 * longer + 1e-6)])
    assert alone.error[-1] == pytest.approx(np.log(2) / 2**0.5, rel=0.01)
    assert uncovered([(1e8, 1e9), (1e6, 1e7), (2e6, 3e6)]) == ((1e7, 1e8),)


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = piece(1e-4, 512, 1, np.s_[9, :256])
    rows = [f"{1e6 * x:.9g}, {1e9 * h:.9g}\n" for x, h in zip(np.arange(256) * 1e-4 / 512, line, strict=True)]
    (tmp_path / "stylus.csv").write_text("".join(["x (um), h (nm)\n", *rows]))
    np.save(tmp_path / "afm.npy", 1e9 * piece(16e-6, 256, 2, np.s_[:128, :128]))
    (tmp_path / "list.toml").write_text(
        '[[measurement]]\npath = "stylus.csv"\nresolution = "2 um"\ninstrument = "stylus"\ndoi = "10.1/x"\n'
        '[[measurement]]\npath = "afm.npy"\nsize = "8 um"\nheight_unit = "nm"\ntip_radius = "1 nm"\n'
    )
    return tmp_path


def run(*words):
    return bem_adhesion(list(map(str, words)))


def test_from_files_to_a_theory_and_a_surface(files, capsys):
    assert run("spectrum", "list.toml", "-o", "psd.nc", "--figure", "psd.png") == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert "instrument resolution" in said.out
    assert (files / "psd.png").stat().st_size > 10_000
    with xr.open_dataset("psd.nc") as dataset:
        found = dataset.load()
    band = np.concatenate([part.vertices[:, 1] for part in plots.measured_spectra(found).collections[0].get_paths()])
    for bound in ("power_spectrum_lower", "power_spectrum_upper"):
        assert np.isin(found[bound].values, band).all(), bound
    assert found.kind.values.tolist() == ["line scan", "map"]
    assert found.doi.values.tolist() == ["10.1/x", ""]
    assert all(one.startswith("sha256:") and len(one) == 71 for one in found.source.values)
    np.testing.assert_allclose(found.shortest_wavelength, [2e-6, 4 * 16e-6 / 256], rtol=1e-6)
    np.testing.assert_allclose(found.power_spectrum_upper / found.power_spectrum, np.exp(2 * found.standard_error))
    off = np.log(found.power_spectrum / LAW.density_at(found.wavevector))
    assert np.mean(np.abs(off) < 2 * found.standard_error) > 0.85
    q, flag = found.measured_wavevector.values, found.measured_flag.values
    assert np.all((flag[0] == 3) == (q[0] > np.pi / 1e-6))
    # The reader takes the combined spectrum among the others; a study runs on it.
    np.testing.assert_allclose(read_spectrum("psd.nc").density, found.power_spectrum, rtol=1e-12)
    study = {
        "surface": {"kind": "spectrum", "spectrum_path": "psd.nc", "size": "10 um", "shape": [32, 32]},
        "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3},
        "interaction": {"law": "hard_wall"},
        "loading": {"path": ["1 MPa"]},
        "theory": {"flows": "none", "spectrum": "file", "spectrum_path": "psd.nc"},
    }
    area = contact_study.run(study, "theory").relative_contact_area
    assert 0 < float(area.squeeze()) < 1
    assert run("spectrum", "list.toml", "-o", "psd.nc") == 1
    assert "psd.nc exists; use --overwrite" in capsys.readouterr().err
    # The rule is 15 % lower for power laws of this H; noise leaves the ratio.
    rule = measured_spectrum(["list.toml"], "approximate").measured_spectrum[0]
    ratio = (rule / found.measured_spectrum[0])[flag[0] == 0]
    assert float(ratio.mean()) == pytest.approx(0.854, abs=0.1)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["afm.npy", "--size", "4 um"], "missing key measurement.height_unit: afm.npy does not say in which unit"),
        (["afm.npy", "--height_unit", "nm"], "missing key measurement.size: how wide is the map?"),
        (["bare.csv", "--height_unit", "nm"], "missing key measurement.lateral_unit: bare.csv does not say"),
        (["stylus.csv", "--height_unit", "um"], 'measurement.height_unit = "um": stylus.csv says nm'),
        (["mixed.xyz"], "mixed.xyz has x in nm and y in um; give both in one unit"),
        (["uneven.csv"], "the coordinate x of uneven.csv is not evenly spaced"),
        (["heights.csv", "--height_unit", "nm"], "missing key measurement.size: how long is the line scan of"),
        (["holes.csv"], 'measurement.fill = "harmonic" fills them'),
        (["short.csv"], "holds 4 points of a line scan; expected 16 or more"),
        (["stylus.csv", "--resolution", "1 mm"], "no two bands of wavevectors are reliable"),
        (["stylus.csv", "--tip_radius", "-1 nm"], "measurement.tip_radius = '-1 nm': must be positive"),
        (["bad.toml"], "bad.toml: expected tables [[measurement]]"),
        (["stylus.csv", "--figure", "psd.doc"], "--figure psd.doc: expected a name that ends in"),
    ],
)
def test_one_line_for_bad_input(files, capsys, words, message):
    rows = (files / "stylus.csv").read_text().splitlines()
    (files / "bare.csv").write_text("\n".join(rows[1:]))
    (files / "mixed.xyz").write_text("X[nm] Y[um] Z[nm]\n0 0 1\n0 1 1\n1 0 1\n1 1 2\n")
    (files / "uneven.csv").write_text("\n".join([*rows[:20], *rows[25:]]))
    (files / "heights.csv").write_text("\n".join(row.split(",")[1] for row in rows[1:]))
    (files / "holes.csv").write_text("\n".join([*rows[:20], "3.7109375, nan", *rows[21:]]))
    (files / "short.csv").write_text("\n".join(rows[:5]))
    (files / "bad.toml").write_text('[measurements]\npath = "afm.npy"\n')
    assert run("spectrum", *words, "-o", "psd.nc") == 1
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1
    assert not (files / "psd.nc").exists()


def test_a_gap_between_measurements_is_named_and_kept(files, capsys):
    np.save("fine.npy", 1e9 * piece(4e-8, 128, 5, np.s_[:64, :64]))
    (files / "far.toml").write_text(
        '[[measurement]]\npath = "stylus.csv"\n[[measurement]]\npath = "fine.npy"\nsize = "20 nm"\nheight_unit = "nm"\n'
    )
    assert run("spectrum", "far.toml", "-o", "psd.nc") == 0
    line = "no measurement is reliable at wavelengths between 6.563 nm and 790.6 nm"
    assert line in capsys.readouterr().err
    with xr.open_dataset("psd.nc") as found:
        assert line in found.attrs["warnings"]


def test_containers_of_contact_engineering(files, capsys):
    pytest.importorskip("SurfaceTopography")
    from SurfaceTopography import Topography, UniformLineScan
    from SurfaceTopography.Container.IO import write_containers
    from SurfaceTopography.Container.SurfaceContainer import InMemorySurfaceContainer

    scans = [
        Topography(1e9 * piece(4e-6, 128, 6, np.s_[:64, :64]).T, (2000.0, 2000.0), unit="nm"),
        UniformLineScan(1e6 * piece(4e-5, 256, 7, np.s_[1, :128]), 20.0, unit="um"),
        UniformLineScan(np.arange(20.0), 20.0),
    ]
    write_containers([InMemorySurfaceContainer(scans)], "twin.zip")
    assert run("spectrum", "twin.zip", "-o", "without.nc") == 0
    said = capsys.readouterr().err
    assert "twin.zip has no digital object identifier: its SHA-256 alone identifies it" in said
    assert "twin.zip/2 is left out: it has no unit" in said
    with zipfile.ZipFile("twin.zip") as packed, zipfile.ZipFile("published.zip", "w") as out:
        for name in packed.namelist():
            content = packed.read(name)
            if name == "index.json":
                about = json.loads(content)
                words = {
                    "url": "",
                    "license": "",
                    "authors": "",
                    "version": 1,
                    "date": "",
                    "doi_url": "https://doi.org/10.57703/ce-test",
                }
                about["surfaces"][0]["publication"] = words
                tip = {"tip_radius": {"value": 300, "unit": "nm"}}
                about["surfaces"][0]["topographies"][0]["instrument"] = {"name": "AFM", "parameters": tip}
                content = json.dumps(about).encode()
            if name != "meta.yml":
                out.writestr(name, content)
    assert run("spectrum", "published.zip", "-o", "with.nc") == 0
    assert "identifier" not in capsys.readouterr().err
    with xr.open_dataset("with.nc") as found, xr.open_dataset("without.nc") as before:
        assert set(found.doi.values) == {"https://doi.org/10.57703/ce-test"}
        assert found.instrument.values.tolist() == ["AFM", ""]
        assert found.limited_by.values.tolist() == ["tip radius", "fewer than 4 points a wave"]
        off = np.log(before.power_spectrum / LAW.density_at(before.wavevector))
        assert np.mean(np.abs(off) < 2 * before.standard_error) > 0.85
    (files / "other.zip").write_bytes(b"PK")
    with pytest.raises(InputError, match=r"measurement\.path: other\.zip is no container of contact\.engineering"):
        measured_spectrum(["other.zip"])


def test_a_bow_is_levelled_where_asked(files):
    rows = np.genfromtxt("stylus.csv", delimiter=",", skip_header=1)
    bow = 500 * np.ptp(rows[:, 1]) * (rows[:, 0] / rows[-1, 0] - 0.5) ** 2
    np.savetxt("bowed.csv", np.stack([rows[:, 0], rows[:, 1] + bow], 1), header="x (um), h (nm)")
    flat, tilt, curved = (
        measured_spectrum([name], detrend=degree).power_spectrum[:3].values
        for name, degree in (("stylus.csv", "curvature"), ("bowed.csv", "tilt"), ("bowed.csv", "curvature"))
    )
    np.testing.assert_allclose(curved, flat, rtol=1e-3)  # the numbers of the text have nine digits
    assert tilt[0] > 2 * flat[0]
