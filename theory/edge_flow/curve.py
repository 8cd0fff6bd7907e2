"""The states of the edge flow along its curve: approached from far away, and from contact outward where that fails.

Under adhesion that dwarfs the stress of the roughness long waves are unstable at mean gaps between far and contact, and
the iteration finds no state there. Contact itself is next to whole then, and found from its own side.
"""

from collections.abc import Callable

import numpy as np

from theory.edge_flow.equilibrium import Equilibrium, Problem

# Ratio of distances to the lowest node from one mean gap to the next.
_RATIO = 0.85

# Halvings of the step between two mean gaps where the iteration does not find the next, and states that are not found
# in a row before the approach ends.
_HALVINGS, _LOST = 3, 3

# States of a curve followed from contact outward, fewer of which make none.
_FEWEST = 4


def curve(problem: Problem, far: float, near: float, highest: float) -> tuple[tuple[Equilibrium, ...], int, int]:
    """States along falling mean gaps, how many of the last ones were followed outward, and how many others are lost.

    Parameters
    ----------
    problem : Problem
        What is in equilibrium.
    far, near : float
        Mean gap to begin at, and the one to reach.
    highest : float
        Pressure to reach.
    """

    def passed(state: Equilibrium) -> bool:
        return bool(state.gap <= near and -(state.weights @ problem.traction) >= highest)

    x = problem.gaps
    approached, ended = _follow(problem, min(int(np.searchsorted(x, far)), x.size - 2), -1, passed, _LOST)
    if not ended or len(approached) < _LOST + _FEWEST:
        return tuple(approached), 0, 0
    approached = approached[:-_LOST]  # the energies of lost states would stand in the pressures beside them
    # The flat block's own pressure is passed, and two nodes more.
    beyond = np.flatnonzero((x <= near) & (-problem.traction >= highest))
    first = max(int(beyond[-1]) - 2, 1) if beyond.size else 1
    last = approached[-1].gap
    outward, _ = _follow(problem, first, 1, lambda state: state.gap >= last, 1)
    sound = [state for state in outward if state.change <= problem.tolerance and state.gap < last]
    if len(sound) < _FEWEST:
        sound = []
    return (*approached, *reversed(sound)), len(sound), _LOST


def _follow(
    problem: Problem, node: int, way: int, passed: Callable[[Equilibrium], bool], patience: int
) -> tuple[list[Equilibrium], bool]:
    """States from a node on towards contact (way −1) or away from it (1), and whether the last ones were lost.

    They are followed until two have passed, one more than asked for: a spline is at its best between its points. They
    lie on nodes: a mean gap between nodes begins as a little scatter about it, whose energy depends on where
    between and would stand in the pressure as a ripple. As many lost in a row as the patience end it.
    """
    x = problem.gaps
    found = [problem.solve(float(x[node]), problem.local())]
    sound = found.copy()
    beyond = lost = 0
    while beyond < 2 and lost < patience and 1 < node + (way > 0) < x.size - 1:
        before = node
        aim = int(np.searchsorted(x, x[0] + _RATIO**-way * (x[before] - x[0])))
        node = before + way * max(way * (aim - before), 1)
        state = _next(problem, sound, float(x[node]))
        for _ in range(_HALVINGS):
            if state.change <= problem.tolerance or abs(node - before) == 1:
                break
            node = before + way * (abs(node - before) // 2)
            state = _next(problem, sound, float(x[node]))
        found.append(state)
        if state.change <= problem.tolerance:
            sound = [sound[-1], state]
            lost = 0
        else:
            lost += 1
        beyond += passed(state)
    return found, lost >= patience


def _next(problem: Problem, sound: list[Equilibrium], gap: float) -> Equilibrium:
    """The state at a mean gap, from the one or two last ones that converged."""
    return problem.solve(gap, problem.between(sound, gap))
