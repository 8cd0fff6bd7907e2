"""Hard wall without adhesion: a constraint, not a potential.

The surfaces may touch but not interpenetrate and exert no force at a distance (Signorini conditions): gap >= 0,
pressure >= 0, gap × pressure = 0. There is no energy to differentiate, hence no traction of the gap; a solver must
know the constraint.
"""

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class HardWall:
    """Gap >= 0, pressure >= 0, gap × pressure = 0; the numbers that a :class:`TractionLaw` gives are all zero.

    Contact is where the pressure is positive.

    Attributes
    ----------
    work_of_adhesion : float
        None to gain (J/m²).
    length : float
        It has none, and no range (m).
    equilibrium_distance : float
        Gap in contact (m).
    peak_tensile_stress : float
        No tension anywhere (Pa).
    """

    work_of_adhesion: ClassVar[float] = 0.0
    length: ClassVar[float] = 0.0
    equilibrium_distance: ClassVar[float] = 0.0
    peak_tensile_stress: ClassVar[float] = 0.0
