"""Continue an earlier run: a finished dataset, the steps of an unfinished run, or both.

Every check comes before the first change. Cases that the dataset holds whole stay there; others move to the work
directory by one rename each, as if the run had just been interrupted. The old dataset stays until the new one is whole.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from contact_study.campaign.dataset.file import DatasetReader, StoredCase, attributes_of, history_of, states_file
from contact_study.campaign.dataset.predictor import GapFields
from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.campaign.progress import Progress
from contact_study.campaign.record import Run, describe_differences, differences
from contact_study.campaign.store.case_file import CaseFile, write_case
from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.study.case import Case, path_points_of

# Why the bins of a finished distribution do not serve.
COARSER_BINS = "the bins of its distributions were coarser than those asked for now"

# Optional content of a step, in rising order, by the key of [output].
_KEPT: Mapping[str, tuple[Any, ...]] = {
    "fields": (False, True),
    "leakage": (False, True),
    "atoms": ("none", "surface", "block"),
    "field_precision": ("single", "double"),
}


class NotKeptError(InputError):
    """A resume would lose content of the same study's earlier run, or its height map changed."""


class Match(NamedTuple):
    """Number of a case in an earlier run, how many of its first steps keep their numbers, and why not all if so."""

    earlier: int
    steps: int
    reason: str = ""


def existing_dataset(work: WorkDirectory, *, resume: bool, overwrite: bool) -> dict[str, Any] | None:
    """Attributes of the dataset at the output, if this run continues it and no steps replace it."""
    output = work.output
    if not output.exists() or overwrite:
        return None
    if not resume:
        raise InputError(f"{output} exists; use --overwrite to replace it or --resume to continue its run")
    if work.replaces() == history_of(output):
        return None
    attributes = attributes_of(output)
    if attributes is None:
        raise InputError(f"{output} exists and is no readable dataset; use --overwrite or another output")
    return attributes


def resume_run(
    run: Run,
    work: WorkDirectory,
    unfinished: Mapping[str, Any] | None,
    finished: Mapping[str, Any] | None,
    git_commit: str,
    progress: Progress,
) -> tuple[list[str], Run | None, dict[int, int]]:
    """Find the finished part of a run; bring cases that no dataset holds whole into its open work directory.

    Earlier runs are given by their attributes: ``unfinished`` steps in the directory, a ``finished`` dataset. Returns
    warnings, the record of the dataset, and the cases of this run that it holds whole, by both numbers.
    """
    notes: list[str] = []
    whole: dict[int, int] = {}
    earlier: Run | None = None
    matches: dict[int, Match] = {}
    if finished is not None:
        earlier, matches = _match(finished, run, work.output, "exists and belongs to another study or model")
        if run.start is not None:
            with DatasetReader(work.output, earlier.study) as dataset:
                _check_starts(run, matches, lambda number: StoredCase(dataset, number, run.study.bins))
    if unfinished is not None:
        notes += _take_over(unfinished, run, work, progress)
    replaced = history_of(work.output) if finished is None and work.output.exists() else None
    work.claim({**run.attributes, "git_commit": git_commit}, replaced)
    if earlier is None:
        return notes, earlier, whole
    with DatasetReader(work.output, earlier.study) as dataset:
        bins = dataset.bins(run.study.bins)
        for number, found in progress.through(matches.items(), "cases of the dataset checked"):
            steps, file = len(run.study.cases[number].path), CaseFile(work.case_file(run.case_names[number]))
            if found.steps == steps and bins.hold(run.study.bins):
                whole[number] = found.earlier
            elif not file.path.exists() or file.finished(steps, last_state=False) < found.steps:
                reason = _extract(dataset, found, bins, run.study.bins, file.path)
                notes += [_again(run, number, reason)] if reason else []
    return list(dict.fromkeys(notes)), earlier, whole


def _match(attributes: Mapping[str, Any], run: Run, where: Path, fault: str) -> tuple[Run, dict[int, Match]]:
    try:
        return match(attributes, run)
    except NotKeptError as error:
        raise InputError(f"{where}: {error}") from None
    except InputError as error:
        raise InputError(f"{where} {fault}; use --overwrite or another output: {error}") from None


