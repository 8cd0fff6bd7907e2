"""Criteria of sticking: each against what it says, computed in another way, and in its limits."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from contact_study.physics.laws import Dugdale, HardWall
from theory import LennardJones104, SelfAffineSpectrum, criteria, dmt_limit, gap_distribution, references, stickiness
from theory.non_adhesive.closed_forms import low_pressure_asymptote

E_STAR, WORK, LENGTH, Q = 93.7348e9, 0.6924, 3.28e-10, 6.0415e7
SPECTRUM = SelfAffineSpectrum(0.8, 1e-9, Q, 3 * Q, 12 * Q)
LAW = LennardJones104(WORK, LENGTH)
RANGE = WORK / LAW.peak_tensile_stress


def test_persson_tosatti_counts_the_true_area():
    # U_full = 5.3532 J/m² and S = 1.03336, computed for this spectrum with two independent programs.
    found = criteria.persson_tosatti_ratio(SPECTRUM, E_STAR, WORK)
    assert found == pytest.approx(1.03336 * WORK / 5.3532, rel=2e-5)


def test_pastewka_robbins_is_the_balance_at_the_edge_of_a_patch():
    """The pull of the ring, π A/d long, on which the gap of a Hertzian line contact is within the range; over h'E*/2.

    Found from the whole gap; its next term is smaller by the ring's width over the radius, 4e-4 here.
    """
    assert criteria.pastewka_robbins_ratio(SPECTRUM, E_STAR, WORK, 1e-5 * RANGE) == pytest.approx(4.1616, rel=1e-3)


def test_dmt_tension_sticks_from_where_dmt_like_tension_outweighs_light_contact():
    ratio = criteria.dmt_tension_ratio(SPECTRUM, E_STAR, WORK, RANGE)
    for factor in (0.98, 1.02):  # two resolutions of the gaps, each within half a per cent of a fine one
        law = Dugdale(factor * WORK / ratio, RANGE)
        bare = gap_distribution(SPECTRUM, E_STAR, 1e-6 * E_STAR, regularised=False)
        assert (dmt_limit(bare, law) < 0) == (factor > 1)
    rougher = SelfAffineSpectrum(0.8, 1e-8, Q, 3 * Q, 12 * Q)
    # Of a short range the ratio is Δγ over E* h² q in what it knows; the range is a fifth of the smoother one's height.
    assert criteria.dmt_tension_ratio(rougher, E_STAR, WORK, RANGE) == pytest.approx(ratio / 100, rel=0.05)


@pytest.mark.parametrize("mean_gap", [0.0, 1e-9, 2.5e-9])
def test_attracted_area_is_what_a_surface_has_within_the_range(mean_gap):
    counted, _ = quad(lambda gap: norm.pdf(gap, mean_gap / 1e-9), 0, 0.3)
    assert criteria.attracted_area(mean_gap, 1e-9, 3e-10) == pytest.approx(counted, rel=1e-9)


def test_bearing_area_model_pulls_from_its_threshold_on():
    threshold = WORK / criteria.bearing_area(SPECTRUM, E_STAR, WORK, RANGE)[0]
    works = threshold * np.array([0.999, 1.001, 4])
    # At a fixed range the tension grows with the work of adhesion.
    below, above, stronger = (criteria.bearing_area(SPECTRUM, E_STAR, work, RANGE)[1] for work in works)
    assert -1e7 < above < 0 == below
    gaps = 1e-9 * np.linspace(0, 6, 20001)
    decay, light = low_pressure_asymptote(SPECTRUM, E_STAR)
    pull = works[2] / RANGE * criteria.attracted_area(gaps, 1e-9, RANGE)
    assert stronger == pytest.approx((light * np.exp(-gaps / decay) - pull).min(), rel=1e-6)


def test_tabor_number_of_all_scales_is_that_of_the_surface():
    for depth, expected in ((1, 0.30), (8, 1.21)):  # of the paper's systems
        found = criteria.local_tabor_number(12 * Q, SPECTRUM, E_STAR, depth * WORK, LENGTH)
        assert found == pytest.approx(expected, abs=0.006)
        radius = 2 / SPECTRUM.rms_laplacian
        assert found == pytest.approx(references.tabor_parameter(radius, E_STAR, depth * WORK, LENGTH), rel=1e-12)
    along = criteria.local_tabor_number(Q * np.array([1, 2, 4, 12]), SPECTRUM, E_STAR, WORK, LENGTH)
    assert np.isnan(along[0]), "no roughness yet"
    assert (np.diff(along[1:]) < 0).all(), "finer roughness is sharper: towards DMT"


def test_a_law_has_the_criteria_of_its_own_work_and_range():
    found = stickiness(SPECTRUM, E_STAR, LAW)
    for name in ("pastewka_robbins", "dmt_tension"):
        assert getattr(found, name) == getattr(criteria, f"{name}_ratio")(SPECTRUM, E_STAR, WORK, RANGE)
    deeper = stickiness(SPECTRUM, E_STAR, LennardJones104(4 * WORK, LENGTH))
    for name in ("persson_tosatti", "pastewka_robbins", "dmt_tension", "bearing_area"):
        assert getattr(deeper, name) == pytest.approx(4 * getattr(found, name), rel=1e-6), name
    assert set(found.to_dataset().data_vars) == set(found.quantities())
    # Outside a wall the length of a Tabor parameter is the range of the attraction.
    walled = stickiness(SPECTRUM, E_STAR, Dugdale(WORK, 3e-10)).tabor_number
    radius = 2 / SPECTRUM.rms_laplacian
    assert walled == pytest.approx(references.tabor_parameter(radius, E_STAR, WORK, 3e-10), rel=1e-12)
    with pytest.raises(ValueError, match="does not attract"):
        stickiness(SPECTRUM, E_STAR, HardWall(0.0, 0.0))
