"""Stiffness of a wave: closed forms against the equations of elasticity, their limits and their units."""

import re

import numpy as np
import pytest
from scipy.linalg import expm

from contact_study.fields import fourier
from contact_study.fields.grid import Grid
from contact_study.problem.elasticity import HalfSpace, Layer, Tabulated, contact_modulus_of, elasticity_of
from contact_study.problem.errors import InputError
from contact_study.problem.study import make_study
from contact_study.problem.surface import realise
from contact_study.problem.surface_scales import scales_of

RATIOS = [-0.3, 0.0, 0.3, 0.42, 0.4999, 0.5]


def through_the_thickness(wavenumber, shear_modulus, ratio, thickness):
    """K of a bonded layer by integrating the equations of elasticity from base to surface.

    With u_x = U sin qx, u_z = W cos qx, σ_xz = T sin qx, σ_zz = S cos qx, Hooke's law and equilibrium give a linear
    system in (U, W, T, S) of constant coefficients, finite for ν = 1/2 too.
    """
    q, mu = wavenumber, shear_modulus
    share = ratio / (1 - ratio)
    system = np.array(
        [
            [0, q, 1 / mu, 0],
            [-share * q, 0, 0, (1 - 2 * ratio) / (2 * mu * (1 - ratio))],
            [2 * mu * q**2 / (1 - ratio), 0, 0, share * q],
            [0, 0, -q, 0],
        ]
    )
    propagated = expm(system * thickness)
    # The base is held: only T and S there are free. At the surface T = 0, S = 1.
    at_base = np.linalg.solve(propagated[2:, 2:], [0.0, 1.0])
    return 1 / (propagated[1, 2:] @ at_base)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("thickness_in_waves", [0.01, 0.1, 0.49, 0.51, 1.0, 2.0, 5.0])
def test_layer_solves_the_equations_of_elasticity(ratio, thickness_in_waves):
    shear_modulus, thickness = 3.0, 0.7
    layer = Layer(2 * shear_modulus / (1 - ratio), ratio, thickness)
    wavenumber = thickness_in_waves / thickness
    expected = through_the_thickness(wavenumber, shear_modulus, ratio, thickness)
    # Two growing and two decaying exponentials: integration loses e^(2qd) of rounding, thin layers (qd)³.
    lost = max(np.exp(2 * thickness_in_waves), thickness_in_waves**-3)
    assert layer.stiffness(wavenumber) == pytest.approx(expected, rel=1e-14 * lost)


@pytest.mark.parametrize("ratio", RATIOS)
def test_thick_layers_are_half_spaces(ratio):
    """The base is felt by what decays to it and back, (qd)² e^(−2qd)."""
    wavenumber = np.array([5.0, 10.0, 17.0, 300.0])
    relative = Layer(2.0, ratio, 1.0).stiffness(wavenumber) / HalfSpace(2.0).stiffness(wavenumber) - 1
    x = wavenumber
    rest = (4 * x**2 + 4 * x + 10 - 24 * ratio + 16 * ratio**2) / (3 - 4 * ratio) * np.exp(-2 * x)
    np.testing.assert_allclose(relative[:3], rest[:3], rtol=2 * rest[0], atol=1e-15)  # its square comes next
    assert relative[3] == 0


@pytest.mark.parametrize("ratio", [-0.3, 0.0, 0.3, 0.42])
def test_thin_compressible_layers_are_a_bed_of_springs(ratio):
    modulus, thickness = 5.0, 2e-3
    layer = Layer(modulus / (1 - ratio**2), ratio, thickness)
    springs = (1 - ratio) * modulus / ((1 + ratio) * (1 - 2 * ratio) * thickness)
    assert layer.mean_compliance * springs == pytest.approx(1, rel=1e-14)
    error = layer.stiffness(np.array([1.0, 2.0]) / thickness * 1e-2) / springs - 1
    # Of second order in qd, whose coefficient is proportional to ν.
    assert error[1] / error[0] == pytest.approx(4 if ratio else 16, rel=1e-2)
    assert abs(error[0]) < 1e-2


def test_thin_incompressible_layers_resist_flow_along_them():
    """K = 3 μ/(q² d³): pressure drives Poiseuille's flow of displacement between base and surface."""
    shear_modulus, thickness = 3.0, 0.5
    layer = Layer(4 * shear_modulus, 0.5, thickness)
    wavenumber = np.array([1e-6, 1e-2, 2e-2]) / thickness
    error = layer.stiffness(wavenumber) * wavenumber**2 * thickness**3 / (3 * shear_modulus) - 1
    assert abs(error[0]) < 1e-11
    assert error[2] / error[1] == pytest.approx(4, rel=1e-2)
    assert layer.mean_compliance == 0


