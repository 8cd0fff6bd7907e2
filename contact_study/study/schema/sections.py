"""The sections of a study file: every key with its unit, default and meaning, in SI once bound."""

from dataclasses import dataclass

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.roughness.spectrum import TabulatedSpectrum
from contact_study.study.schema import keys
from contact_study.study.schema.keys import (
    FACTOR,
    FLAG,
    METRES,
    PASCALS,
    SECONDS,
    SHARE,
    TEXT,
    choice,
    key,
    quantity,
)

POISSONS_RATIO = quantity("1", minimum=-0.999, maximum=0.5)


@dataclass(frozen=True)
class StudySection:
    """Title of the study."""

    title: str = key(TEXT, "title of the study, written into every dataset", "untitled study")


@dataclass(frozen=True)
class MaterialSection:
    """The elastic block."""

    youngs_modulus: float = key(PASCALS, "Young's modulus E")
    poissons_ratio: float = key(POISSONS_RATIO, "Poisson's ratio ν")
    lattice_constant: float | None = key(
        METRES, "lattice constant a of the block; divides surface.size (atoms, well_depth)", None
    )
    atom_mass: float | None = key(keys.KILOGRAMS, "mass of a block atom, for atomistic.method = dynamics", None)
    hardness: float | None = key(PASCALS, "largest pressure; points that reach it yield plastically (continuum)", None)

    counter_youngs_modulus: float | None = key(
        PASCALS, "Young's modulus of the second body, if it is elastic, too (half-spaces)", None
    )
    counter_poissons_ratio: float | None = key(POISSONS_RATIO, "Poisson's ratio of the second body", None)

    def __post_init__(self) -> None:
        given = {"youngs_modulus": self.counter_youngs_modulus, "poissons_ratio": self.counter_poissons_ratio}
        lacking = [name for name, value in given.items() if value is None]
        if len(lacking) == 1:
            raise InputError(f"missing key material.counter_{lacking[0]}: an elastic second body needs both")

    @property
    def contact_modulus(self) -> float:
        """E* = E / (1 − ν²), of this body alone (Pa)."""
        return self.youngs_modulus / (1 - self.poissons_ratio**2)

    @property
    def counter_modulus(self) -> float | None:
        """E* of the second body (Pa), None if it is rigid."""
        if self.counter_youngs_modulus is None or self.counter_poissons_ratio is None:
            return None
        return self.counter_youngs_modulus / (1 - self.counter_poissons_ratio**2)

    def combined(self, modulus: float) -> float:
        """1/E* = 1/E*₁ + 1/E*₂ of two half-spaces without friction, the first of a modulus (Pa)."""
        other = self.counter_modulus
        return modulus if other is None else 1 / (1 / modulus + 1 / other)


@dataclass(frozen=True)
class SolverSection:
    """Accuracy and effort."""

    tolerance: float = key(
        quantity("1", minimum=1e-15, maximum=1e-2),  # less is the rounding of double precision
        "largest residual stress over the contact modulus, less for loads below 0.001 of it",
        1e-8,
    )
    max_iterations: int = key(keys.integer(1, 2**31 - 1), "outer iterations of one step before it is flagged", 2000)
    threads: int = key(keys.integer(0, 1024), "threads of one solve; 0: the cores that the cases leave idle", 0)
    path: str = key(
        choice("quasi_static", "overdamped"),
        "path of the continuum: successive equilibria, or slow motion against friction",
        "quasi_static",
    )


