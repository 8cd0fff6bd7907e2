"""What every kind of surface says of itself."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from contact_study.physics.roughness.spectrum import SelfAffineSpectrum
from contact_study.physics.surfaces.realisation import Surface
from contact_study.physics.surfaces.scales import SurfaceScales
from contact_study.study.schema.keys import integer, key, pair, quantity, text

_SIZE = pair(quantity("m", positive=True), broadcast=True)
_SHAPE = pair(integer(minimum=4, maximum=2**31 - 1))


@dataclass(frozen=True, kw_only=True)
class SurfaceSection(ABC):
    """The rigid rough surface; heights point toward the block.

    A kind declares its own keys as fields and checks them in ``__post_init__``.

    Attributes
    ----------
    words : str
        The surface in a sentence; a name in braces is replaced by the values of that key, ``{size}`` by the size of
        the cell. A key that holds a word has its own words in ``phrases``.
    height_key : str
        The key to look at when the heights make no sense.
    rough : bool
        Whether it has any height.
    periodic : bool
        Whether heights and slopes go on over the edge of the cell, so that its spectrum is that of a roughness.
    absent : bool
        Whether the study has a roughness spectrum only, for theories.
    """

    words: ClassVar[str]
    phrases: ClassVar[dict[str, str]] = {}
    height_key: ClassVar[str]
    rough: ClassVar[bool] = True
    periodic: ClassVar[bool] = True
    absent: ClassVar[bool] = False

    kind: str = key(text(), "geometry of the rigid surface")
    size: tuple[float, float] | None = key(_SIZE, "lateral periods (a height map may bring its own)", None)
    shape: tuple[int, int] | None = key(_SHAPE, "points of the continuum grid (a height map may bring its own)", None)

    @abstractmethod
    def realise(self, directory: Path) -> Surface:
        """The heights.

        Parameters
        ----------
        directory : pathlib.Path
            Where relative paths of the study start.

        Raises
        ------
        InputError
            If a height map cannot be read or used.
        """

    @abstractmethod
    def scales(self, directory: Path) -> SurfaceScales:
        """What the study alone says of heights and slopes; parameters and errors as :meth:`realise`."""

    @property
    def stated_cell(self) -> tuple[float, float] | None:
        """Periods along y and x (m) as far as the study alone tells them."""
        return self.size

    def cell(self, directory: Path) -> tuple[float, float] | None:
        """Periods along y and x (m), None if they are not known; parameters and errors as :meth:`realise`."""
        return self.stated_cell

    @property
    def map_path(self) -> str | None:
        """File of the heights as the study writes it; None for a surface that needs none."""
        return None

    @property
    def target_spectrum(self) -> SelfAffineSpectrum | None:
        """The spectrum that a random surface is a sample of."""
        return None

    @property
    def realisation(self) -> int | None:
        """Seed of a random surface."""
        return None


@dataclass(frozen=True, kw_only=True)
class CellSection(SurfaceSection):
    """A surface made on a cell that the study must give."""

    size: tuple[float, float] = key(_SIZE, "lateral periods (a height map may bring its own)")
    shape: tuple[int, int] = key(_SHAPE, "points of the continuum grid (a height map may bring its own)")
