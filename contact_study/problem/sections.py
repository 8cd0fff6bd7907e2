"""The sections of a study file: every key with its unit, default and meaning, in SI once bound."""

from dataclasses import dataclass

from contact_study.problem.errors import InputError
from contact_study.problem.keys import choice, flag, integer, key, pair, quantity, sequence, text
from contact_study.problem.units import unit_of

LAWS = ("lennard_jones_10_4", "lennard_jones_9_3", "hard_wall")


@dataclass(frozen=True)
class StudySection:
    """What the study is called."""

    title: str = key(text(), "title of the study, written into every dataset", "untitled study")


@dataclass(frozen=True)
class MaterialSection:
    """The elastic block."""

    youngs_modulus: float = key(quantity("Pa", positive=True), "Young's modulus E")
    poissons_ratio: float = key(quantity("1", minimum=-0.999, maximum=0.5), "Poisson's ratio ν")
    lattice_constant: float | None = key(
        quantity("m", positive=True),
        "lattice constant a of the block; divides surface.size (atoms, well_depth)",
        None,
    )
    atom_mass: float | None = key(quantity("kg", positive=True), "mass of a block atom; no model uses it today", None)

    @property
    def contact_modulus(self) -> float:
        """E* = E / (1 − ν²) (Pa)."""
        return self.youngs_modulus / (1 - self.poissons_ratio**2)


@dataclass(frozen=True)
class InteractionSection:
    """The interaction across the interface."""

    law: str = key(choice(*LAWS), "traction-separation law of the continuum", "lennard_jones_10_4")
    well_depth: float | None = key(
        quantity("J", positive=True), "ε of the pair potential between two layers of atoms (10-4 law)", None
    )
    work_of_adhesion: float | None = key(quantity("J/m^2", positive=True), "Δγ, in place of well_depth", None)
    well_depth_ratio: float = key(quantity("1", positive=True), "multiplies well_depth or work_of_adhesion", 1.0)
    length: float | None = key(
        quantity("m", positive=True),
        "the law's length: distance of zero stress (10-4 law: r0 of the pairs; 9-3 law: z0)",
        None,
    )
    contact_distance: float | None = key(
        quantity("m", positive=True), "gaps below it count as contact, default 2^(1/6) length", None
    )

    def __post_init__(self):
        if self.well_depth is not None and self.work_of_adhesion is not None:
            raise InputError("interaction.well_depth and interaction.work_of_adhesion: give one of the two, not both")
        if self.law == "hard_wall":
            return
        if self.well_depth is None and self.work_of_adhesion is None:
            raise InputError(
                f'missing key interaction.well_depth or interaction.work_of_adhesion: law = "{self.law}" needs one'
            )
        if self.law == "lennard_jones_9_3" and self.well_depth is not None:
            raise InputError(
                'interaction.well_depth: law = "lennard_jones_9_3" is that of two half-spaces, whose adhesion needs '
                "the number of atoms per volume of both; give interaction.work_of_adhesion and length = z0 "
                "(docs/conventions.md has both from ε, r0 and the densities)"
            )
        if self.length is None:
            raise InputError(f'missing key interaction.length: law = "{self.law}" needs it')
        if self.contact_distance is not None and self.contact_distance <= self.length:
            raise InputError(
                f"interaction.contact_distance = {self.contact_distance:g} m: must exceed the equilibrium distance, "
                f"interaction.length = {self.length:g} m"
            )


