"""Contacts with analytic solutions, to hold a calculation against: a paraboloid, and waves in one and two directions.

All in SI; pressures and forces are positive in compression. Arguments are numbers or arrays that broadcast.
"""

from theory.references.paraboloid import (
    dmt_contact_radius,
    dmt_pull_off_force,
    hertz_approach,
    hertz_contact_radius,
    hertz_pressure,
    jkr_approach,
    jkr_contact_radius,
    jkr_pull_off_force,
    maugis_dugdale_contact,
    maugis_dugdale_pull_off,
    maugis_parameter,
    tabor_parameter,
)
from theory.references.waves import (
    egg_box_full_contact_pressure,
    egg_box_heavy_area,
    egg_box_light_area,
    wave_adhesion,
    wave_full_contact_pressure,
    wave_relative_area,
    wave_relative_mean_gap,
    wave_relative_pressure,
)

__all__ = [
    "dmt_contact_radius",
    "dmt_pull_off_force",
    "egg_box_full_contact_pressure",
    "egg_box_heavy_area",
    "egg_box_light_area",
    "hertz_approach",
    "hertz_contact_radius",
    "hertz_pressure",
    "jkr_approach",
    "jkr_contact_radius",
    "jkr_pull_off_force",
    "maugis_dugdale_contact",
    "maugis_dugdale_pull_off",
    "maugis_parameter",
    "tabor_parameter",
    "wave_adhesion",
    "wave_full_contact_pressure",
    "wave_relative_area",
    "wave_relative_mean_gap",
    "wave_relative_pressure",
]
