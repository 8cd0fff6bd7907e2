from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from contact_study.inputs.errors import InputError
from contact_study.physics import laws
from contact_study.physics.laws import LennardJones93, LennardJones104, Morse, TabulatedLaw, make_law
from contact_study.physics.laws.lennard_jones import work_of_adhesion
from contact_study.study.study import make_study
from tests.laws_of_all_kinds import ADHESIVE, EVERY_LAW, KEYS, TABLE_GAPS, TABLE_TRACTIONS, WORK
from tests.study.test_study import changed

R0 = 3.28e-10


def test_values_of_the_paper():
    gap = np.geomspace(0.8, 4, 9)
    np.testing.assert_allclose(LennardJones104(1.0, 1.0).traction(gap), 20 / 3 * (gap**-5 - gap**-11), rtol=1e-12)
    np.testing.assert_allclose(LennardJones93(1.0, 1.0).traction(gap), 8 / 3 * (gap**-3 - gap**-9), rtol=1e-12)
    block, substrate = 1 / 2.6e-10**2, (647 / 1040e-10) ** 2
    # The sum over discrete atoms gives 0.6924; smearing them costs 0.06 %.
    assert work_of_adhesion(18.6e-3 * 1.602176634e-19, R0, block, substrate) == pytest.approx(0.6924, rel=1e-3)


@pytest.mark.parametrize("wrong", [-0.69, 0.0, float("nan"), "3.28 angstrom", True])
def test_laws_refuse_what_is_no_law(wrong):
    for name, given in (("work_of_adhesion", (wrong, R0)), ("length", (0.69, wrong))):
        with pytest.raises(ValueError, match=f"{name} = {wrong!r}: must be a"):
            LennardJones104(*given)


def by_default(law, **members):
    members |= {"potential": lambda _, gap: law.potential(gap), "has_wall": law.has_wall, "title": law.title}
    return type("PotentialOnly", (laws.TractionLaw,), members)(law.work_of_adhesion, law.length)


def test_a_repulsion_that_ends_is_told():
    law = by_default(Morse(WORK, R0, R0))
    strongest = -float(law.traction(np.array(0.0)))
    assert law.traction(law.repulsive_gap(np.array(-1e-3 * strongest))) == pytest.approx(-1e-3 * strongest)
    with pytest.raises(ValueError, match=r"Morse.*reaches .* Pa, not .* Pa; .*diverges is False"):
        law.repulsive_gap(np.array([0.0, -1.1 * strongest]))


@pytest.mark.parametrize("law", ADHESIVE.values(), ids=ADHESIVE)
def test_every_law_of_the_table(law):
    """What solvers and theories take for granted of a law; its closed forms against what follows from its potential."""
    nearest, peak = law.equilibrium_distance, law.peak_tensile_stress
    assert law.potential(np.array(nearest)) == pytest.approx(-law.work_of_adhesion, rel=1e-12)
    assert abs(law.potential(np.array(nearest + 1e4 * law.length))) < 1e-7 * law.work_of_adhesion
    gap = nearest + law.length * np.geomspace(1e-4, 30, 4001)
    assert np.all(law.traction(gap) > 0), "tension everywhere beyond equilibrium"
    assert law.traction(gap).max() <= peak * (1 + 1e-12)
    assert law.traction(np.array(law.peak_distance)) == pytest.approx(peak, rel=1e-12)
    assert -law.stiffness(gap).min() <= law.strongest_softening * (1 + 1e-12)
    assert law.stiffness(np.array(nearest)) == pytest.approx(law.equilibrium_stiffness, rel=1e-12)
    if not law.has_wall:
        # At any pressure: a weak law under a stiff block has 1e16 times its peak. Near equilibrium the traction of a
        # rounded gap is uncertain by eps times gap times stiffness.
        pressure = peak * np.concatenate([[0.0], np.geomspace(1e-12, 1e16, 100)])
        floor = 4 * np.finfo(float).eps * law.equilibrium_stiffness * nearest
        np.testing.assert_allclose(law.traction(law.repulsive_gap(-pressure)), -pressure, rtol=1e-12, atol=floor)
    # Second-order differences: 1e-8 of them at this step, for energy and traction alike.
    step = 1e-5 * law.length
    if law.title == "tabulated":  # the stiffness bends at its points
        gap = gap[np.abs(gap[:, None] - TABLE_GAPS).min(axis=1) > step]
    for integral, derivative in ((law.potential, law.traction), (law.traction, law.stiffness)):
        differences = (integral(gap + step) - integral(gap - step)) / (2 * step)
        np.testing.assert_allclose(differences, derivative(gap), atol=3e-8 * np.abs(derivative(gap)).max())
    if law.title == "tabulated":
        return
    # Rounding for the traction, differences of fourth order for the stiffness.
    default, softening = by_default(law, diverges=law.diverges), law.strongest_softening
    if not law.has_wall:
        gap = np.concatenate([law.length * np.linspace(0.5, 1, 51), gap])
    np.testing.assert_allclose(default.traction(gap), law.traction(gap), rtol=1e-12, atol=1e-13 * peak)
    np.testing.assert_allclose(default.stiffness(gap), law.stiffness(gap), rtol=3e-8, atol=1e-9 * softening)
    for name, tolerance in (
        ("equilibrium_distance", 1e-12),
        ("peak_distance", 1e-7),  # a maximum is found to the square root of rounding
        ("peak_tensile_stress", 1e-12),
        ("equilibrium_stiffness", 1e-8),
        ("strongest_softening", 1e-8),
    ):
        # A wall has no stiffness of its own: that of the tension there, to the differences' share of the largest.
        floor = 1e-9 * softening if law.has_wall and "stiffness" in name else 0
        assert getattr(default, name) == pytest.approx(getattr(law, name), abs=floor, rel=tolerance), name
    pressure = peak * np.concatenate([[0.0], np.geomspace(1e-6, 1e8, 57)])
    np.testing.assert_allclose(default.repulsive_gap(-pressure), law.repulsive_gap(-pressure), rtol=1e-12)
    assert default.contact_distance == law.contact_distance


