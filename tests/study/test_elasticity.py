import re

import numpy as np
import pytest
from scipy.linalg import expm, schur

from contact_study.inputs.errors import InputError
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import Layer, Layered, Measured, Tabulated, contact_modulus_of, elasticity_of
from contact_study.physics.solids.base import indentation_modulus, stiffnesses
from contact_study.study.case import realise
from contact_study.study.study import make_study


def integrated(q, layer, thickness, base=None):
    """K by integrating the equations of elasticity from a rigid base, or a half-space, to a surface without shear.

    With u_x = U sin qx, u_z = W cos qx, σ_xz = T sin qx, σ_zz = S cos qx, Hooke's law and equilibrium give a linear
    system in (U, W, T, S). Materials: C₁₁ − C₁₃²/C₃₃, C₁₃/C₃₃, 1/C₃₃ and 1/C₄₄, finite for ν = 1/2 too.
    """

    def system(plane, share, axial, shear):
        return np.array([[0, q, shear, 0], [-share * q, 0, 0, axial], [plane * q**2, 0, 0, share * q], [0, 0, -q, 0]])

    start = np.eye(4)[:, 2:]  # held
    if base is not None:  # what decays into the half-space
        _, vectors, count = schur(system(*base), sort=lambda value: value.real > 0)
        assert count == 2
        start = vectors[:, :2]
    at_surface = expm(system(*layer) * thickness) @ start
    return 1 / (at_surface[1] @ np.linalg.solve(at_surface[2:], [0.0, 1.0]))


def isotropic(modulus, ratio):
    shear = modulus * (1 - ratio) / 2
    return modulus, ratio / (1 - ratio), (1 - 2 * ratio) / (2 * shear * (1 - ratio)), 1 / shear


@pytest.mark.parametrize("ratio", [-0.3, 0.42, 0.5])
@pytest.mark.parametrize("thickness_in_waves", [0.01, 0.49, 0.51, 5.0])
def test_layers_solve_the_equations_of_elasticity(ratio, thickness_in_waves):
    modulus, thickness = 3.0, 0.7
    layer, q = Layer(modulus, ratio, thickness), thickness_in_waves / thickness
    expected = integrated(q, isotropic(modulus, ratio), thickness)
    # Two growing and two decaying exponentials: integration loses e^(2qd) of rounding, thin layers (qd)³.
    lost = max(np.exp(2 * thickness_in_waves), thickness_in_waves**-3)
    assert layer.stiffness(q) == pytest.approx(expected, rel=1e-14 * lost)
    assert layer.depth == layer.layer_thickness == thickness
    if thickness_in_waves == 0.01 and ratio < 0.5:  # a bed of springs, to the square of that
        assert layer.mean_compliance * expected == pytest.approx(1, rel=3e-4)
    coating = Layered(modulus, ratio, thickness, 20.0, 0.2)
    expected = integrated(q, isotropic(modulus, ratio), thickness, isotropic(20.0, 0.2))
    assert coating.stiffness(q) == pytest.approx(expected, rel=1e-7)
    assert (coating.depth, coating.layer_thickness) == (np.inf, thickness)


def test_thin_incompressible_layers_resist_flow_along_them():
    """K = 3 μ/(q² d³), where integration loses all digits; thick ones are half-spaces, which no base compresses."""
    layer, q = Layer(12.0, 0.5, 0.5), 2e-6
    assert layer.stiffness(q) * q**2 * 0.5**3 / 9.0 == pytest.approx(1, abs=1e-11)
    assert layer.mean_compliance == 0
    assert layer.stiffness(600.0) == elasticity_of(12.0).stiffness(600.0) == pytest.approx(3600.0)
    assert elasticity_of(layer) is layer
    stiffness_q = layer.stiffness_on(Grid((6, 9), (2.0, 3.0)))
    assert stiffness_q[0, 0] == 0
    assert stiffness_q[5, 2] == pytest.approx(layer.stiffness(2 * np.pi * np.hypot(1 / 2, 2 / 3)), rel=1e-14)


