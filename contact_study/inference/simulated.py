"""Simulated loops of a probe as a model: a few of them over w/E*, and branches interpolated between them.

Force over E* depends on displacement, topography, range and w/E* alone. The loops are cases of a campaign on disk.
"""

import copy
import hashlib
import json
import warnings
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.library import run
from contact_study.inference.branches import Branch
from contact_study.inference.parameters import MODULUS, WORK
from contact_study.inputs.errors import InputError
from contact_study.physics.solids import HalfSpace, Layer
from contact_study.plots.force_curves import force_states
from contact_study.study.study import make_study, read_study

SPACING = 0.2  # of loops in ln(w/E*)
_STATES = 120  # of each piece of a branch
_FREE = 20  # of the line before attraction
_DEEPER = 0.05  # of the depth: how far loops go beyond it, so that curves of one probe share them
_STEPS = 0.25  # of the range of adhesion: largest step near contact
_AROUND = 3.0  # ranges of adhesion before first touch from which steps are as fine
_SHARP, _DEEP = 4.0, 0.05  # of a jump: its slope over its neighbours', and its height over the largest tension
_FEWEST, _MOSTLY = 20, 0.9  # states of a loop, and their share that must have converged
_NEAR = 400  # places among which the least force is sought
_RESOLUTION = 0.003  # of the adaptive steps
_TAIL = 12.0  # ranges of adhesion from which an approach begins
_MOST_LOOPS = 24
_KEY = "interaction.work_of_adhesion"