def test_nearly_incompressible_layers_tend_to_incompressible_ones():
    wavenumber = np.array([0.3, 1.0, 3.0])
    limit = Layer(4.0, 0.5, 1.0).stiffness(wavenumber)
    errors = [np.abs(Layer(4.0, 0.5 - e, 1.0).stiffness(wavenumber) / limit - 1).max() for e in (2e-6, 1e-6)]
    assert errors[0] / errors[1] == pytest.approx(2, rel=1e-2)


@pytest.mark.parametrize("solid", [HalfSpace(3.0), Layer(3.0, 0.3, 0.2)])
def test_units_change_nothing(solid):
    wavenumber, length, stress = np.array([0.5, 3.0, 40.0]), 1e-9, 1e9
    scaled = solid.scaled(length, stress)
    np.testing.assert_allclose(
        scaled.stiffness(wavenumber * length) * stress / length, solid.stiffness(wavenumber), rtol=1e-14
    )
    assert scaled.mean_compliance * length / stress == pytest.approx(solid.mean_compliance, rel=1e-14)


def test_stiffness_on_a_grid_is_that_of_each_wave_and_none_of_the_mean():
    grid = Grid((6, 9), (2.0, 3.0))
    layer = Layer(3.0, 0.3, 0.2)
    stiffness_q = layer.stiffness_on(grid)
    assert stiffness_q.shape == grid.spectrum_shape
    assert stiffness_q[0, 0] == 0
    assert stiffness_q[5, 2] == pytest.approx(layer.stiffness(2 * np.pi * np.hypot(1 / 2, 2 / 3)), rel=1e-14)
    assert contact_modulus_of(HalfSpace(7.0).stiffness(3.0), 3.0) == pytest.approx(7.0)


def test_a_number_is_the_contact_modulus_of_a_half_space():
    assert elasticity_of(2.5) == HalfSpace(2.5)
    layer = Layer(1.0, 0.5, 1.0)
    assert elasticity_of(layer) is layer


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((0.0, 0.3, 1.0), "contact_modulus"),
        ((np.nan, 0.3, 1.0), "contact_modulus"),
        ((1.0, 0.51, 1.0), "poissons_ratio"),
        ((1.0, -1.0, 1.0), "poissons_ratio"),
        ((1.0, 0.3, 0.0), "thickness"),
        ((1.0, 0.3, np.inf), "thickness"),
    ],
)
def test_impossible_layers_are_named(arguments, name):
    with pytest.raises(ValueError, match=name):
        Layer(*arguments)


def direction_dependent(shape=(12, 10), size=(3.0, 2.0)):
    """A lattice-like K that depends on direction, and every entry on its own wavevector."""
    grid = Grid(shape, size)
    q_y, q_x = grid.wavevectors
    stiffness_q = 0.5 * 4.0 * grid.wavenumber * (1 - 1e-3 * q_x**2 - 2e-3 * q_y**2 - 1e-3 * q_x * q_y)
    return grid, Tabulated(4.0, grid, stiffness_q)


def test_a_table_gives_each_wave_its_own_stiffness():
    grid, solid = direction_dependent()
    stiffness_q = solid.stiffness_on(grid)
    np.testing.assert_array_equal(stiffness_q.ravel()[1:], solid.table.ravel()[1:])
    assert stiffness_q[0, 0] == 0
    coarse = grid.with_shape((6, 5))
    q_y, q_x = coarse.wavevectors
    expected = 2.0 * coarse.wavenumber * (1 - 1e-3 * q_x**2 - 2e-3 * q_y**2 - 1e-3 * q_x * q_y)
    np.testing.assert_allclose(solid.stiffness_on(coarse), expected, rtol=1e-14)
    scaled = solid.scaled(1e-9, 5.0)
    in_units = scaled.stiffness_on(Grid(grid.shape, (3e9, 2e9)))
    np.testing.assert_allclose(in_units * 5.0 / 1e-9, stiffness_q, rtol=1e-14)


def test_theories_see_the_mean_over_directions():
    grid = Grid((64, 64), (1.0, 1.0))
    with np.errstate(invalid="ignore"):
        cosine = (grid.wavevectors[1] / grid.wavenumber) ** 2
    isotropic = 3.0 * grid.wavenumber
    solid = Tabulated(6.0, grid, isotropic * (1 + 0.2 * cosine))
    wavenumber = 2 * np.pi * np.array([8.0, 16.0, 30.0])
    # <cos²> = 1/2, to what the points on a ring of finite width are uneven.
    np.testing.assert_allclose(solid.stiffness(wavenumber), 3.3 * wavenumber, rtol=5e-3)
    # A half-space in the table is a half-space.
    plain = Tabulated(6.0, grid, isotropic)
    np.testing.assert_allclose(plain.stiffness(wavenumber * 0.77), 3.0 * wavenumber * 0.77, rtol=1e-13)


