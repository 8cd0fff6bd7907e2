"""Intervals, shares and corrections from draws of a linear model whose variance is known."""

import numpy as np
import pytest
import tomli_w
import xarray as xr
from scipy.special import ndtri

import contact_study
from contact_study import plots
from contact_study.inputs.errors import InputError
from contact_study.results.uncertainty import draws_of

DECLARED = {
    "material.youngs_modulus": {"distribution": "normal", "mean": "10 GPa", "error": "1 GPa"},
    "interaction.work_of_adhesion": {"distribution": "lognormal", "median": 0.1, "error": 0.01},
}
LOADS = [1e6, 2e6]


def dataset(numbers, answer, declared=DECLARED, **further):
    """A run at draws; ``answer(scores, load)`` is the contact area."""
    attrs = {"study_toml": tomli_w.dumps({"uncertainty": dict(declared)}), "model": "theory"}
    coords = {"draw": numbers, "step": [0, 1], "applied_pressure": ("step", LOADS), "branch": ("step", [0, 0])}
    made = xr.Dataset({}, coords, attrs)
    scores = ndtri(draws_of(made).shares)
    area = np.stack([answer(scores, load) for load in LOADS], axis=1)
    return made.assign(relative_contact_area=(("draw", "step"), area, {"units": "1"}), **further)


def linear(scores, load):
    return 0.3 + load * 1e-8 * (2 * scores[:, 0] + scores[:, 1])


def test_intervals_and_shares_of_a_linear_answer():
    found = contact_study.uncertainty(dataset(range(513), linear))
    spread = np.array(LOADS) * 1e-8 * np.sqrt(5)
    expected = 0.3 + np.outer(ndtri([0.05, 0.5, 0.95]), spread)
    # The quantile at 5 % of 512 independent draws errs by 0.093 of the spread; Sobol points err by half of that.
    np.testing.assert_allclose((found.relative_contact_area - expected) / spread, 0, atol=0.05)
    np.testing.assert_allclose(found.relative_contact_area_share, [[0.8, 0.8], [0.2, 0.2]], atol=1e-9)
    swing = found.relative_contact_area_swing.sel(parameter="material.youngs_modulus", step=1)
    np.testing.assert_allclose(swing, 0.3 + 0.04 * ndtri([0.05, 0.5, 0.95]), atol=1e-9)


def test_states_that_did_not_converge_and_the_central_case_do_not_count():
    made = dataset(range(65), linear)
    reference = contact_study.uncertainty(made.isel(draw=slice(1, 60)))
    made["converged"] = ("draw", "step"), np.repeat(np.arange(65) < 60, 2).reshape(65, 2)
    made["relative_contact_area"][0] = 100.0
    found = contact_study.uncertainty(made)
    np.testing.assert_array_equal(found.relative_contact_area, reference.relative_contact_area)
    assert int(found.relative_contact_area_draws[0]) == 59


def test_anchors_correct_the_value_and_the_dependence():
    def true(scores, load):
        return 0.5 * linear(scores, load) * np.exp(0.1 * scores[:, 1])

    theory, truth = dataset(range(257), linear), dataset(range(257), true)
    found = contact_study.uncertainty(theory, truth.isel(draw=slice(0, 9)))
    expected = contact_study.uncertainty(truth)
    # The correction is of the form that is fitted, so that it is exact.
    for name in ("relative_contact_area", "relative_contact_area_share"):
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-9)
    assert float(found.relative_contact_area_correction_error.max()) < 1e-9


def test_one_anchor_scales_the_answer():
    theory = dataset(range(33), linear)
    truth = dataset([0], lambda scores, load: 3 * linear(scores, load))
    found = contact_study.uncertainty(theory, truth).relative_contact_area
    np.testing.assert_allclose(found, 3 * contact_study.uncertainty(theory).relative_contact_area, rtol=1e-12)


def test_anchors_add_an_answer_that_the_theory_lacks():
    theory, numbers = dataset(range(257), linear), range(16)
    work = np.exp(0.2 * ndtri(draws_of(theory).shares[:16, 0]))
    anchors = dataset(numbers, linear, work_of_separation=("draw", work, {"units": "J m-2"}))
    found = contact_study.uncertainty(theory, anchors).work_of_separation
    # Quantiles of 256 Sobol points, see above: √2 times as far off.
    np.testing.assert_allclose(np.log(found), 0.2 * ndtri([0.05, 0.5, 0.95]), atol=0.2 * 0.07)


def test_an_answer_that_the_theory_lacks_needs_anchors_for_each_input():
    numbers = range(5)
    anchors = dataset(numbers, linear, work_of_separation=("draw", np.arange(1.0, 6.0), {"units": "J m-2"}))
    found = contact_study.uncertainty(dataset(range(33), linear), anchors)
    assert found.work_of_separation.isnull().all()