class SimulatedLoops:
    """Loops of a probe of given topography, as a model of a measured curve.

    Parameters
    ----------
    study : mapping or path-like
        Study of the probe: form, roughness, solid and law. Its modulus, work of adhesion and loading are replaced.
    folder : path-like
        Where the loops are kept; those that are there are not computed again.
    workers : int
        Processes for the loops.

    Examples
    --------
    >>> loops = SimulatedLoops("probe.toml", "loops")  # doctest: +SKIP
    """

    names: tuple[str, ...] = (WORK, MODULUS)

    def __init__(self, study: Mapping[str, Any] | str | Path, folder: str | Path, workers: int = 1):
        self.folder, self.workers = Path(folder), workers
        self.table = _table(study)
        self.case = make_study({**self.table, "loading": {"control": "approach", "path": [0.0]}}).cases[0]
        solid = self.case.solid
        if type(solid) not in (HalfSpace, Layer) or self.case.material.hardness is not None:
            raise InputError("study: an inference needs an elastic half-space or layer without hardness")
        if not self.case.law.attracts:
            raise InputError(f'study: interaction.law = "{self.case.interaction.law}" does not attract; choose another')
        self.modulus = float(solid.contact_modulus)
        self.range = self.case.work_of_adhesion / self.case.law.peak_tensile_stress
        self.radius = _radius(self.case)
        self.notes: list[str] = []
        self._loops: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        self._depth = self._start = self._end = 0.0

    @property
    def count(self) -> int:
        """Number of loops."""
        return len(self._loops)

    def prepare(self, depth: float) -> bool:
        """Set the largest displacement (m), of the preload; returns whether loops start again."""
        if (1 - 2 * _DEEPER) * self._depth < depth <= self._depth:
            return False
        step = np.ceil(np.log(depth) / _DEEPER) + 0.5
        self._depth, self._loops = float(f"{np.exp(step * _DEEPER):.3e}"), {}
        self._forget()
        return True

    def cover(self, low: float, high: float) -> int:
        """Simulate the loops missing around an interval of ln(w/E*); returns their number."""
        first, last = int(np.floor(low / SPACING)) - 1, int(np.ceil(high / SPACING)) + 1
        missing = sorted({*range(first, last + 1)} - self._loops.keys())
        if len(missing) + self.count > _MOST_LOOPS:
            raise InputError(
                f"study: the curves leave w/E* open over a factor of {np.exp(high - low):.3g}, which needs "
                f"{len(missing) + self.count} loops; give a prior of the modulus or of the work of adhesion"
            )
        if missing:
            self._simulate(missing)
        return len(missing)

    def branches(
        self, constants: Mapping[str, float], largest_force: float, start: float, compliance: float
    ) -> tuple[Branch, Branch]:
        """States of approach and retraction; parameters as for :class:`contact_study.inference.spheres.SphereModel`."""
        modulus = constants[MODULUS]
        places, spline = self._splines
        at = float(np.clip(np.log(constants[WORK] / modulus), places[0] - SPACING / 2, places[-1] + SPACING / 2))
        pieces = spline(at)
        ways = []
        for before, after in (pieces[:2], pieces[2:]):
            states = [np.array([x, modulus * f, np.zeros_like(x)]) for x, f in (before, after)]
            first = states[0][0, 0]
            far = np.linspace(min(start, first) - 0.1 * abs(first), first, _FREE, endpoint=False)
            free = np.array([far, np.zeros(_FREE), np.zeros(_FREE)])
            beyond = 2 * states[1][:, -1:] - states[1][:, -9:-8]
            # Between the pieces lies a jump, or a step of a path without one.
            ways.append(Branch(np.hstack([free, states[0]]), np.hstack([states[0][:, -1:], states[1], beyond])))
        return ways[0], ways[1]

    def interpolation_error(self, ratio: float) -> float:
        """Error of the force over E* (m²) between loops near a ln(w/E*), by leaving out every second of them."""
        from scipy.interpolate import make_interp_spline  # slow to import

        places, values = self._stacked
        near = int(np.argmin(np.abs(places * SPACING - ratio)))
        others = (places - places[near]) % 2 == 1
        if others.sum() < 2:
            return float("nan")
        degree = min(3, int(others.sum()) - 1)
        kept = make_interp_spline(places[others], values[others], degree)(places[near])
        difference = (kept - values[near])[[1, 3], 1]  # forces in contact
        return float(np.sqrt(np.mean(difference**2))) / 2.0 ** (degree + 1)

    @cached_property
    def _stacked(self) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the loops in ascending order, and their pieces, shape (loops, 4, 2, states)."""
        places = np.array(sorted(self._loops))
        pieces: list[list[np.ndarray]] = [[] for _ in places]
        for way in (0, 1):
            own = [self._loops[place][way] for place in places]
            jumps = [_jump(one) for one in own]
            if None in jumps:
                jumps = [None] * len(jumps)
            for at, (one, jump) in enumerate(zip(own, jumps, strict=True)):
                pieces[at] += _pieces(one, jump)
        return places, np.array(pieces)

    @cached_property
    def _splines(self) -> tuple[np.ndarray, Any]:
        """ln(w/E*) of the loops, and their pieces as a spline over it."""
        from scipy.interpolate import make_interp_spline  # slow to import

        places, values = self._stacked
        return places * SPACING, make_interp_spline(places * SPACING, values, min(3, places.size - 1))

    def _forget(self) -> None:
        """Drop what was made of the loops."""
        for name in ("_splines", "_stacked"):
            self.__dict__.pop(name, None)

    def _simulate(self, places: Iterable[int]) -> None:
        """Run loops at multiples of the spacing, beside those on disk."""
        everyone = sorted({*places, *self._loops})
        works = [float(f"{self.modulus * np.exp(place * SPACING):.12g}") for place in everyone]
        stretch = float(np.cbrt(self.radius * (works[-1] / self.modulus) ** 2))
        if not self._start:
            self._start = float(f"{_TAIL * self.range + stretch:.1e}")
            self._end = float(f"{6 * stretch + _TAIL * self.range:.1e}")
        near = max(-_AROUND * self.range - stretch, -0.9 * self._start)
        fine = np.linspace(near, self._depth, int((self._depth - near) / (_STEPS * self.range)) + 2)
        far = max(-_AROUND * self.range - 4 * stretch, -0.9 * self._end)
        back = np.linspace(self._depth, far, int((self._depth - far) / (_STEPS * self.range)) + 2)
        way = [-self._start, *fine, *back[1:], -self._end]
        loading = {
            "control": "approach",
            "path": [float(f"{place:.6e}") for place in way],
            "adaptive": True,
            "resolution": _RESOLUTION,
        }
        table = {**self.table, "loading": loading}
        name = hashlib.sha256(json.dumps(table, sort_keys=True, default=str).encode()).hexdigest()[:12]
        path = self.folder / f"loops-{name}.nc"
        self.folder.mkdir(parents=True, exist_ok=True)
        if path.exists():
            with xr.open_dataset(path) as kept:
                works = sorted({*works, *(float(w) for w in kept["work_of_adhesion"].values)})
        with warnings.catch_warnings(record=True) as raised:
            warnings.simplefilter("always")
            found = run({**table, "sweep": {_KEY: works}}, output=path, resume=path.exists(), workers=self.workers)
        self.notes = [*dict.fromkeys([*self.notes, *(_shortened(str(one.message)) for one in raised)])]
        for work in found["work_of_adhesion"].values:
            place = round(float(np.log(float(work) / self.modulus)) / SPACING)
            self._loops[place] = _ways(found.sel(work_of_adhesion=work), self.modulus)
        self._forget()


def _table(study: Mapping[str, Any] | str | Path) -> dict[str, Any]:
    """Sections of a probe, with a work of adhesion and without sweep and loading."""
    if isinstance(study, Mapping):
        table = copy.deepcopy(dict(study))
    else:
        read = read_study(study)
        table = copy.deepcopy(dict(read.table))
        for section in table.values():
            if isinstance(section, dict) and isinstance(section.get("path"), str):
                section["path"] = str(Path(study).parent / section["path"])
    if table.pop("sweep", None):
        raise InputError("study: sweeps; an inference varies the work of adhesion itself, leave [sweep] out")
    table.pop("loading", None)
    interaction = table.get("interaction")
    if not isinstance(interaction, dict) or "work_of_adhesion" not in interaction:
        raise InputError("missing key interaction.work_of_adhesion: an inference varies it; any value will do")
    return table


def _radius(case: Any) -> float:
    """Radius (m) of the probe's form."""
    found = getattr(case.form, "radius", None) or getattr(case.form, "radii", None)
    if case.surface.kind == "sphere":
        found = case.surface.radius
    if found is None:
        raise InputError('study: the probe has no radius; use [form] with kind = "sphere" or "paraboloid"')
    return float(np.exp(np.mean(np.log(found))))


