"""Run a study by one of the models."""

import argparse
from pathlib import Path

from contact_study.campaign.engines import ENGINES
from contact_study.campaign.model import WORDS
from contact_study.command_line.frame import epilog, report_convergence
from contact_study.inputs.errors import InputError

KEYS = True
KEPT = "finished steps are kept, continue with --resume"
USAGE = "STUDY.toml -o OUT.nc [options] [--section.key VALUE ...]"
END = epilog(
    "bem-adhesion run study.toml -o bem.nc",
    "bem-adhesion run study.toml -o md.nc --model atoms --workers 4",
    'bem-adhesion run study.toml -o bem.nc --resume --surface.seed 1,2,3 --loading.path "-1 kPa, 2 MPa"',
    solves=True,
)


def add(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("study", type=Path, metavar="STUDY.toml", help="study file")
    add("-o", "--output", required=True, metavar="FILE", help="dataset to write, .nc or .zarr")
    add("--model", choices=WORDS, default="continuum", metavar="NAME", help="continuum (default), atoms or theory")
    add("--start-from", dest="predictor", type=Path, metavar="FILE", help="dataset whose gaps the atoms start from")
    add("--predictor", type=Path, help=argparse.SUPPRESS)  # its name in earlier versions
    add("--resume", action="store_true", help="continue or extend an earlier run")
    add("--overwrite", action="store_true", help="replace an existing dataset")
    add("--workers", type=int, metavar="N", help="processes; default: one per case, at most the cores")
    add("--engine", choices=ENGINES, metavar="NAME", help=f"{', '.join(ENGINES)}; default: by the number of workers")
    add("--scheduler", metavar="ADDRESS", help="address, or file, of the scheduler of a Dask cluster")
    add("--section.key", metavar="VALUE", help="any key of the study, listed by `bem-adhesion keys`; a list sweeps it")


def run(given: argparse.Namespace) -> int:
    from contact_study.campaign import model as models
    from contact_study.campaign.progress import Progress
    from contact_study.campaign.run import RunOptions, run_campaign
    from contact_study.campaign.store.files import check_inputs_kept, named_file
    from contact_study.study.study import read_study

    output, model = named_file(given.output), given.other_model or models.MODELS[WORDS[given.model]]
    if given.predictor is not None and not model.takes_predictor:
        raise InputError(f"--start-from {given.predictor}: only atoms start from gaps; use --model atoms")
    if given.resume and given.overwrite:
        raise InputError("--resume and --overwrite exclude each other")
    if given.workers is not None and given.workers < 1:
        raise InputError(f"--workers {given.workers}: must be at least 1")
    study = read_study(given.study, given.keys)
    maps = (path for case in study.cases for path in case.height_maps.values())
    check_inputs_kept(output, [given.study, given.predictor, *maps])
    options = RunOptions(given.resume, given.overwrite, given.workers, given.engine, given.scheduler)
    groups = run_campaign(model, study, output, Progress(given.command), given.words, given.predictor, options)
    print(output)
    return report_convergence(given.command, groups)