def test_a_theory_without_pull_off_leaves_it_to_the_simulations():
    pulled = -np.exp(0.2 * ndtri(draws_of(dataset(range(16), linear)).shares[:, 1]))
    anchors = dataset(range(16), linear, pull_off_pressure=("draw", pulled, {"units": "Pa"}))
    theory = dataset(range(257), linear, pull_off_pressure=((), 0.0, {"units": "Pa"}))
    found = contact_study.uncertainty(theory, anchors).pull_off_pressure
    # Quantiles of 256 Sobol points, see above.
    np.testing.assert_allclose(np.log(-found), 0.2 * ndtri([0.95, 0.5, 0.05]), atol=0.2 * 0.07)


def test_an_answer_that_no_draw_changes_has_no_spread():
    made = dataset(range(33), linear, pull_off_pressure=((), -0.3, {"units": "Pa"}))
    found = contact_study.uncertainty(made)
    assert (found.pull_off_pressure == -0.3).all()
    assert not found.pull_off_pressure_share.any()


def test_correlated_keys_have_no_shares():
    pair = [*DECLARED, 0.5]
    found = contact_study.uncertainty(dataset(range(65), linear, {**DECLARED, "correlation": [pair]}))
    assert found.relative_contact_area_share.isnull().all()
    assert found.relative_contact_area.notnull().all()


def test_mistakes_end_in_one_line():
    theory = dataset(range(33), linear)
    with pytest.raises(InputError, match="4 draws give no interval"):
        contact_study.uncertainty(theory.isel(draw=slice(0, 4)))
    with pytest.raises(InputError, match="has no draws"):
        contact_study.uncertainty(theory.isel(draw=0))
    with pytest.raises(InputError, match="the anchors have draw 33"):
        contact_study.uncertainty(theory, dataset([33], linear))
    other = {**DECLARED, "material.youngs_modulus": {"distribution": "normal", "mean": 1e9, "error": 1e8}}
    with pytest.raises(InputError, match=r"section \[uncertainty\] is another"):
        contact_study.uncertainty(theory, dataset([0], linear, other))


def test_the_tornado_has_the_largest_share_on_top_and_bars_at_the_swings():
    made = dataset(range(65), linear)
    axes = plots.tornado(made).axes[0]
    labels = [text.get_text() for text in axes.get_yticklabels()]
    assert labels == ["work of adhesion  20 %", "Young's modulus  80 %"]
    ends = sorted(patch.get_x() + patch.get_width() for patch in axes.patches if abs(patch.get_height() - 0.6) < 1e-9)
    swing = contact_study.uncertainty(made).relative_contact_area_swing.isel(step=1, end=[0, 2])
    np.testing.assert_allclose(ends, np.sort(swing.values.ravel()), rtol=1e-9)


def test_the_area_of_draws_is_a_band():
    made = dataset(range(65), linear)
    axes = plots.contact_area(made)
    found = contact_study.uncertainty(made).relative_contact_area
    np.testing.assert_allclose(axes.lines[0].get_ydata(), found[1])
    band = axes.collections[0].get_paths()[0].vertices[:, 1]
    assert (band.min(), band.max()) == pytest.approx((found.values.min(), found.values.max()))


@pytest.mark.parametrize("sign", [1, -1])
def test_value_and_slopes_of_one_simulation_replace_those_of_a_theory(sign):
    theory = dataset(range(65), lambda scores, load: sign * (0.3 + 0.01 * scores[:, 0]))
    central = dataset([0], lambda scores, load: np.full(1, sign * (0.6 + load * 1e-8)))
    slopes = sign * np.array([[2e-11, 3e-11], [0.4, 0.0]])  # per Pa, per J/m²
    found = contact_study.uncertainty(
        theory, central.assign(relative_contact_area_by_key=(("parameter", "step"), slopes))
    )
    areas = found["relative_contact_area_swing"].values
    middle = sign * np.array([0.61, 0.62])
    np.testing.assert_allclose(areas[:, 1], [middle, middle], rtol=3e-3)
    scores = ndtri(0.95)
    modulus, work = 1e9 * scores * slopes[0], 0.1 * 0.0995 * scores * slopes[1]
    # Differences of the ends have no errors of second order, and the fit of shares is of third.
    np.testing.assert_allclose((areas[0, 2] - areas[0, 0]) / 2, modulus, rtol=0.02)
    np.testing.assert_allclose((areas[1, 2] - areas[1, 0]) / 2, work, rtol=0.02, atol=5e-5)
