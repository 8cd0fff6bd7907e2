"""Rankings, scatter between surfaces, and that every finding reaches the text."""

import numpy as np
import pytest
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.report.align.deviations import compute_deviations, ensemble_statistics
from contact_study.report.align.regime import compute_regime
from contact_study.report.facts.ranking import DIVIDED, EQUAL, NEARER, find, rank_models, surface_deviations
from contact_study.report.facts.shown_states import _balances
from contact_study.report.read.datasets import read_inputs, read_scatter
from tests.report.panels import reported, run
from tests.report.synthetic import H_RMS, HEIGHTS, PRESSURES, SEEDED, STUDY, area, of_seeds, read, write

AREA, GAP = "relative_contact_area_relative_deviation", "mean_gap_deviation"
LABELS = ["ε = ε₀", "ε = 8 ε₀"]


def compared(inputs, change=lambda deviations: None):
    """Models, deviations with a change made, and regime numbers."""
    deviations = compute_deviations(inputs.models, inputs.control).copy(deep=True)
    change(deviations)
    return inputs.models, deviations, compute_regime(inputs)


def by_model(ranking):
    return {each.model: each for each in ranking.distances}


def test_one_surface_is_no_order(inputs):
    """The paper's comparison: correlated states of one surface, some of them on a grid that traps contact edges."""
    models, deviations, regime = compared(inputs)
    regime["pixel_over_process_zone"][:] = [0.2, 0.25]
    found = rank_models(models, deviations, regime)
    assert [(each.at.label, each.states, each.surfaces, each.trapped) for each in found] == [
        (LABELS[0], 3, 1, 0.0),
        (LABELS[1], 4, 1, 0.25),
    ]
    assert not any(each.relations for each in found)
    first = by_model(found[0])
    assert first["persson"].area == pytest.approx(4 / 9, rel=1e-9)  # 0.5 for 0.9
    assert first["continuum"].gap == pytest.approx(0.5e-10 / H_RMS, rel=1e-9)
    assert np.isnan(first["continuum"].area_error)
    text = " ".join(find(models, deviations, regime).sentences())
    assert text.count("One surface cannot decide their order.") == 2
    assert text.count("the grid may trap contact edges") == 1
    assert "nearest" not in text
    assert "Persson's theory is published. The gap-flow theory is this project's own, unpublished." in text


@pytest.mark.parametrize(
    ("area_of_persson", "gap_of_persson", "relation", "words"),
    [
        ([0.10, 0.11, 0.12], [0.0, 0.0, 0.0], NEARER, ", then "),  # always nearer in area, no worse in gap
        ([0.10, 0.40, 0.32], [0.0, 0.0, 0.0], EQUAL, ", not distinguishable from it "),  # on some surfaces only
        ([0.10, 0.11, 0.12], [0.5, 0.51, 0.52], DIVIDED, ", in opposite order "),
    ],
)
def test_an_ensemble_decides_where_its_scatter_allows(tmp_path, area_of_persson, gap_of_persson, relation, words):
    """Of two theories; the other one is off by 0.3 in area and not in mean gap, on each of three surfaces."""

    def change(deviations):
        for name, persson, flow in ((AREA, area_of_persson, 0.3), (GAP, np.array(gap_of_persson) * 1e-9, 0.0)):
            for pair, values in (("persson - continuum", persson), ("gap_flow - continuum", [flow] * 3)):
                own = deviations[name].sel(pair=pair)
                signs = (-1.0) ** np.arange(own.sizes["step"])  # magnitudes count, not signs
                values = xr.DataArray(values, dims="seed") * xr.DataArray(signs, dims="step")
                deviations[name].loc[{"pair": pair}] = values.where(own.notnull()).transpose(*own.dims)

    models, deviations, regime = compared(read(tmp_path, SEEDED, ("continuum", "theory")), change)
    for ranking in rank_models(models, deviations, regime):
        assert ranking.surfaces == 3
        assert ranking.relations == (relation,)
        if relation == NEARER:
            assert list(by_model(ranking)) == ["persson", "gap_flow"]
        own = by_model(ranking)["persson"]
        assert own.area == pytest.approx(np.mean(area_of_persson), rel=1e-9)
        assert own.area_error == pytest.approx(np.std(area_of_persson, ddof=1) / np.sqrt(3), rel=1e-9)
    text = " ".join(find(models, deviations, regime).sentences())
    assert text.count(words) == 2
    assert "3 surfaces; from the nearest to the continuum to the farthest" in text
    assert "cannot decide" not in text


def test_without_a_shared_state_there_is_no_ranking(tmp_path):
    paths = [
        write(tmp_path / "a.nc", "atomistic"),
        write(tmp_path / "c.nc", "continuum", unconverged=[(case, step) for case in (0, 1) for step in (1, 2, 3)]),
        write(tmp_path / "t.nc", "theory", unconverged=[(0, 0), (1, 0)]),
    ]
    findings = find(*compared(read_inputs(paths)))
    assert findings.unranked
    assert "share no state" in findings.sentences()[0]


