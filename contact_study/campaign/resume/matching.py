"""Match the cases of an earlier run to those of a new one; count the steps that keep their numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from contact_study.campaign.record import Run, RunRecord, describe_differences, differences, nearest
from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.study.case import Case
from contact_study.study.load_steps import path_points_of

# Optional content of a step, in rising order, by the key of [output].
_KEPT: Mapping[str, tuple[Any, ...]] = {"fields": (False, True), "atoms": ("none", "surface", "block")}


class NotKeptError(InputError):
    """A resume would lose content of the same study's earlier run, or its height map changed."""


@dataclass(frozen=True)
class Match:
    """Number of a case in an earlier run, how many of its first steps keep their numbers, and why not all if so."""

    earlier: int
    steps: int
    reason: str = ""


def match(attributes: Mapping[str, Any], run: Run) -> tuple[RunRecord, dict[int, Match]]:
    """Read an earlier run from a dataset's attributes; find its cases in a new one, by the numbers of the new one.

    The new run may add points to the sweep and the path and keep more content; it must contain the earlier one. An
    InputError names the difference, the caller the earlier run; it is a NotKeptError if only the kept content or the
    height map's content differs.
    """
    for name in ("model", "version", "schema_version"):
        if attributes.get(name) != run.record.attributes[name]:
            raise InputError(
                f"{name} is {attributes.get(name, 'unknown')} there and {run.record.attributes[name]} here"
            )
    there = str(attributes.get("predictor", ""))
    if bool(there) != bool(run.record.predictor):
        names = [text.partition(" ")[0] or "none" for text in (there, run.record.predictor)]
        raise InputError(f"--predictor is {names[0]} there and {names[1]} here")
    earlier = RunRecord.read(attributes, run.study.directory, run.model.ignores)
    earlier.require_height_maps()
    values = [run.record.deciding_keys(case) for case in run.study.cases]
    by_text: dict[str, list[int]] = {}
    for number, text in enumerate(run.record.case_texts):
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
    differing = nearest(values, others)
    if list(differing) == ["surface.path"] and case.height_map is not None:
        one, two = (str(value).rpartition(" ")[2][:12] for value in differing["surface.path"])
        return NotKeptError(
            f"the height map {case.surface.map_path} has changed since it was started (SHA-256 {one}… then, {two}… "
            "now); use another output, or --overwrite"
        )
    if {key.rpartition(".")[2] for key in differing} <= set(case.coordinates) & set(swept):
        return InputError(f"the study lacks the point {case.label}")
    return InputError(describe_differences(differing, "there", "here"))


def _matched_steps(number: int, case: Case, other: Case, run: Run) -> Match:
    """Count the steps that a case shares with another that differs only in its path and kept content."""
    model = run.model
    added = [reason for name in model.keeps if (reason := _added_content(name, case, other))]
    where = f" at {case.label}" if case.label else ""
    if case.loading.unload and not other.loading.unload:
        raise InputError(f"loading.unload is true there and false here{where}")
    before, after = path_points_of(case), path_points_of(other)
    length = len(case.loading.path)
    if after[:length] != before[:length]:
        raise InputError(f"loading.path{where} does not begin with the {length} points that are there")
    if "fields" in model.keeps and case.output.fields:
        added += filter(None, [_added_fields(case, other)])
    if model.whole_path and before != after:
        added.append("the path has changed, and its points share quantities of the whole path")
    if model.own_steps and case.least_step != other.least_step:
        added.append("the least step of loading.adaptive follows the largest value of the path, which grew")
    if not _ranges_contain(case, run.bins):
        added.append("the distributions there were counted in a narrower range")
    if added:
        return Match(number, 0, added[0])
    shared = next((i for i, pair in enumerate(zip(before, after, strict=False)) if pair[0] != pair[1]), len(before))
    return Match(number, shared, "unloading starts from another point" if shared < len(before) else "")


def _added_content(name: str, case: Case, other: Case) -> str:
    """Why a case needs some content that an earlier run did not keep, if so; raises NotKeptError if it keeps less."""
    there, here = getattr(case.output, name), getattr(other.output, name)
    change = _KEPT[name].index(here) - _KEPT[name].index(there)
    # Flags as a study file has them.
    then, now = (value if isinstance(value, str) else str(value).lower() for value in (there, here))
    if change < 0:
        raise NotKeptError(
            f"it keeps {name} by output.{name} = {then}, this study has {now}: set it so, or use another output or "
            "--overwrite"
        )
    return f"output.{name} = {now}: the earlier run did not keep its {name}" if change else ""


def _added_fields(case: Case, other: Case) -> str:
    """Why a case needs more of its fields than an earlier run kept, if so; raises NotKeptError if it keeps fewer."""
    digits = case.output.field_precision, other.output.field_precision
    if case.kept_fields - other.kept_fields:
        raise NotKeptError(
            "it keeps fields of points that output.field_steps leaves out: name them, too, or use another output or "
            "--overwrite"
        )
    if digits == ("double", "single"):
        raise NotKeptError(
            "it keeps fields by output.field_precision = double, this study has single: set it so, or use another "
            "output or --overwrite"
        )
    if other.kept_fields.intersection(range(len(case.path))) - case.kept_fields:
        return "output.field_steps: the earlier run did not keep the fields of these points"
    if digits == ("single", "double"):
        return "output.field_precision = double: the earlier run kept single precision"
    return ""


def _ranges_contain(case: Case, bins: Bins) -> bool:
    """Whether the ranges that an earlier study chose for its distributions contain all of the bins asked for."""
    asked = (bins.pressure_edges, bins.gap_edges)
    for chosen, edges in zip((case.output.pressure_range, case.output.gap_range), asked, strict=True):
        slack = 1e-9 * (edges[-1] - edges[0])
        if chosen is not None and not chosen[0] - slack <= edges[0] < edges[-1] <= chosen[1] + slack:
            return False
    return True
