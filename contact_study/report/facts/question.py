"""The studies of the datasets, for the report's section on what was run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_study.report.models import TARGET, entry_of, spectrum_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.text.rendering import paragraphs
from contact_study.report.text.wording import (
    control_unit,
    coordinate_label,
    length,
    listed,
    listed_points,
    number,
    varied,
)
from contact_study.study.case import Case
from contact_study.study.schema.keys import keys_of


def study_paragraphs(inputs: Inputs) -> list[tuple[str, str]]:
    """Heading and text of each part of the question."""
    made = paragraphs("question.j2", facts=Question(inputs))
    return [(heading, text) for heading, _, text in (paragraph.partition(": ") for paragraph in made)]


def sample_notes(inputs: Inputs) -> list[str]:
    """Explain the statistics of the deviations: their surfaces, and the keys that means are over."""
    seeds = inputs.seeds
    if not seeds:
        return []
    ensembles = [name for name in inputs.models if not entry_of(name).simulation and _knows_the_target(inputs, name)]
    return paragraphs(
        "samples.j2",
        counts=sorted({len(own) for own in seeds.values()}),
        with_target=bool(ensembles),
        target=_slopes(inputs, ensembles),
        realised=_slopes(inputs, list(seeds)),
    )


def over(cases: Sequence[Case], show: Callable[[Case], str], last: str = "and") -> str:
    """One value of every case in words, different ones side by side."""
    return varied((show(case) for case in cases), last)


@dataclass(frozen=True)
class Question:
    """Facts of the studies that their template puts into words."""

    inputs: Inputs  # what was compared or reported on

    @property
    def cases(self) -> list[Case]:
        """Every case of some study."""
        return self.inputs.cases

    @property
    def entries(self) -> list[Any]:
        """Entry of every model."""
        return [entry_of(name) for name in self.inputs.models]

    @property
    def surfaces(self) -> list[str]:
        """Each kind of surface in its own words, with its realisations."""
        kinds = _grouped(self.cases, lambda case: case.surface.kind)
        return [own[0].surface.words.format_map(_Values(own, "surface")) + self._seeds(own) for own in kinds.values()]

    @property
    def solids(self) -> list[str]:
        """Each kind of elastic solid in its own words; empty for a half-space."""
        kinds = _grouped(self.cases, lambda case: case.elasticity.kind)
        return [own[0].elasticity.words.format_map(_Values(own, "elasticity")) for own in kinds.values()]

    @property
    def isotropic(self) -> bool:
        """Whether E* follows from E and ν in every case."""
        return all(case.solid.contact_modulus == case.material.contact_modulus for case in self.cases)

    @property
    def boundaries(self) -> list[str]:
        """Boundary conditions of the cases."""
        return sorted({case.elasticity.boundary for case in self.cases})

    def having(self, **wanted: bool) -> list[Case]:
        """The cases whose law has these properties."""
        return [case for case in self.cases if all(getattr(case.law, name) is it for name, it in wanted.items())]

    def of_law(self, law: type) -> list[Case]:
        """The cases with this law."""
        return [case for case in self.cases if isinstance(case.law, law)]

    def label(self, case: Case) -> str:
        """Label of the point of the sweep of a case."""
        units = {name: swept.units for study in self.inputs.studies.values() for name, swept in study.sweep.items()}
        shown = {name: value for name, value in case.coordinates.items() if name != self.inputs.average}
        return ", ".join(coordinate_label(name, value, units[name]) for name, value in shown.items())

    def labels(self, cases: Sequence[Case]) -> str:
        """Labels of the points of the sweep of some cases."""
        return listed_points(self.label(case) for case in cases)

    @property
    def paths(self) -> list[dict[str, Any]]:
        """Each loading path: its values in words, whether it unloads, and the points of the sweep that take it."""
        unit = control_unit(self.inputs.models, self.inputs.control)
        paths = _grouped(self.cases, lambda case: (case.loading.path, case.loading.unload))
        return [
            {
                "values": f"{', '.join(number(value / unit.size, 5) for value in path)} {unit.name}",
                "unload": unload,
                "where": self.labels(cases),
            }
            for (path, unload), cases in paths.items()
        ]

    @property
    def starts(self) -> list[str]:
        """Starting configurations of each simulation, those that start others first; empty if none has a predictor."""
        simulations = {name: entry_of(name) for name in self.inputs.simulations}
        # A dataset joined of parts names the predictor of each, a line each.
        lines = {name: str(self.inputs.models[name].attrs.get("predictor", "")).splitlines() for name in simulations}
        fields = {name: listed(line.partition(" ")[0] for line in own) if own else "" for name, own in lines.items()}
        if len(simulations) > 1 and not any(fields.values()):
            return []
        ordered = sorted(simulations, key=lambda name: bool(fields[name]))
        return [
            (entry_of(name).start_predicted if fields[name] else entry_of(name).start).format(predictor=fields[name])
            for name in ordered
        ]

    def _seeds(self, cases: Sequence[Case]) -> str:
        """The realisations of a kind of surface, and models that have only some of them."""
        seeds = [seed for seed in dict.fromkeys(case.surface.realisation for case in cases) if seed is not None]
        if not seeds:
            return ""
        words = f"; {len(seeds)} realisation{'s' if len(seeds) > 1 else ''} (seed {', '.join(map(str, seeds))})"
        partly = {name: own for name, own in self.inputs.seeds.items() if set(own) != set(seeds)}
        return words + "".join(
            f", {entry_of(n).words} on seed {', '.join(map(str, s))} only" for n, s in partly.items()
        )


def _grouped(cases: Sequence[Case], key: Callable[[Case], Any]) -> Mapping[Any, list[Case]]:
    groups: dict[Any, list[Case]] = {}
    for case in cases:
        groups.setdefault(key(case), []).append(case)
    return groups


class _Values(dict[str, "_Value"]):
    """Values of the keys of a section for the words of its kind."""

    def __init__(self, cases: Sequence[Case], section: str):
        self._cases = cases
        self._section = section

    def __missing__(self, name: str) -> "_Value":
        return _Value(self._cases, self._section, name)


@dataclass(frozen=True)
class _Value:
    """The values of a key over cases, joined by "and" or as the format says."""

    cases: Sequence[Case]
    section: str
    name: str

    def __format__(self, last: str) -> str:
        return over(self.cases, self._of, last or "and")

    def _of(self, case: Case) -> str:
        if self.name == "size":
            size = case.surface.stated_cell
            return f"{length(size[0])} × {length(size[1])}" if size else "its size from the file"
        section = getattr(case, self.section)
        value = getattr(section, self.name)
        if isinstance(value, float):
            in_metres = keys_of(type(section))[self.name].kind == "m"
            return length(value) if in_metres else f"{value:g}"
        return case.surface.phrases.get(value, str(value))


def _knows_the_target(inputs: Inputs, model: str) -> bool:
    own = spectrum_of(model)
    return any((own or case.spectra[0]) == TARGET for case in inputs.studies[entry_of(model).file].cases)


def _slopes(inputs: Inputs, models: Sequence[str]) -> list[float]:
    """Least and largest root-mean-square slope of the surfaces that some models know; empty where none is stored."""
    stored = [inputs.models[name]["rms_slope"].values.ravel() for name in models if "rms_slope" in inputs.models[name]]
    found = np.concatenate([np.empty(0), *stored])
    found = found[np.isfinite(found)]
    return list(dict.fromkeys((found.min(), found.max()))) if found.size else []
