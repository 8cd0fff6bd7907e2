"""A tabulated spectrum against the self-affine one that it is a table of."""

import doctest

import numpy as np
import pytest

from contact_study.physics.roughness import spectrum as tabulated_spectrum
from contact_study.physics.roughness.spectrum import SelfAffineSpectrum, TabulatedSpectrum

TARGET = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
CORNERS = np.array([6e7, 1.8e8, 7.2e8])


@pytest.fixture(scope="module")
def table():
    return TabulatedSpectrum(CORNERS, TARGET.density(CORNERS))


@pytest.mark.parametrize("order", [-1.0, 1, 2.6, 3, 5])  # 2.6 makes the second integrand 1/q
def test_three_corners_have_every_moment_of_the_target(table, order):
    upper = np.array([5e7, 6e7, 1e8, 1.8e8, 3e8, 7.2e8, 1e9])
    np.testing.assert_allclose(table.moment(order, upper=upper), TARGET.moment(order, upper=upper), rtol=1e-12)
    np.testing.assert_allclose(table.moment(order, lower=1e8), TARGET.moment(order, lower=1e8), rtol=1e-12)
    assert np.shape(table.moment(order)) == ()


def test_weights_density_and_limits_are_those_of_the_target(table):
    upper = np.array([1e8, 7.2e8])
    for power in (0, 1, 2):
        found = table.weighted_variance(lambda q, n=power: q**n, upper)
        np.testing.assert_allclose(found, TARGET.weighted_variance(lambda q, n=power: q**n, upper), rtol=1e-9)
    q = np.array([5e7, 6e7, 4e8, 8e8])
    np.testing.assert_allclose(table.density_at(q), TARGET.density(q), rtol=1e-12)
    assert table.limits == TARGET.limits
    edges = table.band_edges(7)
    assert (edges[0], edges[-1], edges.size) == (*table.limits, 8)
    assert table.rms_slope == pytest.approx(TARGET.rms_slope, rel=1e-12)


@pytest.mark.parametrize(
    ("wavevectors", "density", "said"),
    [
        ([1.0], [1.0], "wavevectors"),
        ([2.0, 1.0], [1.0, 1.0], "rise"),
        ([1.0, 2.0], [1.0, -1.0], "density"),
        ([1.0, 2.0], [1.0, np.nan], "density"),
        ([1.0, 2.0], [1.0, 1.0, 1.0], "one each"),
        ("spectrum.txt", [1.0, 1.0], "wavevectors"),
    ],
)
def test_what_is_no_table_is_named(wavevectors, density, said):
    with pytest.raises(ValueError, match=said):
        TabulatedSpectrum(wavevectors, density)


def test_example():
    found = doctest.testmod(tabulated_spectrum)
    assert found.attempted > 0
    assert found.failed == 0
