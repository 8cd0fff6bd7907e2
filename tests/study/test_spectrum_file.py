import numpy as np
import pytest
import xarray as xr

from contact_study import run
from contact_study.inputs.errors import InputError
from contact_study.study.study import make_study
from tests.study.test_study import TABLE
from theory import TabulatedSpectrum, read_spectrum

Q, POWER = np.array([1.5e8, 4.5e8, 1.8e9]), np.array([2e-35, 2e-35, 1.4e-37])
HEADER = "q (1/nm), C (nm^4)\n"
ROWS = "0.15, 20\n0.45, 20\n1.8, 0.14\n"
STUDY = {**TABLE, "interaction": {"work_of_adhesion": "0.7 J/m^2", "length": "3.28 angstrom"}}


def study(folder, sweep=None, **theory):
    return make_study({**STUDY, "theory": theory, **({"sweep": sweep} if sweep else {})}, folder)


def assert_is_the_spectrum(found):
    np.testing.assert_allclose(found.wavevectors, Q, rtol=1e-12)
    np.testing.assert_allclose(found.density, POWER, rtol=1e-12)


def test_text_with_a_header_or_units_of_the_study(tmp_path):
    path = tmp_path / "psd.csv"
    for text, *units in (
        ("# made of three points\n# q [nm^-1]  C [nm^4]\n" + ROWS.replace(",", "\t"),),
        ("\ufeffq (nm-1);C (nm4);waves (1)\n0.15;20;8\n0.45;20;16\n1.8;0.14;64\n",),
        (HEADER + "0.1, 0\n" + ROWS + "2, 1e-30\n3, 0\n",),  # power of none and of rounding at both ends is outside
        (ROWS, "nm^-1", "nm^4"),
        (HEADER + ROWS, "1/nm", "nm^4"),
    ):
        path.write_text(text, encoding="utf-8")
        assert_is_the_spectrum(read_spectrum(path, *units))
    with pytest.raises(InputError, match=r"its power is in nm\^4, the study says m\^4"):
        read_spectrum(path, density_unit="m^4")
    path.write_text(ROWS)
    with pytest.raises(InputError, match=r"does not say the unit of its power; give a header.* theory\.density_unit"):
        read_spectrum(path, "nm^-1")


def test_netcdf_with_units(tmp_path):
    axis = xr.Variable("k", np.append(Q, np.nan) * 1e-10, {"units": "angstrom-1"})
    power = xr.Variable("k", np.append(POWER, np.nan), {"units": "m4"})
    xr.Dataset({"psd": power}, {"k": axis}).to_netcdf(tmp_path / "one.nc")
    assert_is_the_spectrum(read_spectrum(tmp_path / "one.nc"))
    several = xr.Dataset({"psd": power, "other": power}, {"k": axis})
    several.to_netcdf(tmp_path / "two.nc")
    with pytest.raises(InputError, match=r"2 variables on one dimension \(psd, other\); expected one"):
        read_spectrum(tmp_path / "two.nc")
    # As the datasets of the models have it, among others.
    several.rename(psd="power_spectrum", k="spectrum_wavevector").to_netcdf(tmp_path / "own.nc")
    assert_is_the_spectrum(read_spectrum(tmp_path / "own.nc"))
    xr.concat([several.psd, several.psd], "seed").rename("power_spectrum").to_netcdf(tmp_path / "swept.nc")
    with pytest.raises(InputError, match="power_spectrum stands on seed, k; expected one spectrum"):
        read_spectrum(tmp_path / "swept.nc")


def test_the_study_holds_what_the_file_says(tmp_path):
    (tmp_path / "psd.csv").write_text(HEADER + ROWS)
    found = study(tmp_path, spectrum=["analytic", "file"], spectrum_path="psd.csv")
    section = found.cases[0].theory
    assert section.spectra == ("analytic", "table")
    assert_is_the_spectrum(section.table())
    swept = study(tmp_path, {"theory.spectrum": ["surface", "file"]}, spectrum_path="psd.csv")
    assert [case.theory.spectra for case in swept.cases] == [("surface",), ("table",)]
    (tmp_path / "psd.csv").unlink()  # a dataset is read without it
    assert_is_the_spectrum(make_study(found.table, tmp_path / "elsewhere").cases[0].theory.table())