def test_impossible_solids_are_named():
    for kind, arguments, words in (
        (Layer, (0.0, 0.3, 1.0), "contact_modulus"),
        (Layer, (1.0, 0.51, 1.0), "poissons_ratio"),
        (Layer, (1.0, 0.3, 0.0), "thickness"),
        (Layered, (1.0, 0.3, 1.0, 0.0, 0.3), "base_modulus"),
        (Layered, (1.0, 0.3, 1.0, 1.0, 0.6), "base_poissons_ratio"),
        (Measured, (1.0, [1.0, 2.0], [1.0]), "as many stiffnesses"),
        (Measured, (1.0, [2.0, 1.0], [1.0, 1.0]), "increasing"),
        (Measured, (1.0, [0.0, 1.0], [1.0, 1.0]), "positive wavenumbers"),
        (Measured, (1.0, [1.0, 2.0], [1.0, -1.0]), "positive stiffnesses"),
    ):
        with pytest.raises(ValueError, match=words):
            kind(*arguments)


def direction_dependent(shape=(12, 10)):
    grid = Grid(shape, (3.0, 2.0))
    q_y, q_x = grid.wavevectors
    return grid, 2.0 * grid.wavenumber * (1 - 1e-3 * q_x**2 - 2e-3 * q_y**2 - 1e-3 * q_x * q_y)


def test_a_table_gives_each_wave_its_own_stiffness():
    grid, table = direction_dependent()
    coarse, expected = direction_dependent((6, 5))
    solid = Tabulated(4.0, grid, table + 7.0 * (grid.wavenumber == 0))
    np.testing.assert_array_equal(solid.stiffness_on(grid), table)
    np.testing.assert_allclose(solid.stiffness_on(coarse), expected, rtol=1e-14)
    in_units = solid.scaled(1e-9, 5.0).stiffness_on(Grid(grid.shape, (3e9, 2e9)))
    np.testing.assert_allclose(in_units * 5.0 / 1e-9, table, rtol=1e-14)
    negative = np.where(table == table[3, 2], -1.0, table)
    for wrong, words in ((table[1:], "table has shape"), (negative, "positive and finite")):
        with pytest.raises(ValueError, match=words):
            Tabulated(4.0, grid, wrong)
    for other in (Grid((13, 10), grid.size), Grid((12, 12), grid.size), Grid(grid.shape, (3.0, 2.1))):
        with pytest.raises(ValueError, match="other waves"):
            solid.stiffness_on(other)
    # Theories see the mean over directions.
    grid = Grid((64, 64), (1.0, 1.0))
    with np.errstate(invalid="ignore"):
        cosine = (grid.wavevectors[1] / grid.wavenumber) ** 2
    solid = Tabulated(6.0, grid, 3.0 * grid.wavenumber * (1 + 0.2 * cosine))
    wavenumber = 2 * np.pi * np.array([8.0, 16.0, 30.0])
    # <cos²> = 1/2, to what the points on a ring of finite width are uneven.
    np.testing.assert_allclose(solid.stiffness(wavenumber), 3.3 * wavenumber, rtol=5e-3)


AXIAL = {"axial_modulus": 9e9, "axial_poissons_ratio": 0.1, "axial_shear_modulus": "3 GPa"}
AXIAL["kind"] = "transversely_isotropic"


def layered():
    return {
        "surface": {"kind": "self_affine", "size": 1e-7, "shape": [48, 48], "rms_height": 5e-10, "cutoff_mode": 8},
        "material": {"youngs_modulus": "2 GPa", "poissons_ratio": 0.3},
        "elasticity": {"kind": "layer", "thickness": "3 nm"},
        "interaction": {"work_of_adhesion": 0.05, "length": "0.4 nm"},
        "loading": {"path": ["20 MPa"]},
    }


def test_stress_of_full_contact_is_that_of_the_surface(tmp_path):
    """What the study alone says, against the waves of a realised surface; the sphere's edge needs many of them."""
    for own, tolerance in (
        # One sample of the ensemble; of the sphere waves beyond the grid are missing; bands of an eighth of an octave.
        ({"kind": "self_affine", "rms_height": 5e-10, "cutoff_mode": 40, "roll_off_mode": 3, "seed": 2}, 0.1),
        ({"kind": "wavy", "amplitude": 1e-9, "modes": [2, 3]}, 1e-9),
        ({"kind": "sphere", "radius": 3e-7}, 0.01),
        ({"kind": "flat"}, 1e-9),
        ({"kind": "file", "path": "map.npy"}, 2e-3),
    ):
        np.save(tmp_path / "map.npy", 1e-9 * np.random.default_rng(5).standard_normal((64, 48)))
        own = {"size": [1e-7, 8e-8], **({} if own["kind"] == "file" else {"shape": [480, 384]}), **own}
        study = make_study(layered() | {"surface": own}, tmp_path)
        case, surface = study.cases[0], realise(study.cases[0])
        found = study.scales[0].full_contact_stress(case.solid)
        power = surface.grid.variances(fourier.transform(surface.sampled))
        assert found == pytest.approx(
            np.sqrt(np.sum(case.solid.stiffness_on(surface.grid) ** 2 * power)), rel=tolerance
        )