@pytest.mark.parametrize("kind", ["Exponential", "Dugdale"])
def test_a_core_vanishes_into_the_wall_in_first_order(kind):
    x, wall, cored = 0.5 * np.linspace(0.2, 3, 15), getattr(laws, kind)(1.0, 0.5), getattr(laws, f"{kind}Core")
    errors = [np.abs(cored(1.0, 1.0, 0.5, core).traction(1 + x) - wall.traction(x)).max() for core in (4e-3, 2e-3)]
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.02)
    assert errors[0] < 0.02 * wall.peak_tensile_stress


def test_dugdales_tension_is_constant_up_to_its_reach_and_repulsion_alone_is_half_of_the_9_3_law():
    tension = laws.Dugdale(0.69, R0).traction(R0 * np.array([0, 1 - 2.2 * 0.05, 1, 1 + 2.2 * 0.05])) * R0 / 0.69
    # ln(1 + e^(1/ramp)) is 1/ramp to e^(−1/ramp), 2e-9.
    assert tension == pytest.approx([1, 1 / (1 + np.exp(-2.2)), 0.5, 1 / (1 + np.exp(2.2))], rel=1e-7)
    law, whole = EVERY_LAW["repulsive"], LennardJones93(0.69, R0)
    inside, outside = R0 * np.linspace(0.5, 1, 20, endpoint=False), R0 * np.linspace(1, 5, 20)
    for name, beyond in (("traction", 0), ("stiffness", 0), ("potential", 0.69)):
        np.testing.assert_allclose(getattr(law, name)(inside), getattr(whole, name)(inside) + beyond)
        np.testing.assert_array_equal(getattr(law, name)(outside), 0)
    pressure = np.geomspace(1e2, 1e16, 20)  # a gap is rounded to 0.1 Pa at the onset
    np.testing.assert_allclose(law.traction(law.repulsive_gap(-pressure)), -pressure, rtol=1e-6)
    assert law.peak_tensile_stress == law.strongest_softening == law.work_of_adhesion == 0


