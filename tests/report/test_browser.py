"""The report in a real Chromium: any width, light and dark, by keyboard, printed, without a network."""

import csv
import io
import os
import shutil

import numpy as np
import pytest
import xarray as xr

from tests.report.panels import run
from tests.report.synthetic import SEEDED, STUDY, write, write_all

pytestmark = [pytest.mark.validation, pytest.mark.filterwarnings("default")]
CHROMIUM = shutil.which(os.environ.get("CHROMIUM", "chromium"))
FLAGS = [
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
]
SECTIONS = {"agreement", "loading", "changes", "distributions", "regime", "numbers", "warnings", "method", "provenance"}


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed: pip install .[dev]")
    if CHROMIUM is None:
        pytest.skip("no Chromium on this machine: apt-get install chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def reports(tmp_path_factory):
    """Reports of a comparison, of an ensemble and of one dataset with unloading."""
    folder = tmp_path_factory.mktemp("pages")
    loop = STUDY[: STUDY.index("[sweep]")].replace("[output]", "unload = true\n[output]")
    inputs = {
        "comparison": write_all(folder),
        "ensemble": [write(folder / f"e_{kind}.nc", kind, SEEDED) for kind in ("continuum", "theory")],
        "one": [write(folder / "one.nc", "continuum", loop, warnings="a grid too coarse", unconverged=[(0, 1)])],
    }
    for name, paths in inputs.items():
        assert run(*paths, "-o", folder / f"{name}_out.nc", "--report", folder / f"{name}.html") in (0, 2)
    return folder


@pytest.fixture
def opened(browser, reports):
    """Open a report; whatever it complains of or asks the network for fails the test."""
    complaints, contexts = [], []

    def page(name, width=1400, scheme="light", **options):
        contexts.append(browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, **options))
        made = contexts[-1].new_page()
        made.on("console", lambda message: complaints.append(message.text))
        made.on("pageerror", lambda error: complaints.append(str(error)))
        made.on("request", lambda request: complaints.append(request.url) if request.url[:4] == "http" else None)
        made.goto((reports / f"{name}.html").as_uri())
        return made

    yield page
    for context in contexts:
        context.close()
    assert complaints == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [400, 800, 1400])
@pytest.mark.parametrize("name", ["comparison", "ensemble", "one"])
def test_nothing_overflows(opened, name, width, scheme):
    page = opened(name, width, scheme)
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    for units in ("si", "rd"):
        page.check(f"input[value={units}]")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    ink, ground = (page.evaluate(f"getComputedStyle(document.body).{name}") for name in ("color", "backgroundColor"))
    brightness = [sum(map(int, colour[4:-1].split(", "))) for colour in (ink, ground)]
    assert (brightness[0] > brightness[1]) == (scheme == "dark")
    drawn = "document.querySelector('figure svg [style*=\"stroke: currentColor\"]')"
    stroke = page.evaluate(f"getComputedStyle({drawn}).stroke")
    assert stroke == ink, "figures are drawn in the ink of the page"


def test_everything_is_reached_by_keyboard(opened):
    page = opened("comparison")
    reached = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        at = page.evaluate(
            "(() => { const at = document.activeElement; return at.closest('summary') ? at.parentElement.id "
            ": at.name || at.tagName; })()"
        )
        if at in SECTIONS and not page.evaluate(f"document.getElementById('{at}').open"):
            page.keyboard.press("Enter")
            assert page.evaluate(f"document.getElementById('{at}').open"), at
        reached.add(at)
        if at == "provenance":
            break
    assert reached >= {*SECTIONS, "units", "BUTTON"}
    page.click("a[href='#method']")
    assert page.evaluate("document.getElementById('method').open")


def test_units_are_a_choice(opened):
    page = opened("comparison")
    page.evaluate("document.getElementById('numbers').open = true")
    cells = "[...document.querySelectorAll('#numbers tbody tr')[0].cells].map((cell) => cell.innerText)"
    physical = page.evaluate(cells)
    assert "0.1 to 5.872\u00a0GPa" in page.inner_text(".tile")
    page.focus("input[value=si]")
    page.keyboard.press("ArrowRight")
    reduced = page.evaluate(cells)
    modulus = 77.2e9 / (1 - 0.42**2)
    assert float(physical[1]) * 1e9 / modulus == pytest.approx(float(reduced[1]), rel=1e-3)
    heads = page.evaluate("[...document.querySelectorAll('#numbers th')].map((cell) => cell.innerText)")
    assert "p/E*" in heads
    gap = heads.index("ū/hrms")
    assert float(physical[gap]) / 7 == pytest.approx(float(reduced[gap]), abs=1e-3)  # Å over 7 Å
    assert page.locator("figure svg:visible").count() == page.locator("div.rd svg:visible").count() + 1, "and the maps"


def test_the_table_sorts_and_its_file_is_the_dataset(opened, reports):
    page = opened("comparison", accept_downloads=True)
    page.click("#numbers summary")
    heads = page.locator("#numbers th")
    names = heads.evaluate_all("all => all.map((head) => head.dataset.name)")
    column = names.index("relative_contact_area (1)")
    values = f"[...document.querySelectorAll('#numbers tbody tr')].map((row) => +row.cells[{column}].dataset.v)"
    for expected, sign in (("ascending", 1), ("descending", -1)):
        heads.nth(column).locator("button").click()
        assert heads.nth(column).get_attribute("aria-sort") == expected
        assert (sign * np.diff(page.evaluate(values)) >= 0).all()
    with page.expect_download() as download:
        page.click(".csv")
    assert download.value.suggested_filename == "comparison_out.csv"
    with open(download.value.path(), newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(io.StringIO(file.read())))
    assert len(rows) == 28
    with xr.open_dataset(reports / "continuum.nc", decode_timedelta=False) as dataset:
        for row in (row for row in rows if row["model"] == "continuum"):
            part = dataset.sel(well_depth_ratio=float(row["well_depth_ratio"]))
            step = int(np.flatnonzero(part.applied_pressure == float(row["applied_pressure (Pa)"]))[0])
            for name in ("relative_contact_area", "mean_gap"):
                (own,) = [float(value) for key, value in row.items() if key.partition(" ")[0] == name]
                assert own == float(part[name][step])


def test_printing_opens_every_section(opened):
    page = opened("one", 800, "dark")
    page.evaluate(
        "addEventListener('beforeprint', () => { window.shown = document.querySelectorAll('details[open]').length; })"
    )
    assert page.pdf().startswith(b"%PDF")
    assert page.evaluate("window.shown") == page.locator("details").count() > 6
    assert page.locator("details[open]").count() == 0, "closed again"
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.querySelector('.tile')).backgroundColor") == "rgb(255, 255, 255)"