@dataclass(frozen=True)
class LoadingSection:
    """The loading path, from separation, in the order given."""

    path: tuple[float, ...] = key(
        sequence((lambda value, name: value, "pressures or gaps")),
        "pressures (control = pressure, Pa) or mean gaps above equilibrium (control = gap, m), in any order",
    )
    control: str = key(choice("pressure", "gap"), "what is prescribed", "pressure")
    unload: bool = key(flag(), "go back through the path after its last point", False)

    def __post_init__(self):
        si = "Pa" if self.control == "pressure" else "m"
        read = quantity(si)[0]
        values = tuple(read(value, f"loading.path[{i}]") for i, value in enumerate(self.path))
        with_unit = [isinstance(value, str) for value in self.path]
        if any(with_unit) and not all(with_unit):  # a forgotten unit is likelier than a number of pascals meant
            bare = self.path[with_unit.index(False)]
            raise InputError(f"loading.path: mixes values with a unit and bare numbers; give {bare!r} its unit, too")
        unit = unit_of(str(self.path[0])) if all(with_unit) else si
        self.__dict__["_unit"] = unit, read(f"1 {unit}", "loading.path")
        object.__setattr__(self, "path", values)

    @property
    def unit(self) -> tuple[str, float]:
        """Name, and size in SI, of the unit that the path's first point is written in: to speak to the user in it."""
        return self.__dict__["_unit"]


@dataclass(frozen=True)
class SolverSection:
    """Accuracy and effort."""

    tolerance: float = key(
        quantity("1", positive=True, maximum=1e-2),
        "largest residual stress in units of the contact modulus",
        1e-8,
    )
    max_iterations: int = key(
        integer(minimum=1, maximum=2**31 - 1), "outer iterations of one step before it is flagged", 2000
    )
    threads: int = key(
        integer(minimum=0, maximum=1024), "threads of one solve; 0: the cores that the cases leave idle", 0
    )


@dataclass(frozen=True)
class AtomisticSection:
    """The block of atoms."""

    block: str = key(choice("isotropic"), "springs of the block; isotropic is the only kind today", "isotropic")
    method: str = key(
        choice("surface_stiffness"),
        "how the block is solved; today only one way: condensed exactly to its bottom layer, at zero temperature",
        "surface_stiffness",
    )
    cutoff: float = key(
        quantity("1", minimum=2.0, maximum=20.0), "cutoff of the pair potential in units of interaction.length", 4.0
    )
    layers: int = key(integer(minimum=0, maximum=1_000_000), "atomic layers of the block; 0: as thick as wide", 0)


@dataclass(frozen=True)
class TheorySection:
    """Choices inside Persson's theory with adhesion (root of the dataset) and what both theories are fed."""

    spectrum: str = key(
        choice("analytic", "surface"),
        "roughness spectrum: the target, or that of the very surface",
        "analytic",
    )
    energy_weight: str = key(
        choice("paper", "wang_mueser", "area"),
        "weight W of the elastic energy in incomplete contact",
        "paper",
    )
    beta: float = key(quantity("1", positive=True, maximum=1.0), "β of the paper's weight", 0.4)
    true_area: str = key(
        choice("persson", "none", "lattice"),
        "true over projected contact area, for the adhesion energy",
        "persson",
    )
    alpha: float = key(quantity("1", positive=True), "α in σ_a² = α E* q γ_eff", 1.0)
    cap_detachment_stress: bool = key(flag(), "limit σ_a to the law's largest tensile stress", False)


@dataclass(frozen=True)
class OutputSection:
    """What is kept."""

    fields: bool = key(flag(), "keep gap and pressure fields of every step", False)
    restart: bool = key(
        flag(),
        "keep each case's last state (8 bytes a point, 24 an atom), so that --resume can lengthen its path; without it "
        "a longer path is computed from its beginning",
        True,
    )
    pressure_range: tuple[float, float] | None = key(
        pair(quantity("Pa"), names="[low, high]"), "range of pressure_pdf, default from modulus, slopes and law", None
    )
    pressure_bins: int = key(integer(minimum=2, maximum=100_000), "bins of pressure_pdf", 300)
    gap_range: tuple[float, float] | None = key(
        pair(quantity("m", minimum=0.0), names="[low, high]"),
        "range of gap_pdf, default from the surface's heights",
        None,
    )
    gap_bins: int = key(integer(minimum=2, maximum=100_000), "bins of gap_pdf", 400)

    def __post_init__(self):
        for name in ("pressure_range", "gap_range"):
            limits = getattr(self, name)
            if limits is not None and not limits[0] < limits[1]:
                raise InputError(f"output.{name} = {list(limits)}: the second value must exceed the first")