@dataclass(frozen=True)
class AtomisticSection:
    """The block of atoms."""

    block: str = key(
        choice("isotropic", "nonlinear_springs"),
        "springs of the block: linear and isotropic, or turning with their atoms (dynamics)",
        "isotropic",
    )
    method: str = key(
        choice("quasi_static", "overdamped", "sampling", "dynamics"),
        "path of the atoms: equilibria at 0 K, slow motion, thermal averages or dynamics",
        "quasi_static",
    )
    temperature: float = key(quantity("K", minimum=0.0), "temperature of the atoms, for sampling and dynamics", 0.0)
    cutoff: float = key(
        quantity(
            "1", minimum=2.0, maximum=20.0, why="the law's peak must lie within, and the switch to zero well beyond it"
        ),
        "cutoff of the pair potential in units of interaction.length",
        4.0,
    )
    layers: int = key(keys.integer(0, 1_000_000), "atomic layers of the block; 0: as thick as wide", 0)
    random_seed: int = key(keys.integer(0, 2**63 - 1), "seed of thermal motion", 1)


@dataclass(frozen=True)
class OverdampedSection:
    """Slow motion against friction, of continuum and atoms."""

    loading_rate: float = key(
        FACTOR, "change of mean pressure over contact modulus while the longest wave relaxes", 1e-3
    )
    step_error: float = key(SHARE, "error allowed to a time step, over the law's length", 0.1)


@dataclass(frozen=True)
class SamplingSection:
    """Thermal averages of the atoms, by Hamiltonian Monte Carlo."""

    trajectories: int = key(keys.integer(2, 2**31 - 1), "states of each point that count", 300)
    equilibration: int = key(
        keys.integer(10, 2**31 - 1), "trajectories before them, which set the time step and do not count", 50
    )


@dataclass(frozen=True)
class DynamicsSection:
    """The explicit block of atoms in motion."""

    time_step: float | None = key(SECONDS, "of velocity Verlet, default a fifth of the largest stable one", None)
    duration: float = key(SECONDS, "of each point of the path", 1e-10)
    damping: float = key(quantity("s^-1", minimum=0.0), "rate at which friction takes momentum", 0.0)
    approach_speed: float = key(quantity("m/s", minimum=0.0), "at which the block first comes down", 0.0)
    frames: int = key(keys.integer(2, 2**31 - 1), "states of each point that are looked at", 200)


@dataclass(frozen=True)
class TheorySection:
    """Persson's theory, the theories beside it and the spectrum that they take."""

    flows: str | tuple[str, ...] = key(
        keys.choices("gap_flow", "edge_flow", "none"),
        "theories beside Persson's; most of the time goes into them",
        ("gap_flow", "edge_flow"),
    )
    spectrum: str | tuple[str, ...] | None = key(
        keys.choices("analytic", "surface", "table", "file"),
        "roughness spectrum of the theories, or several; default the surface's and its target",
        None,
    )
    wavevectors: tuple[float, ...] | None = key(
        keys.sequence(keys.PER_METRE), 'spectrum "table": rising wavevectors q', None
    )
    density: tuple[float, ...] | None = key(
        keys.sequence(quantity("m^4", positive=True)), 'spectrum "table": C(q) at each, a power law between two', None
    )
    spectrum_path: str | None = key(
        TEXT, 'spectrum "file": text with q and C(q) a row, or NetCDF; the study then holds its numbers', None
    )
    wavevector_unit: str | None = key(TEXT, "unit of its q, where the file does not say it", None)
    density_unit: str | None = key(TEXT, "unit of its C(q), where the file does not say it", None)
    energy_weight: str = key(
        choice("paper", "wang_mueser", "area"), "weight W of the elastic energy in incomplete contact", "paper"
    )
    beta: float = key(SHARE, "β of the paper's weight", 0.4)
    true_area: str = key(
        choice("persson", "none", "lattice"), "true over projected contact area, for the adhesion energy", "persson"
    )
    alpha: float = key(FACTOR, "α in σ_a² = α E* q γ_eff", 1.0)
    cap_detachment_stress: bool = key(FLAG, "limit σ_a to the law's largest tensile stress", False)
    magnifications: int = key(
        keys.integer(0, 10_000),
        "magnifications ζ at which P(σ, ζ) of Persson's theory is kept, evenly in ln ζ; 0: none",
        0,
    )
    accuracy: float | None = key(
        FACTOR, "relative error of area and mean gap that warns, by states of half the resolution", None
    )

    def __post_init__(self):
        if "none" in self.flows and self.flows != "none":  # in a list of several
            raise InputError('theory.flows: "none" leaves no room for another')
        if "file" in self.spectra:
            raise InputError(
                'missing key theory.spectrum_path: theory.spectrum = "file" needs it, the same at all points'
            )
        for name in ("spectrum_path", "wavevector_unit", "density_unit"):
            if getattr(self, name) is not None:
                raise InputError(f'theory.{name}: belongs to theory.spectrum = "file"')
        if "table" in self.spectra:
            for name in ("wavevectors", "density"):
                if getattr(self, name) is None:
                    raise InputError(f'missing key theory.{name}: theory.spectrum = "table" needs it')
            try:
                self.table()
            except ValueError as error:
                raise InputError(f"theory.{error}") from None

    def table(self) -> TabulatedSpectrum:
        return TabulatedSpectrum(np.array(self.wavevectors), np.array(self.density))

    def has(self, flow: str) -> bool:
        """Test whether a theory is solved beside Persson's."""
        return flow in ((self.flows,) if isinstance(self.flows, str) else self.flows)

    @property
    def spectra(self) -> tuple[str, ...]:
        return (self.spectrum,) if isinstance(self.spectrum, str) else self.spectrum or ()


