"""Measured curves and theories of a sphere beside a computed force curve, and the command that draws them."""

import matplotlib.image
import numpy as np
import pytest
from matplotlib.figure import Figure

import contact_study
from contact_study import plots, start
from contact_study.command_line.verbs.plot import PICTURES
from theory import JKR, MaugisDugdale

RADIUS, MODULUS, WORK, REACH = 50e-9, 1e9, 0.02, 1e-9
STUDY = {
    "surface": {"kind": "sphere", "size": 60e-9, "shape": [32, 32], "radius": RADIUS},
    "material": {"youngs_modulus": MODULUS, "poissons_ratio": 0.0},
    "elasticity": {"boundary": "free"},
    "interaction": {"law": "dugdale", "work_of_adhesion": WORK, "length": REACH},
    "loading": {"path": [-0.5e-9, 0.5e-9, 1.5e-9, -0.3e-9], "control": "approach"},
}
MEASURED = """# positive_force = tension
displacement (nm), force (nN), contact radius (nm), force error (nN)
-0.5,4.2,nan,0.1
0.0,5.4,4.1,0.1
1.5,-13.3,10.7,0.2
0.1,5.1,4.9,0.1
"""


@pytest.fixture(scope="module")
def computed():
    return contact_study.run(STUDY, "continuum")


@pytest.fixture
def measured(tmp_path):
    path = tmp_path / "jkr.csv"
    path.write_text(MEASURED)
    return path


def line(axes, label):
    return next(one for one in axes.lines if str(one.get_label()).startswith(label))


def test_the_computed_sphere_is_on_the_line_of_maugis(computed):
    axes = plots.force_curve(computed, theories=["jkr", "maugis", "dmt", "hertz"])
    maugis = line(axes, "Maugis")
    sphere = MaugisDugdale(RADIUS, MODULUS, WORK, WORK / REACH)
    assert maugis.get_label() == f"Maugis, λ = {sphere.parameter:.2g} (σ₀: the law's peak)"
    displacement, force = maugis.get_xdata(), maugis.get_ydata()
    fit = np.isfinite(force)
    found = np.interp(1e9 * computed.displacement, displacement[fit], force[fit])
    # 32 points over 60 nm: the contact has 5 spacings across at most; the law's end is 2 % wide.
    np.testing.assert_allclose(1e9 * computed.total_force, found, atol=0.02 * np.abs(found).max())
    jkr = line(axes, "JKR")
    assert np.nanmin(jkr.get_ydata()) == pytest.approx(1e9 * JKR(RADIUS, MODULUS, WORK).pull_off_force, rel=1e-4)
    assert np.nanmin(line(axes, "DMT").get_ydata()) == pytest.approx(-2e9 * np.pi * WORK * RADIUS, rel=1e-4)
    assert np.nanmin(line(axes, "Hertz").get_ydata()) == 0
    unstable = axes.lines[axes.lines.index(jkr) + 1]
    assert unstable.get_alpha() < jkr.get_alpha()
    assert np.nanmax(jkr.get_ydata()) == pytest.approx(1e9 * float(computed.total_force.max()), rel=1e-6)
    # Lines end where the axes do; Maugis' curve would go on to -1 nm.
    assert displacement[fit].min() > 1e9 * float(computed.displacement.min()) - 0.5


def test_measured_points_are_drawn_in_the_units_of_all(computed, measured):
    curve = contact_study.read_force_curve(measured)
    axes = plots.force_curve(computed, measured=[curve, 1000 * curve], axes=Figure().subplots())
    assert axes.get_ylabel() == "force $F$ (µN)"
    assert axes.get_xlabel() == r"displacement $\delta$ (µm)"
    axes = plots.force_curve(computed, measured=[curve])
    assert axes.get_ylabel() == "force $F$ (nN)"
    container, back = axes.containers
    assert container.get_label() == "jkr.csv"
    points, _, bars = container
    np.testing.assert_allclose(points.get_xdata(), [-0.5, 0.0, 1.5])
    np.testing.assert_allclose(points.get_ydata(), [-4.2, -5.4, 13.3])
    assert (points.get_markerfacecolor(), back[0].get_markerfacecolor()) == ("white", back[0].get_color())
    np.testing.assert_allclose(back[0].get_xydata(), [[0.1, -5.1]])
    np.testing.assert_allclose([one[:, 1] for one in bars[0].get_segments()][2], [13.1, 13.5])


def test_against_the_contact_radius(computed, measured):
    curve = contact_study.read_force_curve(measured)
    passed = {
        f"passed_{name}": computed[f"mean_{name}"].expand_dims("passed", -1) for name in ("pressure", "separation")
    }
    known = computed.assign(passed)  # radii are known of the points of the path alone
    axes = plots.force_curve(known, against="contact_radius", measured=[curve], theories=["jkr"])
    shown = [line.get_xdata() for line in axes.lines[:2]]
    np.testing.assert_allclose(shown[0], 1e9 * computed.contact_radius)
    assert axes.get_xlabel() == "contact radius $a$ (nm)"
    jkr = line(axes, "JKR")
    a = 1e-9 * jkr.get_xdata()[np.isfinite(jkr.get_ydata())][-1]
    expected = 4 * MODULUS * a**3 / (3 * RADIUS) - np.sqrt(8 * np.pi * WORK * MODULUS * a**3)
    assert jkr.get_ydata()[-1] == pytest.approx(1e9 * expected, rel=1e-9)
    np.testing.assert_allclose(axes.containers[0][0].get_xdata()[1:], [4.1, 10.7])
    with pytest.raises(ValueError, match=r"jkr\.csv: .* no variable 'displacement'; draw it against another"):
        plots.force_curve(computed, measured=[curve.drop_vars("displacement")])


