"""Theories of a smooth sphere on a half-space, a file each, and the numbers that say which of them holds.

All in SI, compression positive; the displacement is that of the undeformed sphere beyond first touch. Each theory is
functions of numbers or arrays, and a class with the whole curve of equilibrium. A sphere on a sphere counts by
1/R = 1/R₁ + 1/R₂.
"""

from contact_study.physics.spheres.base import SphereCurve, SphereTheory
from contact_study.physics.spheres.dmt import DMT
from contact_study.physics.spheres.hertz import Hertz
from contact_study.physics.spheres.jkr import JKR
from contact_study.physics.spheres.maugis import MaugisDugdale

__all__ = ["DMT", "JKR", "Hertz", "MaugisDugdale", "SphereCurve", "SphereTheory"]
