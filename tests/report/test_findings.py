"""Facts of the report's findings: rankings, extremes, scatter; and that every one of them reaches the text."""

import numpy as np
import pytest
import xarray as xr

from contact_study.report.align.deviations import compute_deviations
from contact_study.report.align.ensemble import ensemble_statistics
from contact_study.report.align.regime import compute_regime
from contact_study.report.facts.captions import _balances
from contact_study.report.facts.findings import find, surface_deviations
from contact_study.report.facts.ranking import DIVIDED, EQUAL, NEARER, rank_models
from contact_study.report.models import MODELS
from contact_study.report.read.datasets import read_inputs
from contact_study.report.read.scatter import read_scatter
from tests.report.synthetic import STUDY, area, write, write_all

SEEDS = np.array([1, 2, 4])
SEEDED = STUDY.replace("[sweep]\n", f'[sweep]\n"surface.seed" = {SEEDS.tolist()}\n')
AREA, GAP = "relative_contact_area_relative_deviation", "mean_gap_deviation"
LABELS = ["ε = ε₀", "ε = 8 ε₀"]
PRESSURES = {1: [0.1e9, 0.7799e9, 5.8725e9], 8: [0.1e9, -0.4987e9, 0.7799e9, 5.8725e9]}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    return read_inputs(write_all(tmp_path_factory.mktemp("findings")))


def compared(inputs, change=lambda deviations: None):
    """Models, deviations with a change made, and regime numbers."""
    deviations = compute_deviations(inputs.models, inputs.control).copy(deep=True)
    change(deviations)
    return inputs.models, deviations, compute_regime(inputs)


def test_one_surface_is_no_order(inputs):
    """The paper's comparison: correlated states of one surface, some of them on a grid that traps contact edges."""
    models, deviations, regime = compared(inputs)
    regime["pixel_over_process_zone"][:] = [0.2, 0.25]
    found = rank_models(models, deviations, regime)
    assert [(each.at, each.states, each.surfaces, each.trapped) for each in found] == [
        ("ε = ε₀", 3, 1, 0.0),
        ("ε = 8 ε₀", 4, 1, 0.25),
    ]
    assert not any(each.relations for each in found)
    first = {each.model: each for each in found[0].distances}
    assert first["persson"].area == pytest.approx(4 / 9, rel=1e-9)  # 0.5 for 0.9
    assert first["continuum"].gap == pytest.approx(0.05, rel=1e-9)
    assert np.isnan(first["continuum"].area_error)
    text = " ".join(find(models, deviations, regime).sentences())
    assert text.count("One surface cannot decide their order.") == 2
    assert text.count("the grid may trap contact edges") == 1
    assert "nearest" not in text
    assert "Persson's theory is published. The gap-flow theory is this project's own, unpublished." in text
    assert "median" not in text


@pytest.mark.parametrize(
    ("area_of_persson", "gap_of_persson", "relation"),
    [
        ([0.10, 0.11, 0.12], [0.0, 0.0, 0.0], NEARER),  # always nearer in area, no worse in gap
        ([0.10, 0.40, 0.32], [0.0, 0.0, 0.0], EQUAL),  # nearer on some surfaces only
        ([0.10, 0.11, 0.12], [0.5, 0.51, 0.52], DIVIDED),
    ],
)
def test_an_ensemble_decides_where_its_scatter_allows(tmp_path, area_of_persson, gap_of_persson, relation):
    """Of two theories; the other one is off by 0.3 in area and not in mean gap, on each of three surfaces."""
    seeded = read_inputs([write(tmp_path / f"{kind}.nc", kind, SEEDED) for kind in ("continuum", "theory")])

    def change(deviations):
        for name, persson, flow in ((AREA, area_of_persson, 0.3), (GAP, np.array(gap_of_persson) * 1e-9, 0.0)):
            for pair, values in (("persson - continuum", persson), ("gap_flow - continuum", [flow] * 3)):
                own = deviations[name].sel(pair=pair)
                signs = (-1.0) ** np.arange(own.sizes["step"])  # magnitudes count, not signs
                values = xr.DataArray(values, dims="seed") * xr.DataArray(signs, dims="step")
                deviations[name].loc[{"pair": pair}] = values.where(own.notnull()).transpose(*own.dims)

    models, deviations, regime = compared(seeded, change)
    for ranking in rank_models(models, deviations, regime):
        assert ranking.surfaces == 3
        assert ranking.relations == (relation,)
        one, other = ranking.distances
        if relation == NEARER:
            assert (one.model, other.model) == ("persson", "gap_flow")
        own = {one.model: one, other.model: other}["persson"]
        assert own.area == pytest.approx(np.mean(area_of_persson), rel=1e-9)
        assert own.area_error == pytest.approx(np.std(area_of_persson, ddof=1) / np.sqrt(3), rel=1e-9)
    text = " ".join(find(models, deviations, regime).sentences())
    words = {NEARER: ", then ", EQUAL: ", not distinguishable from it ", DIVIDED: ", in opposite order "}
    assert text.count(words[relation]) == 2
    assert "3 surfaces; from the nearest to the continuum to the farthest" in text
    assert "cannot decide" not in text


