"""The dataset of an inference: estimates, intervals, profiles, evidence, residuals and lines, by model."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from contact_study.inference.curves import MeasuredCurve
from contact_study.inference.fit import Fit
from contact_study.inference.parameters import MODULUS, OFFSETS, PARAMETERS, PHYSICAL, RADIUS, RANGE, WORK
from contact_study.inference.wording import notes_of
from contact_study.results.schema import CONVENTIONS
from contact_study.version import __version__

_LINE = 300  # states of a fitted line
_FLAGS = ("fixed", "not_identified", "bounded_above", "bounded_below", "bounded")
_WAYS = ("approach", "retraction")
Entry = tuple[tuple[str, ...], np.ndarray, dict[str, object]]


def dataset_of(fits: Mapping[str, Fit], curves: Sequence[MeasuredCurve]) -> xr.Dataset:
    """Collect the fits of all models.

    Parameters
    ----------
    fits : mapping of str to Fit
        By name of the model, with profiles.
    curves : sequence of MeasuredCurve
        Measured points.

    Returns
    -------
    xarray.Dataset
    """
    found: dict[str, Entry] = {}
    for name in PHYSICAL:
        if any(name in fit.problem.constants(fit.best) for fit in fits.values()):
            found |= _parameter(name, fits)
    found |= _offsets(fits, len(curves)) | _numbers(fits) | _correlation(fits) | _points(fits, curves)
    found |= _lines(fits, curves)
    labels = list(dict.fromkeys(label for fit in fits.values() for label in fit.problem.labels))
    dataset = xr.Dataset(
        found,
        coords={
            "model": ("model", list(fits), {"long_name": "model of the contact"}),
            "curve": ("curve", [curve.name for curve in curves], {"long_name": "measured curve"}),
            "way": ("way", list(_WAYS), {"long_name": "approach or retraction"}),
            "parameter": ("parameter", labels, {"long_name": "free parameter, with the number of its curve"}),
            "other_parameter": ("other_parameter", labels, {"long_name": "free parameter"}),
        },
        attrs={
            "Conventions": CONVENTIONS,
            "title": "constants of a contact inferred from measured curves",
            "source": f"bem-adhesion {__version__}",
            "confidence": "90 % intervals by profile likelihood",
        },
    )
    dataset.attrs["notes"] = "\n".join(notes_of(dataset))
    return dataset


def _about(units: str, long_name: str, **more: object) -> dict[str, object]:
    return {"units": units, "long_name": long_name, **more}


def _parameter(name: str, fits: Mapping[str, Fit]) -> dict[str, Entry]:
    """Estimate, interval, status and profile of one parameter."""
    _, units, words = PARAMETERS[name]
    longest = max([fit.profiles[name].coordinate.size for fit in fits.values() if name in fit.profiles], default=0)
    value, lower, upper = (np.full(len(fits), np.nan) for _ in range(3))
    status = np.zeros(len(fits), np.int8)
    along, rise = (np.full((len(fits), longest), np.nan) for _ in range(2))
    for at, fit in enumerate(fits.values()):
        value[at] = fit.problem.constants(fit.best).get(name, np.nan)
        if name in fit.profiles:
            profile = fit.profiles[name]
            free = fit.problem.free[fit.problem.labels.index(name)]
            ends = profile.interval
            lower[at], upper[at] = (free.value(end) if np.isfinite(end) else np.nan for end in ends)
            status[at] = 1 + int(np.isfinite(ends[1])) + 2 * int(np.isfinite(ends[0]))
            along[at, : profile.coordinate.size] = [free.value(u) for u in profile.coordinate]
            rise[at, : profile.rise.size] = profile.rise
    flags = {"flag_values": np.arange(len(_FLAGS), dtype=np.int8), "flag_meanings": " ".join(_FLAGS)}
    found: dict[str, Entry] = {
        name: (("model",), value, _about(units, words)),
        f"{name}_lower": (("model",), lower, _about(units, f"lower end of the 90 % interval of {name}; NaN: open")),
        f"{name}_upper": (("model",), upper, _about(units, f"upper end of the 90 % interval of {name}; NaN: open")),
        f"{name}_status": (("model",), status, {"long_name": f"whether the curves bound {name}", **flags}),
    }
    if longest:
        dims = ("model", f"{name}_step")
        meaning = f"rise of -2 ln likelihood along {name}, minimised over the other parameters"
        found[f"{name}_profile"] = dims, along, _about(units, f"values of {name} along its profile")
        found[f"{name}_profile_rise"] = dims, rise, _about("1", meaning)
    return found


def _offsets(fits: Mapping[str, Fit], curves: int) -> dict[str, Entry]:
    found: dict[str, Entry] = {}
    for row, name in enumerate(OFFSETS):
        value, error = (np.full((len(fits), curves), np.nan) for _ in range(2))
        for at, fit in enumerate(fits.values()):
            for number in range(curves):
                value[at, number] = fit.problem.offsets(fit.best, number)[row]
            for place, one in enumerate(fit.problem.free):
                if one.name == name and one.curve is not None:
                    error[at, one.curve] = one.unit * np.sqrt(fit.covariance[place, place])
        _, units, words = PARAMETERS[name]
        found[name] = ("model", "curve"), value, _about(units, words)
        found[f"{name}_error"] = ("model", "curve"), error, _about(units, f"standard error of {name}; NaN: fixed")
    return found


def _numbers(fits: Mapping[str, Fit]) -> dict[str, Entry]:
    """Evidence, goodness of fit and Tabor parameter."""
    tabor, low, high, length = (np.full(len(fits), np.nan) for _ in range(4))
    for at, fit in enumerate(fits.values()):
        constants = fit.problem.constants(fit.best)
        if WORK not in constants:
            continue
        length[at] = np.cbrt(constants[RADIUS] * (constants[WORK] / constants[MODULUS]) ** 2)
        if RANGE in constants:
            tabor[at] = length[at] / constants[RANGE]
        if RANGE in fit.profiles:
            profile = fit.profiles[RANGE]
            inside = [fit.problem.constants(u) for u in profile.others[profile.rise <= fit.threshold]]
            all_of = [np.cbrt(c[RADIUS] * (c[WORK] / c[MODULUS]) ** 2) / c[RANGE] for c in inside]
            low[at] = min(all_of) if np.isfinite(profile.interval[1]) else np.nan
            high[at] = max(all_of) if np.isfinite(profile.interval[0]) else np.nan
    bic = np.array([fit.bic for fit in fits.values()])
    weight = np.exp(-0.5 * (bic - bic.min()))
    reduced, threshold, count = (
        np.array([getattr(fit, of) for fit in fits.values()]) for of in ("reduced", "threshold", "data_count")
    )
    found = {
        "elastic_length": (length, "m", "length (R w²/E*²)^(1/3), Tabor parameter times range"),
        "tabor_parameter": (tabor, "1", "Tabor parameter by the range of adhesion"),
        "tabor_parameter_lower": (low, "1", "lower end of the 90 % interval of the Tabor parameter; NaN: open"),
        "tabor_parameter_upper": (high, "1", "upper end of the 90 % interval of the Tabor parameter; NaN: open"),
        "bic": (bic, "1", "Bayesian information criterion, up to a constant of the data"),
        "weight": (weight / weight.sum(), "1", "relative evidence of the model by the BIC"),
        "reduced_misfit": (reduced, "1", "sum of squares over degrees of freedom, with the errors of input"),
        "threshold": (threshold, "1", "rise of a profile at the ends of the 90 % interval"),
        "values": (count, "1", "number of independent measured values"),
    }
    return {name: (("model",), values, _about(units, words)) for name, (values, units, words) in found.items()}


def _correlation(fits: Mapping[str, Fit]) -> dict[str, Entry]:
    labels = list(dict.fromkeys(label for fit in fits.values() for label in fit.problem.labels))
    found = np.full((len(fits), len(labels), len(labels)), np.nan)
    for at, fit in enumerate(fits.values()):
        places = [labels.index(label) for label in fit.problem.labels]
        error = np.sqrt(np.diag(fit.covariance))
        found[at][np.ix_(places, places)] = fit.covariance / np.maximum(np.outer(error, error), 1e-300)
    words = _about("1", "correlation of the parameters (physical ones: of their logarithms)")
    return {"correlation": (("model", "parameter", "other_parameter"), found, words)}


def _points(fits: Mapping[str, Fit], curves: Sequence[MeasuredCurve]) -> dict[str, Entry]:
    """Fitted points as they were measured, and their residuals."""
    sizes = [curve.points.shape[1] for curve in curves]
    numbers = np.repeat(np.arange(len(curves)), sizes).astype(np.int32)
    columns = np.full((3, sum(sizes)), np.nan)
    residual = np.full((len(fits), sum(sizes)), np.nan)
    for number, curve in enumerate(curves):
        own = numbers == number
        for at, row in enumerate(curve.rows):
            columns[row, own] = curve.points[at] - (curve.compliance * curve.force if row == 0 else 0.0)
        for at, fit in enumerate(fits.values()):
            residual[at, own] = fit.problem.signed(fit.best, number)
    flags = {"flag_values": np.array([0, 1], np.int8), "flag_meanings": "loading unloading"}
    unloading = np.concatenate([curve.unloading for curve in curves]).astype(np.int8)
    words = "distance of a point from the fit in its errors, positive above the line"
    return {
        "displacement": (("point",), columns[0], _about("m", "measured displacement of the probe")),
        "total_force": (("point",), columns[1], _about("N", "measured force, compression positive")),
        "contact_radius": (("point",), columns[2], _about("m", "measured radius of the contact")),
        "branch": (("point",), unloading, {"long_name": "branch of the measurement", **flags}),
        "curve_number": (("point",), numbers, _about("1", "number of the point's curve, from 0 on")),
        "residual": (("model", "point"), residual, _about("1", words)),
    }


def _lines(fits: Mapping[str, Fit], curves: Sequence[MeasuredCurve]) -> dict[str, Entry]:
    """States of the fitted models, from loose to pressed, parted by NaN at a jump."""
    dims = ("model", "curve", "way", "state")
    found = np.full((3, len(fits), len(curves), 2, _LINE), np.nan)
    for at, fit in enumerate(fits.values()):
        for number, curve in enumerate(curves):
            for way, lines in enumerate(fit.problem.lines(fit.best, number)):
                gap = np.full((len(curve.rows), 1), np.nan)
                joined = np.concatenate([part for line in lines for part in (line, gap)][:-1], axis=1)
                shown = np.unique(np.linspace(0, joined.shape[1] - 1, _LINE).astype(int))
                shown = np.union1d(shown, np.flatnonzero(np.isnan(joined[0])))[-_LINE:]
                for place, row in enumerate(curve.rows):
                    values = joined[place] - (curve.compliance * joined[curve.rows.index(1)] if row == 0 else 0.0)
                    found[row, at, number, way, : shown.size] = values[shown]
    return {
        "fitted_displacement": (dims, found[0], _about("m", "displacement of the fitted model, as measured")),
        "fitted_force": (dims, found[1], _about("N", "force of the fitted model, as measured")),
        "fitted_contact_radius": (dims, found[2], _about("m", "contact radius of the fitted model")),
    }
