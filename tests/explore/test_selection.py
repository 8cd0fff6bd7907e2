"""What a page shows, without a page: cases, states, cells of a screen, sections, differences, and a run that grows."""

import numpy as np
import pytest
import xarray as xr

from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.campaign.model import MODELS
from contact_study.campaign.record import prepare_run
from contact_study.campaign.store.case_file import write_case
from contact_study.explore import selection
from contact_study.inputs.errors import InputError
from contact_study.plots.selection import along_line
from contact_study.report.read.lazy import open_models
from tests.report import synthetic
from tests.report.synthetic import LOOP, write, write_all


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_all(tmp_path_factory.mktemp("files"))


@pytest.fixture(scope="module")
def whole(files):
    """The first dataset in memory, read before it is opened to stay open."""
    return xr.load_dataset(files[0])


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    return write(tmp_path_factory.mktemp("loop") / "loop.nc", "continuum", LOOP)


@pytest.fixture
def waves():
    """A state of 8 x 12 points whose heights are a plane wave along y, gaps one along x (m)."""
    y, x = np.arange(8) * 2e-9, np.arange(12) * 1e-9
    height = np.cos(2 * np.pi * y / 16e-9)[:, None] + np.zeros(12)
    gap = np.maximum(np.sin(2 * np.pi * x / 12e-9), 0)[None, :] + np.zeros((8, 1))
    state = xr.Dataset({"height": (("y", "x"), height), "gap": (("y", "x"), gap)}, coords={"y": y, "x": x})
    return state.assign(contact_distance=1e-3)


def test_models_of_several_files_have_one_name_each(files, loop):
    models = open_models([*files, loop])
    assert list(models)[:2] == ["continuum:continuum", "atomistic"]
    assert models["continuum:loop"].path == loop
    assert {"persson", "gap_flow"} <= set(models)
    assert selection.sweep_menus(models)["well_depth_ratio"] == {"1": 1.0, "8": 8.0}


def test_a_case_is_that_of_the_menus_and_none_where_the_model_lacks_it(files):
    model = next(iter(open_models(files).values()))
    assert model.case({"well_depth_ratio": 8.0 * (1 + 1e-14)})["well_depth_ratio"] == 8.0
    assert model.case({"well_depth_ratio": 2.0}) is None
    path = selection.load_path(model.case({"well_depth_ratio": 1.0}))
    assert path.steps.tolist() == [0, 1, 2]  # the other case has a fourth
    assert path.words[1] == "780 MPa, loading"
    tension = selection.load_path(model.case({"well_depth_ratio": 8.0}))
    assert tension.words[1] == "−499 MPa, loading"


def test_other_models_show_the_nearest_load_on_the_same_branch(loop):
    path = selection.load_path(next(iter(open_models([loop]).values())).case({}))
    assert path.unloading.any()
    for place in range(path.steps.size):
        assert path.nearest(path, place) == place  # the same load is passed twice


def test_a_state_has_the_fields_that_its_map_needs(loop):
    case = next(iter(open_models([loop]).values())).case({})
    assert {"gap", "contact", "clusters", "pressure", "height"} == set(selection.fields_of(case))
    state = selection.state_of(case, 1, "section")
    root = open_models([loop])["continuum"].root
    assert np.array_equal(state["gap"], root["gap"].squeeze().isel(step=1))
    assert "pressure" not in state
    with pytest.raises(ValueError, match="no variable 'pressure'"):
        selection.state_of(case.drop_vars("pressure"), 1, "pressure")


