"""A law that differs from point to point: a map of the work of adhesion, and a hardness with every law."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import contact_study
from bem_adhesion import Exponential, HalfSpace, HardWall, Layer, LennardJones104, Outcome, TabulatedLaw, rough_contact
from bem_adhesion.kernels import law as law_kernels
from bem_adhesion.kernels.local_energy import LocalEnergy
from bem_adhesion.kernels.local_law import LocalLaw
from bem_adhesion.operators import Load
from contact_study.campaign.model import MODELS, check_study
from contact_study.campaign.record import prepare_run
from contact_study.numerics.grid import Grid
from contact_study.physics import adhesion_maps
from contact_study.study.study import make_study
from scripts import validate_plasticity
from scripts.harness import ROOT
from tests.bem_adhesion.paper_system import E_STAR, R0, approach_of, law, self_affine, stepped, study_table
from tests.laws_of_all_kinds import ADHESIVE, EVERY_LAW, TABLE_GAPS, TABLE_TRACTIONS

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

RNG = np.random.default_rng(7)
HEIGHT = self_affine(48)[0]
SIZE = 500e-10  # of a cell on which these heights are steep
FACTORS = np.exp(0.3 * RNG.standard_normal(HEIGHT.shape))
SOFT = {name: one for name, one in EVERY_LAW.items() if name != "hard_wall"}


def contact(the_law, height=HEIGHT, size=SIZE, elasticity=E_STAR, **options):
    return rough_contact(height, size, elasticity, the_law, **options)


def times(the_law, factor):
    if isinstance(the_law, TabulatedLaw):
        return TabulatedLaw.through(TABLE_GAPS, factor * TABLE_TRACTIONS)
    return replace(the_law, work_of_adhesion=factor * the_law.work_of_adhesion)


@pytest.mark.parametrize("name", ADHESIVE)
def test_a_uniform_map_is_the_law_of_that_work_of_adhesion(name):
    the_law, loads = ADHESIVE[name], (2e9, 0.1e9)
    ones, twice = (np.full(HEIGHT.shape, each * the_law.work_of_adhesion) for each in (1.0, 2.0))
    # A compiled loop with a factor of one may sum in another order: Newton's steps meet 1e-8 of the modulus elsewhere.
    fine = {"tolerance": 1e-12}
    plain, of_ones = (stepped(contact(the_law, **each), loads) for each in (fine, {"work_of_adhesion": ones, **fine}))
    for one, other in zip(plain, of_ones, strict=True):
        np.testing.assert_allclose(one.gap, other.gap, rtol=1e-9)
        assert one.interaction_energy == pytest.approx(other.interaction_energy, rel=1e-9)
        assert abs(one.iterations - other.iterations) <= 1
    found, expected = (
        stepped(each, loads) for each in (contact(the_law, work_of_adhesion=twice), contact(times(the_law, 2)))
    )
    for one, other in zip(found, expected, strict=True):
        assert one.outcome is other.outcome is Outcome.CONVERGED
        # Two solves to 1e-8 of the modulus, over the softest stiffness.
        np.testing.assert_allclose(one.gap, other.gap, atol=1e-4 * R0)
        assert one.interaction_energy == pytest.approx(other.interaction_energy, rel=1e-6)


@pytest.mark.parametrize("name", SOFT)
@pytest.mark.parametrize("hardness", [np.inf, 2e9])
def test_energy_traction_and_curvature_belong_together(name, hardness, monkeypatch):
    monkeypatch.setattr(law_kernels, "BLOCK", 10)  # rows of their own part of the map
    the_law, shape = SOFT[name], (21, 5)
    strength = np.linspace(0.5, 2, 105).reshape(shape) if the_law.attracts else None
    local = LocalLaw.of(the_law, strength, hardness, shape)
    energy = LocalEnergy(the_law, pointwise=local)
    start = the_law.equilibrium_distance + (0 if the_law.has_wall else 1e-3) * the_law.length
    elastic = start + the_law.length * np.geomspace(1e-3, 3, 105).reshape(shape)
    depths = [0.0] if np.isinf(hardness) else [0.0, 1.0]
    for depth in depths:
        gap = elastic if not depth else local.yield_gap - 0.5 * the_law.length * np.linspace(0.1, 1, 105).reshape(shape)
        step = 1e-5 * the_law.length

        def at(one):
            traction, curvature = np.empty(shape), np.empty(shape)
            total = sum(
                energy.evaluate(one[rows], traction[rows], curvature[rows], rows) for rows in law_kernels.blocks(one)
            )
            return total, traction, curvature

        (above, high, _), (below, low, _), (_, traction, curvature) = (at(gap + each) for each in (step, -step, 0.0))
        size = np.abs(traction).max()
        # Central differences of step 1e-5 of the length: 1e-10 of truncation, 1e-11 of rounding; a table has kinks.
        close = 1e-6 if name == "tabulated" else 1e-8
        assert (above - below) / (2 * step) == pytest.approx(traction.sum(), rel=1e-6, abs=close * size * gap.size)
        np.testing.assert_allclose((high - low) / (2 * step), curvature, atol=1e-4 * size / the_law.length)
        if depth:
            np.testing.assert_array_equal(traction, -hardness)
        elif strength is not None:
            np.testing.assert_allclose(traction, strength * the_law.traction(gap), rtol=1e-9, atol=1e-12 * size)


def test_a_wall_holds_a_point_up_to_the_hardness_and_pushes_with_no_more():
    """Pulled off, held, at more than the wall carries, and below it; the law pulls with 2 at the wall, H = 5."""
    gap, pressing = np.array([[0.0, 0.0, 0.0, -0.3]]), np.array([[-3.0, 4.0, 7.0, 7.0]])
    energy = LocalEnergy(Exponential(2.0, 1.0), pointwise=LocalLaw.of(Exponential(2.0, 1.0), None, 5.0, gap.shape))
    right_side, curvature, step = np.empty(gap.shape), np.empty(gap.shape, np.float32), np.ones(gap.shape)
    found = energy.energy_and_gradient(pressing, gap, Load(np.zeros(gap.shape)), right_side, curvature)
    np.testing.assert_allclose(right_side, [[1, 0, -2, -2]])
    assert (found.largest, found.square, found.total) == (2, 9, 3)
    energy.hold(curvature, step)
    np.testing.assert_array_equal(step, [[1, 0, 1, 1]])
    energy.advance(gap, np.array([[-0.1, 0.0, -0.1, 0.4]]), 0.4, out := np.empty(gap.shape))
    np.testing.assert_allclose(out, [[0, 0, -0.1, 0]])


KINDS = {
    "smooth": (law(2.0), {}),
    "smooth, mean gap": (law(2.0), {"control": "gap"}),
    "smooth, free": (law(2.0), {"boundary": "free"}),
    "wall": (Exponential(1.4, 4e-10), {}),
    "wall, mean gap": (Exponential(1.4, 4e-10), {"control": "gap"}),
    "wall, free, approach": (Exponential(1.4, 4e-10), {"boundary": "free", "control": "approach"}),
}
TARGETS = {"pressure": (1e9, 3e9, 0.3e9), "gap": (6e-10, 2e-10, 8e-10), "approach": (8e-10, 20e-10, 12e-10)}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("hardness", [None, 8e9])
def test_states_satisfy_law_hardness_and_elasticity(kind, hardness):
    """By the fields alone, on a grid that is not square and with the map that this library was given."""
    the_law, options = KINDS[kind]
    height, factors = HEIGHT[:, ::2], FACTORS[:, ::2]
    size, targets = (SIZE, 0.8 * SIZE), TARGETS[options.get("control", "pressure")]
    own = {"work_of_adhesion": factors * the_law.work_of_adhesion, "hardness": hardness}
    before = np.zeros(height.shape)
    for target, found in zip(targets, stepped(contact(the_law, height, size, **own, **options), targets), strict=True):
        assert found.converged, found.message
        indentation = before if hardness is None else found.plastic_indentation
        np.testing.assert_allclose(found.displacement, height - indentation + found.gap, atol=1e-14 * np.ptp(height))
        of_law = -factors * the_law.traction(found.gap)
        touching = found.gap == 0 if the_law.has_wall else np.zeros(height.shape, bool)
        np.testing.assert_allclose(found.pressure[~touching], of_law[~touching], atol=1e-9 * E_STAR)
        assert np.all(found.pressure[touching] >= of_law[touching] - 2e-8 * E_STAR)
        if hardness is not None:
            assert found.pressure.max() <= hardness + 1e-8 * E_STAR
            assert found.complementarity_residual >= (found.pressure.max() - hardness) / E_STAR
            assert found.complementarity_residual <= 1e-8
            assert np.all(indentation >= before)
            yields = indentation > before
            np.testing.assert_allclose(found.pressure[yields], hardness, rtol=1e-8)
            assert found.plastic_work == pytest.approx(hardness * indentation.mean(), rel=1e-12)
            before = indentation
        assert found.interaction_energy == pytest.approx((factors * the_law.potential(found.gap)).mean(), rel=1e-9)
        if "boundary" not in options:
            grid = Grid(height.shape, size)
            bent = np.fft.irfft2(HalfSpace(E_STAR).stiffness_on(grid) * np.fft.rfft2(found.displacement), grid.shape)
            # The solver's tolerance, and the rounding of the transform.
            np.testing.assert_allclose(found.pressure - found.pressure.mean(), bent, atol=2.1e-8 * E_STAR)
        if options.get("control") == "gap":
            assert found.mean_gap == pytest.approx(target, abs=2e-8 * the_law.length)
        if options.get("control") == "approach":
            met = approach_of(found, height, HalfSpace(E_STAR), the_law)
            assert met == pytest.approx(target, abs=2e-8 * the_law.length)
    assert hardness is None or before.max() > 0.1 * R0, "the test is one of yielding"


def test_coarse_grids_and_subdomains_have_the_map_of_their_points():
    """A start by coarser grids, and places that relax by themselves, end where the finest grid alone does."""
    height, _ = self_affine(256)
    factors = np.where(np.arange(256) % 128 < 64, 1.4, 0.6) * np.ones((256, 1))
    own = {"work_of_adhesion": 0.69 * 4 * factors, "hardness": 1.2e10}
    made = contact(law(4.0), height, 600e-10, **own)
    fast = stepped(made, (1e9, 3e9))
    levels = made._make(height).levels
    every_other = levels.coarser.finest.local.pointwise
    np.testing.assert_array_equal(every_other.strength, factors[::2, ::2])
    assert every_other.yield_gap.shape == (128, 128)
    levels.finest.corrector.correct(
        *(np.full((256, 256), each) for each in (1.1, 0.0)), Load(np.zeros((256, 256))), _patch(), np.empty((256, 256))
    )
    moved = levels.finest.corrector.solver.local.pointwise.strength
    np.testing.assert_array_equal(np.unique(moved), [0.6, 1.4])
    assert all(one.converged for one in fast)
    # The work of a solve that knows nothing of the map on coarser grids: predictions there would be far off.
    assert sum(one.fft_pairs for one in fast) < 200


def _patch():
    residual = np.zeros((256, 256), np.float32)
    residual[100:120, 40:60] = 1
    return residual


def test_a_flat_interface_of_stripes_detaches_as_one_or_half_by_half():
    """The gap of a stiff solid is one: its strength is the mean. Wide stripes of a soft one go at their own."""
    the_law, contrast = law(1.0), 0.5
    stripes = np.where(np.arange(64) < 32, 1 + contrast, 1 - contrast) * np.ones((4, 1))
    flat, strength = np.zeros((4, 64)), the_law.peak_tensile_stress
    own = {"work_of_adhesion": stripes * the_law.work_of_adhesion}
    stiff = stepped(contact(the_law, flat, (1e-13, 16e-13), **own), (1e8, -0.999 * strength, -1.001 * strength))
    assert [one.detached for one in stiff] == [False, False, True]
    # Two points a process zone of the strong half; the weak half is five of its zones wide, and its crack runs on.
    zone, weak = E_STAR * the_law.work_of_adhesion / strength**2 / (1 + contrast), (1 - contrast) * strength
    wide = stepped(contact(the_law, flat, (2 * zone, 32 * zone), **own), (1e8, -0.99 * weak, -1.05 * weak))
    assert [one.detached for one in wide] == [False, False, True]
    assert wide[1].gap.max() < the_law.peak_distance


@pytest.mark.parametrize("name", ["lennard_jones_10_4", "exponential", "repulsive"])
def test_a_hardness_out_of_reach_changes_nothing(name):
    elastic = stepped(contact(SOFT[name]), (1e9, 0.2e9))
    hard = stepped(contact(SOFT[name], hardness=100 * elastic[0].pressure.max()), (1e9, 0.2e9))
    for one, other in zip(elastic, hard, strict=True):
        assert other.plastic_indentation.max() == other.plastic_work == 0
        # Both within 1e-8 of the modulus of balance.
        np.testing.assert_allclose(one.pressure, other.pressure, atol=1e-6 * E_STAR)
        assert one.elastic_energy == pytest.approx(other.elastic_energy, rel=1e-6)


@pytest.mark.parametrize("the_law", [EVERY_LAW["exponential"], law(1.0)], ids=["wall", "smooth"])
def test_unloading_is_elastic_and_the_same_load_yields_no_more(the_law):
    hard = contact(the_law, hardness=5e9)
    up, down, again, beyond = stepped(hard, (2e9, 0.5e9, 2e9, 2.5e9))
    for one in (down, again):
        # A second solve to the tolerance over the stiffness of the solid.
        np.testing.assert_allclose(one.plastic_indentation, up.plastic_indentation, atol=1e-5 * R0)
    assert beyond.plastic_work > 1.1 * up.plastic_work > 0
    elastic = contact(the_law, HEIGHT - up.plastic_indentation)
    expected = elastic.step(elastic.separated(), 0.5e9)
    np.testing.assert_allclose(down.pressure, expected.pressure, atol=1e-5 * E_STAR)
    less = hard.step(down, 0.499e9)
    slope = (less.pressure.mean() - down.pressure.mean()) / (down.gap.mean() - less.gap.mean())
    assert slope == pytest.approx(hard.stiffness(down), rel=0.01)  # a difference over 0.2 % of the load


def test_weak_adhesion_leaves_a_hard_wall_with_that_hardness():
    """The work of adhesion enters in first order: a tenth of it leaves a tenth of the difference."""
    loads = (1e9, 2e9)
    wall = [one.plastic_indentation.mean() for one in stepped(contact(HardWall(), hardness=5e9), loads)]
    off = [
        [
            one.plastic_indentation.mean() - expected
            for one, expected in zip(
                stepped(contact(Exponential(work, 1e-10), hardness=5e9, tolerance=1e-10), loads), wall, strict=True
            )
        ]
        for work in (0.02, 0.002)
    ]
    assert np.all(np.divide(off[0], wall) > 0), "attraction presses the surfaces together"
    # Points that pass from one state to another make the difference piecewise linear.
    np.testing.assert_allclose(np.divide(*off), 10, rtol=0.15)


@pytest.mark.parametrize("the_law", [EVERY_LAW["exponential"], law(1.0)], ids=["wall", "smooth"])
def test_a_flat_punch_on_a_layer_carries_its_hardness_and_sinks_in(the_law):
    """Uniform: the approach is the layer's compression at H, the law's at H, and the rest plastic."""
    solid, hardness = Layer(E_STAR, 0.3, 5e-9), 2e10
    punch = contact(the_law, np.zeros((8, 8)), 5e-9, solid, control="approach", hardness=hardness)
    at_yield = float(the_law.repulsive_gap(np.array(-hardness)))
    elastic = solid.mean_compliance * hardness + the_law.equilibrium_distance - at_yield
    below, sunk, lifted = stepped(punch, (0.99 * elastic, 1.5 * elastic, 1.4 * elastic))
    assert below.plastic_work == 0 < below.pressure.max() < hardness
    np.testing.assert_allclose(sunk.pressure, hardness, rtol=1e-9)
    np.testing.assert_allclose(sunk.plastic_indentation, 0.5 * elastic, rtol=1e-6)
    assert sunk.plastic_work == pytest.approx(0.5 * hardness * elastic, rel=1e-6)
    assert sunk.outcome is Outcome.YIELDED, "a hair more of approach finds no more pressure"
    assert lifted.plastic_work == sunk.plastic_work
    assert lifted.pressure.max() < hardness


def test_a_sphere_yields_at_the_load_of_hertz():
    """First at its centre, where p0 = H: P = π³R²H³/6E*² (K. L. Johnson, Contact Mechanics (1985), with p0 for H)."""
    radius, points = 100e-9, 96
    size = 40e-9
    modulus, hardness = 1e9, 5e7
    x = (np.arange(points) - points / 2) * size / points
    height = -(x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    force = np.pi**3 * radius**2 * hardness**3 / (6 * modulus**2)
    weak = Exponential(1e-7, 1e-10)
    ball = contact(weak, height, size, modulus, boundary="free", hardness=hardness)
    below, above = stepped(ball, np.array([0.93, 1.07]) * force / size**2)
    # The mesh is a sixth of the contact radius: its pressure is p0 to 2 %, a force to 6 %.
    assert below.plastic_work == 0 < above.plastic_work
    # A contact of 19 points' radius yields within √(1 − p0^−2) = 0.21 of it, and a point more.
    assert np.argwhere(above.plastic_indentation > 0).min() > points // 2 - 6


@pytest.mark.validation
def test_a_path_with_jumps_and_yielding_accounts_for_its_work():
    loading = {"path": [20e-10, 2e-10], "control": "gap", "unload": True, "adaptive": True, "resolution": 0.02}
    table = study_table(24, size=150e-10, surface={"rms_height": 4e-10, "cutoff_mode": 8}, loading=loading)
    table["interaction"] |= {"work_of_adhesion": 4.0}
    table["material"] |= {"hardness": 3e10}
    table["adhesion_map"] = {"kind": "patches", "modes": [0, 2], "contrast": 0.4}
    found = contact_study.run(table)
    assert found.converged.all()
    assert np.all(found.plastic_work.values[1:] > 0)
    pressure, separation, energy = (
        found[f"passed_{name}"].values[~np.isnan(found[f"passed_{name}"].values)]
        for name in ("pressure", "separation", "energy")
    )
    work = -np.trapezoid(pressure, separation)
    stored = found.elastic_energy + found.interaction_energy + found.plastic_work
    assert energy[-1] == pytest.approx(float(stored[-1]), rel=1e-12)
    lost, unsure = (float(found[f"dissipated_energy{end}"][-1]) for end in ("", "_resolution_error"))
    assert lost > 0.2 * float(found.plastic_work[-1]), "there are jumps"
    assert unsure < float(found.plastic_work[-1]) / 4, "and what is not known of them is less than what has yielded"
    assert work == pytest.approx(float(stored[-1] - stored[0]) + lost, abs=unsure)
    turn = np.argmin(separation)
    balance = turn + np.argmax(pressure[turn:] < 0)
    at_zero = np.interp(0.0, -pressure[[balance - 1, balance]], separation[[balance - 1, balance]])
    outwards = -np.trapezoid([0.0, *pressure[balance:]], [at_zero, *separation[balance:]])
    # The trapezoid has half of each jump's step, as the result's error says.
    error = float(found.work_of_separation_resolution_error)
    assert float(found.work_of_separation) == pytest.approx(outwards, abs=error + 0.02)


def test_random_maps_are_positive_of_their_mean_and_deviation():
    loading, output = {"path": [1e9]}, {"fields": True}
    table = study_table(64, size=SIZE, loading=loading, output=output)
    table["adhesion_map"] = {"kind": "random", "relative_rms": 0.5, "roll_off_mode": 4, "cutoff_mode": 24, "seed": 3}
    found = contact_study.run(table)
    work, touching = found.work_of_adhesion_map.values, found.gap.values[0] < 3.68e-10
    assert work.min() > 0
    assert work.mean() == pytest.approx(0.69, rel=1e-12)
    # One sample of some hundred independent patches.
    assert work.std() == pytest.approx(0.5 * 0.69, rel=0.15)
    assert found.work_of_adhesion_in_contact.item() == pytest.approx(work[touching].mean(), rel=1e-12)
    power = np.abs(np.fft.rfft2(np.log(work)))
    wave = np.hypot(np.fft.fftfreq(64, 1 / 64)[:, None], np.fft.rfftfreq(64, 1 / 64)[None, :])
    assert power[wave > 24.5].max() < 1e-10 * power.max()
    zone = E_STAR * 0.69 / LennardJones104(0.69, R0).peak_tensile_stress ** 2
    assert found.process_zone.item() == pytest.approx(zone * 0.69 / work.max(), rel=1e-9)


IN_TIME = {
    "elasticity": {"kind": "viscoelastic", "branch_youngs_moduli": [5e9], "relaxation_times": ["1 s"]},
    "loading": {"path": [1e8], "duration": 1.0},
}


@pytest.mark.validation
@pytest.mark.parametrize("way", [IN_TIME, {"solver": {"path": "overdamped"}, "loading": {"path": [1e8]}}])
def test_slow_paths_have_the_map_too(way):
    """Contact gathers where the work of adhesion is large."""
    table = study_table(32, size=200e-10, surface={"rms_height": 4e-10}, **way)
    table["interaction"]["work_of_adhesion"] = 2.8
    uniform = contact_study.run(table)
    assert "work_of_adhesion_in_contact" not in uniform
    found = contact_study.run({**table, "adhesion_map": {"kind": "patches", "modes": [0, 2], "contrast": 0.5}})
    assert found.converged.all()
    assert found.work_of_adhesion_in_contact.item() > 1.05 * 2.8
    assert found.relative_contact_area.item() != pytest.approx(uniform.relative_contact_area.item(), rel=0.01)


def test_maps_of_files_are_scaled_to_the_mean_and_repeated_on_finer_grids(tmp_path):
    values = RNG.random((32, 16)) + 0.5
    np.save(tmp_path / "adhesion.npy", values)
    table = study_table(32, size=SIZE, output={"fields": True})
    table["adhesion_map"] = {"kind": "file", "path": str(tmp_path / "adhesion.npy")}
    work = contact_study.run(table).work_of_adhesion_map.values
    np.testing.assert_allclose(work, 0.69 * np.repeat(values, 2, axis=1) / values.mean(), rtol=1e-12)
    # Without adhesion here and there: the law outside a wall goes with it.
    np.save(tmp_path / "adhesion.npy", [[0.0, 1.0, 0.0, 1.0]] * 4)
    factors = adhesion_maps.from_file(Grid((4, 8), (SIZE, SIZE)), tmp_path / "adhesion.npy", None, "adhesion_map")
    assert factors.tolist() == [[0, 0, 2, 2, 0, 0, 2, 2]] * 4


def test_the_content_of_a_map_decides_the_numbers_of_simulations_alone(tmp_path):
    table, hashes = study_table(32, size=SIZE), []
    table["adhesion_map"] = {"kind": "file", "path": str(tmp_path / "adhesion.txt")}
    study = make_study(table)
    for seed in (1, 2):
        np.savetxt(tmp_path / "adhesion.txt", np.random.default_rng(seed).random((32, 32)) + 0.5)
        hashes += [prepare_run(MODELS["continuum"], study).deciding_keys(study.cases[0])["adhesion_map.path"]]
        assert study.cases[0].strongest_adhesion == pytest.approx(1.5, abs=0.01), "over a mean of one"
        study.cases[0].__dict__.pop("strongest_adhesion")
    assert hashes[0] != hashes[1]
    assert "adhesion_map.path" not in prepare_run(MODELS["theory"], study).deciding_keys(study.cases[0])
    assert "take the mean work of adhesion" in " ".join(check_study(MODELS["theory"], study))


def test_patches_cover_their_share():
    table = study_table(40, size=SIZE, output={"fields": True})
    for modes, share in (([0, 4], 0.3), ([2, 4], 0.25)):
        table["adhesion_map"] = {"kind": "patches", "modes": modes, "contrast": 0.5, "share": share}
        work = contact_study.run(table).work_of_adhesion_map.values
        strong = work > work.mean()
        assert strong.mean() == pytest.approx(share, abs=1e-12)
        assert work[strong][0] / work[~strong][0] == pytest.approx(3, rel=1e-12)
        assert np.abs(np.fft.rfft2(strong))[modes[0], modes[1]] > 10


def test_yielding_states_are_those_of_the_code_adhesion():
    table = pd.read_csv(ROOT / "data" / "adhesion_plastic.csv")
    found = np.array(list(validate_plasticity.ours(table.pressure.values)))
    # Six digits are kept, of pressures too: near the hardness an indentation changes twenty times as much.
    np.testing.assert_allclose(found, table[["mean_gap", "yielded", "indentation"]], rtol=1e-4, atol=1e-6)
    assert found[-1, 1] > 0.7