def test_models_are_ranked_by_shared_states_and_each_point_by_itself(tmp_path):
    """One pair lacks the state where another is far off; without a shared state there is no ranking."""
    paths = [
        write(tmp_path / "c.nc", "continuum", STUDY, unconverged=[(0, 0)]),
        write(tmp_path / "a.nc", "atomistic", STUDY),
        write(tmp_path / "t.nc", "theory", STUDY),
    ]
    here = {"pair": "persson - atomistic", "well_depth_ratio": 1, "step": 0}
    models, deviations, regime = compared(read_inputs(paths), lambda found: found[AREA].loc.__setitem__(here, -0.87))
    first, second = rank_models(models, deviations, regime)
    assert (first.states, second.states) == (2, 4)
    assert {each.model: each.area for each in first.distances}["persson"] == pytest.approx(4 / 9, rel=1e-9)
    findings = find(models, deviations, regime)
    assert not findings.unranked
    write(tmp_path / "c.nc", "continuum", STUDY, unconverged=[(case, step) for case in (0, 1) for step in (1, 2, 3)])
    write(tmp_path / "t.nc", "theory", STUDY, unconverged=[(0, 0), (1, 0)])
    findings = find(*compared(read_inputs(paths)))
    assert findings.unranked
    assert "share no state" in findings.sentences()[0]


def test_scatter_between_surfaces(inputs, tmp_path):
    scatter = read_scatter(write(tmp_path / "seeds.nc", "continuum", SEEDED), inputs)
    models, deviations, regime = compared(inputs)
    statistics = ensemble_statistics({scatter.model: scatter.dataset})
    from_surfaces = surface_deviations(models, scatter.model, scatter.dataset)
    (found,) = find(models, deviations, regime, statistics, from_surfaces).scatter
    areas = {ratio: area(ratio, np.array([p]), SEEDS[:, None]) for ratio, p in PRESSURES.items()}
    relative = {ratio: values.std(0, ddof=1) / values.mean(0) for ratio, values in areas.items()}
    for label, values in zip(LABELS, relative.values(), strict=True):
        assert found.relative[label] == pytest.approx(values.mean(), rel=1e-9)
    one = {ratio: area(ratio, np.array(p)) for ratio, p in PRESSURES.items()}
    within = sum(int((np.abs(one[r] - areas[r].mean(0)) <= areas[r].std(0, ddof=1)).sum()) for r in PRESSURES)
    assert found.within == (within, 7)
    # A theory that knows one surface, paired with each of three.
    for ranking, ratio in zip(found.rankings, PRESSURES, strict=True):
        off = np.abs(0.5 * one[ratio] / areas[ratio] - 1).mean(axis=1)
        persson = {each.model: each for each in ranking.distances}["persson"]
        assert persson.area == pytest.approx(off.mean(), rel=1e-9)
        assert persson.area_error == pytest.approx(off.std(ddof=1) / np.sqrt(3), rel=1e-9)
        assert [each.model for each in ranking.distances] == ["gap_flow", "persson"]
    # Where theories are fed with the target, too, these are compared.
    both = {**models, "persson@analytic": models["gap_flow"], "gap_flow@analytic": models["gap_flow"]}
    target = surface_deviations(both, scatter.model, scatter.dataset)
    assert {pair.partition(" - ")[0] for pair in target["pair"].values} == {"persson@analytic", "gap_flow@analytic"}


def test_every_theory_has_a_status():
    own = {entry.name: entry.status for entry in MODELS if not entry.simulation}
    assert own == {
        "persson": "published",
        "gap_flow": "this project's own, unpublished",
        "edge_flow": "this project's own, unpublished",
    }


def test_captions_name_theories_whose_stress_does_not_carry_the_pressure():
    balances = {"persson": [1.0, 0.995], "edge_flow": [0.84, np.nan, 0.98], "gap_flow": [np.nan, np.nan]}
    models = {name: xr.Dataset({"stress_balance": ("step", values)}) for name, values in balances.items()}
    assert list(_balances({**models, "continuum": xr.Dataset()})) == [("the edge flow", 0.84, 0.98)]
