"""Measured force curves: columns, units and signs of text, files of microscopes, zeros, and what cannot be read."""

import hashlib

import numpy as np
import pytest

from contact_study import InputError, read_force_curve
from contact_study.physics.force_curves.columns import QUANTITIES
from contact_study.physics.force_curves.curve import OPTIONS
from theory import JKR

SPHERE = JKR(1e-6, 1e8, 0.05)
STIFFNESS, SENSITIVITY = 0.5, 4e-8


def written(path, text):
    path.write_text(text, encoding="utf-8")
    return path


def cycle(noise=0.0):
    """Displacement, force and branch of a sphere that snaps in at first touch and is pulled off."""
    forth = np.linspace(-60e-9, 30e-9, 181)
    least = SPHERE.pull_off_displacement
    pressed = [SPHERE.at_displacement(one)[0] if one >= 0 else 0.0 for one in forth]
    pulled = [SPHERE.at_displacement(one)[0] if one > least else 0.0 for one in forth[::-1]]
    branch = np.repeat([0, 1], forth.size)
    force = np.concatenate([pressed, pulled]) + noise * np.random.default_rng(1).standard_normal(branch.size)
    return np.concatenate([forth, forth[::-1]]), force, branch


@pytest.mark.parametrize(
    "text",
    [
        "displacement [nm], force (nN)\n0.5,1.5\n2,-3\n",
        "displacement (nm), force (nN)\n5e-1,15e-1\n2,-3\n",
        "Displacement / nm\tForce / nN\n0.5\t1.5\n2\t-3\n",
        "delta_nm;load_uN\n0,5;0,0015\n2;-0,003\n",
        "# a probe on rubber\n# indentation  force\n# m  mN\n5e-10 1.5e-6\n2e-9 -3e-6\n",
        "# positive_force = tension\nforce (nN), separation (nm)\n-1.5,-0.5\n3,-2\n",
        "# positive_displacement: retraction\ndisplacement (Å) load (pN)\n-5 1500\n-20 -3000\n",
        '"tip-sample separation (nm)","normal force (nN)"\n-0.5,1.5\n-2,-3\n',
    ],
)
def test_columns_units_signs_and_decimals_of_a_text(tmp_path, text):
    path = written(tmp_path / "curve.txt", text)
    found = read_force_curve(path)
    np.testing.assert_allclose(found.displacement, [0.5e-9, 2e-9], rtol=1e-14)
    np.testing.assert_allclose(found.total_force, [1.5e-9, -3e-9], rtol=1e-14)
    assert (found.total_force.units, found.displacement.units) == ("N", "m")
    assert found.source == f"curve.txt sha256:{hashlib.sha256(path.read_bytes()).hexdigest()}"


def test_integers_between_commas_are_numbers_under_names_between_commas(tmp_path):
    found = read_force_curve(written(tmp_path / "curve.csv", "displacement (nm),force (nN)\n1,2\n2,5\n"))
    np.testing.assert_allclose(found.total_force, [2e-9, 5e-9], rtol=1e-14)


def test_a_unit_below_its_name_and_a_deflection_that_is_positive_in_tension(tmp_path):
    text = "height (measured)\tdeflection\num\tnm\n-0.5\t-3\n-0.7\t4\n"
    options = {"spring_constant": "2 N/m", "positive_force": "tension"}
    found = read_force_curve(written(tmp_path / "curve.txt", text), **options)
    np.testing.assert_allclose(found.total_force, [6e-9, -8e-9], rtol=1e-14)
    np.testing.assert_allclose(found.displacement, [0.5e-6 - 3e-9, 0.7e-6 + 4e-9], rtol=1e-14)


def test_a_jkr_test_has_force_and_radius_or_area_and_their_uncertainties(tmp_path):
    text = "load (mN), contact radius (um), load error (uN), radius std (nm), temperature (K)\n1,20,5,-300,293\n"
    columns = "force (mN), contact_radius (um), force std (uN), uncertainty of contact radius (nm), -"
    found = read_force_curve(written(tmp_path / "jkr.csv", text + "2,,5,300,293\n-1,9,5,300,294\n"), columns=columns)
    assert {"displacement", "time"}.isdisjoint(found)
    np.testing.assert_allclose(found.contact_radius, [20e-6, np.nan, 9e-6], rtol=1e-14)
    np.testing.assert_allclose(found.total_force_uncertainty, 5e-6, rtol=1e-14)
    np.testing.assert_allclose(found.contact_radius_uncertainty, 3e-7, rtol=1e-14)
    assert found.branch.values.tolist() == [0, 0, 1]  # turned at the largest force
    area = read_force_curve(written(tmp_path / "area.txt", "force (mN)  contact area (um^2)\n1  2\n"))
    assert area.contact_radius.item() == pytest.approx(np.sqrt(2e-12 / np.pi), rel=1e-14)