def test_a_table_is_met_at_its_points_and_near_its_source_between():
    source, law = LennardJones104(0.69, R0), EVERY_LAW["tabulated"]
    np.testing.assert_allclose(law.traction(TABLE_GAPS), TABLE_TRACTIONS, rtol=1e-12)
    beyond = R0 * np.linspace(1, 7.9, 1000)
    # Of third order in the spacing at worst, 2 % of r0: measured 2e-3 of the peak, at the steep end.
    np.testing.assert_allclose(law.traction(beyond), source.traction(beyond), atol=5e-3 * source.peak_tensile_stress)
    assert law.work_of_adhesion == pytest.approx(0.69, rel=2e-3)
    assert law.equilibrium_distance == pytest.approx(R0, rel=1e-4, abs=0)
    # Its ends join on: value and slope of the core, value and slope of the tail.
    for function in (law.potential, law.traction, law.stiffness):
        near, far = function(TABLE_GAPS[[0, -1]] * (1 + 1e-9 * np.array([[-1], [1]])))
        assert near == pytest.approx(far, rel=1e-6)
    deep = law.traction(R0 * np.array([0.01, 0.02]))
    # The power of the source is 11, its other power 0.18 of it there.
    assert np.log2(deep[0] / deep[1]) == pytest.approx(11.0, rel=0.15)


NM_MPA = np.array([[0.2, -200], [0.25, -50], [0.3, -10], [0.35, 0], [0.4, 20], [0.6, 25], [1, 10], [2, 1]])


# Level, the end fades over the distance from the peak.
@pytest.mark.parametrize(("end", "fading"), [(0.1, 1 / np.log(10)), (0, 1.0), (1, 2.4)], ids=["steep", "zero", "level"])
def test_a_table_ends_as_its_last_points_fall(end, fading):
    gap, traction = np.vstack([NM_MPA, [3, end]]).T * [[1e-9], [1e6]]
    law = TabulatedLaw.through(gap, traction)
    last, tension = gap[-1], traction[-1]
    beyond = last + 1e-9 * np.array([0.01, 0.3, 2.0])
    expected = tension * np.exp(-(beyond - last) / (fading * 1e-9))
    np.testing.assert_allclose(law.traction(beyond), expected, rtol=1e-12)
    # Coefficients of the last cubic are rounded to some eps of 1 MPa.
    assert np.all(np.diff(law.traction(np.linspace(gap[-2], last, 101))) <= 1e-15 * 1e6)
    # The slope changes by 1e-9 of 6 times the secant, 1 MPa/nm; where the end is level it jumps: with a slope there the
    # cubic would rise before it.
    near, far = law.stiffness(last * (1 + 1e-9 * np.array([-1, 1])))
    assert near - far == pytest.approx(tension / 2.4e-9 if fading == 2.4 else 0.0, abs=1e-7 * 1e15, rel=1e-5)
    # The exact integral: two cubics of each interval and the tail, to 1e-10 of the quadrature.
    ends = [law.length, *gap[gap > law.length], last + 50e-9]
    work = sum(quad(lambda d: float(law.traction(np.array(d))), *pair, epsrel=1e-10)[0] for pair in pairwise(ends))
    assert law.work_of_adhesion == pytest.approx(work, rel=1e-8)


PEAK = int(np.argmax(TABLE_TRACTIONS))


def changed_point(index, value):
    return TABLE_GAPS, np.where(np.arange(100) == index, value, TABLE_TRACTIONS)


def test_bad_tables_are_named():
    for table, words in (
        ((TABLE_GAPS[:4], TABLE_TRACTIONS[:4]), "at least 5 gaps"),
        ((TABLE_GAPS[:-1], TABLE_TRACTIONS), "as many tractions as gaps"),
        ((TABLE_GAPS[::-1], TABLE_TRACTIONS[::-1]), "increasing order"),
        ((TABLE_GAPS - TABLE_GAPS[0], TABLE_TRACTIONS), "positive gaps"),
        ((TABLE_GAPS[20:], TABLE_TRACTIONS[20:]), "no core: .*, a repulsion$"),  # no sign of a sign
        ((TABLE_GAPS, -np.abs(TABLE_TRACTIONS)), "does not attract"),
        ((TABLE_GAPS[:30], TABLE_TRACTIONS[:30]), "ends at a tension"),
        (changed_point(5, TABLE_TRACTIONS[4]), "fall steadily"),
        (changed_point(70, -1e3), "repels again at a gap of .* smooth the measurement there, or end the table before"),
        ((TABLE_GAPS, -TABLE_TRACTIONS), "no core: .*, a repulsion; tension is positive .* change all signs"),
        (changed_point(PEAK - 2, 0.99 * TABLE_TRACTIONS[PEAK - 3]), "second peak"),
        (changed_point(50, np.nan), "no finite number"),
    ):
        with pytest.raises(ValueError, match=words):
            TabulatedLaw.through(*table)


