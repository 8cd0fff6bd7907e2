"""Intervals of a study's answers from its draws, the shares of their variance, and what each key does.

Draws are cases of a run with a section ``[uncertainty]``. A second run at a few of them, by a simulation, corrects a
run at all of them by theory: the logarithm of the ratio of the two answers is expanded in the inputs, and the theory's
answers are multiplied by it.
"""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.numerics.expansion import NORMAL, UNIFORM, Expansion, Input, expansion
from contact_study.results.schema import CONVENTIONS
from contact_study.study.uncertainty import Uncertainty, uncertainty_of
from contact_study.version import __version__

ANSWERS = (
    "relative_contact_area",
    "mean_gap",
    "mean_pressure",
    "pull_off_pressure",
    "work_of_separation",
)
QUANTILES = (0.05, 0.5, 0.95)
BY_KEY = "_by_key"  # after the name of an answer: its derivatives by the keys, in SI
_LEAST = 8  # draws below which an interval is none
_PRESCRIBED = {"applied_pressure": "mean_pressure", "applied_gap": "mean_gap"}


@dataclass(frozen=True)
class Draws:
    """Draws of a dataset: their numbers and the shares (draws, keys) of the distributions below their values."""

    uncertainty: Uncertainty
    numbers: tuple[int, ...]
    shares: np.ndarray

    @property
    def inputs(self) -> tuple[Input, ...]:
        kinds = {"normal": NORMAL, "lognormal": NORMAL}
        every = self.uncertainty.distributions.values()
        return tuple(Input(kinds.get(one.kind, UNIFORM), len(one.values)) for one in every)


def draws_of(dataset: xr.Dataset) -> Draws:
    """The draws of a run's dataset; ValueError if it has none."""
    if "draw" not in dataset.dims:
        raise ValueError("the dataset has no draws: run a study with a section [uncertainty] and its key draws")
    declared = uncertainty_of(tomllib.loads(str(dataset.attrs["study_toml"])))
    assert declared is not None
    numbers = tuple(int(number) for number in dataset["draw"].values)
    return Draws(declared, numbers, declared.shares(numbers))


def uncertainty(dataset: xr.Dataset, anchors: xr.Dataset | None = None) -> xr.Dataset:
    """Turn the draws of a run into intervals and shares of variance.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a run of a study with ``[uncertainty]``, on the dimension ``draw``.
    anchors : xarray.Dataset, optional
        Dataset of a simulation of the same study at some of these draws, or of its central case with derivatives, by
        :func:`bem_adhesion.study.sensitivity.sensitivity`. Its answers correct those of ``dataset``.

    Returns
    -------
    xarray.Dataset
        Each answer on ``quantile`` (5, 50, 95 %). Its ``..._share`` is the part of the variance by each ``parameter``,
        the first-order Sobol index; ``..._joint`` is that by pairs, ``..._unexplained`` the rest. Its ``..._swing`` has
        one parameter at 5, 50 and 95 % and the others at their medians. With anchors ``..._correction_error`` is the
        relative error of the corrected answer at an anchor that is left out.

    Raises
    ------
    InputError
        If a dataset has no draws or too few, or the two are of different studies.

    Examples
    --------
    >>> import contact_study
    >>> theory = contact_study.run("study.toml", "theory")  # doctest: +SKIP
    >>> contact_study.uncertainty(theory).relative_contact_area  # doctest: +SKIP
    """
    try:
        draws = draws_of(dataset)
        own = None if anchors is None else draws_of(anchors)
    except ValueError as error:
        raise InputError(str(error)) from None
    if sum(number > 0 for number in draws.numbers) < _LEAST:
        raise InputError(f"{len(draws.numbers)} draws give no interval; at least {_LEAST} beside the central case do")
    if own is not None:
        assert anchors is not None
        _check_alike(dataset, anchors, draws, own)
    found: dict[str, xr.Variable] = {}
    prescribed = {name for load, name in _PRESCRIBED.items() if load in dataset}
    for name in ANSWERS:
        if name in prescribed or name not in {*dataset, *(anchors if anchors is not None else ())}:
            continue
        answer = corrected = _answer(dataset, name) if name in dataset else None
        errors = None
        if anchors is not None and own is not None and name in anchors:
            if name + BY_KEY in anchors:
                corrected = _expanded(answer, anchors[name], anchors[name + BY_KEY], draws)
            else:
                corrected, errors = _corrected(answer, _answer(anchors, name), draws, own)
        if corrected is not None:
            found |= _summary(name, corrected, draws)
        if errors is not None:
            words = f"relative error of {name} at an anchor left out of the correction"
            found[f"{name}_correction_error"] = xr.Variable(
                errors.dims, errors.values, {"units": "1", "long_name": words}
            )
    coords = {name: dataset[name] for name in dataset.coords if "draw" not in dataset[name].dims}
    made = xr.Dataset(found)
    used = {name: one for name, one in coords.items() if set(one.dims) <= set(made.dims)}
    parameter = ("parameter", list(draws.uncertainty.keys), {"long_name": "uncertain key of the study"})
    quantile = ("quantile", list(QUANTILES), {"units": "1", "long_name": "share of the draws below the value"})
    ends = ("end", ["low", "middle", "high"], {"long_name": "5, 50 or 95 % of a parameter, or the ends of its choices"})
    attributes = {
        "Conventions": CONVENTIONS,
        "title": "intervals and shares of variance from the draws of a study",
        "source": f"bem-adhesion {__version__}",
        "draws": len(draws.numbers),
        "anchors": 0 if own is None else len(own.numbers),
        **{name: dataset.attrs[name] for name in ("model", "study_toml") if name in dataset.attrs},
    }
    return made.assign_coords({**used, "parameter": parameter, "quantile": quantile, "end": ends}).assign_attrs(
        attributes
    )


