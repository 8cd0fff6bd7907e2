"""Inference by theories of a sphere: constants found, intervals, evidence, and one line for input without use."""

import numpy as np
import pytest
import xarray as xr

import contact_study
from contact_study import InputError, start
from contact_study.inference.branches import nearest
from contact_study.inference.curves import measured_curve
from contact_study.inference.parameters import prescribed
from scripts.validate_inference import jkr_probe, jkr_test, maugis_probe, on_spring
from theory import DMT, JKR

PARAMETERS = ("work_of_adhesion", "contact_modulus")


@pytest.fixture(scope="module")
def probe():
    return jkr_probe(1)


@pytest.fixture(scope="module")
def found(probe):
    return contact_study.infer(probe.curve, **{**probe.options, "models": None})


def test_constants_of_a_noisy_curve_are_inside_their_intervals(found, probe):
    one = found.sel(model="jkr")
    for name in PARAMETERS:
        low, high = float(one[f"{name}_lower"]), float(one[f"{name}_upper"])
        assert low < float(one[name]) < high
        # Three half widths of a 90 % interval: 5 standard deviations.
        assert abs(float(one[name]) - probe.truth[name]) < 1.5 * (high - low)
        assert high - low < 0.1 * probe.truth[name]


def test_evidence_prefers_the_theory_that_made_the_curve(found):
    assert str(found["model"].values[np.argmin(found["bic"].values)]) == "jkr"
    assert float(found["weight"].sel(model="dmt")) < 1e-6
    assert float(found["weight"].sum()) == pytest.approx(1)
    assert "prefers jkr" in found.attrs["notes"]


def test_a_short_range_is_bounded_from_above_only(found):
    one = found.sel(model="maugis")
    assert np.isnan(one["range_lower"])
    assert float(one["range_upper"]) < 0.7 * float(one["elastic_length"])
    assert "range is bounded from above only" in found.attrs["notes"]


def test_errors_of_a_perfect_model_are_those_of_the_noise(probe):
    pull = 1.5 * np.pi * probe.truth["work_of_adhesion"] * 5e-6
    noise = {"force": 0.02 * pull, "displacement": "2 nm"}
    one = contact_study.infer(probe.curve, **probe.options, noise=noise).isel(model=0)
    # 300 points: the standard deviation of the reduced misfit is √(2/300) = 0.08; three of them.
    assert float(one["reduced_misfit"]) == pytest.approx(1, abs=0.25)
    assert np.abs(one["residual"]).max() < 5
    assert float(one["threshold"]) == pytest.approx(2.7055, abs=1e-3)  # 1.6449², of the normal distribution


def test_profiles_rise_to_the_threshold_at_the_ends_of_the_interval(found):
    one = found.sel(model="jkr")
    values, rise = one["contact_modulus_profile"].values, one["contact_modulus_profile_rise"].values
    known = np.isfinite(values)
    at = np.interp(float(one["contact_modulus_upper"]), values[known], np.sqrt(rise[known]))
    assert at**2 == pytest.approx(float(one["threshold"]), rel=0.03)  # interpolated along the root
    assert rise[known].min() == 0.0


def test_an_exact_curve_gives_back_its_constants():
    theory = DMT(2e-6, 3e7, 0.02)
    pull = -theory.pull_off_force
    random = np.random.default_rng(0)
    curve = on_spring(theory, 2 * pull, 1e3, random, 1e-5 * pull, 1e-14)
    found = contact_study.infer(curve, ["dmt"], fixed={"radius": 2e-6}, spring_constant=1e3).isel(model=0)
    # The noise of 1e-5 of the force; the polyline of 250 states is as fine.
    assert float(found["work_of_adhesion"]) == pytest.approx(0.02, rel=1e-4)
    assert float(found["contact_modulus"]) == pytest.approx(3e7, rel=1e-3)
    assert abs(float(found["displacement_zero"][0])) < 1e-3 * theory.at_force(2 * pull)[1]


def test_contact_radii_need_no_displacement():
    one = jkr_test(3)
    found = contact_study.infer(one.curve, **one.options).isel(model=0)
    for name in PARAMETERS:
        assert float(found[f"{name}_lower"]) < one.truth[name] * 1.1
        assert float(found[f"{name}_upper"]) > one.truth[name] * 0.9
    assert float(found["displacement_zero"].isel(curve=0)) == 0


