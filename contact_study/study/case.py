"""One point of a study's sweep: all that a model is given, frozen, in SI numbers."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs.errors import InputError, refuse
from contact_study.inputs.units import stress
from contact_study.numerics.grid import Grid
from contact_study.physics.lattice import Lattice, lattice_of
from contact_study.physics.laws import LAWS, TractionLaw
from contact_study.physics.laws.lennard_jones import work_of_adhesion
from contact_study.physics.solids import Elasticity, Viscoelastic
from contact_study.physics.surfaces.surface import Surface, SurfaceScales
from contact_study.study.schema import sections
from contact_study.study.schema.adhesion_map import AdhesionMapSection
from contact_study.study.schema.bodies import composed
from contact_study.study.schema.elasticity import ElasticitySection
from contact_study.study.schema.form import FormSection
from contact_study.study.schema.interaction import InteractionSection
from contact_study.study.schema.loading import LoadingSection
from contact_study.study.schema.surface import SurfaceSection

# The least step of a gap or approach is the resolution times so many lengths of the law, by default a twentieth of one.
# Pressures vary over that length, and the error of the trapezoidal rule is the square of a step over 12.
_LENGTHS = 5
# A longer step of a displacement passes several jumps of a rough contact, whose work the error of the rule may hide.
# Over the law's length, and over the way between two points, which is passed in no more than a hundred such steps.
_LONGEST, _SHARE = 0.5, 0.01


@dataclass(frozen=True)
class Case:
    """One point of a study's sweep."""

    study: sections.StudySection
    surface: SurfaceSection
    form: FormSection
    detail: Any
    counterface: Any
    material: sections.MaterialSection
    elasticity: ElasticitySection
    interaction: InteractionSection
    adhesion_map: AdhesionMapSection
    loading: LoadingSection
    solver: sections.SolverSection
    atomistic: sections.AtomisticSection
    overdamped: sections.OverdampedSection
    sampling: sections.SamplingSection
    dynamics: sections.DynamicsSection
    theory: sections.TheorySection
    uncertainty: sections.UncertaintySection
    output: sections.OutputSection
    coordinates: dict[str, Any] = field(default_factory=dict)  # the swept keys, by their last part, and their values
    index: tuple[int, ...] = ()  # position along each swept key
    directory: Path = Path(".")

    def __post_init__(self):
        _ = self.solid, self.geometry  # raise where no solid has these constants, and nothing is there to add to
        lowest = min(self.loading.path)
        if not self.law.attracts and self.loading.control == "pressure" and lowest <= 0:
            raise InputError(
                f"loading.path: {lowest:g} Pa cannot be carried by {self.law.words}; give positive pressures"
            )
        free, control = self.elasticity.boundary != "periodic", self.loading.control
        if (hardness := self.material.hardness) is not None:
            given = f"material.hardness = {hardness:g} Pa"
            if control == "pressure" and max(self.loading.path) >= hardness:
                raise InputError(
                    f"loading.path: a mean pressure of {max(self.loading.path):g} Pa is not below {given}: no state "
                    "can carry it, all of the surface would yield"
                )
            closed = float(self.law.repulsive_gap(np.array(-hardness))) - self.law.equilibrium_distance
            if control == "gap" and lowest <= closed:
                limit = f"{closed:g} m" if closed else "zero"
                raise InputError(
                    f"loading.path: with {given} surfaces close at no one pressure; give gaps above {limit}"
                )
        if self.adhesion_map.kind != "none" and not self.law.attracts:
            raise InputError(
                f'adhesion_map.kind = "{self.adhesion_map.kind}": interaction.law = "{self.interaction.law}" does not '
                "attract; leave it out"
            )
        self._check_time()
        if self.material.counter_modulus is not None and not self.elasticity.may_be_free:
            raise InputError(
                f'material.counter_youngs_modulus: elasticity.kind = "{self.elasticity.kind}" has no combined modulus '
                'with a second body; use "half_space" or "transversely_isotropic"'
            )
        if free and control == "gap":
            given = f'elasticity.boundary = "{self.elasticity.boundary}"'
            raise InputError(f'loading.control = "gap": {given} takes "pressure" or "approach"')
        for name in ("machine_stiffness", "trigger_force"):
            if getattr(self.loading, name) is not None and control != "approach":
                raise InputError(f'loading.{name}: belongs to loading.control = "approach", not "{control}"')
        moves = free or self.solid.mean_compliance or self.loading.machine_stiffness
        if control == "approach" and not moves:
            held = math.isfinite(self.solid.depth)
            moved = "not at all, being incompressible" if held else "by no finite distance, repeated periodically"
            raise InputError(
                f'loading.control = "approach": a uniform pressure moves elasticity.kind = "{self.elasticity.kind}" '
                f'{moved}; use "pressure" or "gap", or give the spring loading.machine_stiffness'
            )
        peak = self.law.peak_tensile_stress
        if self.law.attracts and control == "pressure" and lowest < -peak:
            raise InputError(
                f"loading.path[{self.loading.path.index(lowest)}] = {stress(lowest)} exceeds the largest tensile "
                f"stress of the adhesive law, {stress(peak)}: no state can carry it; give values above {stress(-peak)}"
            )

    def require_gap(self) -> None:
        """Raise InputError if a prescribed mean gap is not positive; that of a driven block is another distance."""
        above, distance = min(self.loading.path), self.law.equilibrium_distance
        # Only a wall can be met everywhere, at a mean gap of zero.
        met = above + distance < 0 or (above + distance == 0 and not self.law.has_wall)
        if self.loading.control == "gap" and met:
            raise InputError(
                f"loading.path: a mean gap of {above:g} m above the equilibrium distance, {distance:g} m, leaves no "
                "gap between the surfaces"
            )

    def _check_time(self) -> None:
        loading, kind = self.loading, f'elasticity.kind = "{self.elasticity.kind}"'
        if not isinstance(self.solid, Viscoelastic):
            for name in ("duration", "speed", "period"):
                if getattr(loading, name) is not None:
                    raise InputError(f'loading.{name}: {kind} has no time; it belongs to "viscoelastic"')
            return
        if loading.duration is None and loading.speed is None:
            raise InputError(f"missing key loading.duration: {kind} needs times between points, or loading.speed")
        if loading.history != "points" and loading.period is None:
            raise InputError(f"missing key loading.period: {kind} needs the time of a cycle")
        refuse(
            {
                f'solver.path = "overdamped": not known of {kind}; leave it out': self.solver.path == "overdamped",
                f"output.stiffness: not known of {kind}; leave it out": self.output.stiffness,
                f"material.hardness: not known of {kind}; leave it out": self.material.hardness is not None,
            }
        )

    @property
    def spectra(self) -> tuple[str, ...]:
        """The roughness spectra that theories are fed with, the first one under their own names."""
        own = ("surface",) if self.geometry.target_spectrum is None else ("surface", "analytic")
        return self.theory.spectra or own

    @property
    def label(self) -> str:
        """Coordinates for progress and messages."""
        given = self.coordinates.items()
        # The conversion of a unit leaves a rounding.
        return ", ".join(f"{name} = {float(f'{v:.12g}') if isinstance(v, float) else v}" for name, v in given)

    @cached_property
    def kept_fields(self) -> frozenset[int]:
        """Numbers of the points of the path whose fields are kept."""
        points = range(len(self.path)) if self.output.fields else range(0)
        asked = points if self.output.field_steps is None else self.output.field_steps
        return frozenset(points[number] for number in asked if -len(points) <= number < len(points))

    @cached_property
    def geometry(self) -> SurfaceSection:
        """The combined surface of both bodies: ``surface`` itself where nothing is added to it."""
        return composed(self.surface, self.form, self.detail, self.counterface)

    @cached_property
    def scales(self) -> SurfaceScales:
        return self.geometry.scales(self.directory)

    @cached_property
    def solid(self) -> Elasticity:
        return self.elasticity.solid(self.material)

    @property
    def block_layers(self) -> int:
        """Cells of the block from its surface to the plane that holds it; of a half-space as many as across."""
        given, depth, constant = self.atomistic.layers, self.solid.depth, self.lattice.constant
        if not math.isfinite(depth):
            return given or max(self.lattice.atoms)
        layers = round(depth / constant)
        if layers < 1 or abs(depth / constant - layers) > 1e-6 * layers or given not in (0, layers):
            clash = f" and atomistic.layers = {given}" if given else ""
            raise InputError(
                f"elasticity.thickness = {depth:g} m{clash}: the layer is {depth / constant:.6g} cells of "
                f"material.lattice_constant = {constant:g} m; atoms need a whole number, and atomistic.layers = 0"
            )
        return layers

    @cached_property
    def law(self) -> TractionLaw:
        return self.interaction.make_law(self.work_of_adhesion)

    @property
    def nominal_area(self) -> float:
        """Area of the cell (m²), one without a surface."""
        return math.prod(self.surface.cell(self.directory) or ())

    @property
    def machine_compliance(self) -> float:
        """Compliance of ``loading.machine_stiffness`` per nominal area, zero if rigid (m/Pa)."""
        stiffness = self.loading.machine_stiffness
        return self.nominal_area / stiffness if stiffness else 0.0

    @property
    def contact_distance(self) -> float:
        """Gaps below it count as contact (m)."""
        given, law = self.interaction.contact_distance, self.law
        return law.contact_distance if given is None or law.bare_wall else given

    @property
    def map_keys(self) -> dict[str, str]:
        """Files of heights and of the work of adhesion as the study writes them, by their keys."""
        adhesion = self.adhesion_map.map_path
        return self.geometry.map_keys | ({} if adhesion is None else {"adhesion_map.path": adhesion})

    @property
    def height_maps(self) -> dict[str, Path]:
        """Files of maps, by their paths as the study writes them."""
        return {path: self.directory / path for path in self.map_keys.values()}

    @property
    def measured_maps(self) -> tuple[tuple[str, SurfaceScales], ...]:
        """Each measured map as the study writes its path, and its scales."""
        own = self.surface.map_path
        return self.scales.maps or (() if own is None else ((own, self.scales),))

    @property
    def path(self) -> list[tuple[float, str]]:
        """Prescribed values in order, each with its branch: "loading" or "unloading"."""
        back = self.loading.path[-2::-1] if self.loading.unload else ()
        return [(value, "loading") for value in self.loading.path] + [(value, "unloading") for value in back]

    @property
    def least_step(self) -> float | None:
        """Least step of an adaptive path, in its unit; None for other paths."""
        if not (self.loading.adaptive and (self.law.attracts or isinstance(self.solid, Viscoelastic))):
            return None
        largest = max(map(abs, self.loading.path))
        if self.loading.control != "pressure":
            largest = min(largest, _LENGTHS * self.law.length)
        return self.loading.resolution * largest

    def longest_step(self, start: float, end: float) -> float:
        """Longest step of an adaptive path between two of its points, in its unit."""
        if self.loading.control == "pressure":
            return math.inf
        return max(_LONGEST * self.law.length, _SHARE * abs(end - start))

    def point_in_words(self, number: int) -> str:
        name, size = self.loading.unit
        what = "" if self.loading.control == "pressure" else f"{self.loading.control} "
        return f"{what}{self.path[number][0] / size:.6g} {name}"

    @cached_property
    def lattice(self) -> Lattice:
        return lattice_of(self.geometry.cell(self.directory), self.material.lattice_constant)

    @property
    def work_of_adhesion(self) -> float:
        """Δγ (J/m²), including ``well_depth_ratio``; zero for a hard wall without adhesion."""
        given = self.interaction
        if not LAWS[given.law].attracts:
            return 0.0
        if given.work_of_adhesion is not None:
            return given.work_of_adhesion * given.well_depth_ratio
        if given.well_depth is None or given.length is None:
            return 0.0
        return work_of_adhesion(given.well_depth * given.well_depth_ratio, given.length, *self.lattice.densities)

    def adhesion_factors(self, grid: Grid) -> np.ndarray | None:
        """Local work of adhesion over its mean on a grid; None if it is uniform, InputError if the law has none."""
        states = tuple(path.stat().st_mtime_ns for path in self.height_maps.values() if path.is_file())
        factors = _adhesion_factors(self.adhesion_map, grid, self.directory, states)
        if factors is not None and not self.law.has_wall and not factors.min() > 0:
            raise InputError(
                f'adhesion_map: the work of adhesion vanishes at points; interaction.law = "{self.interaction.law}" '
                'would not repel there either. Use a smaller contrast, or a law outside a wall such as "exponential"'
            )
        return factors

    @cached_property
    def strongest_adhesion(self) -> float:
        """Largest local work of adhesion over its mean."""
        factors = self.adhesion_factors(Grid(self.scales.shape, self.scales.size))
        return 1.0 if factors is None else float(factors.max())

    @property
    def well_depth(self) -> float:
        """ε of the pair potential (J), including ``well_depth_ratio``."""
        given = self.interaction
        if given.well_depth is not None:
            return given.well_depth * given.well_depth_ratio
        if given.length is None:
            raise InputError("missing key interaction.length: atoms need a pair potential")
        return self.work_of_adhesion / work_of_adhesion(1.0, given.length, *self.lattice.densities)


