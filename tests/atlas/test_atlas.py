"""A small condition from its study to the tables of the atlas."""

import shutil

import numpy as np
import pytest
import xarray as xr

from contact_study.atlas import collection, loops
from contact_study.atlas.collection import collect
from contact_study.atlas.design import STRESS, Condition, design
from contact_study.atlas.joining import join
from contact_study.atlas.loops import run_condition
from contact_study.atlas.validation import problems
from contact_study.inputs.errors import InputError
from scripts import atlas_tables, contact_atlas, validate_hysteresis

PRELOADS = (0.4, 2.0)
SURFACES = atlas_tables.DATA.with_name("contact_atlas_surfaces.nc")
CONDITION = Condition(7, 0.8, 4.0, 0.3, 0.2, "exponential", "half_space")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("atlas")
    assert CONDITION.points == 32
    run_condition(CONDITION, found, 2, preloads=PRELOADS)
    return found


@pytest.fixture(scope="module")
def dataset(folder):
    return collect([CONDITION], folder, 2)


@pytest.mark.validation
def test_loops_reach_their_preloads_and_end_apart(dataset):
    assert problems(dataset) == []
    one = dataset.isel(condition=0, surface=0)
    np.testing.assert_allclose(one.mean_pressure.max("step") / STRESS, one.preload, rtol=1e-4)
    for preload in range(len(PRELOADS)):
        loop = one.isel(preload=preload).dropna("step", subset=["mean_pressure"])
        assert loop.relative_contact_area[0] == loop.relative_contact_area[-1] == 0
        turn = int(loop.mean_pressure.values.argmax())
        assert (np.diff(loop.mean_separation) < 0).tolist() == [step < turn for step in range(loop.sizes["step"] - 1)]
    assert (one.pull_off_pressure < 0).all()
    # A long range has one state at each separation: nothing is lost.
    assert one.work_of_separation.values == pytest.approx(one.work_of_approach.values, rel=2e-3)


@pytest.mark.validation
def test_moments_are_those_of_the_distributions(folder, dataset):
    with xr.open_dataset(loops.file_of(folder, CONDITION)) as opened:
        loop = opened.isel(seed=0, trigger_force=-1).load()
    whole = dataset.isel(condition=0, surface=0, preload=-1)
    step = int(np.flatnonzero(whole.mean_pressure > 0.2 * STRESS)[0])
    own = whole.isel(step=step)
    density = loop.gap_pdf.isel(step=step)
    share = density / density.sum()
    mean = float((share * density.gap_bin).sum())
    # Points at the wall count as half a bin away from it.
    assert mean == pytest.approx(float(own.mean_gap), abs=0.5 * float(density.gap_bin.diff("gap_bin")[0]))
    assert float(own.gap_standard_deviation) == pytest.approx(
        float(np.sqrt((share * (density.gap_bin - mean) ** 2).sum())), rel=1e-5
    )
    # Near full contact the pressure has the deviation of the roughness, E* h'/2.
    assert float(whole.pressure_standard_deviation.max()) == pytest.approx(STRESS, rel=0.1)


@pytest.mark.validation
def test_losses_of_a_loop_are_its_work(dataset):
    """∮ −p ds between separated states is all that a loop loses: nothing at this long range."""
    one = dataset.isel(condition=0, surface=0, preload=-1).dropna("step", subset=["mean_pressure"])
    lost = (one.dissipated_energy + one.unaccounted_work)[-1]
    works = float(one.work_of_separation - one.work_of_approach)
    # The trapezoidal rule errs by some per cent near full contact, and by the opposite on the way back.
    assert float(lost) == pytest.approx(works, abs=0.01 * float(one.work_of_adhesion))
    assert float(abs(one.unaccounted_work).max()) > 0


