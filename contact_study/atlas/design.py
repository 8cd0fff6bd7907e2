"""Conditions of the contact atlas: a space-filling design, and the smallest grid that resolves each.

Stresses over E* h'/2 and lengths over the cell are all that matters to a linear elastic contact. So cell, modulus and
rms slope are the same for all conditions; roughness, adhesion, law and solid vary.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from contact_study.inputs.errors import InputError
from contact_study.physics.laws import LAWS, TractionLaw
from contact_study.physics.process_zone import jump_number, process_zone, resolving_shape
from contact_study.physics.roughness.spectrum import SelfAffineSpectrum
from contact_study.physics.solids import Elasticity, HalfSpace, Layer
from contact_study.physics.spheres.numbers import tabor_parameter
from contact_study.study.schema.modes import Modes, spectrum_of_modes
from contact_study.study.uncertainty import Distribution, Uncertainty

WHOLE = 250  # conditions of the design
JUMPING = 60  # further conditions whose mean asperity jumps
SURFACES = 4  # of each condition of the whole design

SIZE, MODULUS, POISSONS_RATIO, RMS_SLOPE = 1e-6, 1e9, 0.4, 0.1  # m, Pa, 1, 1
STRESS = 0.5 * MODULUS * RMS_SLOPE  # of full contact with a half-space (Pa)
ROLL_OFF_MODE = 2.0
LARGEST_GRID = 512  # points a side
LONGEST_RANGE = 1.0  # of adhesion, over the rms height
LEAST_JUMP = 1.1  # of the jumping conditions: Maugis' number of the mean asperity over that from which one jumps

RANGES = {
    "hurst_exponent": Distribution("uniform", 0.2, 1.0),
    "cutoff_ratio": Distribution("loguniform", 4.0, 64.0),
    "relative_adhesion": Distribution("loguniform", 0.05, 3.0),
    "tabor_number": Distribution("loguniform", 0.1, 5.0),
    "law": Distribution("values", values=("lennard_jones_10_4", "exponential", "dugdale")),
    "solid": Distribution("values", values=("half_space", "half_space", "half_space", "layer")),
}
DESIGNED = {  # what a condition is, in datasets
    "hurst_exponent": "Hurst exponent",
    "cutoff_ratio": "cutoff over roll-off wavevector",
    "relative_adhesion": "work of adhesion over elastic energy of full contact, by design",
    "tabor_number": "Tabor parameter of the mean asperity, by design",
    "law": "traction-separation law",
    "solid": "solid",
    "points": "points of the grid along a side",
}


@dataclass(frozen=True)
class Condition:
    """One condition of the atlas.

    Attributes
    ----------
    number : int
        Its place in the sequence of points, those refused included.
    hurst_exponent, cutoff_ratio : float
        H, and q_1/q_0.
    relative_adhesion : float
        θ = Δγ/U_full, U_full the elastic energy of full contact with a half-space per area.
    tabor_number : float
        μ of the mean asperity, of radius 2 / rms Laplacian.
    law, solid : str
        As in the sections ``[interaction]`` and ``[elasticity]`` of a study.
    roll_off_mode : float, optional
        q_0, in waves a side.
    """

    number: int
    hurst_exponent: float
    cutoff_ratio: float
    relative_adhesion: float
    tabor_number: float
    law: str
    solid: str
    roll_off_mode: float = ROLL_OFF_MODE

    @property
    def modes(self) -> Modes:
        return 1.0, self.roll_off_mode, self.roll_off_mode * self.cutoff_ratio

    @property
    def thickness(self) -> float:
        """Thickness of a layer: a quarter of the wave of the roll-off (m)."""
        return SIZE / (4 * self.roll_off_mode)

    @cached_property
    def spectrum(self) -> SelfAffineSpectrum:
        """The target spectrum, of the atlas' rms slope."""
        unit = spectrum_of_modes(self.hurst_exponent, SIZE, self.modes, (SIZE, SIZE))
        height = SIZE * RMS_SLOPE / unit.rms_slope
        return spectrum_of_modes(self.hurst_exponent, height, self.modes, (SIZE, SIZE))

    @cached_property
    def elasticity(self) -> Elasticity:
        if self.solid == "half_space":
            return HalfSpace(MODULUS)
        return Layer(MODULUS, POISSONS_RATIO, self.thickness)

    @cached_property
    def work_of_adhesion(self) -> float:
        """Δγ = θ U_full (J/m²), U_full that of a half-space for layers, too."""
        return self.relative_adhesion * float(self.spectrum.full_contact_energy(HalfSpace(MODULUS).stiffness))

    @property
    def length(self) -> float:
        """Length of the law (m)."""
        of_one = tabor_parameter(2 / self.spectrum.rms_laplacian, MODULUS, self.work_of_adhesion, 1.0)
        return float(of_one) / self.tabor_number

    @cached_property
    def traction_law(self) -> TractionLaw:
        return LAWS[self.law](self.work_of_adhesion, self.length)

    @property
    def jump_ratio(self) -> float:
        """Maugis' λ of the mean asperity over that from which one jumps."""
        return jump_number(2 / self.spectrum.rms_laplacian, MODULUS, self.traction_law)

    @cached_property
    def points(self) -> int:
        """Points a side of the smallest grid with four in the process zone and in the shortest wave."""
        shortest = SIZE / self.modes[-1]
        zone = process_zone(self.elasticity.softest_modulus(SIZE, shortest), self.traction_law)
        return resolving_shape((SIZE, SIZE), min(zone, shortest))[0]

    @property
    def refusal(self) -> str:
        """Say why the atlas leaves this condition out; nothing if it does not."""
        if self.points > LARGEST_GRID:
            return f"grid beyond {LARGEST_GRID}²"
        if self.length > LONGEST_RANGE * self.spectrum.rms_height:
            return "range beyond the rms height"
        return ""


def drawn(seed: int = 1) -> Iterator[Condition]:
    """Draw conditions without end, those refused included: points of a scrambled Sobol sequence."""
    space = Uncertainty(RANGES, seed)
    first, count = 1, 64
    while True:
        for number, values in enumerate(space.values(range(first, count + 1)), first):
            yield Condition(number, **values)
        first, count = count + 1, 2 * count


def design(count: int = WHOLE, seed: int = 1, least_jump: float = 0.0) -> tuple[list[Condition], dict[str, int]]:
    """Draw the first conditions that the atlas takes.

    Parameters
    ----------
    count : int, optional
        Number of conditions. A shorter design is the beginning of a longer one, and stands for it.
    seed : int, optional
        Of the scrambled Sobol sequence.
    least_jump : float, optional
        Least :attr:`Condition.jump_ratio`; those below are passed over.

    Returns
    -------
    conditions : list of Condition
        In the order of the sequence.
    refused : dict
        Number of points refused up to the last condition, by reason.

    Raises
    ------
    InputError
        If there is no condition to draw.

    Examples
    --------
    >>> from contact_study.atlas.design import design
    >>> conditions, refused = design(5)
    >>> max(one.points for one in conditions) <= 512
    True
    """
    if count < 1:
        raise InputError(f"conditions = {count}: must be at least 1")
    taken: list[Condition] = []
    refused: dict[str, int] = {}
    for condition in drawn(seed):
        if condition.jump_ratio < least_jump:
            continue
        if reason := condition.refusal:
            refused[reason] = refused.get(reason, 0) + 1
            continue
        taken.append(condition)
        if len(taken) == count:
            break
    return taken, refused