def _take_over(unfinished: Mapping[str, Any], run: Run, work: WorkDirectory, progress: Progress) -> list[str]:
    """Give the case files of an unfinished run the names of this run's cases; drop steps that do not serve."""
    earlier, matches = _match(unfinished, run, work.folder, "holds the steps of another study or version")
    files = [CaseFile(work.case_file(name)) for name in earlier.case_names]
    for file in progress.through(files, "case files of the earlier run checked"):
        file.check()
    _check_starts(run, matches, files.__getitem__)
    # No check comes after this line.
    notes = []
    for number, found in matches.items():
        file, target = files[found.earlier], work.case_file(run.case_names[number])
        usable = file.usable_steps(run.study.bins)
        file.keep(min(found.steps, usable), partial=usable < found.steps and not file.has_step(usable))
        if file.path != target and file.path.exists():
            file.path.rename(target)
        if found.reason and not file.has_steps:
            notes.append(_again(run, number, found.reason))
    damaged = sum(file.damaged for file in files)
    if damaged:
        notes.append(f"{damaged} damaged files of the earlier run: this run computes their lost steps again")
    return notes


def _again(run: Run, number: int, reason: str) -> str:
    return ": ".join(filter(None, (run.study.cases[number].label, "computed again", reason)))


def _check_starts(run: Run, matches: Mapping[int, Match], earlier: Callable[[int], CaseFile | StoredCase]) -> None:
    """Check that every finished step started from the gap field that the predictor holds now."""
    if run.start is None:
        return
    for number, found in matches.items():
        case = run.study.cases[number]
        fields = GapFields(run.start, case)
        for step in range(found.steps):
            before = earlier(found.earlier).step_text(step, "predictor_field")
            if before is None:  # not finished
                break
            if before != fields.fingerprint(step):
                where = f"{case.label}, " if case.label else ""
                raise InputError(
                    f"--predictor {run.start}: holds another gap field than the finished step started from ({where}"
                    f"point {step + 1}); use the earlier file, --overwrite or another output"
                )


def _extract(dataset: DatasetReader, found: Match, bins: Bins, own: Bins, path: Path) -> str:
    """Write the usable steps of a dataset's case to a case file; returns why none are usable, if so."""
    if found.steps == 0:
        return found.reason
    if not bins.hold(own):
        return COARSER_BINS
    case = StoredCase(dataset, found.earlier, bins)
    state = case.state(found.steps - 1)
    if state:
        write_case(path, case.constants, (case.step(number)[0] for number in range(found.steps)), bins, state)
        return ""
    return found.reason or (
        "the state after its last point was not kept (output.restart = false), or its file "
        f"{states_file(dataset.path).name} is missing, of another dataset or damaged"
    )


def match(attributes: Mapping[str, Any], run: Run) -> tuple[Run, dict[int, Match]]:
    """Find the cases of an earlier run, read from attributes, in one that may be larger, by number."""
    for name in ("model", "version", "schema_version"):
        if attributes.get(name) != run.attributes[name]:
            raise InputError(f"{name} is {attributes.get(name, 'unknown')} there and {run.attributes[name]} here")
    there = str(attributes.get("predictor", ""))
    if bool(there) != bool(run.predictor):
        names = [text.partition(" ")[0] or "none" for text in (there, run.predictor)]
        raise InputError(f"--predictor is {names[0]} there and {names[1]} here")
    earlier = Run.read(attributes, run.study.directory, run.model)
    values = [run.deciding_keys(case) for case in run.study.cases]
    by_text: dict[str, list[int]] = {}
    for number, text in enumerate(run.case_texts):
        by_text.setdefault(text, []).append(number)
    matches: dict[int, Match] = {}
    for number, case in enumerate(earlier.study.cases):
        own = earlier.deciding_keys(case)
        # Equal texts are the rule; equal values may round to different texts.
        likely = by_text.get(earlier.case_texts[number], range(len(values)))
        alike = [other for other in likely if other not in matches and not differences(own, values[other])]
        if not alike:
            raise _different(own, values, case, run.study.cases[0].coordinates)
        # Of cases that differ only in loading.unload the one with the same value comes first.
        chosen = min(alike, key=lambda other: run.study.cases[other].loading.unload != case.loading.unload)
        matches[chosen] = _matched_steps(number, case, run.study.cases[chosen], run)
    return earlier, matches