@dataclass(frozen=True)
class UncertaintySection:
    """Draws of uncertain keys; their distributions are the section's entries with dotted names."""

    draws: int | None = key(keys.integer(1, 65536), "number of draws beside the central case", None)
    seed: int = key(keys.integer(0, 2**63 - 1), "seed of the quasi-random draws", 1)
    draw: int = key(keys.integer(0, 65536), "number of a draw, 0 for the central case; swept by draws", 0)


@dataclass(frozen=True)
class OutputSection:
    """Output that is kept."""

    fields: bool = key(FLAG, "keep gap and pressure fields of every step", False)
    field_steps: tuple[int, ...] | None = key(
        keys.sequence(keys.integer()),
        "points of the path whose fields are kept, from 0 on, -1 for the last; default all",
        None,
    )
    field_precision: str = key(
        choice("double", "single"), "digits of the fields that are kept: 16, or 7 in half the space", "double"
    )
    atoms: str = key(
        choice("none", "surface", "block"),
        "atoms kept at every step: none, the bottom layer, or the explicit block (dynamics), too",
        "none",
    )
    stiffness: bool = key(
        FLAG, "contact stiffness and conductance of every step of the continuum, by a linear solve", False
    )
    leakage: bool = key(FLAG, "hydraulic gaps of every step of a simulation, by a direct solve of Reynolds flow", False)
    restart: bool = key(FLAG, "keep the last state of each case, from which --resume lengthens its path", True)
    pressure_range: tuple[float, float] | None = key(
        keys.pair(quantity("Pa"), names="[low, high]"),
        "range of pressure_pdf, default from modulus, slopes and law",
        None,
    )
    pressure_bins: int = key(keys.integer(2, 100_000), "bins of pressure_pdf", 300)
    gap_range: tuple[float, float] | None = key(
        keys.pair(quantity("m", minimum=0.0), names="[low, high]"),
        "range of gap_pdf, default from the surface's heights",
        None,
    )
    gap_bins: int = key(keys.integer(2, 100_000), "bins of gap_pdf", 400)

    def __post_init__(self):
        for name, default in (("field_steps", None), ("field_precision", "double")):
            if getattr(self, name) != default and not self.fields:
                raise InputError(f"output.{name}: no fields are kept; set output.fields = true, or leave it out")
        for name in ("pressure_range", "gap_range"):
            limits = getattr(self, name)
            if limits is not None and not limits[0] < limits[1]:
                raise InputError(f"output.{name} = {list(limits)}: the second value must exceed the first")