@pytest.mark.parametrize(
    ("changes", "arguments", "message"),
    [
        ({}, {"theories": ["hertz", "greenwood"]}, "'greenwood' is none of hertz, jkr, dmt, maugis"),
        ({}, {"theories": ["jkr"], "against": "approach"}, "no approach of a machine"),
        ({"interaction": {"law": "hard_wall"}}, {"theories": ["dmt"]}, 'does not attract; use "hertz"'),
        ({"surface": {"kind": "flat", "size": 6e-8, "shape": [8, 8]}}, {"theories": ["jkr"]}, "no smooth sphere"),
        ({"detail": {"kind": "wavy", "amplitude": 1e-9, "modes": [3, 3]}}, {"theories": ["jkr"]}, "no smooth sphere"),
        (
            {"adhesion_map": {"kind": "patches", "modes": [2, 0], "contrast": 0.5}},
            {"theories": ["jkr"]},
            r"one work of adhesion; this study's varies by \[adhesion_map\]",
        ),
        ({"elasticity": {"kind": "layer", "thickness": 1e-8}}, {"theories": ["jkr"]}, "elastic half-space"),
        (
            {"sweep": {"surface.radius": [RADIUS, 2 * RADIUS]}},
            {"theories": ["jkr"]},
            "does not say which radius of its study",
        ),
        (None, {"theories": ["jkr"]}, "attribute study_toml"),
    ],
)
def test_what_cannot_be_drawn_is_named(computed, changes, arguments, message):
    text = "" if changes is None else contact_study.make_study(STUDY | changes).toml
    with pytest.raises(ValueError, match=message):
        plots.force_curve(computed.assign_attrs(study_toml=text), **arguments)


def test_one_case_of_a_sweep_has_its_own_sphere(computed):
    study = contact_study.make_study(STUDY | {"sweep": {"surface.radius": [RADIUS, 2 * RADIUS]}})
    swept = computed.assign_attrs(study_toml=study.toml).assign_coords(radius=2 * RADIUS)
    axes = plots.force_curve(swept, theories=["dmt"])
    assert np.nanmin(line(axes, "DMT").get_ydata()) == pytest.approx(-4e9 * np.pi * WORK * RADIUS, rel=1e-4)


def test_a_form_without_roughness_is_a_sphere(computed):
    flat = {"kind": "flat", "size": 6e-8, "shape": [32, 32]}
    for form in ({"kind": "sphere", "radius": RADIUS}, {"kind": "paraboloid", "radii": RADIUS}):
        text = contact_study.make_study(STUDY | {"surface": flat, "form": form}).toml
        axes = plots.force_curve(computed.assign_attrs(study_toml=text), theories=["dmt"])
        assert np.nanmin(line(axes, "DMT").get_ydata()) == pytest.approx(-2e9 * np.pi * WORK * RADIUS, rel=1e-4)


def test_the_command_draws_measured_curves_and_theories(computed, measured, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    computed.to_netcdf("bem.nc")
    drawn = []
    draw = plots.force_curve
    monkeypatch.setattr(plots, "force_curve", lambda *given, **named: drawn.append(draw(*given, **named)) or drawn[-1])

    def command(*words):
        status = start.bem_adhesion(["plot", "bem.nc", *map(str, words)])
        return status, capsys.readouterr().err

    assert command("force", "--measured", measured, "--theory", "jkr", "maugis", "-o", "a.png")[0] == 0
    assert matplotlib.image.imread("a.png").shape[1] > 400
    assert {"jkr.csv", "JKR"} <= {*drawn[-1].get_legend_handles_labels()[1]}
    flipped = ["--reading", "positive_force=compression", "--against", "contact_radius"]
    assert command("force", "--measured", measured, *flipped)[0] == 0
    np.testing.assert_allclose(drawn[-1].containers[0][0].get_ydata()[1:], [5.4, -13.3])
    for words, message in (
        (["area", "--measured", measured], "--measured: belongs to the picture force"),
        (["force", "--reading", "curve=1"], "--reading: says how to read measured curves"),
        (["force", "--measured", measured, "--reading", "zero"], "--reading zero: expected KEY=VALUE"),
        (["force", "--measured", measured, "--reading", "curve=1"], "curve: "),
        (["force", "--measured", "none.csv"], "none.csv does not exist"),
        (["force", "--measured", measured, "-o", measured], "expected a name that ends in"),
        (["force", "--theory", "jrk"], "'jrk' is none of hertz"),
    ):
        status, errors = command(*words)
        assert (status, errors.count("\n")) == (1, 1)
        assert message in errors
    assert PICTURES["force"][0] == "force_curve"
