"""Measured curves as an inference uses them: checked, thinned, with the errors of their axes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import force, length, quantity

if TYPE_CHECKING:
    import xarray as xr

AXES = ("displacement", "total_force", "contact_radius")
NOISE = {"displacement": "m", "force": "N", "contact_radius": "m"}  # SI unit by the word of the option
_FEWEST, _MOST = 8, 1000  # points of a curve; of more, neighbours are averaged
_REST, _OF_REST = 0.2, 10  # part of the approach from its start that is the baseline, and its fewest points
_CONTACT, _FREE = 5.0, 3.0  # deviations of the baseline: beyond them is contact, within them none
_DRIFT = 0.5  # of the largest force: largest drift of a baseline over the whole curve
_IN_FLIGHT = 4  # most points between the two states of a jump
_FLOOR = 0.02  # of the median step: least error of a displacement that looks exact
_OPTICAL, _BALANCE = 1e-2, 1e-3  # relative errors of a contact radius and of its force, up to a common factor


@dataclass(frozen=True)
class MeasuredCurve:
    """Points of one curve.

    Attributes
    ----------
    name : str
        Its title.
    points : numpy.ndarray
        Shape (axes, points): displacement of the machine (m), force (N) and contact radius (m), as far as measured.
    rows : tuple of int
        Which of the three they are.
    errors : numpy.ndarray
        Standard error of each axis, shape (axes,).
    known : bool
        Whether these are known; otherwise up to a common factor.
    unloading : numpy.ndarray
        Whether a point is of the retraction.
    compliance : float
        Compliance (m/N) of the spring between probe and machine.
    rest : float or None
        Mean force of the baseline (N).
    pull_off : tuple of float or None
        Displacements of the machine (m) between which the contact detached.

    Examples
    --------
    :func:`measured_curve` returns one.
    """

    name: str
    points: np.ndarray
    rows: tuple[int, ...]
    errors: np.ndarray
    known: bool
    unloading: np.ndarray
    compliance: float
    rest: float | None
    pull_off: tuple[float, float] | None

    @property
    def force(self) -> np.ndarray:
        """Measured force (N)."""
        return self.points[self.rows.index(1)]


def measured_curve(curve: "xr.Dataset", noise: Mapping[str, Any], spring_constant: float | str | None) -> MeasuredCurve:
    """Check a curve of :func:`contact_study.read_force_curve` and prepare it.

    Parameters
    ----------
    curve : xarray.Dataset
        With ``total_force`` and ``displacement``, ``contact_radius`` or both, on ``point``.
    noise : mapping
        Standard errors of ``displacement``, ``force`` and ``contact_radius``: numbers in SI or text with a unit.
    spring_constant : float or str or None
        Stiffness of the spring between probe and machine (N/m); default: the one that the curve was read with.

    Returns
    -------
    MeasuredCurve

    Raises
    ------
    InputError
        For missing numbers, too few points, no contact, or a drift larger than the signal.
    """
    name = str(curve.attrs.get("title", "curve"))
    rows = tuple(row for row, axis in enumerate(AXES) if axis in curve)
    if 1 not in rows or len(rows) < 2:
        raise InputError(f"{name}: has no total_force with displacement or contact_radius; read it by read_force_curve")
    points = np.array([curve[AXES[row]].values for row in rows], dtype=float)
    if not np.isfinite(points).all():
        row, at = np.argwhere(~np.isfinite(points))[0]
        raise InputError(f"{name}, point {at + 1}: {AXES[rows[row]]} is missing; leave the point out")
    if points.shape[1] < _FEWEST:
        raise InputError(f"{name}: holds {points.shape[1]} points; an inference needs {_FEWEST} at least")
    if not np.ptp(points, axis=1).all():
        still = AXES[rows[int(np.argmin(np.ptp(points, axis=1)))]]
        raise InputError(f"{name}: {still} does not change; an inference needs points at several loads")
    unloading = np.asarray(curve["branch"].values == 1) if "branch" in curve else np.zeros(points.shape[1], bool)
    compliance = 1 / stiffness if 0 in rows and (stiffness := _stiffness(curve, spring_constant)) else 0.0
    if compliance:
        points[0] += compliance * points[1]
    rest, noise_of_rest = _baseline(name, points, unloading) if 0 in rows else (None, None)
    pull_off, flying = None, np.zeros(points.shape[1], bool)
    if rest is not None and noise_of_rest is not None:
        pull_off, flying = _jumps(points, unloading, rest, noise_of_rest)
    errors, known = _errors(curve, points, rows, unloading, noise_of_rest, noise)
    points, unloading = points[:, ~flying], unloading[~flying]
    points, unloading, averaged = _thinned(points, unloading)
    return MeasuredCurve(name, points, rows, errors / np.sqrt(averaged), known, unloading, compliance, rest, pull_off)


def check_alike(curves: list[MeasuredCurve]) -> None:
    """Raise InputError if the forces of curves differ by so much that one of them has another unit."""
    spans = [float(np.ptp(curve.force)) for curve in curves]
    low, high = int(np.argmin(spans)), int(np.argmax(spans))
    if spans[high] > 300 * spans[low]:
        raise InputError(
            f"{curves[high].name}: its forces span {force(spans[high])}, those of {curves[low].name} "
            f"{force(spans[low])}; check the units of both, or infer from them separately"
        )


def _stiffness(curve: "xr.Dataset", given: float | str | None) -> float | None:
    read = dict(pair.split(" = ", 1) for pair in str(curve.attrs.get("reading", "")).split(", ") if " = " in pair)
    words = given if given is not None else read.get("spring_constant")
    if isinstance(words, str) and words.replace(".", "").replace("e-", "").isdigit():
        words = float(words)
    if words is None:
        return None
    found = quantity(words, "N/m", "spring_constant")
    if found <= 0:
        raise InputError(f"spring_constant = {words!r}: must be positive")
    return found


def _baseline(name: str, points: np.ndarray, unloading: np.ndarray) -> tuple[float | None, float | None]:
    """Mean force without contact and its deviation (N); None for a curve with too few points before contact."""
    machine, load = points[:2]
    way = ~unloading if (~unloading).sum() >= unloading.sum() / 4 else unloading
    start = machine[way].min() + _REST * np.ptp(machine[way])
    free = way & (machine <= start)
    signal = float(np.abs(load - np.median(load[free])).max())
    if free.sum() < _OF_REST:
        return None, None
    slope, offset = np.polyfit(machine[free] - start, load[free], 1)
    noise = float(np.std(load[free] - slope * (machine[free] - start) - offset, ddof=2))
    error = noise / (np.std(machine[free]) * np.sqrt(free.sum()))
    drift = abs(float(slope)) * float(np.ptp(machine))
    if signal <= _CONTACT * max(noise, 1e-12 * signal) or (
        load[way].max() - load[free].max() <= 0 and signal < 8 * noise
    ):
        raise InputError(
            f"{name}: shows no contact, as its force stays within {force(signal)} of a baseline that scatters by "
            f"{force(noise)}; give a curve that reaches contact"
        )
    if drift > _DRIFT * signal and abs(slope) > _FREE * error:
        raise InputError(
            f"{name}: the force drifts by {force(drift)} over the curve, judged by its first fifth, and reaches "
            f"{force(signal)}; subtract the drift, or give a longer approach before contact"
        )
    return float(load[free].mean()), noise


def _jumps(
    points: np.ndarray, unloading: np.ndarray, rest: float, noise: float
) -> tuple[tuple[float, float] | None, np.ndarray]:
    """Displacements of the machine on either side of pull-off, and points during a jump."""
    machine, pull = points[0], points[1] - rest
    flying = np.zeros(pull.size, bool)
    pull_off = None
    for way in (np.flatnonzero(unloading), np.flatnonzero(~unloading)[::-1]):  # both from pressed to free
        if not way.size:
            continue
        lowest = int(np.argmin(pull[way]))
        least = pull[way[lowest]]
        if least > -_CONTACT * noise or lowest == way.size - 1:
            continue
        after = np.flatnonzero(pull[way[lowest:]] > -_FREE * noise)
        if not after.size:
            continue
        first_free = lowest + int(after[0])
        holds = np.flatnonzero(pull[way[lowest:first_free]] < 0.5 * least)
        last = lowest + int(holds[-1])
        if first_free - last - 1 > _IN_FLIGHT:
            continue
        flying[way[last + 1 : first_free]] = True
        if unloading[way[0]]:
            ends = machine[way[last]], machine[way[first_free]]
            pull_off = float(min(ends)), float(max(ends))
    return pull_off, flying


def _errors(
    curve: "xr.Dataset",
    points: np.ndarray,
    rows: tuple[int, ...],
    unloading: np.ndarray,
    noise_of_rest: float | None,
    noise: Mapping[str, Any],
) -> tuple[np.ndarray, bool]:
    """Standard error of each axis, and whether they are known: those not given are estimated up to a factor."""
    for word in noise:
        if word not in NOISE:
            raise InputError(f"noise {word}: is none of {', '.join(NOISE)}")
    errors, known = np.empty(len(rows)), False
    for at, row in enumerate(rows):
        axis = AXES[row]
        word = "force" if row == 1 else axis
        if word in noise:
            errors[at] = quantity(noise[word], NOISE[word], f"noise {word}")
            if errors[at] < 0 or (errors[at] == 0 and row == 1):
                raise InputError(f"noise {word} = {noise[word]!r}: must be positive")
            known |= row == 1 or 0 not in rows
        elif f"{axis}_uncertainty" in curve:
            errors[at] = np.sqrt(np.mean(curve[f"{axis}_uncertainty"].values ** 2))
            known |= row == 1 or 0 not in rows
        elif row == 2:
            errors[at] = _OPTICAL * points[at].max()
        elif row == 1:
            errors[at] = noise_of_rest if noise_of_rest else _BALANCE * np.ptp(points[at])
        else:
            errors[at] = _scatter(points[at], unloading)
        if row != 1:
            errors[at] = max(errors[at], _FLOOR * float(np.median(np.abs(np.diff(points[at])))))
    return np.maximum(errors, 1e-9 * np.ptp(points, axis=1)), known


def _scatter(values: np.ndarray, unloading: np.ndarray) -> float:
    """Deviation of values from a smooth motion, by third differences."""
    ways = [values[way] for way in (unloading, ~unloading) if way.sum() > _FEWEST]
    if not ways:
        return 0.0
    third = np.concatenate([np.diff(way, 3) for way in ways])
    return float(1.4826 * np.median(np.abs(third)) / np.sqrt(20))


def _thinned(points: np.ndarray, unloading: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """Means over neighbours of one branch, if there are many points, and of how many."""
    block = -(-points.shape[1] // _MOST)
    if block == 1:
        return points, unloading, 1
    parts, ways = [], []
    for back in (False, True):
        own = points[:, unloading == back]
        whole = own.shape[1] // block
        parts.append(own[:, : whole * block].reshape(len(points), whole, block).mean(2))
        ways.append(np.full(whole, back))
    return np.concatenate(parts, axis=1), np.concatenate(ways), block


def describe(curve: MeasuredCurve) -> str:
    """The errors of a curve in words."""
    words = ("displacement", "force", "radius")
    shown = [f"{words[r]} {(force if r == 1 else length)(e)}" for r, e in zip(curve.rows, curve.errors, strict=True)]
    return f"{', '.join(shown)} ({'given' if curve.known else 'estimated up to a factor'})"
