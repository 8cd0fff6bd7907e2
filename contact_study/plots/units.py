"""The units in which lengths and pressures read well."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Unit:
    """A unit to show a quantity in: its name and its size in SI."""

    name: str
    size: float


def length_unit(largest: float) -> Unit:
    """The unit in which lengths up to ``largest`` (m) read well; ångströms reach up to the cells of atoms."""
    for name, size, limit in (("Å", 1e-10, 2e-7), ("nm", 1e-9, 1e-6), ("µm", 1e-6, 1e-3), ("mm", 1e-3, 1.0)):
        if largest < limit:
            return Unit(name, size)
    return Unit("m", 1.0)


def pressure_unit(largest: float) -> Unit:
    """The unit in which pressures up to ``largest`` (Pa) read well."""
    for name, size in (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)):
        if largest >= size:
            return Unit(name, size)
    return Unit("Pa", 1.0)