@pytest.mark.parametrize("most", [480, 7, 3])
def test_cells_of_a_map_are_means_of_their_points_at_their_place(most):
    field = np.random.default_rng(1).random((20, 21))
    cells, largest = selection.reduced(field, most), selection.reduced(field, most, np.maximum)
    blocks = [selection.block_of(size, most) for size in field.shape]
    assert cells.shape == tuple(-(-size // block) for size, block in zip(field.shape, blocks, strict=True))
    assert max(cells.shape) <= most
    for row, column in np.ndindex(cells.shape):
        points = field[row * blocks[0] : (row + 1) * blocks[0], column * blocks[1] : (column + 1) * blocks[1]]
        assert cells[row, column] == pytest.approx(points.mean(), rel=1e-14)
        assert largest[row, column] == points.max()


def test_a_section_is_bilinear_and_leaves_a_periodic_cell(waves):
    distance, height, gap, _ = along_line(waves, (0.0, 0.0), (16e-9, 12e-9))
    assert distance[-1] == pytest.approx(20e-9)
    at = np.linspace(0, 1, distance.size)
    # linear between points of a wave: a quarter of its second difference at most
    assert height == pytest.approx(np.cos(2 * np.pi * at), abs=0.5 * (1 - np.cos(2 * np.pi / 8)))
    assert height[-1] == pytest.approx(height[0])
    assert gap[-1] == pytest.approx(gap[0])
    grid = along_line(waves, (2e-9, 3e-9), (2e-9, 7e-9))
    assert np.allclose(grid[2], waves["gap"].values[1, 3:8])
    assert np.array_equal(grid[3], waves["gap"].values[1, 3:8] <= 1e-3)


def test_a_section_beyond_a_free_edge_is_as_at_the_edge(waves):
    free = waves.assign_coords(boundary="free")
    _, height, _, _ = along_line(free, (14e-9, 2e-9), (18e-9, 2e-9))
    assert height == pytest.approx(np.full(height.size, waves["height"].values[-1, 2]))


def test_a_difference_has_the_sign_of_the_first_state(waves):
    more = waves.assign(gap=waves["gap"] + 2.0)
    assert np.allclose(selection.difference(more, waves, "gap"), 2.0)
    assert selection.difference(waves, more, "contact").max() == 1.0
    with pytest.raises(ValueError, match=r"8 × 12 and 8 × 6 points"):
        selection.difference(waves, waves.isel(x=slice(6)), "gap")


def test_the_nearest_point_is_that_on_the_screen():
    x, y = np.array([0.0, 10.0, np.nan]), np.array([0.0, 1.0, 0.0])
    assert selection.nearest_point(x, y, (6.0, 0.1), (10.0, 1.0)) == 0
    assert selection.nearest_point(x, y, (6.0, 0.1), (1000.0, 1.0)) == 0
    assert selection.nearest_point(x, y, (6.0, 0.1), (10.0, 1000.0)) == 1
    assert selection.nearest_point(x[2:], y[2:], (6.0, 0.1), (10.0, 1.0)) is None


def test_what_is_no_dataset_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nothing\.nc: does not exist"):
        open_models([tmp_path / "nothing.nc"])
    xr.Dataset({"a": 1}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(InputError, match="is no dataset of bem-adhesion"):
        open_models([tmp_path / "other.nc"])


def test_a_run_that_grows_has_its_finished_states_as_its_dataset_will_have_them(tmp_path, whole):
    run = prepare_run(MODELS["continuum"], synthetic.study())
    work = WorkDirectory(tmp_path / "bem.nc")
    work.claim(run.attributes)
    for case, name, count in zip(run.study.cases, run.case_names, (2, 3), strict=True):
        bins, path = run.study.bins, case.path[:count]
        steps = [
            synthetic._values(case, bins, "continuum", load) | {"branch": False, "converged": 1} for load, _ in path
        ]
        write_case(work.case_file(name), synthetic._constants(case, "continuum"), steps, bins, {})
    case = open_models([work.output])["continuum"].case({"well_depth_ratio": 8})
    whole = whole.sel(well_depth_ratio=8)
    assert selection.load_path(case).steps.tolist() == [0, 1, 2]
    assert np.array_equal(case["relative_contact_area"][:3], whole["relative_contact_area"][:3])
    assert np.array_equal(case["pressure_pdf"][2], whole["pressure_pdf"][2])
    state = selection.state_of(case, 2, "pressure")
    assert np.array_equal(state["pressure"], whole["pressure"][2])
    assert np.array_equal(case["gap"][1:3, 4, ::2], whole["gap"][1:3, 4, ::2])
    with pytest.raises(ValueError, match="keeps no pressure of this point"):
        selection.state_of(case, 3, "pressure")
    assert not list(tmp_path.glob("*.lock"))
