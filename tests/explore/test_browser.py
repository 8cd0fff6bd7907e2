"""The page in a real Chromium: a look at results, a map that becomes a study, a run, and what must not happen."""

import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import numpy as np
import pytest
import xarray as xr

from contact_study.explore import runs
from tests.report.synthetic import write_all

pytest.importorskip("panel")
playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed: pip install .[dev]")
CHROMIUM = shutil.which(os.environ.get("CHROMIUM", "chromium"))
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
PROGRAM = "import sys; from contact_study.start import bem_adhesion; sys.exit(bem_adhesion())"
pytestmark = [
    pytest.mark.validation,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine: apt-get install chromium"),
    pytest.mark.filterwarnings("default"),
]
SMALL = """
[surface]
kind = "self_affine"
size = "100 nm"
shape = [32, 32]
rms_height = "1 nm"
cutoff_mode = 8
[material]
youngs_modulus = "1 GPa"
poissons_ratio = 0.3
[interaction]
law = "hard_wall"
[loading]
path = ["1 MPa", "2 MPa"]
"""


@contextmanager
def served(folder, *files):
    """The command in a process of its own, and the address that it prints."""
    command = [sys.executable, "-c", PROGRAM, "explore", "--no-browser", *files]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
    try:
        yield process.stdout.readline().strip(), process
    finally:
        process.send_signal(signal.SIGINT)
        process.stdout.close()
        process.wait(30)


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as driver:
        opened = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture
def visit(browser):
    """Open an address in a window; everything that a page complains of, or asks of others, is kept."""
    complaints, pages = [], []

    def own(url):
        return url.startswith(("http://localhost:", "data:", "blob:"))

    def go(address, scheme="light"):
        page = browser.new_page(viewport={"width": 1280, "height": 720}, color_scheme=scheme)
        page.set_default_timeout(60_000)
        page.on("console", lambda message: message.type == "error" and complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: own(request.url) or complaints.append(request.url))
        page.goto(address)
        pages.append(page)
        return page

    go.complaints = complaints
    yield go
    for page in pages:
        page.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_look_slide_cut_and_export(tmp_path, visit, scheme):
    files = write_all(tmp_path)
    with served(tmp_path, *(file.name for file in files)) as (address, _):
        page = visit(address, scheme)
        page.get_by_text("100 MPa").first.wait_for()
        slider = page.get_by_role("slider").first
        slider.focus()
        page.keyboard.press("ArrowRight")
        page.get_by_text("780 MPa").first.wait_for()
        assert page.evaluate("document.documentElement.scrollWidth") <= 1280
        ink, ground = page.evaluate(
            "['color', 'background-color'].map(name => getComputedStyle(document.body).getPropertyValue(name))"
        )
        dark = [sum(map(int, rgb.strip("rgb()").split(","))) < 3 * 128 for rgb in (ink, ground)]
        assert dark == ([True, False] if scheme == "light" else [False, True])
        drawing = page.locator("canvas").first.bounding_box()
        page.mouse.move(drawing["x"] + 90, drawing["y"] + 90)
        page.mouse.down()
        page.mouse.move(drawing["x"] + 200, drawing["y"] + 200, steps=5)
        page.mouse.up()
        for name, begins in (("PNG", b"\x89PNG"), ("SVG", b"<?xml"), ("Table", b"model"), ("Python", b"import xarray")):
            with page.expect_download() as coming:
                page.get_by_text(name, exact=True).first.click()
            with open(coming.value.path(), "rb") as file:
                assert file.read(20).startswith(begins)
        page.reload()
        page.get_by_text("100 MPa").first.wait_for()
    assert visit.complaints == []


