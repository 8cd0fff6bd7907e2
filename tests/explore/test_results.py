"""The page of results without a browser: one slider moves maps, words, dots and distributions of all models."""

import csv

import numpy as np
import pytest

from contact_study.report.read.lazy import open_models
from tests.report.synthetic import write_all

pn = pytest.importorskip("panel")
pytestmark = pytest.mark.filterwarnings("default")  # those of Panel


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_all(tmp_path_factory.mktemp("files"))


@pytest.fixture
def page(files):
    from contact_study.explore.results import results_page

    return results_page(files, files[0].parent)


def shown(page, key, source):
    return page._shown[key].sources[source].data


def test_one_slider_moves_all(page, files):
    assert "100 MPa" in page.words.object
    cells, density = np.array(shown(page, "map0", "image")["image"][0]), shown(page, "pressure", "lines")["ys"][0]
    page.sweep[0].value = 8.0
    page.load.value = 2
    assert page.words.object.count("780 MPa") == 4  # in every model
    now = page._shown["relative_contact_area"].now.data
    assert np.allclose(now["x"], 0.7799)
    case = open_models(files)["continuum"].case({"well_depth_ratio": 8})
    assert float(case["relative_contact_area"][2]) in now["y"]
    page.field.value = "pressure"
    assert not np.array_equal(shown(page, "map0", "image")["image"][0], cells)
    assert not np.array_equal(shown(page, "pressure", "lines")["ys"][0], density)
    density = shown(page, "gap", "lines")
    for x, y in zip(density["xs"], density["ys"], strict=True):
        # densities below 1e-8 of the largest are left out
        assert np.sum(y) * (x[1] - x[0]) == pytest.approx(1.0, rel=1e-6)
    assert page.fault.object == ""


def test_a_case_that_ends_earlier_is_followed_from_its_last_state(page):
    page.sweep[0].value = 8.0
    page.load.value = 3
    page.sweep[0].value = 1.0
    assert page.load.value == page.load.end == 2
    assert "5.87 GPa" in page.words.object


def test_states_are_kept_compared_and_subtracted(page):
    page.load.value, page.field.value = 1, "pressure"
    page._keep(None)
    page.load.value = 2
    page.beside.value = "kept state"
    first, second = (shown(page, f"map{number}", "image")["image"][0] for number in (0, 1))
    page.how.value = "difference"
    assert "map1" not in page._shown
    unit = page._shown["map0"].view.look.unit.size
    found = shown(page, "map0", "image")["image"][0] * unit
    assert np.allclose(found, (first - second) * 1e9, atol=1e-6 * np.abs(found).max())  # both maps were in GPa
    assert found.max() > 0


def test_colours_stay_where_they_are_held(page):
    page.field.value = "pressure"
    page.hold.value = True
    high = page._shown["map0"].mapper.high
    page.load.value = 2
    assert page._shown["map0"].mapper.high == high
    page.hold.value = False
    assert page._shown["map0"].mapper.high > high


def test_a_drag_cuts_the_section_and_a_click_chooses_the_state(page):
    from bokeh.events import Tap

    page._shown["map0"].line.data = {"x": [0.0, 30.0], "y": [10.0, 10.0]}  # nm
    assert np.allclose(page.ends, ((1e-8, 0.0), (1e-8, 3e-8)), rtol=1e-12)
    assert shown(page, "section", "section")["x"][-1] == pytest.approx(30.0)
    figure = page._shown["relative_contact_area"].figure
    page._tapped("relative_contact_area", Tap(figure, x=5.5, y=0.5))
    assert page.load.value == 2


def test_a_window_of_a_map_shows_its_points(page):
    picture = page._shown["map0"]
    whole = picture.view
    picture.figure.x_range.end = whole.sources["image"]["dw"][0] / 2
    page._zoomed("map0", None)
    assert picture.view.cells.shape == (24, 12)
    assert np.array_equal(picture.view.cells, whole.cells[:, :12])
    assert picture.view.sources["image"]["dw"][0] == pytest.approx(whole.sources["image"]["dw"][0] / 2)


def test_exports_are_those_of_the_view(page):
    page.load.value = 1
    rows = list(csv.DictReader(page._exported("csv")))
    assert {row["model"] for row in rows} >= {"continuum", "atomistic", "persson"}
    assert "case.isel(step=1)" in page._exported("py").read()
    assert page._exported("png").read().startswith(b"\x89PNG")


def test_a_file_that_is_no_dataset_is_a_line_on_the_page(page, tmp_path):
    (tmp_path / "<b>.nc").write_text("x")
    page._chose(type("Event", (), {"new": [tmp_path / "<b>.nc"]}))
    assert "&lt;b&gt;.nc" in page.fault.object
    assert page.models


@pytest.mark.parametrize("field", ["gap", "contact", "pressure", "clusters", "height"])
def test_no_map_travels_point_by_point(field):
    import xarray as xr

    from contact_study.explore import pictures

    rows, columns = 700, 2048
    axes = {"y": np.arange(rows) * 1e-9, "x": np.arange(columns) * 1e-9}
    waves = np.sin(np.arange(columns) / 50) + np.zeros((rows, 1))
    fields = {"gap": np.abs(waves) * 1e-9, "pressure": waves * 1e6, "height": waves * 1e-9}
    state = xr.Dataset({name: (("y", "x"), values) for name, values in fields.items()}, coords=axes)
    view = pictures.map_view(state.assign(contact_distance=1e-10), field)
    assert view.cells.dtype == np.float32
    assert view.cells.shape == (350, 512)
    assert view.sources["image"]["dw"] == [pytest.approx(2.048)]  # µm
    part = pictures.map_view(
        state.assign(contact_distance=1e-10), field, window=(1.0002e-6, 3.002e-7, 1.996e-7, 9.96e-8)
    )
    assert part.cells.shape == (100, 200)
    assert [part.sources["image"][end][0] for end in "xy"] == pytest.approx([1.0, 0.3])
