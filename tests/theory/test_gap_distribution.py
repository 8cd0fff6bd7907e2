"""P(u) without adhesion and the DMT-like limit: what they conserve, and their limits."""

import numpy as np
import pytest
from scipy.special import erf

from contact_study.physics.laws import Dugdale
from tests.theory.test_criteria import E_STAR, SPECTRUM
from theory import dmt_limit, gap_distribution
from theory.non_adhesive import closed_forms
from theory.non_adhesive.gap_distribution import attracted_at_light_load


@pytest.fixture(scope="module", params=[True, False], ids=["regularised", "original"])
def found(request):
    return gap_distribution(SPECTRUM, E_STAR, 1e9, regularised=request.param)


def moment(found, power):
    edges = np.linspace(0, 2e-8, 40001)
    middle = 0.5 * (edges[1:] + edges[:-1])
    return np.sum(found.density(edges) * middle**power) * (edges[1] - edges[0])


def test_area_and_mean_gap_are_those_of_the_theory(found):
    variance = SPECTRUM.full_contact_stress_variance(lambda q: 0.5 * E_STAR * q)
    assert found.relative_contact_area == pytest.approx(erf(1e9 / np.sqrt(2 * variance)), rel=1e-12)
    assert found.fraction_below(0.0) == pytest.approx(found.relative_contact_area, rel=1e-12)
    assert found.fraction_below(1.0) == pytest.approx(1, rel=1e-12)
    assert moment(found, 0) == pytest.approx(1 - found.relative_contact_area, rel=1e-9)
    # 100 bands against 1000: second order.
    assert found.mean_gap == pytest.approx(float(closed_forms.mean_gap(1e9, SPECTRUM, E_STAR)), rel=1e-4)
    # Each part is a folded Gaussian: its second moment is that of one that is not, its mean is larger.
    assert moment(found, 2) == pytest.approx(found.shares @ (found.centres**2 + found.widths**2), rel=1e-6)
    plain = gap_distribution(SPECTRUM, E_STAR, 1e9, regularised=False)
    if found.widths[0] != plain.widths[0]:
        np.testing.assert_allclose(found.widths**-2, plain.widths**-2 + plain.centres**-2, rtol=1e-9)
    assert moment(found, 1) > found.mean_gap


def test_under_light_load_the_gaps_are_the_heights_and_the_spread_of_their_centres():
    found = gap_distribution(SPECTRUM, E_STAR, 1e-6 * E_STAR, regularised=False)
    mean, square = moment(found, 1), moment(found, 2)
    assert mean == pytest.approx(found.mean_gap, rel=1e-3)
    # All but a few parts come off where all roughness is still to come, at ū = u₀ ln(p₀A/p): u₁ = ū + u₀, and ln A of
    # an area that falls evenly from one to zero has the variance one.
    decay, _ = closed_forms.low_pressure_asymptote(SPECTRUM, E_STAR)
    assert np.sqrt(square - mean**2) == pytest.approx(np.hypot(1e-9, decay), rel=2e-3)  # 50 parts: 4e-4


def test_attracted_area_follows_the_pressure_down_to_the_limit_of_light_load():
    limit = attracted_at_light_load(SPECTRUM, E_STAR, 2e-10)
    over_pressure = []
    for pressure in (1e-3 * E_STAR, 1e-5 * E_STAR, 1e-7 * E_STAR):
        found = gap_distribution(SPECTRUM, E_STAR, pressure, regularised=False)
        over_pressure.append((found.fraction_below(2e-10) - found.relative_contact_area) / pressure)
    # Parts elsewhere: 50 and 100 of them, each within half a per cent of many.
    assert over_pressure[-1] == pytest.approx(limit, rel=0.01)
    assert over_pressure[0] < 0.9 * over_pressure[1] < over_pressure[2]


def test_pressed_flat_there_is_no_gap_and_next_to_it_no_nonsense():
    nearly = gap_distribution(SPECTRUM, E_STAR, E_STAR)
    assert dmt_limit(nearly, Dugdale(0.1, 2e-10)) == pytest.approx(E_STAR, rel=1e-9)
    for pressure, words in ((10 * E_STAR, "presses the roughness flat"), (0.0, "pressure"), (np.nan, "pressure")):
        with pytest.raises(ValueError, match=words):
            gap_distribution(SPECTRUM, E_STAR, pressure)


def test_dmt_limit_sums_the_traction_of_the_bare_gaps(found):
    # The end of the range lies inside one of 4000 bins; one beyond all gaps pulls everywhere but in contact.
    for reach, accuracy in ((2e-10, 2e-2), (1e-9, 2e-2), (1e-6, 1e-6)):
        law = Dugdale(0.1, reach)
        pulled = law.peak_tensile_stress * (found.fraction_below(reach) - found.relative_contact_area)
        assert 1e9 - dmt_limit(found, law) == pytest.approx(pulled, rel=accuracy)


def test_its_dataset_holds_the_whole_area_with_the_contact_in_the_first_bin(found):
    dataset = found.to_dataset()
    width = float(dataset.gap_bin[1] - dataset.gap_bin[0])
    shares = dataset.gap_pdf.values * width
    assert shares.sum() == pytest.approx(1, rel=1e-8)  # a billionth is left out
    assert shares[0] == pytest.approx(float(found.fraction_below(width)), rel=1e-9)
    assert shares[5] == pytest.approx(width * float(found.density(width * np.array([5.0, 6.0]))[0]), rel=1e-9)
    assert (dataset.theory, float(dataset.mean_gap)) == ("almqvist", found.mean_gap)
    assert float(dataset.relative_contact_area) == found.relative_contact_area
    with pytest.raises(ValueError, match="gap_edges: must be rising"):
        found.to_dataset(np.array([1.0, 0.0]))
