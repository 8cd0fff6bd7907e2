"""A solid whose stiffness is a function of the wavenumber, and solids that a Python module holds."""

import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Self

import numpy as np

from contact_study.inputs.files import content_hash
from contact_study.physics.solids.base import Elasticity


@dataclass(frozen=True, eq=False)
class FunctionSolid(Elasticity):
    """A solid of any stiffness K(q), the same in all directions; nothing holds its mean.

    Parameters
    ----------
    contact_modulus : float
        E* to quote, and the unit of stresses (Pa).
    function : callable
        K (Pa/m) of an array of wavenumbers q > 0 (1/m), of its shape, positive.
    length, stress : float
        Units of the wavenumbers and stiffnesses that the solid is asked for (m, Pa).

    Examples
    --------
    >>> from contact_study.physics.solids import FunctionSolid
    >>> f"{float(FunctionSolid(1e9, lambda q: 5e8 * q).stiffness(1e7)):.3g}"
    '5e+15'
    """

    function: Callable[[np.ndarray], np.ndarray]
    length: float = 1.0
    stress: float = 1.0

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        q = np.asarray(wavenumber, dtype=float)
        found = np.asarray(self.function(q / self.length), dtype=float)
        if found.shape != q.shape or not np.all(np.isfinite(found) & (found > 0)):
            raise ValueError("the stiffness K(q) must be positive and finite, one for each wavenumber")
        return found * (self.length / self.stress)

    def scaled(self, length: float, stress: float) -> Self:
        units = {"length": self.length * length, "stress": self.stress * stress}
        return type(self)(self.contact_modulus / stress, self.function, **units)


@cache
def named(name: str) -> tuple[Any, str]:
    """Import what ``"module:name"`` says; return it with the SHA-256 of its module's file, ValueError if it is none."""
    module_name, _, attribute = name.partition(":")
    if not (module_name and attribute):
        raise ValueError('must be "module:name"')
    try:
        module = importlib.import_module(module_name)
        found = getattr(module, attribute)
    except Exception as error:  # whatever a stranger's module raises
        raise ValueError(
            f"cannot be imported ({error}); Python must find the module, by PYTHONPATH or installed"
        ) from None
    if not (isinstance(found, Elasticity) or callable(found)):
        raise ValueError(f"is a {type(found).__name__}, neither a function K(q) nor an Elasticity")
    return found, content_hash(Path(str(module.__file__)))


def name_of(found: Any) -> str:
    """Return the ``"module:name"`` by which :func:`named` finds an object again; ValueError if there is none."""
    holders = {
        module_name: name
        for module_name, module in list(sys.modules.items())
        if module_name != "__main__" and getattr(module, "__file__", None)
        for name, value in list(vars(module).items())
        if value is found
    }
    own = getattr(found, "__module__", None)  # of an object, that of its class
    if own in holders:
        holders = {own: holders[own]}
    if len(holders) > 1:
        names = " or ".join(f'"{module_name}:{name}"' for module_name, name in holders.items())
        raise ValueError(f"several modules hold it; give {names}")
    for module_name, name in holders.items():
        return f"{module_name}:{name}"
    raise ValueError(
        "no module holds it, so that no run could find it again; put it into a module of your own, such as "
        "my_solids.py, and import it from there"
    )
