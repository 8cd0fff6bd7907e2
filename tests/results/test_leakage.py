"""Reynolds flow through the gap: closed forms, a network solved another way, another program, the whole command."""

import numpy as np
import pytest

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.results.observables.gap_at_edge import distance_to_contact
from contact_study.results.observables.leakage import hydraulic_gaps

SPACING = (2e-9, 0.5e-9)
PERIODIC = pytest.mark.parametrize("periodic", [True, False])


@PERIODIC
def test_plates_that_vary_along_one_axis(periodic):
    """In parallel the mean of u³, in series its harmonic mean: exact for this discretisation."""
    film = np.tile(np.random.default_rng(1).uniform(1e-9, 5e-9, 9), (5, 1))
    along_y, along_x = hydraulic_gaps(film, SPACING, periodic)
    assert along_y == pytest.approx(np.mean(film[0] ** 3) ** (1 / 3), rel=1e-12)
    assert along_x == pytest.approx(np.mean(film[0] ** -3.0) ** (-1 / 3), rel=1e-12)
    np.testing.assert_allclose(hydraulic_gaps(film.T, SPACING[::-1], periodic), (along_x, along_y), rtol=1e-12)


def test_a_channel_that_winds_once_up_and_twice_across():
    """Of n cells in a row with the drop of two periods: 2/n of it at each side, and 2/n of that flow in each row."""
    steps = [*("x" * 5), "y", *("x" * 5), "y", *("x" * 6), "y"]  # 16 across, of 8 columns: two periods; 3 up
    y, x, cells = 0, 0, []
    for step in steps:
        cells.append((y % 6, x % 8))
        y, x = y + 2 * (step == "y"), x + (step == "x")
        if step == "y":
            cells.append(((y - 1) % 6, x % 8))
    channel = np.zeros((6, 8))
    for cell in cells:
        channel[cell] = 3e-9
    number = len(set(cells))
    assert number == len(cells) == 22
    expected = [3e-9 * (periods**2 / number * ratio) ** (1 / 3) for periods, ratio in ((1, 6 / 8), (2, 8 / 6))]
    np.testing.assert_allclose(hydraulic_gaps(channel, (1.0, 1.0)), expected, rtol=1e-12)


def network(film, spacing, axis, periodic):
    """Sides as resistors, pressures by least squares, the flow by summing over one section."""
    cells, lines = film.size, film.shape[axis]
    rows, jumps, conductances, sections = [], [], [], []
    number = np.arange(cells).reshape(film.shape)
    for along in (0, 1):
        ratio = spacing[1 - along] / spacing[along]
        for place in np.ndindex(film.shape):
            there = list(place)
            there[along] = (place[along] + 1) % film.shape[along]
            over = place[along] + 1 == film.shape[along]
            one, other = film[place] ** 3, film[tuple(there)] ** 3
            ends = [(place, 1.0), (tuple(there), -1.0)]
            sides = [(ends, 0.0 if not (over and along == axis) else 1.0, 2 * one * other / (one + other + 1e-99))]
            if over and not periodic:
                sides = [([ends[0]], 0.0, 2 * one), ([ends[1]], 1.0, 2 * other)] if along == axis else []
            for pair, jump, conductance in sides:
                rows.append(np.zeros(cells))
                for where, sign in pair:
                    rows[-1][number[where]] += sign
                jumps.append(jump)
                conductances.append(conductance * ratio)
                sections.append(along == axis and jump == 1.0)
    fall, jump, conductance = np.array(rows), np.array(jumps), np.array(conductances)
    root = np.sqrt(conductance)
    pressure = np.linalg.lstsq(root[:, None] * fall, -root * jump, rcond=1e-13)[0]
    flow = conductance * (fall @ pressure + jump)
    width = film.shape[1 - axis] * spacing[1 - axis]
    return (flow[np.array(sections)].sum() * lines * spacing[axis] / width) ** (1 / 3)


@PERIODIC
def test_a_rough_film_is_a_network(periodic):
    rng = np.random.default_rng(3)
    film = np.where(rng.random((8, 11)) < 0.25, 0.0, rng.uniform(0.2, 1.0, (8, 11)))
    found = hydraulic_gaps(film, SPACING, periodic)
    expected = [network(film, SPACING, axis, periodic) for axis in (0, 1)]
    assert min(expected) > 0.05
    np.testing.assert_allclose(found, expected, rtol=1e-9)  # rounding of least squares
    if periodic:
        np.testing.assert_allclose(hydraulic_gaps(np.roll(film, (3, 5), (0, 1)), SPACING), found, rtol=1e-12)


@PERIODIC
def test_nothing_leaks_where_nothing_leads_through(periodic):
    film = np.ones((6, 8))
    film[2] = 0.0
    along_y, along_x = hydraulic_gaps(film, (1.0, 1.0), periodic)
    assert along_y == 0.0
    assert along_x == pytest.approx((5 / 6) ** (1 / 3))
    assert hydraulic_gaps(np.zeros((4, 4)), (1.0, 1.0), periodic) == (0.0, 0.0)
    assert hydraulic_gaps(np.full((4, 4), np.inf), (1.0, 1.0), periodic) == (np.inf, np.inf)


