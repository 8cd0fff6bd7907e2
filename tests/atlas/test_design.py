"""The design of the atlas: space-filling, reproducible, its beginning stands for it, and the rule of its grids."""

import math

import numpy as np
import pytest
from scipy.stats import ks_2samp, qmc

from contact_study.atlas.design import (
    LARGEST_GRID,
    MODULUS,
    RANGES,
    RMS_SLOPE,
    SIZE,
    Condition,
    design,
    drawn,
)
from contact_study.atlas.loops import cores_of, study_of, theory_study_of
from contact_study.inputs.errors import InputError
from contact_study.physics.process_zone import process_zone
from contact_study.physics.solids import HalfSpace
from contact_study.study.study import make_study


def unit_cube(conditions: list[Condition]) -> np.ndarray:
    """Place conditions in the cube of their numerical ranges, shape (conditions, 4)."""
    rows = []
    for name, values in RANGES.items():
        if values.kind == "values":
            continue
        given = np.array([getattr(one, name) for one in conditions])
        low, high = values.first, values.second
        if values.kind == "loguniform":
            given, low, high = np.log(given), math.log(low), math.log(high)
        rows.append((given - low) / (high - low))
    return np.transpose(rows)


def first(count):
    points = drawn()
    return [next(points) for _ in range(count)]


def test_points_fill_the_ranges_more_evenly_than_random_ones():
    points = unit_cube(first(256))
    assert points.shape == (256, 4)
    assert points.min() > 0
    assert points.max() < 1
    # Random points in four dimensions have a discrepancy ten times as large.
    assert qmc.discrepancy(points) < 3e-3
    laws = [one.law for one in first(256)]
    assert {laws.count(law) for law in RANGES["law"].values} <= {85, 86}


def test_a_design_is_reproducible_and_longer_ones_continue_it():
    short, refused = design(10)
    longer, more = design(20)
    assert longer[:10] == short
    assert all(refused[reason] <= more[reason] for reason in refused)
    assert sum(refused.values()) == short[-1].number - 10
    assert design(10, seed=2)[0] != short


@pytest.mark.validation
@pytest.mark.parametrize("count", [25, 75])
def test_the_beginning_stands_for_the_whole(count):
    whole, first = design()[0], design(count)[0]
    assert whole[:count] == first
    for name in ("hurst_exponent", "cutoff_ratio", "relative_adhesion", "tabor_number", "points"):
        both = ([getattr(one, name) for one in some] for some in (first, whole))
        assert ks_2samp(*both).pvalue > 0.3, name


def test_grids_are_the_smallest_that_resolve_process_zone_and_waves():
    even = [2 * 2**i * 3**j * 5**k for i in range(9) for j in range(6) for k in range(4)]
    for one in design(30)[0]:
        assert not one.refusal
        least = 4 * max(SIZE / process_zone(one.elasticity.softest_modulus(SIZE, 1e-9), one.traction_law), one.modes[2])
        assert one.points == min(points for points in even if points >= least * (1 - 1e-9))


def test_conditions_beyond_the_grid_or_the_range_are_refused():
    given = 0.8, 8.0, 0.3
    assert not Condition(0, *given, 0.3, "dugdale", "half_space").refusal
    sharp, blunt = Condition(0, *given, 5.0, "dugdale", "half_space"), Condition(0, *given, 0.01, "dugdale", "layer")
    assert sharp.points > LARGEST_GRID
    assert sharp.refusal == "grid beyond 512²"
    assert blunt.refusal == "range beyond the rms height"


def test_a_condition_has_the_slope_the_adhesion_and_the_range_that_it_says():
    for solid in ("half_space", "layer"):
        one = Condition(0, 0.6, 10.0, 0.5, 0.7, "exponential", solid)
        assert one.spectrum.rms_slope == pytest.approx(RMS_SLOPE)
        full = float(one.spectrum.full_contact_energy(HalfSpace(MODULUS).stiffness))
        assert one.work_of_adhesion == pytest.approx(0.5 * full)
        made = make_study(study_of(one, [1], preloads=(2.0,))).cases[0].solid
        assert one.elasticity.stiffness(3e7) == pytest.approx(float(made.stiffness(3e7)), rel=1e-12)
        tabor = math.cbrt(2 / one.spectrum.rms_laplacian * (one.work_of_adhesion / 1e9) ** 2 / one.length**3)
        assert tabor == pytest.approx(0.7)


@pytest.mark.parametrize("law", ["exponential", "dugdale", "lennard_jones_10_4"])
def test_repulsions_in_place_of_a_wall_are_short_against_range_and_rms_height(law):
    of_law = [one for one in first(60) if one.law == law]
    lengths = []
    for one in of_law:
        cores = cores_of(one)
        assert all(0 < core <= 0.02 * 1.0001 for core in cores) if one.traction_law.has_wall else cores == (0.0,)
        for core in cores:
            given = theory_study_of(one, 1, [1.0], core)["interaction"]
            lengths.append(given.get("core", 0.0) / one.spectrum.rms_height)
    assert max(lengths) == pytest.approx(0.0 if law == "lennard_jones_10_4" else 0.004)  # where the range is long


def test_no_condition_is_an_error():
    with pytest.raises(InputError, match="at least 1"):
        design(0)
