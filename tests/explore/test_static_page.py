"""The page in a file: what its script reads, and the page in a real Chromium, without a network."""

import base64
import json
import os
import re
import shutil
import subprocess
import sys
import zlib

import numpy as np
import pytest
import xarray as xr

from contact_study.command_line.program import main
from contact_study.explore.figure_code import drawn, figure_code
from contact_study.report.read.lazy import open_models
from tests.report.synthetic import LOOP, write, write_all

pytest.importorskip("bokeh")
CHROMIUM = shutil.which(os.environ.get("CHROMIUM", "chromium"))
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
CELLS = "Bokeh.documents[0].get_model_by_name('map:image').data.image[0].slice(0, 20).join()"
PRINTED = {"check": True, "capture_output": True, "text": True}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_all(tmp_path_factory.mktemp("files"))


@pytest.fixture(scope="module")
def dataset(files):
    """The first dataset in memory, read before the page opens the files."""
    return xr.load_dataset(files[0])


@pytest.fixture(scope="module")
def page(dataset, files, tmp_path_factory):
    output = tmp_path_factory.mktemp("page") / "page.html"
    assert main("bem-adhesion", ["explore", *map(str, files), "--html", str(output)]) == 0
    return output


@pytest.fixture(scope="module")
def data(page):
    return json.loads(re.search(r'id="data">(.*?)</script>', page.read_text("utf-8"), re.DOTALL)[1])


def test_the_page_needs_no_network_and_is_small(page):
    text = page.read_text("utf-8")
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=", text)
    assert len(text) < 4e6


def test_the_page_has_every_state_of_every_case(data, dataset):
    for number, case in enumerate(data["cases"]):
        steps = np.flatnonzero(np.isfinite(dataset["applied_pressure"][number].values))
        assert len(case["states"]) == steps.size
        states = case["curves"]["relative_contact_area"]["sources"]["states"]
        area = [y for y, model in zip(states["y"], states["model"], strict=True) if model == "continuum"]
        assert area == pytest.approx(dataset["relative_contact_area"][number, steps].values, rel=1e-3)
        assert {"atomistic", "continuum", "persson"} <= set(states["model"])


def test_levels_of_a_map_are_its_values(data, dataset):
    state = dataset.isel(well_depth_ratio=0, step=1)
    shown = data["cases"][0]["states"][1]["maps"]["gap"]
    levels = np.frombuffer(zlib.decompress(base64.b64decode(shown["levels"])), np.uint8).reshape(shown["shape"])
    values = shown["low"] + levels * (shown["high"] - shown["low"]) / 254
    contact = state["gap"].values <= float(state["contact_distance"])
    assert np.array_equal(levels == 255, contact)
    assert shown["words"].startswith("gap (nm)")
    half = 0.51 * (shown["high"] - shown["low"]) / 254  # a level is rounded
    assert values[~contact] == pytest.approx(1e9 * state["gap"].values[~contact], abs=half)


def test_names_of_a_study_are_text_on_the_page(tmp_path):
    hostile = '</script><script>alert("x")</script>'
    made = write(tmp_path / "bem.nc", "continuum", LOOP, title=hostile)
    assert main("bem-adhesion", ["explore", str(made), "--html", str(tmp_path / "page.html")]) == 0
    assert "<script>alert" not in (tmp_path / "page.html").read_text("utf-8")


def test_mistakes_are_one_line_each(tmp_path, files, capsys, monkeypatch):
    assert main("bem-adhesion", ["explore", str(files[0]), "--html", str(tmp_path / "page.png")]) == 1
    assert "expected a name that ends in .html" in capsys.readouterr().err
    monkeypatch.delitem(sys.modules, "contact_study.explore.static_page", raising=False)
    monkeypatch.setitem(sys.modules, "bokeh", None)
    monkeypatch.setitem(sys.modules, "bokeh.embed", None)
    assert main("bem-adhesion", ["explore", str(files[0]), "--html", str(tmp_path / "page.html")]) == 1
    assert "pip install 'bem-adhesion[explore]'" in capsys.readouterr().err


@pytest.mark.validation
@pytest.mark.parametrize("field", ["clusters", None])
def test_the_lines_of_python_draw_the_view(files, field, monkeypatch, tmp_path):
    models = open_models(files)
    name = "persson" if field is None else "continuum"
    ends = None if field is None else ((1e-9, 2e-9), (20e-9, 30e-9))
    code = figure_code(models[name], {"well_depth_ratio": np.float64(8)}, 2, field, ends)
    assert len(code.splitlines()) <= 12
    monkeypatch.chdir(tmp_path)
    done = subprocess.run([sys.executable, "-c", f"{code}\nprint(float(state['relative_contact_area']))"], **PRINTED)
    assert (tmp_path / "view.png").stat().st_size > 10_000
    case = models[name].case({"well_depth_ratio": 8})
    assert float(done.stdout) == float(case["relative_contact_area"][2])
    assert drawn(code, models[name], "svg").read().startswith(b"<?xml")


@pytest.mark.validation
@pytest.mark.filterwarnings("default")
def test_the_page_moves_in_a_browser(page):
    playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed: pip install .[dev]")
    if CHROMIUM is None:
        pytest.skip("no Chromium on this machine: apt-get install chromium")
    complaints = []
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        for scheme in ("light", "dark"):
            opened = browser.new_page(color_scheme=scheme, viewport={"width": 1280, "height": 720})
            opened.on("console", lambda message: message.type == "error" and complaints.append(message.text))
            opened.on("pageerror", lambda error: complaints.append(str(error)))
            opened.on("request", lambda request: request.url[:4] == "http" and complaints.append(request.url))
            opened.goto(page.as_uri())
            words = opened.locator("#words")
            opened.wait_for_function("document.getElementById('words').innerText.includes('100 MPa')")
            first = opened.evaluate(CELLS)
            opened.get_by_label("State on the loading path").focus()
            opened.keyboard.press("ArrowRight")
            assert "780 MPa" in words.inner_text()
            assert opened.evaluate("Bokeh.documents[0].get_model_by_name('curve:now').data.x[1]") == 0.7799
            opened.get_by_label("well depth ratio").select_option("8")
            opened.get_by_label("Map").select_option("pressure")
            opened.wait_for_function("Bokeh.documents[0].get_model_by_name('map').title.text == 'pressure'")
            assert opened.evaluate(CELLS) != first
            assert opened.evaluate("document.documentElement.scrollWidth") <= 1280
            opened.get_by_role("button", name="Play").press("Enter")
            opened.wait_for_function("document.getElementById('load').value != '1'")
        browser.close()
    assert complaints == []