def test_displacement_with_contact_radius_gives_the_radius():
    theory = JKR(1e-3, 1e6, 0.05)
    states = np.array([theory.at_force(force) for force in np.linspace(-1.5e-4, 1e-3, 30)]).T
    noisy = states[2] * (1 + 2e-3 * np.random.default_rng(2).normal(size=30))
    curve = xr.Dataset(
        {"total_force": ("point", states[0]), "displacement": ("point", states[1] + 3e-6)}
        | {"contact_radius": ("point", noisy)}
    )
    found = contact_study.infer(curve, ["jkr"], fixed={"force_zero": 0.0}).isel(model=0)
    assert float(found["radius"]) == pytest.approx(1e-3, rel=0.02)  # errors of 0.2 % in 30 radii
    assert float(found["displacement_zero"][0]) == pytest.approx(3e-6, rel=0.1)


@pytest.mark.validation
def test_several_curves_share_constants_and_have_offsets_of_their_own():
    one, moved = jkr_probe(5), jkr_probe(5).curve.copy()
    moved["displacement"] = moved["displacement"] + 4e-7
    options = {**one.options, "prior": {"force_scale": "1 +- 0.1"}}
    both = contact_study.infer([one.curve, moved], **options).isel(model=0)
    zeros = both["displacement_zero"].values
    assert zeros[1] - zeros[0] == pytest.approx(4e-7, rel=1e-3)
    # Alone, the same curve; an error of the spring of 10 % is one of the work of adhesion of 10 %.
    alone = contact_study.infer(one.curve, **one.options).isel(model=0)
    width = float(both["work_of_adhesion_upper"] / both["work_of_adhesion_lower"])
    assert width > 1.25 > float(alone["work_of_adhesion_upper"] / alone["work_of_adhesion_lower"])


@pytest.mark.validation
def test_range_between_the_limits_is_bounded():
    one = maugis_probe(4)
    found = contact_study.infer(one.curve, **one.options).isel(model=0)
    assert float(found["work_of_adhesion_lower"]) < one.truth["work_of_adhesion"] * 1.02
    assert not float(found["range_upper"]) < 0.9 * one.truth["range"]
    assert not float(found["range_lower"]) > 1.1 * one.truth["range"]
    tabor = np.cbrt(1e-6 * (one.truth["work_of_adhesion"] / one.truth["contact_modulus"]) ** 2) / one.truth["range"]
    assert 0.8 * tabor < float(found["tabor_parameter"])


def test_nearest_states_are_on_the_segments():
    lines = [np.array([[0.0, 1.0, 2.0], [0.0, 0.0, 1.0]]), np.array([[5.0, 6.0], [0.0, 0.0]])]
    points = np.array([[0.4, 1.5, 3.6, -1.0], [0.3, 0.5, 0.2, 0.2]])
    expected = np.array([[0.4, 1.5, 5.0, 0.0], [0.0, 0.5, 0.0, 0.0]])
    np.testing.assert_allclose(nearest(points, lines, np.ones(2)), expected, atol=1e-12)
    # A short error of the second axis leads to the first line, at its height.
    assert nearest(np.array([[4.9], [0.3]]), lines, np.array([10.0, 0.001]))[0, 0] == pytest.approx(1.3, abs=1e-4)


def test_points_in_flight_are_left_out(probe):
    curve = measured_curve(probe.curve, {}, probe.options["spring_constant"])
    low, high = curve.pull_off
    theory = JKR(5e-6, probe.truth["contact_modulus"], probe.truth["work_of_adhesion"])
    states = theory.curve(1.5 * -theory.pull_off_force, 5000)
    fold = (states.displacement + states.force * curve.compliance)[states.displacement > -1e-3].min()
    noise = 4 * curve.errors[0]
    assert low - noise < fold < high + noise


