"""The section ``[interaction]`` of a study file: the keys of each law, and the law that they make."""

from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.laws import LAWS, HardWall, TabulatedLaw, TractionLaw
from contact_study.physics.laws.exponential import RAMP
from contact_study.study.schema import keys
from contact_study.study.schema.keys import FACTOR, METRES, TEXT, key, quantity

# The key that may be left to be chosen, and the word that does so.
LENGTH, AUTO = "interaction.length", "auto"


@dataclass(frozen=True, kw_only=True)
class InteractionSection:
    """The adhesive law; a law with further keys or checks has a subclass."""

    adhesive: ClassVar[bool] = False  # whether it needs a work of adhesion and a length
    refuses: ClassVar[tuple[tuple[str, ...], str]] = (), ""  # keys without use, and why, in words after its name

    law: str = key(TEXT, "traction-separation law of the continuum", "lennard_jones_10_4")
    well_depth: float | None = key(keys.JOULES, "ε of the pair potential between two layers of atoms (10-4 law)", None)
    work_of_adhesion: float | None = key(keys.PER_AREA, "Δγ, in place of well_depth", None)
    well_depth_ratio: float = key(FACTOR, "multiplies well_depth or work_of_adhesion", 1.0)
    length: float | None = key(
        keys.or_word(METRES, AUTO),
        "equilibrium distance, range or reach of the law; auto: longest of JKR-like contacts",
        None,
    )
    contact_distance: float | None = key(
        METRES, "gaps below it count as contact, default 2^(1/6) length; outside a wall, touching it", None
    )

    def __post_init__(self):
        if self.well_depth is not None and self.work_of_adhesion is not None:
            raise InputError("interaction.well_depth and interaction.work_of_adhesion: give one of the two, not both")
        for name in self.refuses[0]:
            if getattr(self, name) is not None:
                raise InputError(f'interaction.{name}: law = "{self.law}" {self.refuses[1]}')
        if not self.adhesive:
            return
        if self.well_depth is None and self.work_of_adhesion is None:
            raise InputError(
                f'missing key interaction.well_depth or interaction.work_of_adhesion: law = "{self.law}" needs one'
            )
        if self.length is None:
            raise InputError(f'missing key interaction.length: law = "{self.law}" needs it')
        cored = not LAWS[self.law].has_wall and self.length != AUTO  # the length is the equilibrium distance
        if cored and self.contact_distance is not None and self.contact_distance <= self.length:
            raise InputError(
                f"interaction.contact_distance = {self.contact_distance:g} m: must exceed the equilibrium distance, "
                f"interaction.length = {self.length:g} m"
            )

    def make_law(self, work_of_adhesion: float) -> TractionLaw:
        """Make the law of these keys, whose fields have the names of the keys, for a work of adhesion (J/m²)."""
        law = LAWS[self.law]
        own = {field.name: getattr(self, field.name) for field in fields(law)[2:]}
        return law(work_of_adhesion, self.length or 0.0, **own)

    @classmethod
    def keys_from(cls, law: TractionLaw) -> dict[str, Any]:
        """Return the keys, without the name, that make a law: the inverse of :meth:`make_law`."""
        own = {field.name: getattr(law, field.name) for field in fields(law)[1:]}
        return own | ({"work_of_adhesion": law.work_of_adhesion} if law.attracts else {})


class SmoothInteraction(InteractionSection):
    """A law with a repulsive core, whose length is its equilibrium distance."""

    adhesive = True


class HardWallInteraction(InteractionSection):
    """A hard wall has no numbers."""

    def make_law(self, work_of_adhesion: float) -> HardWall:
        return HardWall()

    @classmethod
    def keys_from(cls, law: TractionLaw) -> dict[str, Any]:
        return {}


class HalfSpacesInteraction(InteractionSection):
    """Keys of the 9-3 law, whose adhesion does not follow from a pair of layers."""

    adhesive = True

    refuses = (
        ("well_depth",),
        "is that of two half-spaces, whose adhesion needs the number of atoms per volume of both; give "
        "interaction.work_of_adhesion and length = z0 (docs/conventions.md has both from ε, r0 and the densities)",
    )


class PlainAdhesion(InteractionSection):
    """A law that no pair of atoms stands for: its adhesion is given as Δγ."""

    adhesive = True

    refuses = ("well_depth",), "is not made of pairs of atoms; give interaction.work_of_adhesion"


@dataclass(frozen=True, kw_only=True)
class MorseInteraction(PlainAdhesion):
    """Keys of Morse's law."""

    range: float = key(METRES, "length over which the attraction fades")


