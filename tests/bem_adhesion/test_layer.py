"""Contact of a layer of finite thickness: both solvers, both controls, limits of thickness with a known answer."""

import numpy as np
import pytest
from scipy.optimize import brentq

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.hard_wall.contact import HardWallContact
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import LennardJones93
from contact_study.physics.solids import HalfSpace, Layer, Tabulated
from tests.bem_adhesion.paper_system import E_STAR, R0, law, surface, touching
from tests.bem_adhesion.rough_surfaces import self_affine


def pressed(height, grid, solid, mean_pressure):
    """Against a hard wall, from no contact."""
    contact = HardWallContact(height, grid, solid)
    return contact.step(contact.separated(), mean_pressure)


def paraboloid(points, size, radius):
    grid = Grid((points, points), (size, size))
    x = grid.coordinates[0] - size / 2
    return -(x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius), grid


def test_thick_layers_are_half_spaces():
    """The difference is that of the stiffness at the longest wave, (qd)² e^(−2qd)."""
    height, grid = self_affine(64, 16)
    half_space = pressed(height, grid, HalfSpace(2.0), 0.05).pressure
    differences = []
    for thickness in np.array([0.5, 1.0, 3.0]) * grid.size[0]:
        pressure = pressed(height, grid, Layer(2.0, 0.3, thickness), 0.05).pressure
        differences.append(np.abs(pressure - half_space).max() / half_space.max())
    assert differences[0] > 1e-3
    assert differences[0] / differences[1] > 0.1 * np.exp(2 * np.pi)
    assert differences[2] < 1e-8


def sphere_on_thin_layers(layers, force_of, peak_of):
    """Relative errors of contact radius, peak pressure and approach of the base, on ever thinner layers."""
    size, radius, wanted = 1.0, 100.0, 0.25
    height, grid = paraboloid(256, size, radius)
    errors = []
    for layer in layers:
        found = pressed(height, grid, layer, force_of(layer, radius, wanted) / size**2)
        assert found.converged
        reached = np.sqrt(np.mean(found.pressure > 0) * size**2 / np.pi)
        # Displacement is that of the layer's surface; the base has moved on by the compression.
        base = found.displacement.mean() - layer.compression(found.pressure.mean())
        approach = (height.max() - base) / (wanted**2 / (2 * radius))
        errors.append([reached / wanted, found.pressure.max() / peak_of(layer, radius, wanted), approach])
    return np.array(errors).T - 1


def test_sphere_on_thin_compressible_layers():
    """A bed of springs k: force π k a⁴/(4R), pressure k (a² − r²)/2R, approach a²/2R.

    K is k to second order in qd, and so are pressure and approach; of the edge a width d is not a spring's.
    """

    def force(layer, radius, contact_radius):
        return np.pi * contact_radius**4 / (4 * radius * layer.mean_compliance)

    def peak(layer, radius, contact_radius):
        return contact_radius**2 / (2 * radius * layer.mean_compliance)

    layers = [Layer(1.0, 0.2, thickness) for thickness in (0.02, 0.01)]
    reached, pressure, approach = sphere_on_thin_layers(layers, force, peak)
    assert np.all(np.abs(reached) < [0.02, 0.012])  # of order d/a = 0.08, 0.04, and half a point of 64
    assert pressure[0] / pressure[1] == pytest.approx(4, rel=0.1)
    assert approach[0] / approach[1] == pytest.approx(4, rel=0.1)
    assert abs(pressure[1]) < 1e-3
    assert abs(approach[1]) < 1e-3


def test_sphere_on_thin_incompressible_layers():
    """The flow along the layer, −∇²p = 3μ/d³ (a²/4R − r²/2R) with p = p' = 0 at the edge.

    Hence the pressure 3μ (a² − r²)²/(32 R d³), which falls smoothly to zero, and the force π μ a⁶/(32 R d³).
    """
    shear_modulus = 0.25

    def force(layer, radius, contact_radius):
        return np.pi * shear_modulus * contact_radius**6 / (32 * radius * layer.thickness**3)

    def peak(layer, radius, contact_radius):
        return 3 * shear_modulus * contact_radius**4 / (32 * radius * layer.thickness**3)

    layers = [Layer(4 * shear_modulus, 0.5, thickness) for thickness in (0.02, 0.01)]
    reached, pressure, _ = sphere_on_thin_layers(layers, force, peak)
    # The edge is shifted by a share of the thickness, which a half-space's corner of width d sets.
    assert reached[0] / reached[1] == pytest.approx(2, rel=0.1)
    assert abs(reached[1]) < 0.07
    assert pressure[0] / pressure[1] == pytest.approx(4, rel=0.05)
    assert abs(pressure[1]) < 0.02


@pytest.mark.parametrize("fraction", [-0.5, 0.5])
def test_uniform_compression_is_no_part_of_the_gap(fraction):
    """Flat on flat: the layer shortens, the gap is the law's, whatever holds it."""
    the_law = LennardJones93(0.5, 1e-9)
    grid = Grid((8, 8), (2e-9, 2e-9))
    layer = Layer(5e9, 0.2, 3e-9)
    contact = AdhesiveContact(np.zeros(grid.shape), grid, layer, the_law)
    pressure = fraction * the_law.peak_tensile_stress
    found = contact.step(touching(contact), pressure)
    expected = brentq(
        lambda gap: float(the_law.traction(np.array(gap))) + pressure, 0.7e-9, the_law.peak_distance, xtol=1e-20
    )
    np.testing.assert_allclose(found.gap, expected, rtol=1e-6)
    assert found.elastic_energy == pytest.approx(0.5 * layer.mean_compliance * pressure**2, rel=1e-6)


def test_a_table_of_a_half_space_is_that_half_space():
    rough = surface(48)
    height, solid = rough.heights(rough.shape), HalfSpace(E_STAR)
    table = Tabulated(E_STAR, rough.grid, solid.stiffness_on(rough.grid))
    for tabulated, plain in (
        [pressed(height, rough.grid, one, 2e9) for one in (table, solid)],
        [(c := AdhesiveContact(height, rough.grid, one, law())).step(c.separated(), 2e9) for one in (table, solid)],
    ):
        np.testing.assert_allclose(tabulated.gap, plain.gap, atol=1e-9 * R0)


def test_a_table_of_the_grids_waves_does_without_squares():
    """Parts of the grid have other waves; on 256² points and more a closed form is relaxed on them."""
    rough = surface(256)
    height, solid = rough.heights(rough.shape), HalfSpace(E_STAR)
    table = Tabulated(E_STAR, rough.grid, solid.stiffness_on(rough.grid))
    whole, plain = (AdhesiveContact(height, rough.grid, one, law(4.0)) for one in (table, solid))
    assert plain.levels.finest.corrector is not None
    assert whole.levels.finest.corrector is None
    found = [contact.step(contact.separated(), 2e9) for contact in (whole, plain)]
    # Residuals of 1e-8 E* over the softest stiffness, about 1e-3 E*/r0 close to a fold.
    np.testing.assert_allclose(found[0].gap, found[1].gap, atol=1e-3 * R0)