@pytest.mark.validation
def test_samples_of_the_posterior_scatter_as_the_intervals_say():
    pytest.importorskip("emcee")
    one = jkr_test(3)
    found = contact_study.infer(one.curve, **one.options, samples=3000).isel(model=0)
    drawn = found["sample"].sel(parameter="work_of_adhesion")
    assert drawn.size >= 3000
    low, high = np.nanquantile(drawn, [0.05, 0.95])
    # Some hundred independent samples: their quantiles scatter by a tenth of the width.
    width = float(found["work_of_adhesion_upper"] - found["work_of_adhesion_lower"])
    assert low == pytest.approx(float(found["work_of_adhesion_lower"]), abs=0.25 * width)
    assert high == pytest.approx(float(found["work_of_adhesion_upper"]), abs=0.25 * width)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"total_force": lambda f: 0 * f + 1e-12 * np.sin(1e3 * np.arange(f.size))}, "shows no contact"),
        ({"total_force": lambda f: f + 6 * np.abs(f).max() * (1 - np.abs(np.linspace(-1, 1, f.size)))}, "drifts by"),
        ({"displacement": lambda x: np.where(np.arange(x.size) == 7, np.nan, x)}, "point 8: displacement is missing"),
        ({"displacement": lambda x: 0 * x}, "does not change"),
        ({"displacement": lambda x: 1e9 * x}, "check the units"),
    ],
)
def test_a_curve_without_use_gets_one_line(probe, change, said):
    curve = probe.curve.copy()
    for name, made in change.items():
        curve[name] = ("point", made(curve[name].values))
    with pytest.raises(InputError, match=said) as raised:
        contact_study.infer(curve, ["jkr"], fixed={"radius": "5 um"})
    assert "\n" not in str(raised.value)


def test_few_points_and_mixed_units_of_curves_are_refused(probe):
    with pytest.raises(InputError, match="holds 5 points"):
        contact_study.infer(probe.curve.isel(point=slice(0, 5)), fixed={"radius": 5e-6})
    other = probe.curve.copy()
    other["total_force"] = other["total_force"] * 1e3
    with pytest.raises(InputError, match="check the units of both"):
        contact_study.infer([probe.curve, other], fixed={"radius": 5e-6}, spring_constant=1e6)


@pytest.mark.parametrize(
    ("fixed", "prior", "said"),
    [
        ({"radius": "5 Pa"}, {}, "radius = '5 Pa'"),
        ({"raduis": 1.0}, {}, "raduis"),
        ({"radius": -1.0}, {}, "must be positive"),
        ({"radius": 1.0}, {"radius": "1 +- 0.1 m"}, "given twice"),
        ({}, {"modulus": "2 MPa"}, "its error"),
        ({}, {"modulus": "2 +- 0 MPa"}, "error must be positive"),
    ],
)
def test_wrong_parameters_are_named(fixed, prior, said):
    with pytest.raises(InputError, match=said):
        prescribed(fixed, prior)


def test_the_radius_must_be_known_without_contact_radius(probe):
    with pytest.raises(InputError, match="radius: force with displacement"):
        contact_study.infer(probe.curve, ["jkr"])
    with pytest.raises(InputError, match="model jkl"):
        contact_study.infer(probe.curve, ["jkl"])


@pytest.mark.validation
def test_the_command_writes_dataset_and_figure(probe, tmp_path, capsys):
    table = np.array([probe.curve["displacement"].values * 1e9, probe.curve["total_force"].values * 1e9]).T
    path = tmp_path / "curve.csv"
    np.savetxt(path, table, delimiter=",", header="displacement (nm), force (nN)", comments="")
    stiffness = f"{probe.options['spring_constant']!r} N/m"
    given = ["infer", path, "--model", "jkr", "--fixed", "radius=5 um", "--spring", stiffness]
    given += ["-o", tmp_path / "fit.nc", "--figure", tmp_path / "fit.png"]
    assert start.bem_adhesion([*map(str, given)]) == 0
    said = capsys.readouterr()
    assert "work_of_adhesion" in said.out
    assert "mJ/m²" in said.out
    assert "jkr: holds if adhesion acts within" in said.err
    with xr.open_dataset(tmp_path / "fit.nc") as dataset:
        assert dataset["work_of_adhesion"].attrs["units"] == "J m-2"
        assert "infer" in dataset.attrs["history"]
    assert (tmp_path / "fit.png").stat().st_size > 10_000
    assert start.bem_adhesion([*map(str, given)]) == 1
    assert "--overwrite" in capsys.readouterr().err
    assert start.bem_adhesion(["infer", str(path), "--fixed", "radius"]) == 1
    assert "expected KEY=VALUE" in capsys.readouterr().err
