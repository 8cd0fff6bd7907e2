import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from md_reference.interface.substrate import Substrate, sample_substrate
from tests.md_reference.systems import rough_coefficients, sample

SIZE = (48e-10, 80e-10)
SURFACE = rough_coefficients(modes=4, rms=1e-10)


def exact(y, x):
    """The trigonometric polynomial itself at scattered points."""
    side = SURFACE.shape[0]
    m_y = np.fft.fftfreq(side, 1 / side)[:, None]
    m_x = np.arange(SURFACE.shape[1])[None, :]
    weight = np.where(m_x > 0, 2.0, 1.0) * SURFACE
    phase = 2 * np.pi * (np.multiply.outer(y, m_y) / SIZE[0] + np.multiply.outer(x, m_x) / SIZE[1])
    return np.real(np.sum(weight * np.exp(1j * phase), axis=(-2, -1)))


def test_height_between_sites_is_exact_to_fourth_order():
    rng = np.random.default_rng(3)
    y, x = rng.uniform(-2, 3, (2, 500)) * np.array(SIZE)[:, None]
    errors = []
    for sites in ((40, 60), (80, 120), (160, 240)):
        substrate = Substrate(sample(SURFACE, sites), (SIZE[0] / sites[0], SIZE[1] / sites[1]))
        errors.append(np.abs(substrate.height_at(y, x) - exact(y, x)).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all((rates > 3.7) & (rates < 4.3))
    assert errors[-1] < 1e-15  # 1e-5 Å


def test_samples_are_refined_until_the_height_is_as_exact_as_asked():
    sites = (16, 16)
    coarse = sample_substrate(lambda shape: sample(SURFACE, shape), SIZE, sites, np.inf)
    fine = sample_substrate(lambda shape: sample(SURFACE, shape), SIZE, sites, 1e-14)
    y, x = np.random.default_rng(4).uniform(0, 1, (2, 500)) * np.array(SIZE)[:, None]
    assert (coarse.refinement, fine.refinement) == (1, 4)
    np.testing.assert_allclose(fine.heights, coarse.heights, atol=1e-24)
    assert np.abs(fine.height_at(y, x) - exact(y, x)).max() < 0.01 * np.abs(coarse.height_at(y, x) - exact(y, x)).max()


@settings(max_examples=50)
@given(st.floats(-1, 1), st.floats(-1, 1), st.integers(-3, 3), st.integers(-3, 3))
def test_height_is_periodic(y, x, rows, columns):
    substrate = Substrate(sample(SURFACE, (20, 30)), (SIZE[0] / 20, SIZE[1] / 30))
    y, x = np.array([y * SIZE[0]]), np.array([x * SIZE[1]])
    moved = substrate.height_at(y + rows * SIZE[0], x + columns * SIZE[1])
    # Slopes are of order one, and a position of several periods is rounded to 1e-24 m.
    np.testing.assert_allclose(moved, substrate.height_at(y, x), atol=1e-23)


def test_skip_map_is_the_maximum_over_the_periodic_neighbourhood():
    heights = np.random.default_rng(5).standard_normal((7, 5))
    reach = (2, 4)  # wider than half of the second axis
    found = Substrate(heights, (1.0, 1.0)).highest_within(reach)
    for j in range(7):
        for i in range(5):
            rows = np.arange(j - reach[0], j + reach[0] + 1) % 7
            columns = np.arange(i - reach[1], i + reach[1] + 1) % 5
            assert found[j, i] == heights[np.ix_(rows, columns)].max()