@pytest.mark.validation
def test_theories_are_at_the_pressures_of_loading(folder, dataset):
    one = dataset.isel(condition=0, surface=0, preload=-1)
    there = one.theory_relative_contact_area.notnull()
    assert there.any("step").all()
    assert (one.mean_pressure > 0).values[there.any("theory").values].all()
    assert {0, 1} == set(one.branch.values[there.any("theory").values])
    own, *cored = (xr.load_dataset(path) for path in loops.theory_files(CONDITION, folder, 701).values())
    given = one.dropna("step", subset=["theory_mean_gap"], how="all")
    np.testing.assert_allclose(given.mean_pressure, own.applied_pressure, rtol=1e-6)
    near, far = (each.relative_contact_area.sel(theory="edge_flow").values for each in cored)
    extrapolated = given.theory_relative_contact_area.sel(theory="edge_flow")
    np.testing.assert_allclose(extrapolated, near + (near - far) / (2 ** (2 / 3) - 1), rtol=1e-5)
    heavy = (one.mean_pressure > STRESS) & there.all("theory")
    assert heavy.any()
    errors = (one.theory_relative_contact_area / one.relative_contact_area - 1).where(heavy)
    assert float(abs(errors).max()) < 0.1
    assert one.finest_tabor_number == pytest.approx(CONDITION.tabor_number, rel=0.2)  # that of the surface


@pytest.mark.validation
def test_a_finished_condition_is_not_run_again(folder, monkeypatch):
    before = {path: path.stat().st_mtime_ns for path in folder.glob("*.*")}
    assert {".nc", ".json"} <= {path.suffix for path in before}
    run_condition(CONDITION, folder, 2, preloads=PRELOADS)
    assert {path: path.stat().st_mtime_ns for path in folder.glob("*.*")} == before


@pytest.mark.validation
def test_further_surfaces_have_the_loop_to_the_largest_preload(folder, dataset, tmp_path):
    one = dataset.isel(condition=0)
    assert one.mean_pressure.notnull().any("step").values.tolist() == [[True, True], [False, True]]
    assert (one.converged.isel(surface=1, preload=0) == -1).all()
    loop = one.isel(surface=1, preload=-1).dropna("step", subset=["mean_pressure"])
    _, further = loops.loop_files(CONDITION, folder, [701, 702])
    with xr.open_dataset(further) as opened:
        own = opened.sel(seed=702).isel(trigger_force=0).load()
    np.testing.assert_allclose(loop.mean_pressure, own.mean_pressure[loops.own_states(own)].dropna("step"), rtol=1e-6)
    assert loop.theory_mean_gap.notnull().any("step").all()
    assert len(list(atlas_tables.deepest(dataset))) == 2
    # Without all of its theories a surface is left out.
    lost = list(loops.theory_files(CONDITION, folder, 702).values())[-1]
    for path in folder.glob("*.*"):
        if path.is_file() and path != lost:
            shutil.copy(path, tmp_path)
    assert collect([CONDITION], tmp_path, 2).mean_gap.identical(dataset.mean_gap.sel(surface=[1]))


@pytest.mark.validation
def test_a_condition_widens_by_a_surface_and_its_processor_time(folder, dataset, tmp_path):
    for path in folder.glob("*.*"):
        if path.is_file():
            shutil.copy(path, tmp_path)
    run_condition(CONDITION, tmp_path, 3, preloads=PRELOADS)
    wide = collect([CONDITION], tmp_path, 3)
    before = wide.mean_gap.sel(surface=[1, 2]).isel(step=slice(dataset.sizes["step"]))
    assert before.identical(dataset.mean_gap)
    assert wide.mean_gap.sel(surface=3, preload=PRELOADS[-1]).notnull().any()
    assert wide.processor_time.item() > dataset.processor_time.item()


@pytest.mark.validation
def test_further_surfaces_are_run_alone_and_joined(folder, dataset, tmp_path):
    run_condition(CONDITION, tmp_path, 2, (0.5,), preloads=PRELOADS, first=2)
    assert not loops.file_of(tmp_path, CONDITION).exists()
    assert not loops.file_of(tmp_path, CONDITION, "grid0.5").exists()  # those are of the first surface
    further = collect([CONDITION], tmp_path, 2)
    assert further.surface.values.tolist() == [2]
    joined = join([dataset.isel(surface=[0]), further])
    assert joined.drop_vars("processor_time").equals(dataset.drop_vars("processor_time"))


