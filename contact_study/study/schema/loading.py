"""The section ``[loading]`` of a study file: the path, cycles about its last point, and the time to each point."""

import itertools
import math
from dataclasses import dataclass, field, replace

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import is_a, unit_of
from contact_study.study.schema import keys
from contact_study.study.schema.keys import FLAG, SECONDS, SHARE, choice, default_of, key, quantity

_OF_CYCLES = ("amplitude", "period", "cycles", "points_per_cycle")


def cycle(history: str, points: int) -> list[float]:
    """Return a cycle that begins upwards from zero, of amplitude one, at evenly spaced times after its start."""
    if history == "sine":
        return [math.sin(2 * math.pi * k / points) for k in range(1, points + 1)]
    phases = (k / points for k in range(1, points + 1))
    return [1 - abs(4 * ((t + 0.25) % 1) - 2) + 0.0 for t in phases]


@dataclass(frozen=True)
class LoadingSection:
    """The loading path, from separation, in the order given."""

    path: tuple[float, ...] = key(
        keys.sequence((lambda value, name: value, "pressures or gaps")),
        "pressures (Pa), forces (with unit, N), mean gaps above equilibrium or approaches (m)",
    )
    control: str = key(choice("pressure", "gap", "approach"), "what is prescribed", "pressure")
    unload: bool = key(FLAG, "go back through the path after its last point", False)
    adaptive: bool = key(FLAG, "adaptive load steps: refine where the contact is unstable (continuum, adhesion)", False)
    resolution: float = key(
        SHARE, "least adaptive step over the largest value of the path, or over 5 lengths of the law", 0.01
    )
    duration: float | tuple[float, ...] | None = key(
        keys.one_or_several(SECONDS),
        "time to each point of the path from the previous one, or a list (viscoelastic)",
        None,
    )
    machine_stiffness: float | None = key(
        quantity("N/m", positive=True),
        "stiffness of cantilever or machine in series with the body (approach; default rigid)",
        None,
    )
    trigger_force: float | None = key(
        quantity("N", positive=True), "force at which the way in ends, before larger approaches of the path", None
    )
    time_steps: int = key(keys.integer(1, 1_000_000), "equal steps of time to each point of the path (viscoelastic)", 1)
    speed: float | tuple[float, ...] | None = key(
        keys.one_or_several((lambda value, name: value, "Pa/s, N/s or m/s")),
        "change of the load to each point per time, in place of duration; or a list (viscoelastic)",
        None,
    )
    history: str = key(
        choice("points", "triangle", "sine"), "path as given, or cycles about its last point after it", "points"
    )
    amplitude: float | None = key(
        (lambda value, name: value, "Pa, N or m"), "amplitude of the cycles of history, upwards first", None
    )
    period: float | None = key(SECONDS, "time of a cycle of history (viscoelastic)", None)
    cycles: int = key(keys.integer(1, 1_000_000), "number of the cycles of history", 1)
    points_per_cycle: int = key(keys.integer(4, 1_000_000), "points of a cycle; the load is linear between them", 32)
    given: int = field(init=False, repr=False, compare=False)  # number of the points before the cycles
    has_forces: bool = field(init=False, repr=False, compare=False)  # a path of forces (N), before :meth:`spread`
    # Name, and size in SI, of the unit that the path's first point is written in: to speak to the user in it.
    unit: tuple[str, float] = field(init=False, repr=False, compare=False)

    def __post_init__(self):
        si = "m" if self.control != "pressure" else "N" if is_a(self.path[0], "N") else "Pa"
        read = quantity(si)[0]
        values = tuple(read(value, f"loading.path[{i}]") for i, value in enumerate(self.path))
        with_unit = [isinstance(value, str) for value in self.path]
        if any(with_unit) and not all(with_unit):  # a forgotten unit is likelier than a number of pascals meant
            bare = self.path[with_unit.index(False)]
            raise InputError(f"loading.path: mixes values with a unit and bare numbers; give {bare!r} its unit, too")
        unit = unit_of(str(self.path[0])) if all(with_unit) else si
        self.__dict__.update(path=values, has_forces=si == "N", unit=(unit, read(f"1 {unit}", "loading.path")))
        positive, rate = quantity(si, positive=True)[0], quantity(f"{si}/s", positive=True)[0]
        amplitude = None if self.amplitude is None else positive(self.amplitude, "loading.amplitude")
        speed = self.speed
        if isinstance(speed, tuple):
            speed = tuple(rate(value, f"loading.speed[{i}]") for i, value in enumerate(speed))
        elif speed is not None:
            speed = rate(speed, "loading.speed")
        self.__dict__.update(amplitude=amplitude, speed=speed, given=len(values))
        self._check_history()
        if amplitude is not None:
            one = cycle(self.history, self.points_per_cycle)
            self.__dict__["path"] += tuple(values[-1] + amplitude * share for share in one) * self.cycles

    def _check_history(self) -> None:
        """Raise InputError unless the keys of cycles and times fit to each other."""
        kind, points = f'loading.history = "{self.history}"', self.points_per_cycle
        if self.history == "points":
            for name in _OF_CYCLES:
                if getattr(self, name) != default_of(LoadingSection, name):
                    raise InputError(f'loading.{name}: belongs to loading.history = "triangle" or "sine"; leave it out')
        elif self.amplitude is None:
            raise InputError(f"missing key loading.amplitude: {kind} needs it")
        elif points % 4:
            raise InputError(
                f"loading.points_per_cycle = {points}: extremes are points of multiples of 4; use one of them"
            )
        elif self.unload:
            raise InputError(f"loading.unload: {kind} ends at its last cycle; leave one out")
        for name, what in (("duration", "times"), ("speed", "speeds")):
            values = getattr(self, name)
            if isinstance(values, tuple) and len(values) != len(self.path):
                raise InputError(
                    f"loading.{name} holds {len(values)} {what} for {len(self.path)} points of loading.path"
                )
        if self.speed is None:
            return
        before = (0.0, *self.path) if self.control == "pressure" else self.path
        held = [value for value, after in itertools.pairwise(before) if value == after]
        if held and self.duration is None:
            raise InputError(
                f"missing key loading.duration: loading.speed leads to no end of the dwell at {held[0]:g} in "
                "loading.path; give the time of dwells"
            )
        if self.duration is not None and (not held or isinstance(self.duration, tuple)):
            raise InputError(
                "loading.duration, loading.speed: give one of them; beside speeds, duration is the one time of all "
                "dwells, points that repeat the one before"
            )

    def unit_of_key(self, name: str) -> str | None:
        """SI unit of a key's numbers, by what the path prescribes; None for keys that always have the same."""
        load = "m" if self.control != "pressure" else "N" if is_a(f"1 {self.unit[0]}", "N") else "Pa"
        return {"path": load, "amplitude": load, "speed": f"{load}/s"}.get(name)

    def spread(self, area: float) -> "LoadingSection":
        """The same with mean pressures on an area (m²) in place of forces."""
        speed = self.speed
        if speed is not None:
            speed = tuple(rate / area for rate in speed) if isinstance(speed, tuple) else speed / area
        found = replace(
            self,
            path=tuple(force / area for force in self.path[: self.given]),
            amplitude=self.amplitude and self.amplitude / area,
            speed=speed,
        )
        name, size = self.unit
        found.__dict__["unit"] = name, size / area
        return found

    def times(self, origin: float = 0.0) -> list[float]:
        """Time to each point of the path, and back, from the one before it; to the first from an ``origin`` (s)."""
        path = self.path[: self.given]

        def each(value: float | tuple[float, ...] | None) -> list[float]:
            return list(value) if isinstance(value, tuple) else [value or 0.0] * len(path)

        times = each(self.duration)
        if self.speed is not None:
            ways = [abs(after - before) for before, after in zip((origin, *path), path, strict=False)]
            each_way = zip(ways, each(self.speed), times, strict=True)
            times = [way / speed if way else dwell for way, speed, dwell in each_way]
        if self.unload:  # each interval takes as long as on the way there
            return times + times[:0:-1]
        return times + [(self.period or 0.0) / self.points_per_cycle] * (len(self.path) - len(path))