@lru_cache(maxsize=2)
def _adhesion_factors(
    given: AdhesionMapSection, grid: Grid, directory: Path, states: tuple[int, ...]
) -> np.ndarray | None:
    """Make a map once for checks, solver and results; ``states`` identify the contents of files."""
    factors = given.factors(grid, directory)
    if factors is not None:
        factors.setflags(write=False)
    return factors


def realise(case: Case) -> Surface:
    """Make the surface of a case; equal cases give equal surfaces, for every model.

    Parameters
    ----------
    case : Case
        One point of a study's sweep.

    Returns
    -------
    Surface

    Raises
    ------
    InputError
        If a height map cannot be read or used.

    Examples
    --------
    >>> import contact_study
    >>> heights = contact_study.realise(contact_study.read_study("study.toml").cases[0]).sampled  # doctest: +SKIP
    """
    return case.geometry.realise(case.directory)


PathPoint = tuple[str, int, int]  # prescribed value to twelve digits, 1 on the way back, earlier visits


def path_points(prescribed: Iterable[float], unloading: Iterable[int]) -> list[PathPoint | None]:
    """Name the points of a path, to find them in another; None where it is padded, by NaN.

    ``unloading`` is 1 on the way back. Contacts remember: the second time at a pressure is not the first.
    """
    visits: Counter[tuple[str, int]] = Counter()
    points: list[PathPoint | None] = []
    for value, back in zip(prescribed, unloading, strict=True):
        if np.isnan(value):
            points.append(None)
            continue
        # The same pressure written in another unit differs in the last of sixteen digits; no zero has a sign.
        key = (f"{value + 0.0:.12g}", int(back))
        points.append((*key, visits[key]))
        visits[key] += 1
    return points


def path_points_of(case: Case) -> list[PathPoint | None]:
    """Names of the points of a case's path."""
    values, branches = zip(*case.path, strict=True)
    return path_points(values, (branch == "unloading" for branch in branches))
