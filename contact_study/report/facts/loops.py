"""Pull-off, jump-in and dissipated energy along the paths of the models."""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.plots.curves import dissipated_energy
from contact_study.plots.selection import UNLOADING
from contact_study.report.align.cases import constant, first_constant, select, sweep_points
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.load_steps import samples_in
from contact_study.results.schema import RESOLUTION_ERROR
from contact_study.results.state import usable

_NOISE = 1e-6  # of the work of adhesion: an energy that is the solver's tolerance


@dataclass(frozen=True)
class Loop:
    """Events of adhesion along the path of one model at one point of the sweep; means over samples, NaN for none.

    Attributes
    ----------
    model, at : str
        Name of the model's entry, label of the point of the sweep.
    pull_off, below : float
        Lowest mean pressure in contact and the pressure that the contact no longer carried (Pa).
    force : float
        Pull-off force on the cell (N).
    lowest : float
        Lowest mean pressure of the path in contact (Pa), below which a pull-off that was not reached lies.
    jump_in : float
        Mean pressure before the first jump into contact (Pa).
    dissipated : float
        Energy between loading and unloading (J/m²).
    separation : float
        Work of separation (J/m²).
    """

    model: str
    at: str
    pull_off: float
    below: float
    force: float
    lowest: float
    jump_in: float
    dissipated: float
    separation: float

    @property
    def reached(self) -> bool:
        """Whether the path passes the pull-off."""
        return bool(np.isfinite(self.pull_off))


def loops(inputs: Inputs) -> list[Loop]:
    """Loops of simulations that unload or pull where the law attracts, and pull-off of the theories beside them."""
    found = []
    for point in sweep_points(inputs.models):
        if not any(case.law.attracts for case in inputs.cases_at(point.selection)):
            continue
        for model, dataset in inputs.models.items():
            part = select(dataset, point)
            if part is None:
                continue
            pressure = part["mean_pressure"].where(usable(part))
            pulled = bool((part["branch"] == UNLOADING).any() or (pressure < 0).any())
            if "pull_off_pressure" not in part and not (pulled and entry_of(model).simulation):
                continue
            pull_off, error = (constant(part, f"pull_off_pressure{name}") for name in ("", RESOLUTION_ERROR))
            sizes = [first_constant(inputs.models, point, f"surface_size_{axis}") for axis in ("y", "x")]
            found.append(
                Loop(
                    model,
                    point.label,
                    pull_off,
                    pull_off - error,
                    pull_off * sizes[0] * sizes[1],
                    float(pressure.min()),
                    constant(part, "jump_in_pressure"),
                    _dissipated(part, _NOISE * first_constant(inputs.models, point, "work_of_adhesion")),
                    constant(part, "work_of_separation"),
                )
            )
    return found


def cycles(inputs: Inputs) -> dict[str, xr.Dataset]:
    """The cycles of the first simulation that has some, by point of the sweep, the strongest adhesion last."""
    for model in inputs.simulations:
        found = {}
        for point in sweep_points(inputs.models):
            part = select(inputs.models[model], point)
            part = None if part is None else part.isel(dict.fromkeys(samples_in(part), 0))
            if part is not None and np.isfinite(_dissipated(part)):
                found[point.label] = part
        if found:
            return found
    return {}


def _dissipated(part: xr.Dataset, noise: float = 0.0) -> float:
    """Energy of the cycle, of the first sample, zero below the noise; NaN where the path has none."""
    try:
        found = dissipated_energy(part.isel(dict.fromkeys(samples_in(part), 0)))
    except ValueError:
        return np.nan
    return found if abs(found) > noise else 0.0
