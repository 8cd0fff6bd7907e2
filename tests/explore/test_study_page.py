"""A study on the page without a browser: keys, checks, files, runs; and who may see the page."""

import time
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
import pytest

from contact_study import InputError, make_study
from contact_study.study.examples import example
from contact_study.study.schema.dotted_keys import SECTIONS
from contact_study.study.schema.keys import keys_of

pytest.importorskip("panel")
pytestmark = pytest.mark.filterwarnings("default")  # those of Panel
from contact_study.explore import draft, runs  # noqa: E402

FIRST = draft.parsed(example("first"))


@pytest.fixture
def page(tmp_path):
    from contact_study.explore.study_page import StudyPage

    opened = []
    made = StudyPage(tmp_path, opened.append)
    made.seen = opened
    return made


def widget(page, dotted):
    page.section.value = dotted.partition(".")[0]
    (found,) = (one for one in page.keys if dotted in one.tags)
    return found


def test_every_key_of_a_study_has_a_field(page):
    for section, declared in SECTIONS.items():
        page.section.value = section
        names = {tag for one in page.keys for tag in one.tags}
        if isinstance(declared, type):
            assert names == {f"{section}.{name}" for name in keys_of(declared)}
    page.section.value = "surface"
    assert {"surface.hurst_exponent", "surface.kind"} <= {tag for one in page.keys for tag in one.tags}
    widget(page, "surface.kind").value = "sphere"
    names = {tag for one in page.keys for tag in one.tags}
    assert "surface.radius" in names
    assert "surface.hurst_exponent" not in names


@pytest.mark.validation
def test_what_one_types_is_the_study_of_the_command(page, tmp_path):
    widget(page, "surface.rms_height").value = "5 angstrom"
    widget(page, "loading.path").value = "10 MPa, 1 GPa"
    widget(page, "interaction.well_depth_ratio").value = "2, 3"
    study = page.judgement.study
    assert [case.interaction.well_depth_ratio for case in study.cases] == [2, 3]
    assert study.cases[0].loading.path == (1e7, 1e9)
    assert study.cases[0].surface.rms_height == pytest.approx(5e-10)
    assert make_study(draft.parsed(page.text.value), tmp_path).cases[0].surface == study.cases[0].surface
    widget(page, "surface.rms_height").value = ""
    assert "rms_height" in page.lights.object
    assert page.go.disabled
    page.text.value = example("sphere")
    assert not page.go.disabled
    assert page.table["surface"]["kind"] == "sphere"


def test_a_value_is_shown_as_it_is_typed():
    for section in ("surface", "loading", "interaction", "sweep"):
        for name, (_, _, value) in draft.keys_shown(FIRST, section).items() if section in SECTIONS else ():
            if value:
                changed = draft.with_key(FIRST, f"{section}.{name}", value)
                one, other = (make_study(table).cases for table in (changed, FIRST))
                assert [getattr(case, section) for case in one] == [getattr(case, section) for case in other]


def test_lights():
    sticky = draft.with_key(FIRST, "interaction.work_of_adhesion", "2 J/m^2")
    good, bad = draft.judge(FIRST, Path()), draft.judge(sticky, Path())
    kinds = {light.title.partition(":")[0]: light.kind for light in good.lights}
    assert kinds["continuum"] == kinds["grid points per process zone"] == "good"
    assert {light.kind for light in bad.lights if "process zone" in light.title} & {"fair", "bad"}
    assert any(line.startswith("E* = 93.7 GPa") for line in good.lines)
    assert "hurst_exponent" in draft.judge(draft.with_key(FIRST, "surface.hurst_exponent", "2"), Path()).error


def test_nothing_outside_the_folder_is_read_and_no_code_is_run(tmp_path):
    (tmp_path / "inside").mkdir()
    np.save(tmp_path / "secret.npy", np.zeros((4, 4)))
    for path in ("../secret.npy", str(tmp_path / "secret.npy")):
        table = {**FIRST, "surface": {"kind": "file", "path": path, "size": "1 um"}}
        assert "outside" in draft.judge(table, tmp_path / "inside").error
        swept = {**FIRST, "sweep": {"surface.path": [path]}}
        assert "outside" in draft.judge(swept, tmp_path / "inside").error
    code = {**FIRST, "elasticity": {"kind": "python", "object": "os:getcwd"}}
    assert "no Python code" in draft.judge(code, tmp_path / "inside").error


@pytest.mark.parametrize("name", ["../up.npy", "a/../../b.npy", "<b>.npy", "run.toml", "x.py", ".npy", "", "no_ending"])
def test_hostile_names_of_uploads_are_refused(tmp_path, name):
    folder = tmp_path / "folder"
    folder.mkdir()
    try:
        path = draft.keep_upload(folder, name, b"1")
    except InputError:
        assert not any(folder.iterdir())
    else:
        assert path.parent == folder
        assert path.name in ("up.npy", "b.npy")
    assert [one.name for one in tmp_path.iterdir()] == ["folder"]


