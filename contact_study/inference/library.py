"""Inference from Python: measured curves in, a dataset of estimates with intervals out."""

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.inference.by_loops import fit_by_loops
from contact_study.inference.curves import MeasuredCurve, check_alike, measured_curve
from contact_study.inference.dataset import dataset_of
from contact_study.inference.fit import Fit, fit, profile
from contact_study.inference.parameters import PHYSICAL, Prior, prescribed
from contact_study.inference.sampling import samples as draw
from contact_study.inference.simulated import SimulatedLoops
from contact_study.inference.spheres import MODELS
from contact_study.inference.starts import starts
from contact_study.inputs.errors import InputError
from contact_study.physics.force_curves.curve import read_force_curve
from contact_study.study.schema.keys import suggestion

THEORIES = ("jkr", "dmt", "maugis")  # compared by default
SIMULATION = "simulation"


def infer(
    curves: xr.Dataset | str | Path | Sequence[xr.Dataset | str | Path],
    models: Sequence[str] | None = None,
    *,
    study: Mapping[str, Any] | str | Path | None = None,
    fixed: Mapping[str, Any] | None = None,
    prior: Mapping[str, Any] | None = None,
    noise: Mapping[str, Any] | None = None,
    spring_constant: float | str | None = None,
    reading: Mapping[str, Any] | None = None,
    loops: str | Path | None = None,
    workers: int = 1,
    samples: int = 0,
) -> xr.Dataset:
    """Infer work of adhesion, modulus, radius and range from measured force curves or JKR tests.

    Parameters
    ----------
    curves : xarray.Dataset, path-like or a sequence of them
        Curves of :func:`contact_study.read_force_curve`, or their files. All share the parameters of the contact; each
        has zeros of displacement and force of its own.
    models : sequence of str, optional
        ``"hertz"``, ``"jkr"``, ``"dmt"``, ``"maugis"``, ``"simulation"``; default: the last of a study, else the three
        before it.
    study : mapping or path-like, optional
        Study of a smooth or rough probe for ``"simulation"``: form, roughness, solid and law with its range. Work of
        adhesion and modulus are inferred; loops at a few ratios of them are simulated, up to the largest force.
    fixed : mapping, optional
        Known values, such as ``{"radius": "10 um"}``. Names: ``work_of_adhesion``, ``contact_modulus``, ``radius``,
        ``range``, ``force_scale`` (fixed at 1 by default), ``displacement_zero``, ``force_zero``.
    prior : mapping, optional
        Values known with a standard error, ``{"modulus": "2 +- 0.2 MPa"}``.
    noise : mapping, optional
        Standard errors of ``force``, ``displacement`` and ``contact_radius``. Default: columns of uncertainty in the
        file, or estimates from the baseline, scaled to the residuals.
    spring_constant : float or str, optional
        Stiffness of the cantilever (N/m). Errors then follow piezo and deflection, and only states that the spring
        holds are fitted. Default: the one that the curve was read with.
    reading : mapping, optional
        Options of :func:`contact_study.read_force_curve` for files.
    loops : path-like, optional
        Folder of the loops, which later calls use again. Default: the study's name with ``.loops``, or none.
    workers : int, optional
        Processes for the loops; with several call this below ``if __name__ == "__main__":``.
    samples : int, optional
        Number of samples of each model's posterior (extra ``sampler``): ``sample`` on ``parameter``, SI values.

    Returns
    -------
    xarray.Dataset
        On ``model``: each parameter with ``..._lower`` and ``..._upper``, its 90 % interval by profile likelihood, the
        profiles, correlations, Tabor parameter, BIC, residuals and fitted lines; in words the attribute ``notes``.

    Raises
    ------
    InputError
        If a curve shows no contact, drifts, has too few points or missing numbers, or a parameter is not determined.

    Examples
    --------
    >>> found = contact_study.infer("curve.csv", fixed={"radius": "5 um"})  # doctest: +SKIP
    >>> found.work_of_adhesion.sel(model="jkr").item()  # doctest: +SKIP
    """
    chosen = _models(models, study is not None)
    measured = _measured(curves, noise or {}, spring_constant, reading or {})
    known = prescribed(fixed or {}, prior or {})
    found: dict[str, Fit] = {}
    notes: list[str] = []
    for name in chosen:
        if name == SIMULATION and study is not None:
            found[name], notes = _simulated(study, loops, workers, measured, known)
            continue
        problem, first = starts(MODELS[name], measured, known, [*found.values()])
        found[name] = fit(problem, first)
        for label in reversed(PHYSICAL):  # the range first: the valley along it is the most bent
            if label in problem.labels:
                found[name].profiles[label] = profile(found[name], label)
    dataset = dataset_of(found, measured)
    if samples:
        dataset["sample"] = _samples(found, samples, [str(label) for label in dataset["parameter"].values])
    dataset.attrs["notes"] = "\n".join([dataset.attrs["notes"], *notes])
    return dataset


def _samples(found: Mapping[str, Fit], count: int, labels: Sequence[str]) -> xr.Variable:
    """Samples of the posterior of each model, NaN for parameters that it does not have."""
    chains = [draw(one, count) for one in found.values()]
    values = np.full((len(found), max(map(len, chains)), len(labels)), np.nan)
    for at, (one, chain) in enumerate(zip(found.values(), chains, strict=True)):
        for place, label in enumerate(one.problem.labels):
            values[at, : len(chain), labels.index(label)] = chain[:, place]
    words = "sample of the posterior, in the SI unit of its parameter"
    return xr.Variable(("model", "sample_number", "parameter"), values, {"long_name": words})


def _models(models: Sequence[str] | None, with_study: bool) -> list[str]:
    chosen = list(dict.fromkeys(models or ([SIMULATION] if with_study else THEORIES)))
    there = [*MODELS, SIMULATION]
    for name in chosen:
        if name not in there:
            raise InputError(f"model {name}: is unknown{suggestion(name, there)}; there is {', '.join(there)}")
    if (SIMULATION in chosen) != with_study:
        raise InputError("study: belongs to the model simulation; give both, or neither")
    return chosen


def _simulated(
    study: Any, loops: str | Path | None, workers: int, measured: Sequence[MeasuredCurve], known: Mapping[str, Prior]
) -> tuple[Fit, list[str]]:
    """Fit by simulated loops, which are kept in a folder."""
    if loops is None and isinstance(study, str | Path):
        loops = Path(study).with_suffix(".loops").name
    with tempfile.TemporaryDirectory(prefix="contact_study") as folder:
        return fit_by_loops(SimulatedLoops(study, folder if loops is None else loops, workers), measured, known)


def _measured(
    curves: Any, noise: Mapping[str, Any], spring_constant: float | str | None, reading: Mapping[str, Any]
) -> list[MeasuredCurve]:
    given = [curves] if isinstance(curves, xr.Dataset | str | Path) else list(curves)
    if not given:
        raise InputError("curves: there is none; give a file or a dataset of read_force_curve")
    options = dict(reading) if spring_constant is None else {"spring_constant": spring_constant, **reading}
    read = [one if isinstance(one, xr.Dataset) else read_force_curve(one, **options) for one in given]
    found = [measured_curve(one, noise, spring_constant) for one in read]
    check_alike(found)
    return found
