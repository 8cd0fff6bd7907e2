"""The states of the edge flow along its curve: approached from far away, and from elsewhere where that fails.

Under strong adhesion the first asperities that touch make long waves unstable, and the iteration finds no state at
mean gaps where a billionth of the area touches. Nearer states are reached by adhesion that grows at one mean gap; those
of next to whole contact also from contact outward.
"""

from collections.abc import Callable

import numpy as np

from theory.edge_flow.equilibrium import Equilibrium, Problem

Piece = tuple[Equilibrium, ...]


def curve(problem: Problem, far: float, near: float, highest: float, thorough: bool) -> tuple[tuple[Piece, ...], int]:
    """Pieces of the curve, from far to contact with falling mean gaps in each, and how many states were lost.

    The first piece is the approach, with states that are not converged if it is the only one.

    Parameters
    ----------
    problem : Problem
        What is in equilibrium.
    far, near : float
        Mean gap to begin at, and the one to reach.
    highest : float
        Pressure to reach.
    thorough : bool
        Whether states are sought elsewhere where the approach ends early.
    """

    def passed(state: Equilibrium) -> bool:
        return bool(state.gap <= near and -(state.weights @ problem.traction) >= highest)

    x = problem.gaps
    first = min(int(np.searchsorted(x, far)), x.size - 2)
    approached, ended = _follow(
        problem, problem.solve(float(x[first]), problem.local()), -1, passed, problem.options.lost
    )
    if not (ended and thorough):
        return (tuple(approached),), 0
    sound = _sound(problem, approached)
    pieces, lost = (
        [sound] if len(sound) >= problem.options.fewest else [],
        sum(s.change > problem.tolerance for s in approached),
    )
    last = sound[-1].gap if sound else float(x[first])
    for part in problem.options.starts:
        node = max(int(np.searchsorted(x, x[0] + part * (last - x[0]))), 1)
        start = problem.grown(float(x[node]))
        if start.change > problem.tolerance:
            lost += 1
            continue
        above = last
        farther, _ = _follow(problem, start, 1, lambda state: state.gap >= above, 1)  # noqa: B023
        nearer, ended = _follow(problem, start, -1, passed, problem.options.lost)
        both = [*reversed(_sound(problem, farther)[1:]), *_sound(problem, nearer)]
        both = [state for state in both if state.gap < above]
        lost += ended * problem.options.lost
        if len(both) >= problem.options.fewest:
            pieces.append(both)
            last = both[-1].gap
        if not ended:
            break
    if ended:
        # The flat block's own pressure is passed, and two nodes more.
        beyond = np.flatnonzero((x <= near) & (-problem.traction >= highest))
        node = max(int(beyond[-1]) - 2, 1) if beyond.size else 1
        outward, _ = _follow(
            problem, problem.solve(float(x[node]), problem.local()), 1, lambda state: state.gap >= last, 1
        )
        both = [state for state in reversed(_sound(problem, outward)) if state.gap < last]
        if len(both) >= problem.options.fewest:
            pieces.append(both)
    if not pieces:
        return (tuple(approached),), 0
    return tuple(map(tuple, pieces)), lost


def _sound(problem: Problem, states: list[Equilibrium]) -> list[Equilibrium]:
    return [state for state in states if state.change <= problem.tolerance]


def _follow(
    problem: Problem, start: Equilibrium, way: int, passed: Callable[[Equilibrium], bool], patience: int
) -> tuple[list[Equilibrium], bool]:
    """States from one on towards contact (way −1) or away from it (1), and whether the last ones were lost.

    They are followed until two have passed, one more than asked for: a spline is at its best between its points. They
    lie on nodes: a mean gap between nodes begins as a little scatter about it, whose energy depends on where
    between and would stand in the pressure as a ripple. As many lost in a row as the patience end it.
    """
    x = problem.gaps
    node = int(np.argmin(np.abs(x - start.gap)))
    found = [start]
    sound = found.copy()
    beyond = lost = 0
    while beyond < 2 and lost < patience and 1 < node + (way > 0) < x.size - 1:
        before = node
        aim = int(np.searchsorted(x, x[0] + problem.options.gap_ratio**-way * (x[before] - x[0])))
        node = before + way * max(way * (aim - before), 1)
        node = min(max(node, 1), x.size - 2)
        state = _next(problem, sound, float(x[node]))
        for _ in range(problem.options.halvings):
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