def test_from_a_map_to_states(tmp_path, visit):
    waves = np.sin(2 * np.pi * np.arange(48) / 24)
    np.save(tmp_path / "own.npy", 2e-10 * waves * waves[:, None])
    folder = tmp_path / "folder"
    folder.mkdir()
    with served(folder) as (address, _):
        page = visit(address)
        page.get_by_role("button", name="Run").wait_for()
        page.locator("input[type=file]").set_input_files(tmp_path / "own.npy")
        page.get_by_text("missing key surface.size").or_(page.get_by_text("surface.size")).first.wait_for()
        for label, value in (("size", "20 nm"), ("height_unit", "m")):
            field = page.get_by_label(label, exact=True)
            if field.evaluate("node => node.tagName") == "SELECT":
                field.select_option(value)
            else:
                field.fill(value)
                field.press("Enter")
            page.wait_for_timeout(1500)
        page.get_by_text("48 x 48 points").first.wait_for()
        page.get_by_role("button", name="Run").click()
        page.get_by_text("State 1 of").first.wait_for()
        page.reload()
        page.get_by_text("study.continuum.nc").first.wait_for(state="attached")
        (output,) = folder.glob("*.nc")
        with xr.open_dataset(output) as dataset:
            assert dataset.sizes["y"] == 48
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "own.npy"]
    assert visit.complaints == []


def test_a_run_outlives_the_page_and_its_server(tmp_path, visit):
    loads = ", ".join(f'"{n} MPa"' for n in range(1, 80))
    text = SMALL.replace('"1 MPa", "2 MPa"', loads).replace("[32, 32]", "[512, 512]")
    (tmp_path / "long.toml").write_text(text)
    with served(tmp_path) as (address, process):
        page = visit(address)
        page.get_by_label("Begin with").select_option("long.toml")
        page.get_by_text("79 load steps").first.wait_for()
        page.get_by_role("button", name="Run").click()
        until = time.monotonic() + 60
        while not runs.runs_in(tmp_path) or not runs.runs_in(tmp_path)[0].done:
            assert time.monotonic() < until
            time.sleep(0.2)
        process.kill()
    (run,) = runs.runs_in(tmp_path)
    assert run.alive
    with served(tmp_path) as (address, _):
        page = visit(address)
        page.get_by_role("button", name="Stop").click()
        page.get_by_role("button", name="Resume").wait_for()
    (run,) = runs.runs_in(tmp_path)
    assert not run.alive
    assert run.state.startswith("stopped")


def test_names_are_words_and_never_markup(tmp_path, visit):
    hostile = "<img src=x onerror=alert(1)>"
    (tmp_path / f"{hostile}.toml").write_text(SMALL)
    (tmp_path / "wrong.nc").write_bytes(b"no dataset")
    with served(tmp_path) as (address, _):
        page = visit(address)
        page.on("dialog", lambda dialog: visit.complaints.append(dialog.message))
        page.get_by_label("Begin with").select_option(f"{hostile}.toml")
        page.get_by_text("32 x 32 points").first.wait_for()
        page.get_by_label("Name of the study").fill(hostile)
        page.get_by_label("Name of the study").press("Enter")
        page.get_by_role("button", name="Run").click()
        page.get_by_text("no name of a study").first.wait_for()
        assert page.locator("img[src=x]").count() == 0
    assert visit.complaints == []


def test_a_large_map_travels_as_large_as_the_screen(tmp_path, visit):
    sent, small = {}, xr.load_dataset(write_all(tmp_path)[0])
    noise = np.random.default_rng(1)
    for points in (256, 2048):
        grid = (np.arange(points) + 0.5) * (float(small["x"][1] - small["x"][0]) * small.sizes["x"] / points)
        coordinates = {axis: (axis, grid, small[axis].attrs) for axis in "yx"}
        large = small.drop_dims(["y", "x"]).assign_coords(coordinates)
        for name, field in small.items():
            if {"y", "x"} <= {*field.dims}:
                shape = [points if dim in "yx" else small.sizes[dim] for dim in field.dims]
                large[name] = field.dims, noise.random(shape, np.float32) * 1e-9, field.attrs
        large.to_netcdf(tmp_path / f"{points}.nc")
        with served(tmp_path, f"{points}.nc") as (address, _):
            page = visit("about:blank")
            total = []
            page.on("websocket", lambda s, total=total: s.on("framereceived", lambda f: total.append(len(f))))
            page.goto(address)
            page.get_by_text("State 1 of").first.wait_for()
            page.wait_for_timeout(2000)
            total.clear()
            page.get_by_role("slider").first.focus()
            page.keyboard.press("ArrowRight")
            page.get_by_text("State 2 of").first.wait_for()
            page.wait_for_timeout(3000)
            sent[points] = sum(total)
    # 64 times the points; cells of the screen are at most 4 times those of the small map.
    assert 0 < sent[2048] < 6 * sent[256]