def test_what_is_no_spectrum_is_one_line(tmp_path):
    for text, words in (
        (HEADER + "0.15, 20\n0.45, -20\n1.8, 1\n", r"row 2: power -2e-35 m\^4; must be a positive number"),
        (HEADER + "0, 20\n0.45, 20\n1.8, 1\n", "row 1: wavevector 0 m"),
        (HEADER + "0.15, 20\n1.8, 20\n0.45, 1\n", r"row 3: wavevector 4\.5e\+08 m\^-1 after 1\.8e\+09; they must rise"),
        (HEADER + "0.15, 20\n0.3, 0\n0.45, 3\n", r"row 2: power 0 m\^4 between others"),
        (HEADER + "0.15, 20\n", "holds 1 rows with power"),
        (HEADER + "0.15, 20\n0.45\n", "is no table of numbers: line 3 has 1 of them, line 2 has 2"),
        ("0.15, 20, 3\n0.45, 20, 3\n", "holds 3 columns of numbers"),
        ("q (1/foo), C (nm^4)\n" + ROWS, r"unit of wavevector = '1 foo\^-1': unknown unit"),
        (ROWS, "does not say the unit of its wavevector"),
    ):
        (tmp_path / "psd.csv").write_text(text)
        with pytest.raises(InputError, match=rf"^theory\.spectrum_path: .*psd\.csv.*{words}") as refused:
            study(tmp_path, spectrum="file", spectrum_path="psd.csv")
        assert "\n" not in str(refused.value)


WAVES = ["1e-2 angstrom^-1", "1 nm^-1", 1e10]
ATOMIC = {"spectrum": ["table"], "wavevectors": WAVES, "density": ["2e-37 m^4", "0.2 nm^4", 2.5e-45], "flows": "none"}


def without_surface(**sections):
    return {**{name: part for name, part in STUDY.items() if name != "surface"}, "theory": ATOMIC, **sections}


def test_theories_of_a_spectrum_need_no_surface(tmp_path):
    dataset = run(without_surface(), model="theory")
    assert dataset["converged"].all()
    table = TabulatedSpectrum([1e8, 1e9, 1e10], [2e-37, 2e-37, 2.5e-45])
    expected = np.sqrt(table.mean_square_height), table.rms_slope
    np.testing.assert_allclose([dataset["rms_height"], dataset["rms_slope"]], expected, rtol=1e-12)
    with pytest.raises(InputError, match=r"missing key surface\.kind: .* needs a surface"):
        run(without_surface(), model="continuum")
    (tmp_path / "psd.csv").write_text(HEADER + ROWS)
    found = make_study(without_surface(theory={"spectrum": "file", "spectrum_path": "psd.csv"}), tmp_path)
    scales = found.cases[0].surface.scales(tmp_path)
    assert scales.rms_curvature == pytest.approx(found.cases[0].theory.table().rms_laplacian / 2)
    assert 4 * scales.rms_height < scales.peak_to_valley < 12 * scales.rms_height
    assert scales.size == pytest.approx([2 * np.pi / Q[0]] * 2)
    assert scales.shortest_wave == pytest.approx(2 * np.pi / Q[-1])


FILE = {"spectrum": "file", "spectrum_path": "words.nc"}


def test_what_does_not_go_together_or_needs_a_surface_is_named(tmp_path):
    (tmp_path / "words.nc").write_text("no dataset")
    for table, words in (
        ({**STUDY, "theory": {"spectrum": "file"}}, r"missing key theory\.spectrum_path"),
        ({**STUDY, "theory": {**FILE, "spectrum_path": "none.csv"}}, r"none\.csv cannot be read \(No such file"),
        ({**STUDY, "theory": FILE}, r"words\.nc is no NetCDF file"),
        ({**STUDY, "theory": {"spectrum_path": "words.nc"}}, 'is given, but theory.spectrum does not name "file"'),
        ({**STUDY, "theory": {**FILE, "density": [1e-36]}}, "give the file or its numbers, not both"),
        ({**STUDY, "theory": {"wavevector_unit": "nm^-1"}}, r"theory\.wavevector_unit: belongs to"),
        (without_surface(theory={**ATOMIC, "spectrum": ["table", "surface"]}), "missing key surface.kind"),
        (without_surface(theory={}), "missing key surface.kind"),
        (without_surface(loading={"path": ["1 nN"]}), "loading.path: forces act on a cell"),
    ):
        with pytest.raises(InputError, match=words):
            make_study(table, tmp_path)