def study_with(folder=".", law="tabulated", **keys):
    table = changed("loading", path=["1 GPa"])
    table["interaction"] = {"law": law, **keys}
    return make_study(table, folder)


def test_a_table_from_a_file_has_units_and_goes_into_the_study(tmp_path):
    table = np.column_stack([TABLE_GAPS * 1e10, TABLE_TRACTIONS * 1e-9])
    np.savetxt(tmp_path / "law.txt", table, "%.12g", ", ", header="gap (angstrom), traction (GPa)")
    found = study_with(tmp_path, path="law.txt", gap_unit="angstrom", traction_unit="GPa", well_depth_ratio=2.0)
    law = found.cases[0].law
    one = EVERY_LAW["tabulated"]
    assert (law.work_of_adhesion, law.length / one.length) == pytest.approx((2 * one.work_of_adhesion, 1), rel=1e-10)
    again = make_study(found.table, tmp_path / "elsewhere")  # a dataset is read without the file
    np.testing.assert_array_equal(again.cases[0].law.tractions, law.tractions)


def test_keys_and_tables_that_make_no_law_are_one_line(tmp_path):
    for name, text in {
        "law": "1 2 3\n4 5 6\n",
        "two": "1 -2\n4 5\n",
        "words": "# measured\ngap, traction # of a law\n1, 2\n",
        "semicolons": "1;2\n",
        "ragged": "\n1 2,\n,\n3 # 4\n",
        "empty": "# gap traction\n\n",
    }.items():
        (tmp_path / f"{name}.txt").write_text(text)
    for keys, words in (
        ({}, r"missing key interaction\.path"),
        ({"path": "none.txt"}, r"^interaction\.path: \S*none\.txt cannot be read"),
        ({"path": "law.txt", "gap": [1e-10]}, r"interaction\.path and interaction\.gap"),
        ({"path": "words.txt"}, r"^interaction\.path: \S*words\.txt is no table of numbers: line 2 is .* remove words"),
        ({"path": "semicolons.txt"}, r"line 1 is '1;2'; .* columns by blanks, tabs or commas$"),
        ({"path": "ragged.txt"}, r"ragged\.txt is no table of numbers: line 4 has 1 of them, line 2 has 2$"),
        ({"path": "empty.txt"}, r"interaction\.path: .*empty\.txt is empty; expected 2 columns"),
        ({"path": "two.txt", "gap_unit": "MPa"}, r"^interaction\.gap_unit = 'MPa': is no unit that .* to m$"),
        ({"path": "two.txt", "traction_unit": "m"}, r"^interaction\.traction_unit = 'm': is no unit that .* to Pa$"),
        ({"path": "two.txt", "work_of_adhesion": 1.0}, r"interaction\.work_of_adhesion: .* from the table"),
        ({"law": "morse", "well_depth": 1e-20, "length": R0, "range": R0}, r"interaction\.well_depth"),
        ({**KEYS["exponential_core"], "law": "exponential_core", "core": 2e-10}, r"interaction\.core .* shorter than"),
        ({**KEYS["dugdale_core"], "law": "dugdale_core", "core": 0.5e-10}, r"interaction\.core .* the ramp"),
        ({**KEYS["dugdale"], "law": "dugdale", "ramp": 0.6}, r"interaction\.ramp = 0\.6"),
        ({"law": "repulsive", "length": R0, "work_of_adhesion": 1.0, "repulsion": 1.0}, "does not attract"),
    ):
        with pytest.raises(InputError, match=words):
            study_with(tmp_path, **keys)


def test_laws_by_name_take_fields_of_their_own():
    wall = make_law("hard_wall", 0.69, R0)
    assert wall.work_of_adhesion == wall.length == wall.equilibrium_distance == wall.peak_tensile_stress == 0
    assert make_law("morse", 0.69, R0, range=1e-10) == Morse(0.69, R0, 1e-10)
    assert make_law("repulsive", 0.69, R0, repulsion=2.0) == laws.Repulsive(0.0, R0, 2.0)
    for name, keys, words in (
        ("morse", {}, "range: .* needs it"),
        ("dugdale", {"core": 1.0}, "core: .* no such field"),
        ("tabulated", {}, "expected one of lennard_jones_10_4"),
    ):
        with pytest.raises(ValueError, match=words):
            make_law(name, 0.69, R0, **keys)