def test_scatter_between_surfaces(seeds, inputs):
    scatter = read_scatter(seeds, inputs)
    models, deviations, regime = compared(inputs)
    statistics = ensemble_statistics({scatter.model: scatter.dataset})
    from_surfaces = surface_deviations(models, scatter.model, scatter.dataset)
    (found,) = find(models, deviations, regime, statistics, from_surfaces).scatter
    areas = {ratio: of_seeds(area, ratio) for ratio in PRESSURES}
    one = {ratio: area(ratio, np.array(p)) for ratio, p in PRESSURES.items()}
    for label, values in zip(LABELS, areas.values(), strict=True):
        assert found.relative[label] == pytest.approx((values.std(0, ddof=1) / values.mean(0)).mean(), rel=1e-9)
    within = sum(int((np.abs(one[r] - areas[r].mean(0)) <= areas[r].std(0, ddof=1)).sum()) for r in PRESSURES)
    assert found.within == (within, 7)
    # A theory that knows one surface, paired with each of three.
    for ranking, ratio in zip(found.rankings, PRESSURES, strict=True):
        off = np.abs(0.5 * one[ratio] / areas[ratio] - 1).mean(axis=1)
        assert by_model(ranking)["persson"].area == pytest.approx(off.mean(), rel=1e-9)
        assert by_model(ranking)["persson"].area_error == pytest.approx(off.std(ddof=1) / np.sqrt(3), rel=1e-9)
        assert list(by_model(ranking)) == ["gap_flow", "persson"]
    # Where theories are fed with the target, too, these are compared.
    both = {**models, "persson@analytic": models["gap_flow"], "gap_flow@analytic": models["gap_flow"]}
    target = surface_deviations(both, scatter.model, scatter.dataset)
    assert {pair.partition(" - ")[0] for pair in target["pair"].values} == {"persson@analytic", "gap_flow@analytic"}


@pytest.mark.validation
@pytest.mark.usefixtures("unrendered")
def test_scatter_in_the_files(files, seeds, tmp_path):
    status, page = reported(tmp_path, *files, options=("--scatter", seeds))
    assert status == 0
    with xr.open_datatree(tmp_path / "out.nc") as tree:
        found = tree["scatter/continuum"].to_dataset().sel(well_depth_ratio=8)
        np.testing.assert_allclose(found.relative_contact_area, of_seeds(area, 8).mean(axis=0), rtol=1e-12)
        assert (found.samples == 3).all()
        # The compared surface's own numbers stay what they are.
        own = tree["continuum"].relative_contact_area.sel(well_depth_ratio=8)
        np.testing.assert_allclose(own, area(8, np.array(PRESSURES[8])), 1e-12)
        assert "ensemble" not in tree.children
    assert page.count("mean ± one standard deviation of the continuum over 3 surfaces") == 2
    assert "over 3 surfaces of one spectrum" in page


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        (SEEDED, "theory", "a theory has no single surface"),
        (STUDY, "continuum", "holds one surface"),
        (SEEDED.replace("77.2", "70"), "continuum", "material.youngs_modulus is 7.72e\\+10 in the one and 7e\\+10"),
        (SEEDED.replace("[1, 8]", "[2]"), "continuum", "no point in common"),
    ],
)
def test_what_is_no_scatter_of_these_is_refused(inputs, tmp_path, text, kind, words):
    with pytest.raises(InputError, match=words):
        read_scatter(write(tmp_path / "other.nc", kind, text), inputs)


def test_scatter_beside_another_average_or_none(files, seeds, inputs, tmp_path, capsys):
    with pytest.raises(InputError, match="does not go with --average rms_height"):
        read_scatter(seeds, read(tmp_path, HEIGHTS, average="rms_height"))
    other = SEEDED.replace("[24, 24]", "[16, 16]").replace("fields = true", "fields = false")
    (note,) = read_scatter(write(tmp_path / "other.nc", "continuum", other), inputs).notes
    assert "surface.shape is [24, 24] in the one and [16, 16] in the other" in note
    assert read_scatter(seeds, inputs).notes == ()
    for output, scatter, words in (("out.nc", "none.nc", "does not exist"), ("other.nc", "other.nc", "another output")):
        assert run(*files, "-o", tmp_path / output, "--scatter", tmp_path / scatter, "--overwrite") == 1
        assert words in capsys.readouterr().err
    assert not (tmp_path / "out.nc").exists()


def test_captions_name_theories_whose_stress_does_not_carry_the_pressure():
    balances = {"persson": [1.0, 0.995], "edge_flow": [0.84, np.nan, 0.98], "gap_flow": [np.nan, np.nan]}
    models = {name: xr.Dataset({"stress_balance": ("step", values)}) for name, values in balances.items()}
    assert list(_balances({**models, "continuum": xr.Dataset()})) == [("the edge flow", 0.84, 0.98)]
