"""The section [uncertainty]: distributions, draws and the cases that they become."""

import copy
import tomllib

import numpy as np
import pytest

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.study.uncertainty import uncertainty_of

STUDY = {
    "surface": {"kind": "wavy", "size": "1 um", "shape": [16, 16], "amplitude": "1 nm"},
    "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": ["1 MPa", "2 MPa"]},
}
MODULUS, AMPLITUDE = "material.youngs_modulus", "surface.amplitude"


def study(draws=8, **section):
    distributions = {MODULUS: {"distribution": "lognormal", "median": "1 GPa", "error": "0.2 GPa"}}
    return copy.deepcopy(STUDY) | {"uncertainty": {"draws": draws, **(section.pop("keys", distributions)), **section}}


def drawn(given, count=4096):
    return np.array(
        [values[MODULUS] for values in uncertainty_of(study(keys={MODULUS: given})).values(range(1, count + 1))]
    )


@pytest.mark.parametrize(
    ("given", "mean", "spread"),
    [
        ({"distribution": "normal", "mean": "2 GPa", "error": "0.3 GPa"}, 2e9, 0.3e9),
        ({"distribution": "normal", "relative_error": 0.1}, 1e9, 0.1e9),
        ({"distribution": "lognormal", "mean": "2 GPa", "error": "1 GPa"}, 2e9, 1e9),
        ({"distribution": "uniform", "low": "1 GPa", "high": "4 GPa"}, 2.5e9, 3e9 / np.sqrt(12)),
        ({"distribution": "values", "values": ["1 GPa", "3 GPa"]}, 2e9, 1e9),
    ],
)
def test_draws_have_the_declared_mean_and_error(given, mean, spread):
    values = [contact_study.inputs.units.quantity(one, "Pa", "") for one in drawn(given)]
    # 4096 points of a Sobol sequence integrate smooth functions to a part in a thousand; tails of x² to one in 300.
    assert np.mean(values) == pytest.approx(mean, rel=1e-3)
    assert np.std(values) == pytest.approx(spread, rel=4e-3)


def test_a_lognormal_median_and_error_are_those_declared():
    values = drawn({"distribution": "lognormal", "median": "2 GPa", "error": "1 GPa"})
    assert np.median(values) == pytest.approx(2e9, rel=1e-3)
    assert np.std(values) == pytest.approx(1e9, rel=5e-3)


def test_a_loguniform_key_is_uniform_in_its_logarithm():
    values = np.log10(drawn({"distribution": "loguniform", "low": "1 MPa", "high": "1 GPa"}))
    assert np.quantile(values, [0, 0.5, 1]) == pytest.approx([6, 7.5, 9], abs=2e-3)


def test_draws_become_cases_with_the_central_one_first():
    made = contact_study.make_study(study())
    assert [case.coordinates["draw"] for case in made.cases] == list(range(9))
    assert made.cases[0].material.youngs_modulus == pytest.approx(1e9, rel=1e-12)
    assert len({case.material.youngs_modulus for case in made.cases}) == 9
    assert list(made.sweep) == ["draw"]
    again = contact_study.make_study(tomllib.loads(made.toml))
    assert [one.material for one in again.cases] == [one.material for one in made.cases]


def test_a_seed_repeats_its_draws_and_more_draws_continue_them():
    moduli = {
        name: [case.material.youngs_modulus for case in contact_study.make_study(study(**keys)).cases]
        for name, keys in {"few": {}, "same": {}, "more": {"draws": 21}, "other": {"seed": 2}}.items()
    }
    assert moduli["few"] == moduli["same"] == moduli["more"][:9]
    assert not set(moduli["few"][1:]) & set(moduli["other"][1:])


def test_a_sweep_beside_the_draws_repeats_them_at_each_value():
    given = study() | {"sweep": {AMPLITUDE: ["1 nm", "2 nm"]}}
    cases = contact_study.make_study(given).cases
    assert len(cases) == 18
    assert [one.material for one in cases[:9]] == [one.material for one in cases[9:]]


