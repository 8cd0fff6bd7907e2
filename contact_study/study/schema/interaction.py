"""What a study file says of the interaction across the interface."""

from dataclasses import dataclass

from contact_study.errors import InputError
from contact_study.study.schema.keys import key, or_word, quantity, text


@dataclass(frozen=True, kw_only=True)
class InteractionSection:
    """The interaction across the interface.

    A law that needs keys of its own, or other checks, gives its :attr:`TractionLaw.section` a subclass.
    """

    law: str = key(text(), "traction-separation law of the continuum", "lennard_jones_10_4")
    well_depth: float | None = key(
        quantity("J", positive=True), "ε of the pair potential between two layers of atoms (10-4 law)", None
    )
    work_of_adhesion: float | None = key(quantity("J/m^2", positive=True), "Δγ, in place of well_depth", None)
    well_depth_ratio: float = key(quantity("1", positive=True), "multiplies well_depth or work_of_adhesion", 1.0)
    length: float | None = key(
        or_word(quantity("m", positive=True), "auto"),
        "the law's length: distance of zero stress (laws with a core; 10-4: r0 of the pairs, 9-3: z0), range "
        "(exponential wall), reach (Dugdale); auto: the longest that leaves contacts JKR-like",
        None,
    )
    contact_distance: float | None = key(
        quantity("m", positive=True),
        "gaps below it count as contact, default 2^(1/6) length; outside a wall, touching it",
        None,
    )

    def __post_init__(self):
        if self.well_depth is not None and self.work_of_adhesion is not None:
            raise InputError("interaction.well_depth and interaction.work_of_adhesion: give one of the two, not both")

    def _check_adhesion(self) -> None:
        """A law with adhesion has a strength and a length."""
        if self.well_depth is None and self.work_of_adhesion is None:
            raise InputError(
                f'missing key interaction.well_depth or interaction.work_of_adhesion: law = "{self.law}" needs one'
            )
        if self.length is None:
            raise InputError(f'missing key interaction.length: law = "{self.law}" needs it')


@dataclass(frozen=True, kw_only=True)
class SmoothInteraction(InteractionSection):
    """A law with a repulsive core, whose length is its equilibrium distance."""

    def __post_init__(self):
        super().__post_init__()
        self._check_adhesion()
        assert self.length is not None  # just checked
        if self.contact_distance is not None and self.contact_distance <= self.length:
            raise InputError(
                f"interaction.contact_distance = {self.contact_distance:g} m: must exceed the equilibrium distance, "
                f"interaction.length = {self.length:g} m"
            )


@dataclass(frozen=True, kw_only=True)
class PlainAdhesion(InteractionSection):
    """A law that no pair of atoms stands for: its adhesion is given as Δγ."""

    def __post_init__(self):
        super().__post_init__()
        if self.well_depth is not None:
            raise InputError(
                f'interaction.well_depth: law = "{self.law}" is not made of pairs of atoms; '
                "give interaction.work_of_adhesion"
            )
        self._check_adhesion()


@dataclass(frozen=True, kw_only=True)
class PlainSmooth(PlainAdhesion, SmoothInteraction):
    """A law with a repulsive core whose adhesion is given as Δγ."""