@pytest.mark.parametrize("form", ["deflection (nm)", "deflection (V)", "force (nN)"])
@pytest.mark.parametrize("where", ["z", "height"])
def test_the_cantilever_bends_back_what_the_piezo_moves(tmp_path, form, where):
    displacement, force, _ = cycle()
    z = (displacement + force / STIFFNESS) * (-1 if where == "height" else 1)
    second = {"deflection (nm)": force / STIFFNESS * 1e9, "force (nN)": force * 1e9}
    second["deflection (V)"] = force / STIFFNESS / SENSITIVITY
    rows = "\n".join(f"{a!r} {b!r}" for a, b in zip((z * 1e9).tolist(), second[form].tolist(), strict=True))
    path = written(tmp_path / "probe.txt", f"# spring_constant: 0.5 N/m\n{where} (nm)  {form}\n{rows}\n")
    found = read_force_curve(path, sensitivity="40 nm/V")
    np.testing.assert_allclose(found.displacement, displacement, atol=1e-21)
    np.testing.assert_allclose(found.total_force, force, atol=1e-21)
    # An option of the call is stronger than that of the file.
    softer = read_force_curve(path, sensitivity=SENSITIVITY, spring_constant=0.25)
    if form != "force (nN)":
        np.testing.assert_allclose(softer.total_force, force / 2, atol=1e-21)


def test_zeros_from_the_baseline_and_the_contact(tmp_path):
    displacement, force, branch = cycle(noise=2e-9)
    table = np.stack([1e9 * displacement + 400, 1e9 * force + 77, branch], axis=1)
    path = tmp_path / "probe.tsv"
    np.savetxt(path, table, header="displacement (nm)\tforce (nN)\tsegment", delimiter="\t")
    given = read_force_curve(path)
    assert given.total_force[0] == pytest.approx(77e-9, abs=1e-8)
    found = read_force_curve(path, zero_force="baseline", zero_displacement="contact")
    # The mean of 37 points before contact; the sphere snaps in at its first touch, on a grid of 0.5 nm.
    assert float((found.total_force - force).mean()) == pytest.approx(0.0, abs=4 * 2e-9 / np.sqrt(37))
    np.testing.assert_allclose(found.displacement, displacement, atol=0.5e-9)
    assert found.branch.values.tolist() == branch.tolist()
    np.testing.assert_allclose(read_force_curve(path, zero_force="baseline").displacement, given.displacement)
    # A baseline that drifts by 1 % of the largest force until contact is no contact.
    clean = cycle()[1]
    table[:, 1] = 1e9 * (clean - 0.01 * np.abs(clean).max() * np.clip(1 + displacement / 60e-9, 0, 1))
    table[60:62, 1] += 0.5 * table[:, 1].max()  # nor are two points alone
    np.savetxt(path, table, header="displacement (nm)\tforce (nN)\tsegment", delimiter="\t")
    drifting = read_force_curve(path, zero_displacement="contact")
    np.testing.assert_allclose(drifting.displacement, displacement, atol=0.5e-9)
    np.testing.assert_allclose(drifting.total_force, 1e-9 * table[:, 1], rtol=1e-14)  # as given


@pytest.mark.parametrize("kind", ["h5", "tab"])
def test_files_of_microscopes(tmp_path, kind):
    afm = pytest.importorskip("afmformats")
    displacement, force, branch = cycle()
    data = {"force": force + 3e-9, "height (measured)": -(displacement + force / STIFFNESS), "segment": branch}
    path = tmp_path / f"probe.{kind}"
    about = {"path": path, "enum": 0, "imaging mode": "force-distance", "spring constant": STIFFNESS}
    one = afm.mod_force_distance.AFMForceDistance(data, about)
    one.export_data(path, metadata=["enum", "imaging mode", "spring constant"], fmt={"h5": "hdf5"}.get(kind, kind))
    found = read_force_curve(path)
    # The offset is that of the baseline, and bends the cantilever by 6 nm all along; tables have 8 digits of 1 µm.
    np.testing.assert_allclose(found.total_force, force, atol=1e-14)
    np.testing.assert_allclose(found.displacement, displacement - 3e-9 / STIFFNESS, atol=1e-13)
    assert found.branch.values.tolist() == branch.tolist()
    stiffer = read_force_curve(path, spring_constant="1 N/m", zero_force="given")
    np.testing.assert_allclose(stiffer.total_force, 2 * (force + 3e-9), atol=1e-14)
    one["segment"] = np.zeros(branch.size, np.uint8)  # formats without segments
    plain = tmp_path / f"plain.{kind}"
    one.export_data(plain, metadata=["enum", "imaging mode", "spring constant"], fmt={"h5": "hdf5"}.get(kind, kind))
    turned = read_force_curve(plain).branch.values  # the last point of the way in is that of the way out, too
    assert (turned.sum(), np.flatnonzero(np.diff(turned)).size) == (branch.sum(), 1)
    with pytest.raises(InputError, match="holds 1 force curves; curve = 1 must be 0 to 0"):
        read_force_curve(path, curve=1)
    with pytest.raises(InputError, match=r"columns: .* names of their own"):
        read_force_curve(path, columns="force (nN)")
    broken = written(tmp_path / f"broken.{kind}", "nothing")
    with pytest.raises(InputError, match=r"broken\.\w+ cannot be read"):
        read_force_curve(broken)


