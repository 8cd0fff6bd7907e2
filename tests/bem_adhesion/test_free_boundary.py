"""Free boundaries: the padded convolution against direct sums, spheres against closed forms, both controls."""

import re

import numpy as np
import pytest
from scipy.signal import convolve2d

import contact_study
from bem_adhesion import Exponential, HardWall, LennardJones104, Repulsive, rough_contact
from contact_study.numerics.grid import Grid
from tests.bem_adhesion.paper_system import approach_of, stepped
from tests.bem_adhesion.test_studies import FREE

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")


def displacement_by_sums(pressure, grid):
    """Σ over cells of a cell's displacement on E* = 1, each by Love's logarithms in their usual form, no transform."""
    y, x = ((np.arange(2 * n) - n + 0.5) * step for n, step in zip(grid.shape, grid.spacing, strict=True))
    v, u = np.meshgrid(y, x, indexing="ij")
    corner = v * np.log(u + np.hypot(u, v)) + u * np.log(v + np.hypot(u, v))
    return convolve2d(np.diff(np.diff(corner, axis=0), axis=1), pressure, "valid") / np.pi


LAWS = HardWall(), Exponential(0.02, 0.01), LennardJones104(0.02, 0.02), Repulsive(0.0, 0.02, 0.02)


@pytest.mark.parametrize("control", ["pressure", "approach"])
@pytest.mark.parametrize(("law", "hardness"), [*((law, None) for law in LAWS), (HardWall(), 0.8)])
def test_states_satisfy_the_equations_of_a_free_half_space(law, hardness, control):
    rng = np.random.default_rng(1)
    grid = Grid((11, 16), (0.9, 1.6))
    y, x = grid.coordinates
    height = 0.1 * rng.standard_normal(grid.shape) - 0.5 * ((y[:, None] - 0.4) ** 2 + (x[None, :] - 0.7) ** 2) + 3.0
    contact = rough_contact(height, grid.size, 1.0, law, control, boundary="free", hardness=hardness)
    loads = (0.02, 0.3, 0.08 if control == "pressure" else 0.05)
    for load, found in zip(loads, stepped(contact, loads), strict=True):
        assert found.converged
        assert found.gap.shape == found.pressure.shape == grid.shape
        surface = found.plane + displacement_by_sums(found.pressure, grid)
        np.testing.assert_allclose(surface, found.displacement, atol=1e-7)  # 1e-8 of stress on a cell of 0.1
        # Rounding; of a wall what its tolerance leaves of gaps where surfaces touch.
        rigid = height if hardness is None else height - found.plastic_indentation
        np.testing.assert_allclose(found.displacement - rigid, found.gap, atol=max(1e-12, 1e-10 * height.std()))
        if control == "pressure":
            assert found.pressure.mean() == pytest.approx(load, abs=1e-7)
        else:
            assert approach_of(found, height, None, law) == pytest.approx(load, rel=1e-6)
        if law.has_wall:
            assert np.all(found.gap >= 0)
            reaction = found.pressure + law.traction(found.gap)
            assert reaction.min() > -2e-8
            np.testing.assert_allclose(reaction[found.gap > 1e-9], 0, atol=1e-12)
        else:
            np.testing.assert_allclose(found.pressure, -law.traction(found.gap), atol=1e-10)
        if hardness is not None:
            assert found.pressure.max() <= hardness * (1 + 1e-14)
            assert load < 0.1 or np.any(rigid < height)
        work = 0.5 * np.mean(found.pressure * displacement_by_sums(found.pressure, grid))
        assert found.elastic_energy == pytest.approx(work, rel=1e-5)
        assert found.interaction_energy == pytest.approx(law.potential(found.gap).mean(), rel=1e-10, abs=1e-15)


def punch(points, rms=0.0, **options):
    """A square of sides one, flat but for so much."""
    height = 0.3 + rms * np.random.default_rng(0).standard_normal((points, points))
    return rough_contact(height, 1.0, 1.0, HardWall(), boundary="free", **options)