@pytest.mark.parametrize("constants", [(3.0, 0.3, 3.0, 0.3), (2.0, -0.2, 5.0, 0.4)])
def test_transversely_isotropic_half_spaces_solve_the_equations_of_elasticity(constants):
    modulus, ratio, axial_modulus, axial_ratio = constants
    shear, (c11, c13, c33) = modulus / 2.6, stiffnesses(*constants)
    # Hooke's law backwards: a pull along one axis leaves no other stress.
    c12 = c11 - modulus / (1 + ratio)
    strain = np.linalg.inv([[c11, c12, c13], [c12, c11, c13], [c13, c13, c33]])
    assert strain[2, 1:] == pytest.approx([-axial_ratio / axial_modulus, 1 / axial_modulus])
    assert strain[0, :2] == pytest.approx([1 / modulus, -ratio / modulus])
    found, material = indentation_modulus(c11, c13, c33, shear), (c11 - c13**2 / c33, c13 / c33, 1 / c33, 1 / shear)
    assert 0.5 * found * 4.0 == pytest.approx(integrated(4.0, material, 0.0, material), rel=1e-7)
    if axial_modulus == modulus:
        assert found == pytest.approx(modulus / (1 - ratio**2), rel=1e-14)


def test_a_table_of_stiffness_is_met_at_its_points_and_is_a_half_space_beyond():
    q, measured = np.array([1e-3, 0.4, 2.0, 50.0, 1e4]), Measured(3.0, [0.4, 2.0, 50.0], [1.0, 2.0, 80.0])
    for each, unit in ((measured, 1.0), (measured.scaled(10.0, 2.0), 10.0)):
        modulus = contact_modulus_of(each.stiffness(q * unit), q * unit)
        np.testing.assert_allclose(modulus * (2.0 if unit > 1 else 1.0), [5.0, 5.0, 2.0, 3.2, 3.2], rtol=1e-14)
    layer, fine = Layer(3.0, 0.3, 0.2), np.geomspace(0.1, 100, 61)
    between = np.sqrt(fine[1:] * fine[:-1])
    close = Measured(3.0, fine, layer.stiffness(fine)).stiffness(between)
    np.testing.assert_allclose(close, layer.stiffness(between), rtol=2e-3)


def test_a_table_of_stiffness_goes_into_the_study_and_each_point_of_a_sweep_has_its_solid(tmp_path):
    swept = {**layered(), "sweep": {"elasticity.thickness": ["10 nm", "20 nm"]}}
    assert [case.solid for case in make_study(swept).cases] == [Layer(2e9 / 0.91, 0.3, d) for d in (1e-8, 2e-8)]
    (case,) = make_study({**layered(), "elasticity": AXIAL}).cases
    assert case.solid.contact_modulus == pytest.approx(indentation_modulus(*stiffnesses(2e9, 0.3, 9e9, 0.1), 3e9))
    (tmp_path / "k.txt").write_text("0.01 0.1\n1 5\n")
    keys = {"kind": "tabulated", "path": "k.txt", "wavenumber_unit": "nm^-1", "stiffness_unit": "GPa/nm"}
    study = make_study({**layered(), "elasticity": keys}, tmp_path)
    (tmp_path / "k.txt").unlink()
    for each in (study, make_study(study.table, tmp_path)):
        expected = Measured(1.0, [1e7, 1e9], [1e17, 5e18]).stiffness(1e8)
        assert each.cases[0].solid.stiffness(1e8) == pytest.approx(expected)


def test_solids_that_cannot_be_are_named():
    for section, words in (
        ({"thickness": "20 nm"}, 'elasticity.thickness: kind = "half_space" has no such key'),
        ({"kind": "layer"}, "missing key elasticity.thickness"),
        ({"kind": "tabulated"}, "missing key elasticity.path"),
        (
            {"kind": "tabulated", "wavenumber": ["2 nm^-1", "1 nm^-1"], "stiffness": [1e18, 1e18]},
            "the table of the stiffness must have positive wavenumbers in increasing order",
        ),
        (AXIAL | {"axial_poissons_ratio": 1.9}, "elasticity.axial_poissons_ratio = 1.9: no solid has it"),
    ):
        with pytest.raises(InputError, match=re.escape(words)):
            make_study({**layered(), "elasticity": section})