@pytest.mark.validation
def test_theories_of_another_loop_are_refused(folder, tmp_path):
    for path in folder.glob("*.*"):
        if path.is_file():
            shutil.copy(path, tmp_path)
    theory = loops.theory_files(CONDITION, tmp_path, 701)[0.0]
    tree = xr.load_datatree(theory)
    tree["applied_pressure"] = 1.01 * tree["applied_pressure"]
    tree.to_netcdf(theory)
    with pytest.raises(InputError, match=r"0007_theory701\.nc: its pressures are not those of the loop"):
        collect([CONDITION], tmp_path)


def test_an_empty_folder_is_an_error(tmp_path):
    with pytest.raises(InputError, match="no finished condition"):
        collect([CONDITION], tmp_path)


@pytest.mark.parametrize("path", [atlas_tables.DATA, validate_hysteresis.JUMPING_DATA, SURFACES])
def test_published_parts_are_sound_and_name_all_units(path):
    with xr.open_dataset(path) as published:
        assert problems(published) == []
        assert all({"units", "long_name"} <= published[name].attrs.keys() for name in published.variables)


def test_on_the_way_out_theories_are_on_their_unloading_branch():
    theory = ["persson", "edge_flow"]
    root = xr.Dataset({"pull_off_pressure": ("theory", [1.0, 2.0])}, {"theory": theory})
    branches = xr.Dataset(
        {"pull_off_pressure": (("theory", "metastable_branch"), [[np.nan, np.nan], [3.0, 4.0]])},
        {"theory": theory, "metastable_branch": ["loading", "unloading"]},
    )
    tree = xr.DataTree.from_dict({"/": root, "/metastable": branches})
    found = [
        float(collection.of_theory(tree, label, "pull_off_pressure", back))
        for label in theory
        for back in (False, True)
    ]
    assert found == [1.0, 1.0, 2.0, 4.0]


@pytest.mark.validation
def test_tables_of_a_dataset(dataset, tmp_path, capsys):
    path = tmp_path / "atlas.nc"
    dataset.to_netcdf(path)
    assert contact_atlas.main(["validate", str(path)]) == 0
    for action in ("areas", "cost", "design"):
        assert atlas_tables.main([action, str(path)]) == 0
    assert validate_hysteresis.main(["means", str(path)]) == 0
    out = capsys.readouterr().out
    assert "edge flow" in out
    assert "| edge flow | all | 1 | " in out
    assert "| edge flow | exponential | 1 | " in out
    assert "| edge flow | Dugdale | " not in out
    assert "| whole | 250 |" in out
    assert "in atlas.nc" not in out  # its condition is none of the design
    assert atlas_tables.main(["grids", str(path)]) == 1
    assert atlas_tables.main(["maps", str(path), "--figure", str(tmp_path / "maps.png")]) == 0
    path.write_bytes(b"broken")
    assert contact_atlas.main(["validate", str(path)]) == 1
    assert "cannot be read" in capsys.readouterr().err