def _different(
    values: Mapping[str, Any], others: Sequence[Mapping[str, Any]], case: Case, swept: Mapping[str, Any]
) -> InputError:
    """Name the difference between an earlier case and the most similar case of this run."""
    differing = min((differences(values, other) for other in others), key=len)
    maps = case.map_keys
    if differing and differing.keys() <= maps.keys():
        dotted = next(iter(differing))
        one, two = (str(value).rpartition(" ")[2][:12] for value in differing[dotted])
        return NotKeptError(
            f"the map {maps[dotted]} has changed since it was started (SHA-256 {one}… then, {two}… "
            "now); use another output, or --overwrite"
        )
    if {key.rpartition(".")[2] for key in differing} <= set(case.coordinates) & set(swept):
        return InputError(f"the study lacks the point {case.label}")
    return InputError(describe_differences(differing, "there", "here"))


def _matched_steps(number: int, case: Case, other: Case, run: Run) -> Match:
    """Count the steps that a case shares with another that differs only in its path and kept content."""
    where = f" at {case.label}" if case.label else ""
    if case.loading.unload and not other.loading.unload:
        raise InputError(f"loading.unload is true there and false here{where}")
    before, after = path_points_of(case), path_points_of(other)
    length = len(case.loading.path)
    if after[:length] != before[:length]:
        raise InputError(f"loading.path{where} does not begin with the {length} points that are there")
    reasons = list(_faults(case, other, run, run.model.whole_path and before != after))
    if reasons:
        return Match(number, 0, reasons[0])
    shared = next((i for i, pair in enumerate(zip(before, after, strict=False)) if pair[0] != pair[1]), len(before))
    return Match(number, shared, "unloading starts from another point" if shared < len(before) else "")


def _faults(case: Case, other: Case, run: Run, path_changed: bool) -> Iterator[str]:
    """Yield why no step of an earlier case serves another one; raises NotKeptError if that keeps less."""
    fields = "fields" in run.model.keeps and case.output.fields
    for name in run.model.keeps:
        yield from _kept_otherwise(case, other, name)
    if fields and case.kept_fields - other.kept_fields:
        raise NotKeptError(
            "it keeps fields of points that output.field_steps leaves out: name them, too, or use another output or "
            "--overwrite"
        )
    if fields and other.kept_fields.intersection(range(len(case.path))) - case.kept_fields:
        yield "output.field_steps: the earlier run did not keep the fields of these points"
    if fields:
        yield from _kept_otherwise(case, other, "field_precision")
    if path_changed:
        yield "the path has changed, and its points share quantities of the whole path"
    if run.model.own_steps and case.least_step != other.least_step:
        yield "the least step of loading.adaptive follows the largest value of the path, which grew"
    output, bins = case.output, run.study.bins
    for chosen, edges in ((output.pressure_range, bins.pressure_edges), (output.gap_range, bins.gap_edges)):
        slack = 1e-9 * (edges[-1] - edges[0])
        if chosen is not None and not chosen[0] - slack <= edges[0] < edges[-1] <= chosen[1] + slack:
            yield "the distributions there were counted in a narrower range"


def _kept_otherwise(case: Case, other: Case, name: str) -> Iterator[str]:
    """Yield why output that an earlier case kept does not serve another one that keeps more of it."""
    there, here = getattr(case.output, name), getattr(other.output, name)
    change = _KEPT[name].index(here) - _KEPT[name].index(there)
    # Flags as a study file has them.
    then, now = (value if isinstance(value, str) else str(value).lower() for value in (there, here))
    if change < 0:
        raise NotKeptError(
            f"it keeps {name.replace('_precision', 's')} by output.{name} = {then}, this study has {now}: set it "
            "so, or use another output or --overwrite"
        )
    if change:
        lacked = "kept single precision" if name == "field_precision" else f"did not keep its {name}"
        yield f"output.{name} = {now}: the earlier run {lacked}"