def test_a_narrow_constriction_keeps_its_digits():
    """All of the drop is at one cell, whose u³ is 1e-18 of the others'."""
    film = np.ones((5, 7))
    film[:, 3] = 0.0
    film[2, 3] = 1e-6
    _, along_x = hydraulic_gaps(film, (1.0, 1.0))
    assert along_x == pytest.approx(1e-6 * (7 / 5) ** (1 / 3), rel=1e-6)  # two halves of a cell in series


@PERIODIC
def test_distances_to_contact_are_those_of_all_pairs(periodic):
    rng = np.random.default_rng(2)
    for share in (0.01, 0.2):
        contact = rng.random((13, 9)) < share
        contact[4, 1] = True
        y, x = np.nonzero(contact)
        down, across = (np.abs(np.arange(n)[:, None] - at) for n, at in zip(contact.shape, (y, x), strict=True))
        if periodic:
            down, across = np.minimum(down, 13 - down), np.minimum(across, 9 - across)
        every = np.hypot(down[:, None] * SPACING[0], across[None] * SPACING[1]).min(axis=-1)
        np.testing.assert_allclose(distance_to_contact(contact, SPACING, periodic), every, rtol=1e-12)


STUDY = {
    "surface": {
        "kind": "self_affine",
        "size": "1 um",
        "shape": [32, 32],
        "rms_height": "10 nm",
        "roll_off_mode": 2,
        "cutoff_mode": 8,
    },
    "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": ["5 MPa", "15 MPa", "120 MPa"]},
}


def test_leakage_from_a_study_to_its_dataset(tmp_path):
    plain = contact_study.run(STUDY, "continuum", output=tmp_path / "bem.nc")
    assert "hydraulic_gap_x" not in plain
    asked = {**STUDY, "output": {"leakage": True, "fields": True, "stiffness": True}}
    found = contact_study.run(asked, "continuum", output=tmp_path / "asked.nc")
    film = np.where(found.pressure > 0, 0.0, found.gap)
    for step, each in enumerate(film):
        found_there = [float(found[f"hydraulic_gap_{axis}"][step]) for axis in "yx"]
        np.testing.assert_allclose(found_there, hydraulic_gaps(each, (1e-6 / 32,) * 2), rtol=1e-12)
    flows = found.hydraulic_gap_x.values
    assert (np.diff(flows) < 0).all()
    assert flows[0] < found.mean_gap[0]
    assert flows[-1] == 0.0
    np.testing.assert_array_equal(found.gap_percolates, [1, 1, 0])
    area, half = float(found.percolation_area), float(found.percolation_area_resolution_error)
    np.testing.assert_allclose([area - half, area + half], found.relative_contact_area[1:], rtol=1e-12)
    modulus = 1e9 / (1 - 0.3**2)
    np.testing.assert_allclose(found.contact_conductance, found.contact_stiffness / modulus, rtol=1e-12)
    with pytest.raises(InputError, match=r"output\.leakage = true, this study has false"):
        contact_study.run({**STUDY, "output": {"fields": True}}, "continuum", output=tmp_path / "asked.nc", resume=True)
    with pytest.raises(InputError, match=r"output\.leakage = 'x'"):
        contact_study.make_study({**STUDY, "output": {"leakage": "x"}})
    with pytest.warns(UserWarning, match=r"output\.leakage = true: the earlier run did not keep its leakage"):
        again = contact_study.run(
            {**STUDY, "output": {"leakage": True}}, "continuum", output=tmp_path / "bem.nc", resume=True
        )
    np.testing.assert_allclose(again.hydraulic_gap_x, flows, rtol=1e-12)


def test_conductance_of_a_spot_is_that_of_holm():
    """A spot of radius a conducts as 2 a times the mean conductivity."""
    sphere = {
        "surface": {"kind": "sphere", "radius": "1 um", "size": "0.3 um", "shape": [64, 64]},
        "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.0},
        "interaction": {"law": "hard_wall"},
        "elasticity": {"boundary": "free"},
        "loading": {"path": [f"{4 / 3 * 1e9 * (1e-7) ** 3 / 1e-6} N"]},
        "output": {"stiffness": True},
    }
    found = contact_study.run(sphere, "continuum")
    # Half of a spacing in the radius of 21: the contact errs by so much at its edge.
    assert float(found.contact_conductance[0]) * 0.3e-6**2 == pytest.approx(2 * 1e-7, rel=0.02)


@pytest.mark.validation
def test_equals_another_program():
    transport = pytest.importorskip("reynoldsflow.transport", reason="pip install reynoldsflow")
    rng = np.random.default_rng(1)
    film = np.where(rng.random((48, 48)) < 0.3, 0.0, rng.uniform(0.01, 1.0, (48, 48)))
    open_, _, flux = transport.solve_fluid_problem(film, boundary_mode="periodic")
    flow, _ = transport.compute_total_flux(open_, flux, 48, "periodic")
    assert hydraulic_gaps(film, (1.0, 1.0))[0] == pytest.approx(flow ** (1 / 3), rel=1e-7)  # of its iterations