@dataclass(frozen=True, kw_only=True)
class CoredInteraction(MorseInteraction):
    """Keys of a law with an exponential repulsion."""

    core: float = key(METRES, "decay length of the repulsion")

    def __post_init__(self):
        super().__post_init__()
        longest, what = self.range, "interaction.range"
        if (ramp := getattr(self, "ramp", None)) is not None:  # which the core would outlast
            longest, what = ramp * self.range, "the ramp, interaction.ramp × interaction.range"
        if self.core >= longest:
            raise InputError(
                f"interaction.core = {self.core:g} m: must be shorter than {what}, {longest:g} m, "
                "or nothing is left of the attraction"
            )


_RAMP = quantity("1", positive=True, maximum=0.5), "width of the end of the constant tension, over its reach", RAMP


@dataclass(frozen=True, kw_only=True)
class DugdaleInteraction(PlainAdhesion):
    """Keys of Dugdale's law."""

    ramp: float = key(*_RAMP)


@dataclass(frozen=True, kw_only=True)
class DugdaleCoreInteraction(CoredInteraction):
    """Keys of Dugdale's law with a core, shorter than the ramp at the end of the tension."""

    ramp: float = key(*_RAMP)


@dataclass(frozen=True, kw_only=True)
class RepulsiveInteraction(InteractionSection):
    """Keys of a soft repulsion."""

    refuses = ("well_depth", "work_of_adhesion"), "does not attract; give interaction.repulsion"

    length: float = key(keys.or_word(METRES, AUTO), "gap at which the repulsion begins")
    repulsion: float = key(keys.PER_AREA, "U, its strength: that of the 9-3 law of this work of adhesion")


@dataclass(frozen=True, kw_only=True)
class TabulatedInteraction(InteractionSection):
    """Keys of a tabulated law: a file, or its numbers, which the file's become when the study is read."""

    refuses = ("well_depth", "work_of_adhesion", "length"), "has its own, from the table"
    columns: ClassVar[dict[str, str]] = {"gap": "m", "traction": "Pa"}  # of the file, in SI, see tables.with_columns

    path: str | None = key(TEXT, "text table of gap and traction, tension positive, relative to the study file", None)
    gap_unit: str = key(TEXT, "unit of the gaps in that table", "m")
    traction_unit: str = key(TEXT, "unit of the tractions in that table", "Pa")
    gap: tuple[float, ...] | None = key(keys.sequence(METRES), "gaps of the table, in place of path", None)
    traction: tuple[float, ...] | None = key(
        keys.sequence(quantity("Pa")), "tractions at these gaps, tension positive, in place of path", None
    )

    def __post_init__(self):
        super().__post_init__()
        keys.check_table(self, "interaction", f'law = "{self.law}"')

    def make_law(self, work_of_adhesion: float) -> TabulatedLaw:
        try:
            return TabulatedLaw.through(np.asarray(self.gap), np.asarray(self.traction) * self.well_depth_ratio)
        except ValueError as error:
            raise InputError(f"interaction: the table of the law {error}") from None

    @classmethod
    def keys_from(cls, law: Any) -> dict[str, Any]:
        return {"gap": law.gaps, "traction": law.tractions}


INTERACTIONS = keys.TaggedUnion(
    "law",
    {
        "lennard_jones_10_4": SmoothInteraction,
        "lennard_jones_9_3": HalfSpacesInteraction,
        "morse": MorseInteraction,
        "exponential_core": CoredInteraction,
        "dugdale_core": DugdaleCoreInteraction,
        "tabulated": TabulatedInteraction,
        "exponential": PlainAdhesion,
        "dugdale": DugdaleInteraction,
        "repulsive": RepulsiveInteraction,
        "hard_wall": HardWallInteraction,
    },
)


def register_law(name: str, law: type[TractionLaw], section: type[InteractionSection] = PlainAdhesion) -> None:
    """Make a traction-separation law from outside the package known to studies.

    Parameters
    ----------
    name : str
        Its name in a study, ``interaction.law = name``.
    law : type
        A frozen dataclass; its fields beyond Δγ and length are keys of the section.
    section : type, optional
        Frozen dataclass of its keys. Without one it has ``work_of_adhesion``, ``length`` and ``contact_distance``.

    Returns
    -------
    None

    Raises
    ------
    ValueError
        If there is another law of that name, or a key is taken for another unit.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> import contact_study
    >>> from contact_study.physics.laws import TractionLaw
    >>> @dataclass(frozen=True)
    ... class Cubic(TractionLaw):
    ...     title, words = "cubic", "a law that falls as the cube"
    ...     def potential(self, gap):
    ...         s = self.length / gap
    ...         return self.work_of_adhesion * (s**6 - 2 * s**3)
    >>> contact_study.register_law("cubic", Cubic)
    """
    if LAWS.get(name, law) is not law:
        raise ValueError(f"law = {name!r} is {LAWS[name].__name__}; give another name")
    INTERACTIONS.register(name, section)
    LAWS[name] = law
