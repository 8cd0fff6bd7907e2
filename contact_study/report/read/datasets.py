"""Datasets of one contact: their studies held against one another, their models side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.physics.laws import TractionLaw
from contact_study.report.models import entry_of, file_kinds, in_order, is_simulated, kind_of, of_file, spectrum_of
from contact_study.report.read.files import branches_in, models_in, open_groups, unknown_theories
from contact_study.report.read.load_steps import SEED, swept_dims, with_average
from contact_study.report.read.studies import carried_study, check_height_maps, check_studies
from contact_study.study.case import Case
from contact_study.study.schema.dotted_keys import SECTIONS, same
from contact_study.study.schema.keys import keys_of
from contact_study.study.study import Study

# Realisations differ in the seed, and what is kept of them changes no number that is shown.
_WITHOUT_SAY = (f"surface.{SEED}", *(f"output.{name}" for name in keys_of(SECTIONS["output"])))
# Attributes by which two datasets of one model may differ; what else they hold follows from these.
_OF_A_RUN = ("study_toml", "predictor", "height_maps", "version", "git_commit")


@dataclass(frozen=True)
class Inputs:
    """The datasets of a comparison."""

    paths: dict[str, Path]  # by name of the file: the kind of dataset, and a suffix where there are several of one kind
    models: dict[str, xr.Dataset]  # each model shown, by the name of its entry, in the order of the entries
    branches: dict[str, dict[str, xr.Dataset]]  # metastable ones that enclose a theory: ``loading`` and ``unloading``
    studies: dict[str, Study]  # of each file
    notes: tuple[str, ...] = ()  # differences between the studies
    groups: dict[str, dict[str, xr.Dataset]] = field(default_factory=dict)  # of each file, "" for the root
    average: str = SEED  # the swept key over which a reader sees means

    @property
    def study(self) -> Study:
        """The study of the first model, in the order of trust."""
        return self._ordered[0]

    @property
    def _ordered(self) -> list[Study]:
        kinds = file_kinds()
        return [self.studies[name] for name in sorted(self.studies, key=lambda name: kinds.index(kind_of(name)))]

    @cached_property
    def with_first_spectra(self) -> "Inputs":
        """The same with each theory fed with the first spectrum of its study alone."""
        models = {name: dataset for name, dataset in self.models.items() if not spectrum_of(name)}
        branches = {name: found for name, found in self.branches.items() if not spectrum_of(name)}
        return replace(self, models=models, branches=branches)

    @property
    def simulations(self) -> list[str]:
        """The models that are of one surface, point by point."""
        return [name for name in self.models if entry_of(name).simulation]

    @cached_property
    def cases(self) -> list[Case]:
        """Every case of some study, once; a theory without a seed has the cases of the simulations."""
        found = list(self.study.cases)
        for study in self._ordered[1:]:
            found += [case for case in study.cases if not any(is_at(known, case.coordinates) for known in found)]
        return found

    def cases_at(self, coordinates: Mapping[str, Any]) -> list[Case]:
        """The cases at a point of the sweep: one, or one for each seed."""
        return [case for case in self.cases if is_at(case, coordinates)]

    @property
    def samples(self) -> int:
        """The largest number of values that a model has of what is averaged over."""
        return max(dataset.sizes.get(self.average, 1) for dataset in self.models.values())

    @property
    def laws(self) -> list[type[TractionLaw]]:
        """Every traction-separation law of the cases."""
        return list(dict.fromkeys(type(case.law) for case in self.cases))

    @property
    def control(self) -> str:
        """The prescribed quantity: "pressure" or "gap"."""
        return self.study.cases[0].loading.control


def is_at(case: Case, coordinates: Mapping[str, Any]) -> bool:
    """Whether a case has these swept values; keys that it does not sweep do not count."""
    return all(same(case.coordinates.get(name, value), value) for name, value in coordinates.items())


def read_inputs(paths: Sequence[Path], average: str | None = None) -> Inputs:
    """Open datasets of one contact, in any order."""
    opened = {path: open_groups(path) for path in paths}
    if len(opened) < len(paths):
        raise InputError(f"{next(path for path in paths if list(paths).count(path) > 1)} is given twice")
    kinds = {path: str(groups[""].attrs["model"]) for path, groups in opened.items()}
    ends = tails(kinds)
    names = {of_file(kind, ends[path]): path for path, kind in kinds.items()}
    files = {name: names[name] for name in sorted(names, key=lambda name: file_kinds().index(kind_of(name)))}
    contents = {name: opened[path] for name, path in files.items()}
    _check_told_apart(files, contents)
    swept = dict.fromkeys(dim for groups in contents.values() for dim in swept_dims(groups[""]))
    if average is not None and average not in swept:
        raise InputError(f"--average {average}: no dataset sweeps it; swept: {', '.join(swept) or 'nothing'}")
    average = average or SEED
    studies: dict[str, Study] = {}
    notes: list[str] = []
    for name, path in files.items():
        studies[name], joined = carried_study(path, contents[name][""], average)
        unknown = unknown_theories(contents[name][""])
        notes += [*joined, *(f"{path}: holds the theory {label}, which is not shown" for label in unknown)]
    notes += check_studies(list(files), files, studies)
    check_height_maps(files, {name: groups[""].attrs for name, groups in contents.items()})
    contents = {
        name: {group: with_average(dataset, average) for group, dataset in groups.items()}
        for name, groups in _one_spelling(contents).items()
    }
    found: dict[str, xr.Dataset] = {}
    branches: dict[str, dict[str, xr.Dataset]] = {}
    for name, groups in contents.items():
        found |= models_in(groups[""], ends[files[name]])
        branches |= branches_in(groups, ends[files[name]])
    if not found:
        raise InputError(f"{', '.join(map(str, paths))}: no model there is one that is shown")
    models = {name: found[name] for name in in_order(found)}
    return Inputs(files, models, branches, studies, tuple(notes), contents, average)


def tails(kinds: Mapping[Path, str]) -> dict[Path, str]:
    """Shortest end of each path, without suffix, that distinguishes files of one kind."""
    ends = {}
    for path, kind in kinds.items():
        others = [other for other in kinds if kinds[other] == kind and other != path]
        parts = path.resolve().with_suffix("").parts
        count = 1
        while any(other.resolve().with_suffix("").parts[-count:] == parts[-count:] for other in others):
            count += 1
            if count > len(parts):
                break
        # A slash would part groups of the comparison's dataset.
        ends[path] = "_".join(parts[-count:]) if others else ""
    return ends


def _check_told_apart(files: Mapping[str, Path], contents: Mapping[str, Mapping[str, xr.Dataset]]) -> None:
    """Refuse two files of one run: what was asked, from what, by which version."""
    first: dict[tuple[str, ...], str] = {}
    for name, groups in contents.items():
        attrs = groups[""].attrs
        run = tuple(str(attrs.get(key, "")) for key in ("model", *_OF_A_RUN))
        other = first.setdefault(run, name)
        if other != name:
            raise InputError(
                f"{files[other]} and {files[name]} are both of the {kind_of(name)} model and of one study and version: "
                "they cannot be distinguished; give one of them"
            )


def _one_spelling(contents: Mapping[str, dict[str, xr.Dataset]]) -> dict[str, dict[str, xr.Dataset]]:
    """The groups with the swept values of the first file that has them where they differ by roundings."""
    known: dict[str, list[Any]] = {}
    spelt: dict[str, dict[str, xr.Dataset]] = {}
    for kind, groups in contents.items():
        spelt[kind] = {}
        for name, dataset in groups.items():
            for dim in swept_dims(dataset):
                values = known.setdefault(dim, [])
                own = [next((value for value in values if same(value, given)), given) for given in dataset[dim].values]
                values += [value for value in own if value not in values]
                dataset = dataset.assign_coords({dim: (dim, own, dataset[dim].attrs)})
            spelt[kind][name] = dataset
    return spelt


@dataclass(frozen=True)
class Scatter:
    """One simulation over several realisations."""

    model: str  # name of its entry
    dataset: xr.Dataset  # its dataset without the fields
    notes: tuple[str, ...] = ()  # differences to the studies compared

    @property
    def surfaces(self) -> int:
        """How many realisations it has."""
        return self.dataset.sizes[SEED]


def read_scatter(path: Path, inputs: Inputs) -> Scatter:
    """Open a dataset of several realisations of the contact that is compared, whose scatter is shown behind it."""
    where = f"--scatter {path}"
    if inputs.average != SEED:
        raise InputError(f"{where}: is over seeds and does not go with --average {inputs.average}; leave one out")
    dataset = open_groups(path)[""]
    model = str(dataset.attrs["model"])
    if not is_simulated(model):
        raise InputError(f"{where}: a theory has no single surface; give a dataset of a simulation")
    if dataset.sizes.get(SEED, 1) < 2:
        raise InputError(f'{where}: holds one surface; sweep the seed, [sweep] "surface.seed" = [1, 2, 3]')
    study, notes = carried_study(path, dataset)
    first, *_ = inputs.paths
    paths, studies = {"compared": inputs.paths[first], model: path}, {"compared": inputs.studies[first], model: study}
    notes += check_studies(list(paths), paths, studies, _WITHOUT_SAY)
    return Scatter(model, with_average(dataset, SEED), tuple(notes))
