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
_TRIGGER = 0.1  # in the logarithm of the preload over E*: its steps, so that curves of one probe share loops
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
        self._loops: dict[int, tuple[Branch, Branch]] = {}
        self._preload: int | None = None
        self._depth = self._start = self._end = 0.0

    @property
    def count(self) -> int:
        """Number of loops."""
        return len(self._loops)

    def prepare(self, preload: float, depth: float) -> bool:
        """Set the largest force over E* (m²) and a displacement beyond it (m); returns whether loops start anew."""
        step = int(np.ceil(np.log(preload) / _TRIGGER))
        if self._preload is not None and abs(step - self._preload) < 2:
            return False
        self._preload, self._loops = step, {}
        self._depth = float(f"{depth:.1e}")
        self.__dict__.pop("_splines", None)
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

        places = np.array(sorted(self._loops))
        near = places[np.argsort(np.abs(places * SPACING - ratio))[:1]][0]
        others = places[(places - near) % 2 == 1]
        if others.size < 2:
            return float("nan")
        values = np.array([_stacked(self._loops[place]) for place in places])
        degree = min(3, others.size - 1)
        kept = make_interp_spline(others, values[np.isin(places, others)], degree)(near)
        difference = (kept - values[places == near][0])[[1, 3], 1]  # forces in contact
        return float(np.sqrt(np.mean(difference**2))) / 2.0 ** (degree + 1)

    @cached_property
    def _splines(self) -> tuple[np.ndarray, Any]:
        """ln(w/E*) of the loops, and their pieces as a spline over it."""
        from scipy.interpolate import make_interp_spline  # slow to import

        places = np.array(sorted(self._loops))
        values = np.array([_stacked(self._loops[place]) for place in places])
        return places * SPACING, make_interp_spline(places * SPACING, values, min(3, places.size - 1))

    def _simulate(self, places: Iterable[int]) -> None:
        """Run loops at multiples of the spacing, beside those on disk."""
        assert self._preload is not None
        everyone = sorted({*places, *self._loops})
        works = [float(f"{self.modulus * np.exp(place * SPACING):.12g}") for place in everyone]
        stretch = float(np.cbrt(self.radius * (works[-1] / self.modulus) ** 2))
        if not self._start:
            self._start = float(f"{_TAIL * self.range + stretch:.1e}")
            self._end = float(f"{6 * stretch + _TAIL * self.range:.1e}")
        trigger = self.modulus * float(np.exp(self._preload * _TRIGGER))
        loading = {
            "control": "approach",
            "path": [-self._start, self._depth, -self._end],
            "trigger_force": trigger,
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
            self._loops[place] = _pieces(found.sel(work_of_adhesion=work), self.modulus, trigger)
        self.__dict__.pop("_splines", None)


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


def _pieces(loop: xr.Dataset, modulus: float, trigger: float) -> tuple[Branch, Branch]:
    """Approach and retraction of one loop, parted at its largest jumps; forces are over E* (m²)."""
    x, force, outwards = force_states(loop)
    if not (loop["converged"] == 1).all() or force.size < 20 or force.max() < 0.9 * trigger:
        work = float(loop["work_of_adhesion"])
        raise InputError(
            f"study: the loop at w/E* = {work / modulus:.3g} m does not converge, or does not reach the force of the "
            "curves; check surface.size and the grid with bem-adhesion check"
        )
    force = force / modulus
    begins = outwards | np.append(outwards[1:], False)  # a way out begins at the state before it
    way_in, way_out = ((x[way], force[way]) for way in (~outwards, begins))
    jump = int(np.argmin(np.diff(way_in[1])))
    loading = Branch(_piece(*way_in, slice(0, jump + 1), -1), _piece(*way_in, slice(jump + 1, None), 1))
    back, pull = way_out[0][::-1], way_out[1][::-1]
    lowest = int(np.argmin(pull))
    drop = int(np.argmin(np.diff(pull[: lowest + 1]))) if lowest else 0
    unloading = Branch(_piece(back, pull, slice(0, drop + 1), -1), _piece(back, pull, slice(drop + 1, None), 1))
    return loading, unloading


def _piece(x: np.ndarray, force: np.ndarray, part: slice, sign: int) -> np.ndarray:
    """States of a piece at even steps of the root of the distance from its fold: first of a contact, last before it."""
    from scipy.interpolate import Akima1DInterpolator  # slow to import

    along, first = np.unique(x[part], return_index=True)
    values = force[part][first]
    if along.size < 2:
        along, values = np.array([along[0] - 1e-15, along[0]]), np.array([values[0], values[0]])
    fold = along[0] if sign > 0 else along[-1]
    root = np.sqrt(np.abs(along - fold))
    even = np.linspace(0.0, root.max(), _STATES)
    shown = Akima1DInterpolator(*(values_[:: 1 if sign > 0 else -1] for values_ in (root, values)))(even)
    states = np.array([fold + sign * even**2, shown])
    return states if sign > 0 else states[:, ::-1]


def _stacked(loop: tuple[Branch, Branch]) -> np.ndarray:
    """Pieces of both ways, shape (4, 2, states)."""
    return np.array([piece for way in loop for piece in way])
