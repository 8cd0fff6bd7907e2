"""A dataset of many realisations of the surface, whose scatter is shown behind the models that are compared."""

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.report.models import is_simulated
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.files import open_groups
from contact_study.report.read.load_steps import SEED, with_average
from contact_study.report.read.studies import carried_study, check_studies
from contact_study.study.schema.dotted_keys import SECTIONS
from contact_study.study.schema.keys import keys_of

# Realisations differ in the seed, and what is kept of them changes no number that is shown.
_WITHOUT_SAY = (f"surface.{SEED}", *(f"output.{name}" for name in keys_of(SECTIONS["output"])))


@dataclass(frozen=True)
class Scatter:
    """One simulation over several realisations."""

    model: str  # name of its entry
    dataset: xr.Dataset  # its dataset without the fields
    path: Path  # its file
    notes: tuple[str, ...] = ()  # differences to the studies compared

    @property
    def surfaces(self) -> int:
        """How many realisations it has."""
        return self.dataset.sizes[SEED]


def read_scatter(path: Path, inputs: Inputs) -> Scatter:
    """Open a dataset of several realisations of the contact that is compared.

    Raises
    ------
    InputError
        If it is unreadable, of a theory, of one realisation or of another contact, or another key than the seed is
        averaged over.
    """
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
    first = next(iter(inputs.paths))
    paths, studies = {"compared": inputs.paths[first], model: path}, {"compared": inputs.studies[first], model: study}
    notes += check_studies(list(paths), paths, studies, _WITHOUT_SAY)
    return Scatter(model, with_average(dataset, SEED), path, tuple(notes))
