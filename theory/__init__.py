"""Theories of rough adhesive contact: Persson's, as Yang et al. 2008 used it, the gap flow and the edge flow.

A spectrum, a target, a table, a file (:func:`read_spectrum`) or that of a height array (:func:`spectrum_of`), a solid
and a law or work of adhesion make a theory; each gives states at a pressure: :class:`PerssonTheory`, :func:`gap_flow`,
:func:`edge_flow`, and without adhesion :class:`NonAdhesiveTheory`. Smooth spheres are
:class:`Hertz`, :class:`JKR`, :class:`DMT` and :class:`MaugisDugdale`. Contacts with analytic solutions are in
:mod:`theory.references`, criteria of sticking in :mod:`theory.criteria` (:func:`stickiness`). Whole studies are run by
:func:`contact_study.run` or the command ``persson-theory``.
"""

from contact_study import __version__
from contact_study.physics.laws import LennardJones93, LennardJones104, TractionLaw
from contact_study.physics.roughness.spectrum import (
    RadialSpectrum,
    RoughnessSpectrum,
    SelfAffineSpectrum,
    TabulatedSpectrum,
    spectrum_of,
)
from contact_study.physics.solids import Elasticity, HalfSpace, Layer
from contact_study.physics.spheres import DMT, JKR, Hertz, MaugisDugdale, SphereCurve, SphereTheory
from contact_study.physics.spheres.numbers import maugis_of_tabor, tabor_of_maugis
from contact_study.study.tables import read_spectrum
from theory.criteria import StickinessCriteria, stickiness
from theory.edge_flow.apparent_adhesion import apparent_adhesion
from theory.edge_flow.flow import EdgeFlow, edge_flow
from theory.gap_flow.flow import GapFlow, gap_flow
from theory.gap_flow.state import GapState
from theory.non_adhesive.corrections import NonAdhesiveContact, NonAdhesiveTheory
from theory.non_adhesive.gap_distribution import GapDistribution, dmt_limit, gap_distribution
from theory.persson.separation import SeparationCurve, energy_defect, pull_off_pressure, separation_curve
from theory.persson.theory import PerssonContact, PerssonTheory

__all__ = [
    "DMT",
    "JKR",
    "EdgeFlow",
    "Elasticity",
    "GapDistribution",
    "GapFlow",
    "GapState",
    "HalfSpace",
    "Hertz",
    "Layer",
    "LennardJones93",
    "LennardJones104",
    "MaugisDugdale",
    "NonAdhesiveContact",
    "NonAdhesiveTheory",
    "PerssonContact",
    "PerssonTheory",
    "RadialSpectrum",
    "RoughnessSpectrum",
    "SelfAffineSpectrum",
    "SeparationCurve",
    "SphereCurve",
    "SphereTheory",
    "StickinessCriteria",
    "TabulatedSpectrum",
    "TractionLaw",
    "__version__",
    "apparent_adhesion",
    "dmt_limit",
    "edge_flow",
    "energy_defect",
    "gap_distribution",
    "gap_flow",
    "maugis_of_tabor",
    "pull_off_pressure",
    "read_spectrum",
    "separation_curve",
    "spectrum_of",
    "stickiness",
    "tabor_of_maugis",
]


def __dir__() -> list[str]:
    return sorted(__all__)
