"""Cost of a study's bookkeeping: what Persson's theory of a few hundred points spends on steps on disk and on the rest.

Runs the paper's study with three adhesion strengths and 60 pressures by ``persson-theory`` in a process of its own and
prints its wall-clock and processor time; then writes and reads its finished steps again, and prints the time of each
and its share of the processor time. Shares compare between machines, times do not.

    python -m scripts.benchmark_storage data/yang2008.toml
    python -m scripts.benchmark_storage data/yang2008.toml --flows gap_flow
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import tomli_w

from contact_study.campaign.dataset.file import DatasetReader, StoredCase
from contact_study.campaign.store.case_file import CaseWriter
from contact_study.results.state import Step
from contact_study.study.study import Study, make_study, read_study
from scripts.harness import RUN, STUDY, Option, children_time, processor_time, program

RATIOS, PRESSURES = (1, 4, 8), np.geomspace(1e8, 1e10, 60)


def run(given: argparse.Namespace) -> None:
    study = many_points(given.study)
    with tempfile.TemporaryDirectory() as folder:
        wall, processor, dataset = run_theory(study, Path(folder), given.workers, given.flows)
        written, read, count = write_and_read(study, dataset, Path(folder) / "all.case")
    print(f"persson-theory, {count} steps, {given.workers} processes: {wall:.1f} s, of processors {processor:.1f} s")
    for words, seconds in (("write", written), ("read", read)):
        share = 100 * seconds / processor
        print(f"{words} a step: {1e3 * seconds / count:.2f} ms, all {share:.1f} % of processors")


def many_points(path: Path) -> Study:
    """The study at the paper's adhesion strengths and many pressures."""
    table = read_study(path).table
    table.pop("override", None)
    table["theory"] = {"spectrum": "analytic"}  # a second spectrum is another theory's time, not bookkeeping
    table["loading"]["path"] = PRESSURES.tolist()
    table["sweep"] = {"interaction.well_depth_ratio": list(RATIOS)}
    return make_study(table, path.parent)


def run_theory(study: Study, folder: Path, workers: int, flows: str) -> tuple[float, float, Path]:
    """Wall-clock and processor time of the command (s), its children included; and its dataset."""
    (folder / "study.toml").write_text(tomli_w.dumps(study.table))
    output = folder / "theory.nc"
    command = [*RUN, str(folder / "study.toml"), "--model", "theory", "-o", str(output)]
    before, began = children_time(), time.perf_counter()
    command += ["--workers", str(workers), "--theory.flows", flows]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    return time.perf_counter() - began, children_time() - before, output


def write_and_read(study: Study, dataset: Path, path: Path) -> tuple[float, float, int]:
    """Processor time to write all steps of a dataset, and to read them (s), and their number."""
    bins = study.bins
    with DatasetReader(dataset, study) as earlier:
        cases = [(StoredCase(earlier, i, bins), len(case.path)) for i, case in enumerate(study.cases)]
        values = [case.step(number)[0] for case, steps in cases for number in range(steps)]
    with CaseWriter(path, len(values), last_state=False) as file:
        written = processor_time(lambda: [file.save_step(i, Step(one, bins=bins)) for i, one in enumerate(values)])
    read = processor_time(lambda: [file.step(i) for i in range(len(values))])
    return written, read, len(values)


main = program(
    run,
    STUDY,
    Option("--workers", 1, "processes of the command"),
    Option("--flows", "gap_flow, edge_flow", "theory.flows of the study"),
)

if __name__ == "__main__":
    sys.exit(main())