def test_impossible_tables_are_named():
    grid, solid = direction_dependent()
    with pytest.raises(ValueError, match="table has shape"):
        Tabulated(4.0, grid, solid.table[1:])
    for wrong in (0.0, np.nan):
        table = solid.table.copy()
        table[3, 2] = wrong
        with pytest.raises(ValueError, match="positive and finite"):
            Tabulated(4.0, grid, table)
    for other in (Grid((13, 10), grid.size), Grid((12, 12), grid.size), Grid(grid.shape, (3.0, 2.1))):
        with pytest.raises(ValueError, match="other waves"):
            solid.stiffness_on(other)


def layered(**sections):
    """A small study of a layer; ``sections`` replaces keys."""
    table = {
        "surface": {"kind": "self_affine", "size": 1e-7, "shape": [48, 48], "rms_height": 5e-10, "cutoff_mode": 8},
        "material": {"youngs_modulus": "2 GPa", "poissons_ratio": 0.3},
        "elasticity": {"kind": "layer", "thickness": "20 nm"},
        "interaction": {"work_of_adhesion": 0.05, "length": "0.4 nm"},
        "loading": {"path": ["20 MPa"]},
    }
    return {**table, **{name: {**table.get(name, {}), **keys} for name, keys in sections.items()}}


def test_a_study_names_its_solid():
    assert make_study(layered()).cases[0].solid == Layer(2e9 / (1 - 0.3**2), 0.3, 20e-9)
    plain = layered()
    del plain["elasticity"]
    assert make_study(plain).cases[0].solid == HalfSpace(2e9 / (1 - 0.3**2))
    swept = {**layered(), "sweep": {"elasticity.thickness": ["10 nm", "20 nm"]}}
    assert [case.solid.thickness for case in make_study(swept).cases] == pytest.approx([1e-8, 2e-8])


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ({"kind": "half_space", "thickness": "20 nm"}, 'elasticity.thickness: kind = "half_space" has no such key'),
        ({"thickness": "20 nm"}, 'elasticity.thickness: kind = "half_space" has no such key'),
        ({"kind": "layer"}, "missing key elasticity.thickness"),
        ({"kind": "layer", "thickness": 0}, "elasticity.thickness = 0: must be positive"),
        ({"kind": "slab"}, "elasticity.kind = 'slab'"),
    ],
)
def test_impossible_solids_end_in_one_line(section, words):
    with pytest.raises(InputError, match=re.escape(words)):
        make_study({**layered(), "elasticity": section})


SURFACES = {
    "self_affine": {},
    "wavy": {"amplitude": 1e-9, "modes": [2, 3]},
    "sphere": {"radius": 3e-7},
    "flat": {},
}


@pytest.mark.parametrize("elasticity", [{"kind": "half_space"}, {"kind": "layer", "thickness": "3 nm"}])
@pytest.mark.parametrize("kind", SURFACES)
def test_stress_of_full_contact_is_that_of_the_surface(kind, elasticity):
    """What the study alone says, against the waves of a realised surface; the sphere's edge needs many of them."""
    own = {"kind": kind, "size": [1e-7, 8e-8], "shape": [480, 384], **SURFACES[kind]}
    if kind == "self_affine":
        own |= {"rms_height": 5e-10, "cutoff_mode": 40, "roll_off_mode": 3, "seed": 2}
    material = {"youngs_modulus": "2 GPa", "poissons_ratio": 0.45}
    study = make_study({**layered(material=material), "surface": own, "elasticity": elasticity})
    case, surface = study.cases[0], realise(study.cases[0])
    scales = scales_of(study)[0]
    found = scales.full_contact_stress(case.solid)
    if isinstance(case.solid, HalfSpace):
        assert found == pytest.approx(0.5 * case.solid.contact_modulus * scales.rms_slope, rel=1e-12)
    power = surface.grid.multiplicity * np.abs(fourier.transform(surface.heights(surface.shape))) ** 2
    expected = np.sqrt(np.sum(case.solid.stiffness_on(surface.grid) ** 2 * power))
    # One sample of the ensemble; of the sphere waves beyond the grid are missing.
    assert found == pytest.approx(expected, rel={"self_affine": 0.1, "sphere": 0.01}.get(kind, 1e-9))


def test_stress_of_full_contact_with_a_height_map(tmp_path):
    grid = Grid((64, 48), (1e-7, 8e-8))
    heights = 1e-9 * np.random.default_rng(5).standard_normal(grid.shape)
    np.save(tmp_path / "map.npy", heights)
    own = {"kind": "file", "path": "map.npy", "size": list(grid.size)}
    study = make_study({**layered(), "surface": own}, tmp_path)
    solid = study.cases[0].solid
    power = grid.multiplicity * np.abs(fourier.transform(heights)) ** 2
    expected = np.sqrt(np.sum(solid.stiffness_on(grid) ** 2 * power))
    # Bands of an eighth of an octave, in which K is taken at one wavenumber.
    assert scales_of(study)[0].full_contact_stress(solid) == pytest.approx(expected, rel=2e-3)
