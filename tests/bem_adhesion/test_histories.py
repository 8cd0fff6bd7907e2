"""Histories of the load in time: cycles, speeds and dwells, and what a cycle costs in closed form."""

import numpy as np
import pytest

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.study.case import realise
from contact_study.study.study import make_study

pytestmark = pytest.mark.filterwarnings("ignore:.*process zone")

SLOW, BRANCH, TIME, RATIO = 10e6, 90e6, 1.0, 0.5
SIDE = 1e-6


def study(viscoelastic=True, **loading):
    table = {
        "surface": {"kind": "wavy", "size": SIDE, "shape": [16, 16], "amplitude": 1e-13, "modes": [0, 1]},
        "material": {"youngs_modulus": SLOW, "poissons_ratio": RATIO},
        "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": "20 nm"},
        "solver": {"tolerance": 1e-13},
        "loading": loading,
    }
    if viscoelastic:
        table["elasticity"] = {"kind": "viscoelastic", "branch_youngs_moduli": [BRANCH], "relaxation_times": [TIME]}
    return table


def path_of(viscoelastic=True, **loading):
    (case,) = make_study(study(viscoelastic, **loading)).cases
    return [value for value, _ in case.path], case.loading.times()


def loss_of_a_cycle(case, rate, mean, amplitude):
    """π J'' F² per wave: the law is a spring k, and its change under the load bends the wave by F = δk (h − u)."""
    law, heights = case.law, realise(case).sampled
    gap = law.equilibrium_distance + np.linspace(-3e-9, 3e-9, 60_001)
    gap = gap[np.argmin(np.abs(law.traction(gap) + mean))]  # tension is positive
    step = 1e-12
    spring, change = law.stiffness(np.array(gap)), law.stiffness(gap + np.array([-step, step]))
    change = (change[1] - change[0]) / (2 * step) * amplitude / spring
    modulus = (SLOW + BRANCH * 1j * rate * TIME / (1 + 1j * rate * TIME)) / (1 - RATIO**2)
    solid, relaxed = np.pi / SIDE * modulus, np.pi / SIDE * SLOW / (1 - RATIO**2)
    bend = change * relaxed / (spring + relaxed)  # per height, that of the solid being k h / (k + K)
    return np.pi * np.mean(heights**2) * bend**2 * -(1 / (spring + solid)).imag


@pytest.mark.parametrize(
    ("rate", "cycles"), [pytest.param(0.3, 3, marks=pytest.mark.validation), (3.0, 7)]
)  # until what creeps, in ten seconds, is at rest
def test_a_cycle_in_full_contact_loses_pi_times_the_loss_compliance(rate, cycles):
    mean, amplitude, errors = 1e5, 1e4, []
    for points in (8, 16):
        wave = {"amplitude": amplitude, "period": 2 * np.pi / rate, "cycles": cycles, "points_per_cycle": points}
        table = study(path=[mean, mean], duration=1e3, history="sine", **wave)
        lost = contact_study.run(table, "continuum").viscous_dissipation.values
        expected = loss_of_a_cycle(make_study(table).cases[0], rate, mean, amplitude)
        errors.append((lost[-1] - lost[-1 - points]) / expected - 1)
    # Chords of a sine err by (2π/n)²/6 in its square, 2.6 % of 16 points. The rest: a finite load.
    assert errors[1] == pytest.approx(-((2 * np.pi / 16) ** 2) / 6, abs=0.005)
    assert (4 * errors[1] - errors[0]) / 3 == pytest.approx(0.0, abs=0.005), "second order"