def test_nothing_is_overwritten(tmp_path, monkeypatch):
    first, again, other = (draft.keep_upload(tmp_path, "map.npy", content) for content in (b"1", b"1", b"2"))
    assert first == again
    assert other.name == "map-2.npy"
    assert first.read_bytes() == b"1"
    study = draft.keep_study(tmp_path, "study", FIRST)
    changed = draft.keep_study(tmp_path, "study", draft.with_key(FIRST, "surface.seed", "9"))
    assert [study.name, changed.name] == ["study.toml", "study-2.toml"]
    monkeypatch.setattr(draft, "LARGEST_UPLOAD", 3)
    with pytest.raises(InputError, match="MB"):
        draft.keep_upload(tmp_path, "large.npy", b"1234")


@pytest.mark.validation
def test_an_upload_becomes_the_surface(page, tmp_path):
    import io

    file = io.BytesIO()
    np.save(file, 1e-9 * np.random.default_rng(1).standard_normal((32, 32)))
    page.upload.value = file.getvalue()
    page.upload.filename = "map.npy"
    assert page.table["surface"] == {"kind": "file", "path": "map.npy"}
    assert "size" in page.lights.object  # which such a file does not hold
    widget(page, "surface.size").value = "1 um"
    widget(page, "surface.height_unit").value = "m"
    assert page.judgement.study is not None, page.judgement.error
    before = page.surface.object
    widget(page, "surface.detrend").value = "tilt"
    assert page.surface.object != before
    assert page.surface.object.startswith("<img")
    page.upload.value, page.upload.filename = b"no map", "wrong.npy"
    assert "wrong.npy" in page.lights.object
    assert page.go.disabled


def test_a_first_look_is_coarser_and_only_that():
    fine = draft.with_key(FIRST, "surface.shape", "512, 512")
    found = draft.coarser(fine, Path())
    assert found["surface"]["shape"] == [64, 64]
    assert {**found["surface"], "shape": 0} == {**fine["surface"], "shape": 0}
    waves = draft.with_key(fine, "surface.cutoff_mode", "60")
    assert draft.coarser(waves, Path())["surface"]["shape"] == [128, 128]


@pytest.mark.validation
def test_the_theories_need_no_grid():
    curves = draft.theory_curve(make_study(draft.with_key(FIRST, "surface.shape", "16, 16")))
    assert curves.keys() == {"persson", "gap_flow", "edge_flow"}
    for pressures, areas in curves.values():
        assert pressures[-1] == pytest.approx(4e9)
        assert (np.diff(areas) > 0).all()
    assert draft.theory_curve(make_study(draft.with_key(FIRST, "loading.path", "-1 MPa"))) == {}


@pytest.mark.validation
def test_a_run_stops_goes_on_and_is_that_of_the_command(page, tmp_path):
    from contact_study.explore.results import ResultsPage

    widget(page, "surface.shape").value = "128, 128"
    widget(page, "loading.path").value = ", ".join(f"{20 * n} MPa" for n in range(1, 60))
    page.go.clicks += 1
    (output,) = (run.output for run in runs.runs_in(tmp_path))
    wait(lambda: runs.run_of(output).done > 2)
    runs.start(tmp_path / "study.toml", output, "continuum")  # a second tab: no second process
    page.follow()
    assert page.seen == [[output]] * len(page.seen) != []
    runs.stop(output)
    wait(lambda: not runs.run_of(output).alive)
    assert runs.run_of(output).state.startswith("stopped")
    assert not output.exists()
    unfinished = ResultsPage([output], tmp_path)  # some cases of the sweep have not begun
    assert unfinished.field.value == "gap"
    assert unfinished._exported("png").read(4) == b"\x89PNG"
    page._resume(output)
    wait(output.exists)
    wait(lambda: not runs.run_of(output).alive)
    assert runs.run_of(output).state == "finished"
    page.go.clicks += 1
    assert not runs.run_of(output).alive


def wait(done, most=120.0):
    until = time.monotonic() + most
    while not done():
        assert time.monotonic() < until
        time.sleep(0.1)


def test_who_has_no_token_sees_nothing(tmp_path):
    from threading import Thread

    from tornado.ioloop import IOLoop

    from contact_study.explore.server import serve

    server, address = serve([], tmp_path)
    codes, hosts = [], {socket.getsockname()[0] for socket in server._http._sockets.values()}

    def ask():
        for url in (address.partition("?")[0], address[:-1], address):
            try:
                codes.append(urllib.request.urlopen(url, timeout=30).status)
            except urllib.error.HTTPError as error:
                codes.append(error.code)
        server.io_loop.add_callback(server.io_loop.stop)

    asking = Thread(target=ask)
    asking.start()
    IOLoop.current().start()
    asking.join()
    server.stop()
    assert codes == [403, 403, 200]
    assert hosts == {"127.0.0.1"}
    assert server._tornado._websocket_origins == {f"localhost:{server.port}"}