def test_one_of_the_curves_of_a_file_is_chosen(tmp_path):
    afm, h5py = pytest.importorskip("afmformats"), pytest.importorskip("h5py")
    displacement, force, branch = cycle()
    with h5py.File(tmp_path / "two.h5", "w") as file:
        for number in (0, 1):
            data = {"force": (1 + number) * force, "height (measured)": -displacement, "segment": branch}
            about = {"path": "", "enum": number, "imaging mode": "force-distance", "spring constant": STIFFNESS}
            curve = afm.mod_force_distance.AFMForceDistance(data, about)
            curve.export_data(file, metadata=["enum", "imaging mode", "spring constant"], fmt="hdf5")
    for number in (0, 1):
        found = read_force_curve(tmp_path / "two.h5", curve=number, zero_force="given")
        np.testing.assert_allclose(found.total_force, (1 + number) * force, atol=1e-14)
    with pytest.raises(InputError, match="holds 2 force curves; choose one with curve = 0 to 1"):
        read_force_curve(tmp_path / "two.h5")


FLAT = "displacement (nm), force (nN)\n" + "".join(f"{n},{(-1) ** n}\n" for n in range(200))


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("1.5,2\n2.5,3\n", {}, "has 2 columns of numbers without names"),
        ("displacement, force (nN)\n1,2\n", {}, "does not give the unit of 'displacement'; .*displacement \\(nm\\)"),
        ("displacement (nm), force (nm)\n1,2\n", {}, "column force .*nanometer cannot be converted"),
        ("displacement (nm), heat (K), force (nN)\n1,2,3\n", {}, "unknown column, 'heat \\(K\\)'; name it .* or - to"),
        ("force (nN), displacement (nm), force (uN)\n1,2,3\n", {}, "two columns of force"),
        ("displacement (nm), separation (nm), force (nN)\n1,2,3\n", {}, "displacement and separation; leave one"),
        ("contact radius (nm), contact area (nm^2), force (nN)\n1,2,3\n", {}, "contact area and contact radius"),
        ("force (nN)\n1\n", {}, "needs displacement or contact radius"),
        ("displacement (nm)\n1\n", {}, "no force and no deflection"),
        ("z (nm), force (nN)\n1,2\n", {}, "z, where the cantilever is held; give spring_constant"),
        ("z (nm), deflection (V)\n1,2\n", {"spring_constant": 1.0}, "deflection in V; give sensitivity"),
        ("z (nm), deflection (nm)\n1,2\n", {}, 'no force; give spring_constant, as in "0.1 N/m"'),
        ("displacement (nm), force (nN)\n1.5,2\n2,\n", {}, "row 2: the force is missing"),
        ("time (s), displacement (nm), force (nN)\n1,2,3\n0.5,3,4\n", {}, "row 2: time 0.5 s after 1 s"),
        ("time (s), displacement (nm), force (nN)\n1,2,3\n1,3,4\n", {}, "row 2: time 1 s after 1 s"),
        ("displacement (nm), force (nN), branch\n1,2,0\n2,3,7\n", {}, "branch other than 0"),
        ("displacement (nm), force (nN)\nlow,high\n", {}, "holds no numbers"),
        (FLAT, {"zero_displacement": "contact"}, "shows no contact: .* 5 deviations, 5e-09 N"),
        (FLAT[:200], {"zero_force": "baseline"}, "fewer than 10 points"),
        ("contact radius (nm), force (nN)\n1,2\n", {"zero_force": "baseline"}, "has no displacement; zero_force"),
        (FLAT, {"positive_force": "up"}, "positive_force = 'up': must be 'compression' or 'tension'"),
        (FLAT, {"spring_constant": "3 nN"}, "spring_constant = '3 nN'"),
        (FLAT, {"spring_constant": -3.0}, "spring_constant = -3.0: must be positive"),
        (FLAT, {"stiffness": 3.0}, "stiffness: is no option of a force curve; there is columns"),
        (FLAT, {"curve": 0}, "which holds one curve"),
        ("# zero_force = mean\n" + FLAT, {}, "curve.csv: zero_force = 'mean'"),
    ],
)
def test_what_cannot_be_read_is_one_line(tmp_path, text, options, message):
    with pytest.raises(InputError, match=message) as found:
        read_force_curve(written(tmp_path / "curve.csv", text), **options)
    assert "\n" not in str(found.value)


def test_a_missing_file_and_the_docstring_name_all_options(tmp_path):
    with pytest.raises(InputError, match=r"nowhere\.csv does not exist"):
        read_force_curve(tmp_path / "nowhere.csv")
    assert [name for name in OPTIONS if f"``{name}``" not in read_force_curve.__doc__] == []
    assert "contact_radius" in QUANTITIES
