"""One law of every kind that a study knows, all with the paper's work of adhesion but the ones that have none."""

import numpy as np

from contact_study.physics import laws

R0 = 3.28e-10
WORK = 0.69

# What an electronic-structure calculation would give: the 10-4 law at a hundred gaps.
TABLE_GAPS = R0 * np.concatenate([np.linspace(0.75, 2, 60), np.geomspace(2.05, 8, 40)])
TABLE_TRACTIONS = laws.LennardJones104(WORK, R0).traction(TABLE_GAPS)

EVERY_LAW = {
    "lennard_jones_10_4": laws.LennardJones104(WORK, R0),
    "lennard_jones_9_3": laws.LennardJones93(WORK, R0),
    "morse": laws.Morse(WORK, R0, 0.6e-10),
    "exponential_core": laws.ExponentialCore(WORK, R0, 1.74e-10, 0.4e-10),
    "dugdale_core": laws.DugdaleCore(WORK, R0, 2.4e-10, 0.3e-10, ramp=0.2),
    "tabulated": laws.TabulatedLaw.through(TABLE_GAPS, TABLE_TRACTIONS),
    "exponential": laws.Exponential(WORK, 1.74e-10),
    "dugdale": laws.Dugdale(WORK, 3.66e-10),
    "repulsive": laws.Repulsive(0.0, R0, WORK),
    "hard_wall": laws.HardWall(),
}
assert EVERY_LAW.keys() == laws.LAWS.keys()
ADHESIVE = {name: law for name, law in EVERY_LAW.items() if law.attracts}

# The keys of [interaction] that make these laws.
KEYS = {
    "lennard_jones_10_4": {"work_of_adhesion": WORK, "length": R0},
    "lennard_jones_9_3": {"work_of_adhesion": WORK, "length": R0},
    "morse": {"work_of_adhesion": WORK, "length": R0, "range": "0.6 angstrom"},
    "exponential_core": {"work_of_adhesion": WORK, "length": R0, "range": 1.74e-10, "core": 0.4e-10},
    "dugdale_core": {"work_of_adhesion": WORK, "length": R0, "range": 2.4e-10, "core": 0.3e-10, "ramp": 0.2},
    "tabulated": {"gap": TABLE_GAPS.tolist(), "traction": TABLE_TRACTIONS.tolist()},
    "exponential": {"work_of_adhesion": WORK, "length": 1.74e-10},
    "dugdale": {"work_of_adhesion": WORK, "length": 3.66e-10},
    "repulsive": {"repulsion": WORK, "length": R0},
    "hard_wall": {},
}
