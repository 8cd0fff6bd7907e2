"""Parameters of an inference: names, units, bounds, and what the user prescribes of them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.study.schema.keys import suggestion

WORK, MODULUS, RADIUS, RANGE = "work_of_adhesion", "contact_modulus", "radius", "range"
SCALE, FORCE_ZERO, DISPLACEMENT_ZERO = "force_scale", "force_zero", "displacement_zero"
PHYSICAL = (WORK, MODULUS, RADIUS, RANGE, SCALE)  # shared by all curves, positive, fitted by their logarithm
OFFSETS = (DISPLACEMENT_ZERO, FORCE_ZERO)  # of each curve
# SI unit as the user writes it, unit of a dataset, and meaning.
PARAMETERS: dict[str, tuple[str, str, str]] = {
    WORK: ("J/m^2", "J m-2", "work of adhesion w"),
    MODULUS: ("Pa", "Pa", "contact modulus E*"),
    RADIUS: ("m", "m", "radius R of the probe"),
    RANGE: ("m", "m", "range of adhesion: work of adhesion over the cohesive strength"),
    SCALE: ("1", "1", "measured force over true force, such as by the error of a spring constant"),
    DISPLACEMENT_ZERO: ("m", "m", "measured displacement at first touch of the undeformed surfaces"),
    FORCE_ZERO: ("N", "N", "measured force far from contact"),
}
_OTHER_NAMES = {"modulus": MODULUS}
_PRIOR = re.compile(r"\s*(?P<value>\S+)\s*(?:\+-|±|\+/-)\s*(?P<error>\S+)\s*(?P<unit>.*?)\s*")


@dataclass(frozen=True)
class Prior:
    """A value known beforehand with its standard error (SI); without an error it is fixed."""

    value: float
    error: float = 0.0


def prescribed(fixed: Mapping[str, Any], prior: Mapping[str, Any]) -> dict[str, Prior]:
    """Values that a user fixes, and those with a prior, by the name of the parameter.

    Parameters
    ----------
    fixed, prior : mapping
        Number in SI or text with a unit, ``"10 um"``; priors are a text ``"2 +- 0.2 MPa"`` or a pair of numbers in SI.

    Returns
    -------
    dict of Prior

    Raises
    ------
    InputError
        For an unknown name, a unit of another kind, or an error that is not positive.

    Examples
    --------
    >>> prescribed({"radius": "10 um"}, {"modulus": "2 +- 0.2 MPa"})["contact_modulus"].error
    200000.0
    """
    found: dict[str, Prior] = {}
    for option, given in (("fixed", fixed), ("prior", prior)):
        for name, value in given.items():
            known = _OTHER_NAMES.get(name, name)
            if known not in PARAMETERS:
                raise InputError(
                    f"{option} {name}: is no parameter{suggestion(name, PARAMETERS)}; there is {', '.join(PARAMETERS)}"
                )
            if known in found:
                raise InputError(f"{option} {name}: is given twice; fix it, or give one prior")
            unit = PARAMETERS[known][0]
            one = _prior(value, unit, f"prior {name}") if option == "prior" else Prior(quantity(value, unit, name))
            if known in PHYSICAL and one.value <= 0:
                raise InputError(f"{option} {name} = {value!r}: must be positive")
            found[known] = one
    return found


def _prior(value: Any, unit: str, name: str) -> Prior:
    if isinstance(value, str):
        parts = _PRIOR.fullmatch(value)
        if parts is None:
            raise InputError(f'{name} = {value!r}: expected a value and its error, such as "2 +- 0.2 MPa"')
        pair = [f"{parts[part]} {parts['unit']}".strip() for part in ("value", "error")]
    else:
        pair = list(value)
        if len(pair) != 2:
            raise InputError(f"{name} = {value!r}: expected a value and its error")
    centre, error = (quantity(one, unit, name) for one in pair)
    if error <= 0:
        raise InputError(f"{name} = {value!r}: the error must be positive; fix the value in place of an error of zero")
    return Prior(centre, error)