def _check_alike(dataset: xr.Dataset, anchors: xr.Dataset, draws: Draws, own: Draws) -> None:
    if own.uncertainty != draws.uncertainty:
        raise InputError("the anchors' section [uncertainty] is another; run both models on one study")
    lacking = [number for number in own.numbers if number not in draws.numbers]
    if lacking:
        raise InputError(
            f"the anchors have draw {lacking[0]}, which the dataset lacks; give more uncertainty.draws there"
        )
    loads = [name for name in ("applied_pressure", "applied_gap", "applied_approach") if name in anchors]
    for name in loads:
        if name not in dataset or not np.array_equal(dataset[name].values, anchors[name].values):
            raise InputError(f"the anchors' {name} is another; run both models on one study")


def _answer(dataset: xr.Dataset, name: str) -> xr.DataArray:
    """An answer by draw, first; NaN where a state did not converge."""
    found = dataset[name].astype(float)
    if "draw" not in found.dims:  # the same at all draws
        found = found.expand_dims(draw=dataset["draw"])
    if "step" in found.dims and "converged" in dataset:
        found = found.where(dataset["converged"] == 1)
    return found.where(np.isfinite(found)).transpose("draw", ...)


def _corrected(
    answer: xr.DataArray | None, truth: xr.DataArray, draws: Draws, own: Draws
) -> tuple[xr.DataArray | None, xr.DataArray | None]:
    """The answer corrected by the anchors', and the error at an anchor that is left out; None if they say nothing."""
    if answer is None:
        answer = xr.zeros_like(truth.isel(draw=0, drop=True)).expand_dims(draw=list(draws.numbers))
    if not set(truth.dims) <= set(answer.dims):
        return answer, None
    truth = xr.broadcast(truth, answer.isel(draw=0, drop=True))[0].transpose(*answer.dims)
    places = [draws.numbers.index(number) for number in own.numbers]
    values, wanted = answer.values.reshape(len(answer), -1).copy(), truth.values.reshape(len(truth), -1)
    found, errors = np.full_like(values, np.nan), np.full(values.shape[1], np.nan)
    for column in range(values.shape[1]):
        there = np.isfinite(wanted[:, column]) & np.isfinite(values[places, column])
        silent = not np.nan_to_num(values[:, column]).any()  # a theory of no answer, or one that is zero at all draws
        if silent:
            values[:, column] = np.sign(np.nansum(wanted[:, column]))
            there = np.isfinite(wanted[:, column])
        true, given = wanted[there, column], values[places, column][there]
        if not there.any() or (silent and len(true) < 2 * _coefficients(draws.inputs)):
            continue
        # The ratio of answers varies little with the inputs; only their difference exists where signs change.
        by_ratio = bool((true * given > 0).all())
        change = np.log(true / given) if by_ratio else true - given
        fit, errors[column] = _change(draws.inputs, own.shares[there], change)
        change = fit(draws.shares)
        found[:, column] = values[:, column] * np.exp(change) if by_ratio else values[:, column] + change
        if not by_ratio:
            errors[column] /= np.abs(true).max() or np.nan
    found = found.reshape(answer.shape)
    return answer.copy(data=found), answer.isel(draw=0, drop=True).copy(data=errors.reshape(answer.shape[1:]))


