"""The 10-4 Lennard-Jones law as a Newton solver walks on it, compiled."""

from numba import njit

from bem_adhesion.law_passes import LANDING, LawPasses
from contact_study.problem.laws.base import TractionLaw


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _evaluate(gap, length, prefactor, traction, stiffness):
    """Fused pass over flat arrays; returns Σ[(r0/d)⁴ − (2/5)(r0/d)¹⁰]."""
    total = 0.0
    for i in range(gap.size):
        s = length / gap[i]
        s2 = s * s
        s4 = s2 * s2
        s6 = s4 * s2
        traction[i] = prefactor * s4 * s * (1.0 - s6)
        stiffness[i] = prefactor / length * s6 * (11.0 * s6 - 5.0)
        total += s4 - 0.4 * s4 * s6
    return total


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _advance(gap, step, limit, length, landing, out):
    """Newton step over flat arrays, see :meth:`LawPasses.advance`; tractions in units of the prefactor."""
    tangent = 6.0 / length
    for i in range(gap.size):
        d = gap[i]
        x = step[i]
        s = length / d
        s2 = s * s
        s4 = s2 * s2
        s6 = s4 * s2
        moved = min(max(x, -limit * d), limit * d) + d
        if d < length:
            y = s4 * s * (s6 - 1.0) - s6 * (11.0 * s6 - 5.0) * x / length
            moved = length + min(-y / tangent, limit * length)
        else:
            y = min(tangent * (length - moved), landing)
        # s¹¹ − s⁵ = y for s >= 1. The root is a concave function of y, so its tangents (here at s = 1, 1.1, 1.25
        # and 1.6) bound it from above, as does the linear step; Newton descends from there.
        y_root = max(y, 0.0)
        root = min(1.0 + y_root / 6.0, 1.1 + (y_root - 1.2426067) / 21.210667)
        root = min(root, min(1.25 + (y_root - 8.5897744) / 90.238452, 1.6 + (y_root - 165.4361) / 1176.6948))
        if d < length:
            root = min(root, max(s - s * x / d, s))
        for _ in range(3):
            r2 = root * root
            r4 = r2 * r2
            r10 = r4 * r4 * r2
            root -= (r10 * root - r4 * root - y_root) / (11.0 * r10 - 5.0 * r4)
        out[i] = length / root if y > 0.0 else moved


class LennardJones104Passes(LawPasses):
    """The 10-4 law, compiled."""

    def evaluate(self, gap, traction, stiffness):
        law = self.law
        flat = gap.reshape(-1), law.length, _prefactor(law), traction.reshape(-1), stiffness.reshape(-1)
        return -law.work_of_adhesion * 5 / 3 * float(_evaluate(*flat))

    def advance(self, gap, step, limit, out):
        law = self.law
        landing = LANDING * law.peak_tensile_stress / _prefactor(law)
        _advance(gap.reshape(-1), step.reshape(-1), limit, law.length, landing, out.reshape(-1))


def _prefactor(law: TractionLaw) -> float:
    return 20 * law.work_of_adhesion / (3 * law.length)