def test_a_flat_square_punch():
    """Its force over E* times approach and side is π times its capacitance over 4πε₀, 0.36679."""
    found = []
    for points in (32, 64):
        contact, lowered = punch(points), punch(points, control="approach")
        pressed = contact.step(contact.separated(), 0.01)
        approach = 0.3 - pressed.plane
        found.append(0.01 / approach)
        assert contact.stiffness(pressed) == pytest.approx(found[-1], rel=1e-6)
        same, lifted = stepped(lowered, [approach, -0.1])
        assert same.pressure.mean() == pytest.approx(0.01, rel=1e-9)
        np.testing.assert_allclose(lifted.gap, 0.1)
    # First order in the spacing: pressures go to infinity at the rim.
    assert 2 * found[1] - found[0] == pytest.approx(0.36679 * np.pi, rel=3e-4)


@pytest.mark.parametrize("hardness", [None, 0.02])
@pytest.mark.parametrize("rms", [1e-6, 1e-13, 1e-16])
def test_a_punch_that_is_nearly_flat(rms, hardness):
    contact, flat = punch(32, rms, hardness=hardness), punch(32, hardness=hardness)
    for load in (1e-8, 0.01):
        found, expected = (each.step(each.separated(), load) for each in (contact, flat))
        assert found.converged
        assert found.pressure.mean() == pytest.approx(load, rel=1e-12)
        if load > 1e4 * rms:
            np.testing.assert_allclose(found.pressure, expected.pressure, rtol=2e4 * rms / load + 1e-6)


def table(**sections):
    return {**FREE, "loading": {"path": ["20 MPa", "-5 MPa"]}, **sections}


@pytest.mark.parametrize("interaction", [{"law": "hard_wall"}, FREE["interaction"]], ids=["wall", "exponential"])
def test_contact_at_the_rim_is_said(interaction):
    pressed = table(interaction=interaction, loading={"path": ["200 MPa", "210 MPa", "20 MPa"]})
    with pytest.warns(UserWarning, match="at 200 MPa contact reaches the rim") as said:
        contact_study.run(pressed, "continuum")
    assert len(said) == 1, "once, and no word of the tension beside it"
    # Without a word: a flat punch, which has no surface beyond its rim.
    flat = {"surface": {"heights": np.zeros((64, 64)), "size": "20 nm"}, "loading": {"path": ["20 MPa"]}}
    found = contact_study.run(table(interaction=interaction, **flat), "continuum").isel(step=0)
    assert found.relative_contact_area == found.converged == found.cluster_count == 1


def test_tension_at_the_rim_is_said():
    """A stiff sphere that comes no nearer than where an exponential of 0.5 nm pulls at its rim with some shares."""
    # At the middle of the two nearer sides the sphere is so far below its tip.
    below_tip, stiff = (20e-9 * 15 / 32) ** 2 / 100e-9, {"youngs_modulus": 1e12, "poissons_ratio": 0.3}
    # The block is stretched by 2e-4 of the law's length, by a tenth of 0.1 GPa over 10 nm of 1 TPa.
    path = [float(below_tip + 0.5e-9 * np.log(share)) for share in (0.009, 0.011, 0.012)]
    contact_study.run(table(material=stiff, loading={"path": path[:1], "control": "approach"}), "continuum")
    with pytest.warns(UserWarning, match="the law pulls at the rim") as said:
        contact_study.run(table(material=stiff, loading={"path": path, "control": "approach"}), "continuum")
    (warning,) = said
    # Where the gap has grown by less than ln 1.1 of the law's length, 2.2 nm about the middle of the two nearer sides:
    # 14 of 124 points.
    words = r"at approach -1\.\d+e-09 m the law pulls at the rim .*, at 11 % of its points .* 1\.1 % of its peak"
    assert re.search(words, str(warning.message)), warning.message