def test_works_fall_short_by_their_share_of_the_energy_of_full_contact(tmp_path, capsys):
    data = atlas_tables.read(SURFACES)
    full = data.work_of_adhesion / data.relative_adhesion
    for name, share in {"work_of_approach": 0.9, "work_of_separation": 0.5}.items():
        data[name] = (
            (data.work_of_adhesion - share * full).expand_dims(preload=data.preload).transpose(*data[name].dims)
        )
    data["theory_work_of_separation"].loc[{"theory": "edge_flow", "way": "unloading"}] = (
        data.work_of_adhesion + 0.25 * full
    )
    path = tmp_path / "works.nc"
    data.isel(condition=np.flatnonzero(data.relative_adhesion < 1.5)).to_netcdf(path)
    assert atlas_tables.main(["works", str(path)]) == 0
    rows = [line.strip("| ").split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    count = int(((data.relative_adhesion >= 1) & (data.relative_adhesion < 1.5) & (data.solid == "half_space")).sum())
    assert [row[0] for row in rows] == ["0.5 … 1", "1 … 1.5"]
    assert rows[1][1:4] == [str(count), "0.90 (0.90…0.90)", "0.50 (0.50…0.50)"]
    assert rows[1][-1] == "−0.25 (−0.25…−0.25)"


def test_grids_extrapolate_a_known_order():
    values = [1 + 0.1 * spacing**2 for spacing in (4.0, 2.0, 1.0)]
    assert atlas_tables.extrapolated(*map(np.array, values)) == pytest.approx(1.0)


def test_errors_of_grids_have_their_sign(tmp_path, capsys):
    data = atlas_tables.read(atlas_tables.DATA)
    there = data.refined_pull_off_pressure.notnull().all("refinement") & (data.law == "exponential")
    data = data.isel(condition=np.flatnonzero(there)[:3], surface=[0])
    own = data.isel(surface=0, preload=-1)
    errors = xr.DataArray([1.06, 1.015], {"refinement": data.refinement}) / 1.03  # of first order, 3 % on all points
    data["refined_mean_pressure"] = own.mean_pressure.broadcast_like(data.refined_mean_pressure)
    data["refined_corrected_contact_area"] = own.corrected_contact_area * errors
    path = tmp_path / "grids.nc"
    data.to_netcdf(path)
    assert atlas_tables.main(["grids", str(path)]) == 0
    head, _, first, *rest = capsys.readouterr().out.splitlines()
    cells = dict(zip(head.strip("| ").split(" | "), first.strip("| ").split(" | "), strict=True))
    assert rest == []
    assert cells["corrected area at 0.4"] == "6.0/3.0/1.5 %"
    assert cells["corrected area at 0.4, signed"] == "+3.0 ± 0.0 %"


def test_parts_of_a_dataset_join_to_the_whole():
    whole = atlas_tables.read(atlas_tables.DATA)
    first, rest = whole.isel(condition=slice(0, 30)), whole.isel(condition=slice(30, None))
    assert join([rest, first]).identical(whole)
    # Others' loops may be shorter, and lack what only some software computes.
    theirs = rest.isel(step=slice(0, 20)).drop_vars(["theory_mean_gap", "cluster_count", "points"])
    wide = join([first, theirs])
    np.testing.assert_array_equal(wide.mean_gap[30:, ..., :20], rest.mean_gap[..., :20])
    assert wide.converged[30:, ..., 20:].values.max() == wide.points[30:].values.max() == -1
    assert wide.theory_mean_gap[30:].isnull().all()
    assert wide.theory_mean_gap[:30].identical(first.theory_mean_gap)


def test_surfaces_of_the_same_conditions_join():
    whole = atlas_tables.read(atlas_tables.DATA).isel(condition=slice(0, 8))
    first, further = whole.isel(surface=[0]), whole.isel(surface=slice(1, None), preload=[-1])
    joined = join([first, further.isel(condition=slice(None, None, 2))])
    assert (
        joined.isel(condition=slice(0, 8, 2))
        .drop_vars("processor_time")
        .identical(whole.isel(condition=slice(0, 8, 2)).drop_vars("processor_time").assign_attrs(joined.attrs))
    )
    assert joined.mean_pressure.sel(surface=[2, 3, 4])[1::2].isnull().all()
    assert joined.converged.sel(surface=[2, 3, 4])[1::2].max() == -1
    twice = np.resize([2.0, 1.0], 8)
    np.testing.assert_allclose(joined.processor_time / whole.processor_time, twice, rtol=1e-6)  # single precision
    with pytest.raises(InputError, match="dataset 3: surface 2 of condition 1 is in another dataset; renumber it"):
        join([first, further, whole.isel(surface=[1])])
    with pytest.raises(InputError, match="dataset 2: condition 1 has another relative_adhesion in another dataset"):
        join([first, further.assign(relative_adhesion=2 * further.relative_adhesion)])


@pytest.mark.validation
def test_datasets_that_do_not_join_are_one_line(tmp_path, capsys):
    data, out = str(atlas_tables.DATA), tmp_path / "wide.nc"
    wrong = tmp_path / "wrong.nc"
    atlas_tables.read(atlas_tables.DATA).drop_vars("mean_gap").to_netcdf(wrong)
    for others, words in (
        ([], "missing --others"),
        (["--others", data], "dataset 2: surface 1 of condition 1 is in another dataset"),
        (["--others", str(wrong)], "mean_gap: is missing"),
    ):
        assert contact_atlas.main(["join", data, *others, "-o", str(out)]) == 1
        assert words in capsys.readouterr().err
    assert not out.exists()
    with pytest.raises(InputError, match="dataset 1: has no coordinate condition"):
        join([xr.Dataset()])


def test_refined_conditions_are_of_all_laws_in_equal_shares():
    conditions = design()[0]
    refined = contact_atlas._refined(conditions, 25)
    taken = [one for one in conditions if one.number in refined]
    laws = [one.law for one in taken]
    assert sorted(laws.count(law) for law in set(laws)) == [8, 8, 9]
    for one in taken:  # of the same law none of a larger Tabor number on a small grid is left
        assert all(
            other.number in refined or other.law != one.law or other.tabor_number < one.tabor_number
            for other in conditions
            if other.points <= contact_atlas.SMALL_GRID
        )


def test_parts_of_a_job_array_share_the_conditions(monkeypatch, tmp_path, capsys):
    ran: list[tuple[str, int]] = []
    parts = ("1/2", "2/2")
    for part in parts:
        monkeypatch.setattr(contact_atlas, "run_condition", lambda one, *_, part=part: ran.append((part, one.number)))
        assert contact_atlas.main(["run", "--first", "6", "--part", part, "--folder", str(tmp_path)]) == 0
    numbers = [one.number for one in design(6)[0]]
    assert sorted(number for _, number in ran) == numbers
    assert [part for part, _ in ran] == ["1/2"] * 3 + ["2/2"] * 3
    assert contact_atlas.main(["run", "--part", "3/2"]) == 1
    assert "--part 3/2: expected K/N" in capsys.readouterr().err
    for first in ("5", "0"):
        assert contact_atlas.main(["run", "--first-surface", first]) == 1
        assert f"--first-surface {first}: expected 1 to 4" in capsys.readouterr().err


@pytest.mark.validation
def test_coarse_bins_are_shares_of_the_surface(folder, dataset):
    with xr.open_dataset(loops.file_of(folder, CONDITION)) as opened:
        loop = opened.isel(seed=0, trigger_force=-1).load()
    whole = dataset.isel(condition=0, surface=0, preload=-1)
    step = int(np.flatnonzero(whole.mean_pressure > 0.2 * STRESS)[0])
    for what, unit in (("gap", float(loop.rms_height)), ("pressure", STRESS)):
        density = loop[f"{what}_pdf"].isel(step=step)
        centres = density[f"{what}_bin"].values
        share = density.values * (centres[1] - centres[0])
        # An edge lies within one of the fine bins.
        for edge, below in zip(whole[f"{what}_edge"].values, whole[f"{what}_below"][step].values, strict=True):
            assert below == pytest.approx(share[centres < edge * unit].sum(), abs=share.max() + 1e-6)
    assert float(whole.pressure_below[step].diff("pressure_edge").max()) > 0.3
    fallen = dataset.assign(gap_below=1 - dataset.gap_below)
    assert any(line.startswith("gap_below: falls with gap_edge") for line in problems(fallen))