def test_keys_without_quotes_and_single_draws_are_read(tmp_path):
    made = contact_study.make_study(study())
    plain = study()
    plain["uncertainty"] = {"draws": 8, "material": {"youngs_modulus": plain["uncertainty"][MODULUS]}}
    assert contact_study.make_study(plain).cases[3].material == made.cases[3].material
    path = tmp_path / "study.toml"
    path.write_text(made.toml)
    (only,) = contact_study.read_study(path, {"uncertainty.draw": [3]}).cases
    assert only.material == made.cases[3].material


def test_correlated_keys_follow_each_other():
    both = {key: {"distribution": "normal", "relative_error": 0.1} for key in (MODULUS, AMPLITUDE)}
    section = study(keys=both, correlation=[[MODULUS, AMPLITUDE, 0.7]])
    rows = uncertainty_of(section).values(range(1, 2049))
    values = np.array([[row[key] for key in both] for row in rows])
    assert np.corrcoef(values.T)[0, 1] == pytest.approx(0.7, abs=5e-3)  # of 2048 Sobol points


NORMAL = {"distribution": "normal"}


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"material.young": NORMAL}, "unknown key 'material.young'"),
        ({"modulus": NORMAL}, "unknown key uncertainty.modulus"),
        (
            {MODULUS: {**NORMAL, "error": "0.5 GPa"}},
            'reaches a value that the key refuses: .* must be positive; use "logn',
        ),
        ({MODULUS: {**NORMAL, "error": 1e8}}, "units mixed, mean = '1 GPa' and error = 100000000.0: give both"),
        ({MODULUS: {**NORMAL, "mean": "1 GPa", "error": "1 nm"}}, "error = '1 nm'.* such as"),
        ({MODULUS: NORMAL}, "missing error"),
        ({MODULUS: {**NORMAL, "error": "1 MPa", "relative_error": 0.1}}, "error and relative_error: give one"),
        ({MODULUS: {**NORMAL, "error": "-1 MPa"}}, "error = '-1 MPa': must be positive"),
        ({MODULUS: {**NORMAL, "eror": "1 MPa"}}, r"did you mean error\?"),
        ({MODULUS: {"distribution": "gauss"}}, "distribution = 'gauss': expected one of normal"),
        ({MODULUS: "1 GPa"}, "expected { distribution"),
        ({MODULUS: {"distribution": "uniform", "low": "2 GPa", "high": "1 GPa"}}, "low = '2 GPa' must be below high"),
        ({MODULUS: {"distribution": "values", "values": []}}, "needs values"),
        ({"material.hardness": {**NORMAL, "error": "1 MPa"}}, "missing mean; the study gives no value"),
        ({"output.fields": {"distribution": "values", "values": [True]}}, "cannot be drawn"),
        ({}, "names no key"),
    ],
)
def test_a_mistake_ends_in_one_line(keys, message):
    with pytest.raises(InputError, match=message) as caught:
        contact_study.make_study(study(keys=keys))
    assert "\n" not in str(caught.value)


def test_draws_are_needed_and_correlations_must_exist():
    lacking = study()
    del lacking["uncertainty"]["draws"]
    with pytest.raises(InputError, match=r"missing key uncertainty\.draws"):
        contact_study.make_study(lacking)
    with pytest.raises(InputError, match=r"'surface\.amplitude' has no distribution"):
        contact_study.make_study(study(correlation=[[MODULUS, AMPLITUDE, 0.5]]))
    with pytest.raises(InputError, match="is swept, too"):
        contact_study.make_study(study() | {"sweep": {MODULUS: ["1 GPa"]}})


def test_more_draws_resume_a_run(tmp_path):
    output = tmp_path / "bem.nc"
    first = contact_study.run(study(), output=output)
    steps = []
    with pytest.MonkeyPatch.context() as patch:
        from bem_adhesion.study import model

        whole = model.solve_path
        patch.setattr(model, "solve_path", lambda case, *args, **more: steps.append(case) or whole(case, *args, **more))
        more = contact_study.run(study(draws=10), output=output, resume=True)
    assert len(steps) == 2
    np.testing.assert_array_equal(more.mean_gap[:9], first.mean_gap)
    assert more.sizes["draw"] == 11
