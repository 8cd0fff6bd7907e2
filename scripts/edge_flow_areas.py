"""Contact areas of the edge flow for conditions of the atlas, outside a wall extrapolated from two repulsions."""

from collections.abc import Sequence

import numpy as np

from contact_study.atlas.design import Condition
from contact_study.atlas.loops import AREA_POWER, cores_of, theory_study_of, without_core
from contact_study.physics.laws import TractionLaw
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.study.case import Case, realise
from contact_study.study.study import make_study
from theory import edge_flow
from theory.edge_flow.apparent_adhesion import stronger
from theory.study.case_theories import roughness


def areas_at(condition: Condition, seed: int, pressures: np.ndarray, ratios: Sequence[float]) -> np.ndarray:
    """Areas at pressures (Pa) for each ratio of the work of adhesion, shape (ratios, pressures)."""
    by_core = []
    for core in cores_of(condition):
        case, spectrum = theory_input(condition, seed, pressures, core)
        laws = (stronger(case.law, ratio) for ratio in ratios)
        by_core.append(np.array([areas_of(case, spectrum, law, pressures) for law in laws]))
    return without_core(by_core, AREA_POWER)


def areas_of(case: Case, spectrum: RoughnessSpectrum, law: TractionLaw, pressures: np.ndarray) -> list[float]:
    """Areas under a law at pressures (Pa)."""
    flow = edge_flow(spectrum, case.solid, law, 1.1 * float(pressures.max()))
    states = [flow.at_pressure(float(pressure)) for pressure in pressures]
    return [state.fraction_below(case.contact_distance) for state in states]


def theory_input(
    condition: Condition, seed: int, pressures: np.ndarray, core: float = 0.0
) -> tuple[Case, RoughnessSpectrum]:
    """Return what a theory takes of one surface of a condition at pressures (Pa): its case, and its spectrum."""
    case = make_study(theory_study_of(condition, seed, pressures.tolist(), core)).cases[0]
    return case, roughness(case, realise(case), "surface")
