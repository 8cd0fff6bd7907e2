import multiprocessing
import os
import random
import resource
import signal

import pytest
import xarray as xr

from contact_study.start import contact_compare as compare
from contact_study.start import contact_merge as merge
from tests.campaign.conftest import fail
from tests.campaign.toy_model import TOY, TOY_ATOMS
from tests.campaign.toy_study import BASE, MORE, changed
from tests.commands import main

FEWER = changed(sweep={"interaction.well_depth_ratio": [2]})
# Processor time (s) for four commands that take one: what is not done by then is in an endless loop.
_PATIENCE = 10

pytestmark = pytest.mark.usefixtures("toy_is_the_continuum")


@pytest.fixture
def ways(finished, run, tmp_path, capsys):
    run(FEWER, output="other.nc")
    dataset, other, new = (str(tmp_path / name) for name in ("bem.nc", "other.nc", "new.nc"))

    def quietly(main, *arguments):
        capsys.readouterr()
        status = main([*arguments, "-o", new])
        return status, capsys.readouterr().err

    return {
        "resume": lambda: run(BASE, "--resume")[::2],
        "predictor": lambda: run(BASE, "--predictor", dataset, output="md.nc", model=TOY_ATOMS)[::2],
        "merge": lambda: quietly(merge, dataset, other),
        "compare": lambda: quietly(compare, dataset),
        "wider": lambda: run(MORE, "--resume")[::2],
    }


@pytest.mark.parametrize("way", ["resume", "predictor", "merge", "compare", "wider"])
def test_whatever_a_library_raises_is_one_line(ways, monkeypatch, tmp_path, way):
    for name in ("open_dataset", "open_datatree"):
        monkeypatch.setattr(xr, name, fail(AttributeError("x")))
    status, said = ways[way]()
    assert (status, said.count("\n")) == (1, 1), said
    assert str(tmp_path / "bem.nc") in said


@pytest.mark.validation
# Python 3.12 warns of threads in the process that forks: those of pytest-xdist, which the child has no part in.
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_one_flipped_bit_is_one_line_or_none(ways, tmp_path, finished):
    chance = random.Random(1)
    whole = (tmp_path / "bem.nc").read_bytes()
    context = multiprocessing.get_context("fork")
    refused, endless = context.Value("i", 0), 0
    for _ in range(60):
        content = bytearray(whole)
        content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
        (tmp_path / "bem.nc").write_bytes(content)
        # A process for each damaged file, as users have: HDF5 is not left whole by one that it could not read.
        trial = context.Process(target=_use, args=(ways, tmp_path, refused))
        trial.start()
        trial.join()
        if trial.exitcode == -signal.SIGXCPU:
            # HDF5 2 reads a global heap with an object of size zero for ever (H5HG__cache_heap_deserialize): a bit of a
            # few thousand leads there, and which one depends on paths and dates in the file. No caller can stop it.
            endless += 1
        else:
            assert trial.exitcode == 0
    assert refused.value > 20
    assert endless <= 2


def _use(ways, folder, refused):
    resource.setrlimit(resource.RLIMIT_CPU, (_PATIENCE, resource.RLIM_INFINITY))
    for way in ("resume", "predictor", "merge", "wider"):
        status, said = ways[way]()
        assert "Traceback" not in said
        if status == 1:
            refused.value += 1
            assert said.splitlines()[-1].count(str(folder / "bem.nc")) == 1
        for name in ("new.nc", "md.nc"):
            (folder / name).unlink(missing_ok=True)


@pytest.fixture
def pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe.nc")
    return tmp_path / "pipe.nc"


def test_what_is_no_file_is_no_input(run, tmp_path, pipe, capsys):
    (tmp_path / "loop.nc").symlink_to(tmp_path / "loop.nc")
    special = "is a pipe or a device, not a file"
    for path, words in (
        (pipe, special),
        ("/dev/zero", special),
        (tmp_path / "loop.nc", "is a link that leads nowhere"),
        (tmp_path, "is a folder"),
    ):
        path = str(path)
        surface = {"kind": "file", "path": path, "height_unit": "m", "rms_height": None, "cutoff_mode": None}
        for status, said in (
            run(BASE, "--predictor", path, output="md.nc", model=TOY_ATOMS)[::2],
            run(changed(surface=surface), output="map.nc")[::2],
            (merge([path, str(tmp_path / "none.nc"), "-o", str(tmp_path / "all.nc")]), capsys.readouterr().err),
            (compare([path, "-o", str(tmp_path / "comparison.nc")]), capsys.readouterr().err),
            (main(TOY, [path, "-o", str(tmp_path / "bem.nc")]), capsys.readouterr().err),
        ):
            assert (status, said.count("\n")) == (1, 1), said
            assert any(f"{path}{more}" in said for more in (f" {words}", f": {words}", ": cannot be read ("))


@pytest.mark.parametrize("how", [(), ("--resume",), ("--overwrite",)])
def test_what_is_no_file_is_no_output(run, tmp_path, pipe, how):
    (tmp_path / "loop.nc").symlink_to(tmp_path / "loop.nc")
    for name in ("pipe.nc", "loop.nc"):
        status, solved, said = run(BASE, *how, output=name)
        assert (status, solved, said.count("\n")) == (1, [], 1), said
        assert str(tmp_path / name) in said
    assert pipe.is_fifo()
    assert (tmp_path / "loop.nc").is_symlink()


def test_a_full_disk_while_a_comparison_is_written(finished, tmp_path, capsys):
    before, limits = sorted(tmp_path.iterdir()), resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, limits[1]))
    try:
        assert compare([str(tmp_path / "bem.nc"), "-o", str(tmp_path / "comparison.nc")]) == 1
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    said = capsys.readouterr().err
    assert f"contact-compare: error: {tmp_path / 'comparison.nc'}: cannot be written" in said.splitlines()[-1]
    assert sorted(tmp_path.iterdir()) == before
