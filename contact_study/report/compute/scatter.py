"""The scatter between realisations of a surface, for the figures along the path."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contact_study.report.compute.cases import SweepPoint, select, series, sweep_points
from contact_study.report.compute.curves import Curve
from contact_study.report.compute.plotted import PathCurves, path_curves
from contact_study.report.models import entry_of
from contact_study.report.read.scatter import Scatter


@dataclass(frozen=True)
class Strips:
    """What is drawn of the scatter between realisations.

    Attributes
    ----------
    model : str
        Name of the entry of the model that has it.
    surfaces : int
        How many realisations.
    curves : PathCurves
        Means over them, whose errors are standard deviations.
    """

    model: str
    surfaces: int
    curves: PathCurves

    @property
    def label(self) -> str:
        """In a legend."""
        return f"{entry_of(self.model).label}, {self.surfaces} surfaces"


def scatter_strips(models: Mapping[str, xr.Dataset], scatter: Scatter, control: str) -> Strips:
    """Means over the realisations, with their standard deviation in place of the error of the mean.

    Parameters
    ----------
    models : mapping
        Datasets that are compared: their points of the sweep are shown, in their colours.
    scatter : Scatter
        The realisations.
    control : str
        ``"pressure"`` or ``"gap"``.
    """
    colours = {point.label: number for number, point in enumerate(sweep_points(models))}
    own = {scatter.model: scatter.dataset}
    points = {point.label: point for point in sweep_points(own)}
    found = path_curves(own, control)

    def deviating(curves: list[Curve]) -> list[Curve]:
        return [
            replace(_deviating(curve, scatter.dataset, points[curve.label]), colour=colours[curve.label])
            for curve in curves
            if curve.label in colours
        ]

    curves = PathCurves(deviating(found.areas), deviating(found.gaps), deviating(found.linear_gaps))
    return Strips(scatter.model, scatter.surfaces, curves)


def _deviating(curve: Curve, dataset: xr.Dataset, point: SweepPoint) -> Curve:
    part = select(dataset, point)
    assert part is not None
    root = np.sqrt(series(part, "mean_pressure").samples)
    x, y = (None if error is None else error * root for error in (curve.x_error, curve.y_error))
    return replace(curve, x_error=x, y_error=y)