def _expanded(
    answer: xr.DataArray | None, truth: xr.DataArray, by_key: xr.DataArray, draws: Draws
) -> xr.DataArray | None:
    """The answer with value and slopes of the central simulation in place of its own; without one the simulation's.

    Logarithms are expanded in logarithms, but for an answer or a key that is not positive. The answer's own slopes are
    those of a fit of second order, if there are twice as many draws as coefficients, else of a linear one.
    """
    keys = np.array([[*values.values()] for values in draws.uncertainty.values(draws.numbers)], float)
    middle = np.array([*draws.uncertainty.values([0])[0].values()], float)
    logarithmic = (keys > 0).all(0) & (middle > 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        changes = np.where(logarithmic, middle * np.log(keys / middle), keys - middle)
    first = truth.isel(draw=0)
    template = first.expand_dims(draw=list(draws.numbers)) if answer is None else answer
    if not set(first.dims) <= set(template.dims):
        return answer
    value, *slopes = (
        xr.broadcast(one, template.isel(draw=0, drop=True))[0].transpose(*template.dims[1:]).values.ravel()
        for one in (first, *by_key)
    )
    found = np.full((len(template), value.size), np.nan)
    own = None if answer is None else answer.values.reshape(len(answer), -1)
    scaled = changes / (np.abs(changes).max(0) + (changes == 0).all(0))
    one, other = np.triu_indices(scaled.shape[1])
    linear = np.hstack([np.ones((len(scaled), 1)), scaled])
    every = np.hstack([linear, scaled[:, one] * scaled[:, other]])
    for column, (center, *by) in enumerate(zip(value, *slopes, strict=True)):
        there = np.ones(len(changes), bool) if own is None else np.isfinite(own[:, column])
        positive = center > 0 and (own is None or bool((own[there, column] > 0).all()))
        left = np.zeros(len(changes))
        if own is not None and there.sum() > linear.shape[1]:
            theirs = np.log(own[there, column]) if positive else own[there, column]
            columns = every if there.sum() >= 2 * every.shape[1] else linear
            fit = np.linalg.lstsq(columns[there], theirs, rcond=None)[0]
            left[there] = theirs - linear[there] @ fit[: linear.shape[1]]
        line = changes @ np.array(by)
        grown = center * np.exp(line / center + left) if positive else center + line + left
        found[there, column] = grown[there]
    return template.copy(data=found.reshape(template.shape))


def _coefficients(inputs: Sequence[Input]) -> int:
    """Number of coefficients of a linear expansion."""
    return 1 + sum(one.choices - 1 if one.choices else 1 for one in inputs)


def _change(inputs: Sequence[Input], shares: np.ndarray, change: np.ndarray) -> tuple[Any, float]:
    """Expand a correction, linearly if the anchors determine that, else as a constant; with its error."""

    def fit(shares: np.ndarray, change: np.ndarray) -> Any:
        try:
            return expansion(inputs, shares, change, 1).at
        except ValueError:
            mean = float(change.mean())
            return lambda at: np.full(len(at), mean)

    left = [
        float(fit(shares[kept], change[kept])(shares[~kept])[0] - change[~kept][0])
        for kept in ~np.eye(len(change), dtype=bool)
        if kept.any()
    ]
    return fit(shares, change), float(np.sqrt(np.mean(np.square(left)))) if left else np.nan


def _summary(name: str, answer: xr.DataArray, draws: Draws) -> dict[str, xr.Variable]:
    """Quantiles, shares and swings of an answer on its other dimensions."""
    others, shape = answer.dims[1:], answer.shape[1:]
    values = answer.values.reshape(len(answer), -1)
    drawn = np.array(draws.numbers) > 0  # the central case belongs to no distribution
    keys, columns = len(draws.inputs), values.shape[1]
    quantiles, shares = np.full((len(QUANTILES), columns), np.nan), np.full((keys, columns), np.nan)
    swing, joint, left = np.full((keys, 3, columns), np.nan), np.full(columns, np.nan), np.full(columns, np.nan)
    used = np.isfinite(values[drawn]).sum(0)
    for column in np.flatnonzero(used >= _LEAST):
        there = drawn & np.isfinite(values[:, column])
        quantiles[:, column] = np.quantile(values[there, column], QUANTILES)
        try:
            fit = expansion(draws.inputs, draws.shares[there], values[there, column])
        except ValueError:
            continue
        if not draws.uncertainty.correlation:
            shares[:, column], joint[column], left[column] = fit.shares()
        swing[..., column] = _swing(fit)
    units = answer.attrs.get("units", "1")
    words = answer.attrs.get("long_name", name.replace("_", " "))

    def variable(dims: tuple[str, ...], data: np.ndarray, units: str, words: str) -> xr.Variable:
        return xr.Variable(
            (*dims, *others), data.reshape((*data.shape[:-1], *shape)), {"units": units, "long_name": words}
        )

    return {
        name: variable(("quantile",), quantiles, units, words),
        f"{name}_share": variable(("parameter",), shares, "1", f"share of the variance of {name} by one parameter"),
        f"{name}_joint": variable((), joint, "1", f"share of the variance of {name} by pairs of parameters"),
        f"{name}_unexplained": variable((), left, "1", f"share of the variance of {name} that the expansion leaves"),
        f"{name}_swing": variable(("parameter", "end"), swing, units, f"{name} at the ends of one parameter"),
        f"{name}_draws": variable((), used, "1", f"draws with a value of {name}"),
    }


def _swing(fit: Expansion) -> np.ndarray:
    """Answers with one input at 5, 50, 95 % and the others at their medians, (inputs, 3); of choices the extremes."""
    found = np.empty((len(fit.inputs), 3))
    for number, one in enumerate(fit.inputs):
        along = (np.arange(one.choices) + 0.5) / one.choices if one.choices else np.array(QUANTILES)
        points = np.full((len(along), len(fit.inputs)), 0.5)
        points[:, number] = along
        values = fit.at(points)
        found[number] = (values.min(), values.mean(), values.max()) if one.choices else values
    return found
