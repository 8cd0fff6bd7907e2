"""A solid whose stiffness K(q) is known at a number of wavenumbers, the same in all directions.

From a finite-element model, a lattice, a graded coating. Between the points E*(q) = 2K/q is a monotone cubic of ln q
(SciPy's ``PchipInterpolator``), beyond them constant: a half-space.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from scipy.interpolate import PchipInterpolator

from contact_study.errors import InputError
from contact_study.physics.solids.base import Elasticity, ElasticitySection, contact_modulus_of
from contact_study.study.schema.keys import key, quantity, sequence, text
from contact_study.study.schema.sections import MaterialSection


@dataclass(frozen=True, eq=False)
class Measured(Elasticity):
    """K through a table.

    Parameters
    ----------
    contact_modulus : float
        E* to quote, and the unit of stresses (Pa).
    wavenumbers : array_like, shape (points,)
        Increasing (1/m).
    stiffnesses : array_like, shape (points,)
        K there (Pa/m), positive.

    Raises
    ------
    ValueError
        If the table is no stiffness.
    """

    wavenumbers: Sequence[float] | np.ndarray
    stiffnesses: Sequence[float] | np.ndarray

    def __post_init__(self) -> None:
        super().__post_init__()
        q, stiffness = (np.asarray(values, dtype=float) for values in (self.wavenumbers, self.stiffnesses))
        if q.ndim != 1 or q.shape != stiffness.shape or q.size < 2:
            raise ValueError("needs at least two wavenumbers, and as many stiffnesses")
        if not (np.all(np.isfinite(q)) and q[0] > 0 and np.all(np.diff(q) > 0)):
            raise ValueError("must have positive wavenumbers in increasing order")
        if not (np.all(np.isfinite(stiffness)) and np.all(stiffness > 0)):
            raise ValueError("must have positive stiffnesses")

    @cached_property
    def _modulus(self) -> PchipInterpolator:
        q = np.asarray(self.wavenumbers, dtype=float)
        return PchipInterpolator(np.log(q), contact_modulus_of(np.asarray(self.stiffnesses, dtype=float), q))

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        q = np.asarray(wavenumber, dtype=float)
        return 0.5 * q * self._modulus(np.log(np.clip(q, self.wavenumbers[0], self.wavenumbers[-1])))

    def keys(self, poissons_ratio: float) -> dict[str, Any]:
        return {"kind": "tabulated", "wavenumber": self.wavenumbers, "stiffness": self.stiffnesses}

    def scaled(self, length: float, stress: float) -> Self:
        return replace(
            super().scaled(length, stress),
            wavenumbers=np.asarray(self.wavenumbers) * length,
            stiffnesses=np.asarray(self.stiffnesses) * (length / stress),
        )


@dataclass(frozen=True, kw_only=True)
class MeasuredSection(ElasticitySection):
    """Keys of a table, from a file whose numbers it becomes when the study is read.

    Attributes
    ----------
    columns : mapping
        Of the file, see :func:`~contact_study.study.reading.tables.with_columns`.
    """

    words = "of tabulated stiffness K(q), quoted by "
    columns: ClassVar[dict[str, tuple[str, str, str]]] = {
        "wavenumber": ("wavenumber_unit", "m^-1", "m^-1"),
        "stiffness": ("stiffness_unit", "Pa/m", "Pa/m"),
    }

    path: str | None = key(text(), "text table of wavenumber and stiffness K, relative to the study file", None)
    wavenumber_unit: str = key(text(), "unit of the wavenumbers in that table", "m^-1")
    stiffness_unit: str = key(text(), "unit of the stiffnesses in that table", "Pa/m")
    wavenumber: tuple[float, ...] | None = key(
        sequence(quantity("m^-1", positive=True)), "wavenumbers of the table, in place of path", None
    )
    stiffness: tuple[float, ...] | None = key(
        sequence(quantity("Pa/m", positive=True)), "stiffnesses at these wavenumbers, in place of path", None
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.path is not None:
            raise InputError("elasticity.path: one table a study; it cannot be swept or overridden")
        if self.wavenumber is None or self.stiffness is None:
            raise InputError(
                f'missing key elasticity.path: kind = "{self.kind}" needs a table, or elasticity.wavenumber and '
                "stiffness"
            )

    def solid(self, material: MaterialSection) -> Measured:
        assert self.wavenumber is not None  # just checked, both
        assert self.stiffness is not None
        try:
            return Measured(material.contact_modulus, self.wavenumber, self.stiffness)
        except ValueError as error:
            raise InputError(f"elasticity: the table of the stiffness {error}") from None