def test_cycles_follow_the_last_point_and_times_the_speeds():
    given = {"path": ["1 kPa", "3 kPa"], "speed": ["1 kPa/s", "500 Pa/s"], "amplitude": "1 kPa", "period": "8 s"}
    values, times = path_of(**given, history="triangle", points_per_cycle=8, cycles=2)
    assert values == pytest.approx([1e3, 3e3, *2 * [3500, 4e3, 3500, 3e3, 2500, 2e3, 2500, 3e3]])
    assert times == pytest.approx([1.0, 4.0, *16 * [1.0]])
    sine, _ = path_of(**given, history="sine", points_per_cycle=12)
    assert sine[2:6] == pytest.approx([3500, 3e3 + 500 * 3**0.5, 4e3, 3e3 + 500 * 3**0.5])
    _, times = path_of(path=[1e3, 2e3, 2e3, 1e3], speed=1e3, duration=7.0)
    assert times == pytest.approx([1.0, 1.0, 7.0, 1.0]), "duration is that of dwells"
    _, times = path_of(path=[1e3, 3e3], speed=[1e3, 500.0], unload=True)
    assert times == pytest.approx([1.0, 4.0, 4.0])
    forces, times = path_of(path=["1 nN"], speed="1 nN/s", history="sine", amplitude="0.5 nN", period=1.0)
    assert max(forces) == pytest.approx(1.5e-9 / SIDE**2)
    assert times[0] == pytest.approx(1.0)
    # Without time a history is a path of loads.
    assert path_of(False, path=[1e3], history="sine", amplitude=500.0)[0] == pytest.approx(
        path_of(path=[1e3], duration=1.0, history="sine", amplitude=500.0, period=1.0)[0]
    )


def test_more_cycles_go_on_from_where_fewer_ended(tmp_path):
    def run(cycles, **options):
        given = {"path": [1e-9], "control": "gap", "speed": 1e-7, "history": "triangle", "amplitude": 5e-10}
        table = study(**given, period=1.0, points_per_cycle=4, cycles=cycles)
        return contact_study.run(table, "continuum", **options)

    whole, output = run(2), tmp_path / "cycles.nc"
    assert run(1, output=output).sizes["step"] == 5
    longer = run(2, output=output, resume=True)
    assert "step" in longer.sizes
    np.testing.assert_array_equal(longer.viscous_dissipation, whole.viscous_dissipation)
    # From the gap out of reach, at the speed; then a period each.
    assert whole.time[-1] - whole.time[0] == pytest.approx(2.0)
    assert whole.time[0] > 0.1


WAVES = {"history": "sine", "amplitude": 10.0, "period": 1.0}


@pytest.mark.parametrize(
    ("loading", "words"),
    [
        ({"speed": 0.0}, r"loading\.speed = 0\.0: must be positive"),
        ({"speed": "1 nm/s"}, r"loading\.speed = '1 nm/s'.*Pa/s"),
        ({"speed": 1.0, "duration": 1.0}, "give one of them"),
        ({"speed": [1.0, 2.0]}, r"loading\.speed holds 2 speeds for 1 points"),
        ({"speed": 1.0, "path": [1e3, 1e3]}, r"missing key loading\.duration.*dwell at 1000"),
        ({}, r"missing key loading\.duration.*loading\.speed"),
        ({"duration": 1.0, **WAVES, "amplitude": None}, r"missing key loading\.amplitude"),
        ({"duration": 1.0, **WAVES, "period": None}, r"missing key loading\.period"),
        ({"duration": 1.0, "cycles": 2}, r"loading\.cycles: belongs to loading\.history"),
        ({"duration": 1.0, **WAVES, "points_per_cycle": 6}, "multiples of 4"),
        ({"duration": 1.0, **WAVES, "unload": True}, r"loading\.unload.*last cycle"),
        ({"viscoelastic": False, "speed": 1.0}, r"loading\.speed.*no time"),
        ({"viscoelastic": False, **WAVES}, r"loading\.period.*no time"),
    ],
)
def test_histories_that_do_not_fit_are_refused(loading, words):
    with pytest.raises(InputError, match=words):
        path_of(**{"path": [1e3], **{name: value for name, value in loading.items() if value is not None}})
