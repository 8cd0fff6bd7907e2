"""Theories of rough adhesive contact: Persson's, as Yang et al. 2008 used it, the gap flow and the edge flow.

A spectrum, a target, a table, a file (:func:`read_spectrum`) or that of a height array (:func:`spectrum_of`), a solid
and a law or work of adhesion make a theory; each gives states at a pressure: :class:`PerssonTheory`, :func:`gap_flow`,
:func:`edge_flow`, and without adhesion :class:`NonAdhesiveTheory`. Contacts with analytic solutions are in
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
from contact_study.study.tables import read_spectrum
from theory.criteria import StickinessCriteria, stickiness
from theory.edge_flow.flow import EdgeFlow, edge_flow
from theory.gap_flow.flow import GapFlow, gap_flow
from theory.gap_flow.state import GapState
from theory.non_adhesive.corrections import NonAdhesiveContact, NonAdhesiveTheory
from theory.non_adhesive.gap_distribution import GapDistribution, dmt_limit, gap_distribution
from theory.persson.separation import SeparationCurve, energy_defect, pull_off_pressure, separation_curve
from theory.persson.theory import PerssonContact, PerssonTheory

__all__ = [
    "EdgeFlow",
    "Elasticity",
    "GapDistribution",
    "GapFlow",
    "GapState",
    "HalfSpace",
    "Layer",
    "LennardJones93",
    "LennardJones104",
    "NonAdhesiveContact",
    "NonAdhesiveTheory",
    "PerssonContact",
    "PerssonTheory",
    "RadialSpectrum",
    "RoughnessSpectrum",
    "SelfAffineSpectrum",
    "SeparationCurve",
    "StickinessCriteria",
    "TabulatedSpectrum",
    "TractionLaw",
    "__version__",
    "dmt_limit",
    "edge_flow",
    "energy_defect",
    "gap_distribution",
    "gap_flow",
    "pull_off_pressure",
    "read_spectrum",
    "separation_curve",
    "spectrum_of",
    "stickiness",
]


def __dir__() -> list[str]:
    return sorted(__all__)