def _shortened(note: str) -> str:
    """A warning of a run without the case that it names."""
    return note.split(": ", 1)[1] if note.startswith("work_of_adhesion = ") and ": " in note else note


def _ways(loop: xr.Dataset, modulus: float) -> tuple[np.ndarray, np.ndarray]:
    """States of approach and retraction of one loop by rising displacement: (m) and force over E* (m²)."""
    states = force_states(loop)
    x, force, outwards = (one[np.isfinite(states[1])] for one in states)  # those that converged
    if force.size < _FEWEST or force.size < _MOSTLY * states[1].size:
        work = float(loop["work_of_adhesion"])
        raise InputError(
            f"study: the loop at w/E* = {work / modulus:.3g} m does not converge; check surface.size and the grid "
            "with bem-adhesion check"
        )
    begins = outwards | np.append(outwards[1:], False)  # a way out begins at the state before it
    ways = []
    for way in (~outwards, begins):
        along, first = np.unique(x[way], return_index=True)
        ways.append(np.array([along, force[way][first] / modulus]))
    return ways[0], ways[1]


def _jump(way: np.ndarray) -> int | None:
    """Number of the last state before a jump into contact; None if the force changes without one."""
    slope = np.diff(way[1]) / np.diff(way[0])
    steepest = int(np.argmin(slope))
    beside = np.abs(slope[max(steepest - 1, 0) : steepest + 2])
    others = beside[beside < abs(slope[steepest])]
    fall = way[1][steepest] - way[1][steepest + 1]
    sharp = others.size > 0 and abs(slope[steepest]) > _SHARP * others.max()
    return steepest if sharp and fall > _DEEP * abs(way[1].min()) else None


def _pieces(way: np.ndarray, jump: int | None) -> tuple[np.ndarray, np.ndarray]:
    """States before and in contact, parted at a jump, or else at the least force, which moves smoothly with w/E*."""
    from scipy.interpolate import Akima1DInterpolator  # slow to import

    x, force = way
    if jump is not None and 1 < jump < x.size - 3:
        before = Akima1DInterpolator(x[: jump + 1], force[: jump + 1])
        after = Akima1DInterpolator(x[jump + 1 :], force[jump + 1 :])
        folds = x[jump], x[jump + 1]
    else:
        before = after = Akima1DInterpolator(x, force)
        lowest = int(np.argmin(force))
        near = np.linspace(x[max(lowest - 1, 0)], x[min(lowest + 1, x.size - 1)], _NEAR)
        folds = (float(near[np.argmin(before(near))]),) * 2
    share = np.linspace(0.0, 1.0, _STATES) ** 2  # states are dense at a fold
    loose = folds[0] - (folds[0] - x[0]) * share[::-1]
    pressed = folds[1] + (x[-1] - folds[1]) * share
    loose, pressed = np.clip(loose, x[0], folds[0]), np.clip(pressed, folds[1], x[-1])  # but for their rounding
    return np.array([loose, before(loose)]), np.array([pressed, after(pressed)])
