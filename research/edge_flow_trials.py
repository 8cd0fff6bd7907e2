"""What was tried to better the edge flow, against the continuum's ensemble, as Markdown.

Phase: beside −f dh the gap may change in quadrature, by −f f' ∇u·∇dh/q², which is what parts the waves q + p and q − p
that a modulation p makes. In second order it leaves the mean response alone, but adds ½ f² f'² <|∇u|²>/q² to the f² by
which a shell spreads the gap. Tried with the edge flow's kernel and with that of second order at c = K, the cost of the
same response.

Branches: V' = s + K u of a scale falls where a wave is unstable. As in the gap flow's branches an approaching block
takes its running minimum from large gaps downward, a retracting one its running maximum from small gaps upward; the
response is that to the slope of this s, which is nowhere below −K. Their pressure is the coarsest traction. The edge
flow itself is also followed from contact outward, each state from the last one.

The simulations are those of ``data/edge_flow_trial_surfaces.csv``, the theory gets the mean spectrum of as many of
their surfaces. Its sweeps are written anew here, plainly, so that they can be changed; the first row, with nothing
changed, checks them.

python -m research.edge_flow_trials --surfaces 12 --table data/edge_flow_trials.csv   # some minutes
python -m research.edge_flow_trials --from data/edge_flow_trials.csv
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.interpolate import PchipInterpolator, make_interp_spline
from scipy.linalg import solve_banded

from contact_study.physics.roughness.spectrum import RadialSpectrum
from contact_study.study.case import realise
from contact_study.study.study import make_study
from research.edge_flow_ensemble import BRANCHES, PRESSURES, SHOWN, study
from research.edge_flow_kernels import PRESSURE, SIMULATIONS, kernels, spectrum_stress
from scripts.harness import Option, head, minus, row, tabulated
from theory import EdgeFlow, edge_flow
from theory.edge_flow.equilibrium import KERNEL, Equilibrium, Problem
from theory.edge_flow.kernels import differences
from theory.gap_flow.state import GapNodes, GapState
from theory.numerics.fixed_point import accelerated

RATIOS = (1.0, 4.0, 8.0)
POINTS = 256  # of the simulations; the spectra are those of the surfaces whatever their points
LEAST = 0.2  # GPa, from which on errors are counted
GAPS, SCALES = 160, 40  # areas within some per cent of those of finer ones, the same for every trial

_GAMMA = 1 - 1 / np.sqrt(2)
_SHARP = 6  # coarse scales taken by the Euler method, as in the edge flow
_BOUNDS = np.log(1e-3), np.log(20.0)
_SWEEPS = 80
_CONVERGED = 1e-3  # largest change of a state that counts
_UNSEEN = 1e-9  # weight below which a node responds by its own curvature


@dataclass(frozen=True)
class Trial:
    """What is changed."""

    words: str
    kernel: tuple[float, float, float] = KERNEL
    phase: bool = False
    branch: str = ""
    outward: bool = False  # from small mean gaps to large ones, each state from the last
    strongest: float = np.inf  # well depth in units of ε0 beyond which its iteration loses states


def trials() -> list[Trial]:
    """Everything that was tried, the edge flow itself first."""
    second_order = kernels()["c = K"]
    return [
        Trial("nothing"),
        Trial("from contact outward", outward=True),
        Trial("phase", phase=True, strongest=4.0),
        Trial("phase, second-order kernel", second_order, phase=True, strongest=4.0),
        Trial("branch of approach", branch="loading"),
        Trial("branch of retraction", branch="unloading", outward=True),
    ]


class TrialProblem:
    """The edge flow's problem with a change."""

    def __init__(self, problem: Problem, trial: Trial):
        self.x, self.traction, self.scales, self.trial = problem.gaps, problem.traction, problem.scales, trial
        self.before, self.behind, self.fall, self.rise, self.cell = differences(problem.gaps)

    def solve(self, gap: float, response: np.ndarray) -> tuple[Equilibrium, float]:
        """The state at a mean gap from a first response, and the coarse traction there."""
        start = np.zeros(self.x.size)
        right = int(np.clip(np.searchsorted(self.x, gap), 1, self.x.size - 1))
        share = (gap - self.x[right - 1]) / (self.x[right] - self.x[right - 1])
        start[right - 1 : right + 1] = 1 - share, share
        found: dict[str, np.ndarray | float] = {}

        def update(logarithm: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
            width = np.exp(logarithm)
            weights, gradients = self.distribution(width, start)
            answer, found["elastic"], found["traction"] = self.answer(width, weights, gradients, gap)
            area = np.maximum(0.5 * (weights[1:] + weights[:-1]), 0.0)
            found["weights"] = weights[0]
            change = float(np.max(np.sum(area * np.abs(answer - width), axis=1)))
            return np.log(answer) - logarithm, np.sqrt(area + _UNSEEN) * width, change

        logarithm, change, sweeps = accelerated(update, np.log(response), _BOUNDS, 1e-5, _SWEEPS)
        state = Equilibrium(gap, found["weights"], found["elastic"], change, sweeps, np.exp(logarithm))  # type: ignore[arg-type]
        return state, float(found["traction"])  # type: ignore[arg-type]

    def diffusion(self, width: np.ndarray, weight: float) -> np.ndarray:
        """1 − weight ½ F² ∂², banded."""
        bands = np.zeros((3, self.x.size))
        factor = weight * width**2
        bands[0, 1:] = -(factor * self.behind)[:-1]
        bands[2, :-1] = -(factor * self.before)[1:]
        bands[1] = 1 + factor * (self.before + self.behind)
        return bands

    def distribution(self, widths: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights and M at the edges of all scales, coarse to fine, in the order of the scales."""
        count = self.scales.steps.size
        weights, gradients = np.zeros((2, count + 1, self.x.size))
        weights[count] = start
        for k in range(count - 1, -1, -1):
            width, euler = widths[k], count - 1 - k < _SHARP
            step = self.scales.steps[k] * (1.0 if euler else _GAMMA)
            bands = _transposed(self.diffusion(width, step))
            early = weights[k] = solve_banded((1, 1), bands, weights[k + 1])
            if not euler:
                again = weights[k + 1] + (1 - _GAMMA) / _GAMMA * (early - weights[k + 1])
                weights[k] = solve_banded((1, 1), bands, again)
            bands = self.stretching(width, step)
            begin = gradients[k + 1] / width**2
            source = step * self.scales.square[k] / self.cell
            middle = solve_banded((1, 1), bands, begin + source * early)
            if not euler:
                again = begin + (1 - _GAMMA) / _GAMMA * (middle - begin)
                middle = solve_banded((1, 1), bands, again + source * weights[k])
            gradients[k] = middle * width**2
        return weights, gradients

    def stretching(self, width: np.ndarray, weight: float) -> np.ndarray:
        """1 − weight (½ F⁻² ∂ F⁴ ∂ + F'²), banded."""
        left, right = weight * self.before[1:-1], weight * self.behind[1:-1]
        before, here, behind = width[:-2], width[1:-1], width[2:]
        bands = np.zeros((3, self.x.size))
        bands[1] = 1.0
        bands[1, 1:-1] += (
            left * before**2 + right * behind**2 - left * (here - before) ** 2 - right * (behind - here) ** 2
        )
        bands[2, :-2] = -left * before**2
        bands[0, 2:] = -right * behind**2
        return bands

    def slope(self, values: np.ndarray) -> np.ndarray:
        found = np.zeros_like(values)
        found[1:-1] = self.fall[1:-1] * np.diff(values)[:-1] + self.rise[1:-1] * np.diff(values)[1:]
        found[[0, -1]] = found[[1, -2]]
        return found

    def answer(
        self, widths: np.ndarray, weights: np.ndarray, gradients: np.ndarray, gap: float
    ) -> tuple[np.ndarray, float, float]:
        """Widths √D of the shells' changes of the gap in equilibrium, the elastic energy, the coarse traction."""
        scales, count = self.scales, self.scales.steps.size
        mean, elastic, found = self.traction.copy(), 0.0, np.empty_like(widths)
        for k in range(count):
            stiffness = scales.stiffness[k]
            mean = self.on_branch(mean, stiffness)
            euler = count - 1 - k < _SHARP
            bands = self.diffusion(widths[k], scales.steps[k] * (1.0 if euler else _GAMMA))
            late = early = solve_banded((1, 1), bands, mean)
            if not euler:
                late = solve_banded((1, 1), bands, mean + (1 - _GAMMA) / _GAMMA * (early - mean))
            curvature = self.slope(0.5 * (mean + late))
            mean = late
            area = np.maximum(0.5 * (weights[k] + weights[k + 1]), 0.0)
            square = 0.5 * (gradients[k] + gradients[k + 1])
            response = self.response(k, curvature, area, square)
            found[k] = response
            if self.trial.phase:
                roughness = np.where(area > _UNSEEN, np.maximum(square, 0) * self.cell / np.maximum(area, _UNSEEN), 0.0)
                found[k] = response * np.sqrt(1 + 0.5 * self.slope(response) ** 2 * roughness / scales.square[k])
            elastic += 0.5 * scales.steps[k] * float(np.sum(area * curvature * (response - found[k] ** 2)))
        return np.clip(found, *np.exp(_BOUNDS)), elastic, float(np.interp(gap, self.x, mean))

    def on_branch(self, mean: np.ndarray, stiffness: float) -> np.ndarray:
        """The traction that a block finds which comes from one side."""
        force = mean + stiffness * self.x
        if self.trial.branch == "loading":
            return np.minimum.accumulate(force[::-1])[::-1] - stiffness * self.x
        if self.trial.branch == "unloading":
            return np.maximum.accumulate(force) - stiffness * self.x
        return mean

    def response(self, k: int, curvature: np.ndarray, area: np.ndarray, square: np.ndarray) -> np.ndarray:
        """f of [κ(X) K + c] f = K, as two coupled tridiagonal systems in one of five bands."""
        slope, level, pole = self.trial.kernel
        stiffness, n = self.scales.stiffness[k], self.x.size
        local = stiffness / (stiffness + np.maximum(curvature, -0.8 * stiffness))
        coupling = np.zeros(n)
        coupling[1:-2] = np.maximum(0.5 * (square[1:-2] + square[2:-1]), 0) / np.diff(self.x)[1:-1]
        coupling /= self.scales.square[k]
        joined = coupling + np.concatenate([[0.0], coupling[:-1]])
        empty = 1e-12 * self.cell
        inner = slice(1, n - 1)
        m = n - 2
        bands, right = np.zeros((5, 2 * m)), np.zeros(2 * m)
        bands[2, 0::2] = (slope * joined + area * (level + curvature / stiffness) + empty)[inner]
        bands[1, 1::2] = ((1 - level) * area)[inner]
        bands[3, 0::2] = (-pole * area)[inner]
        bands[2, 1::2] = (joined + pole * area + empty)[inner]
        bands[0, 2::2] = -slope * coupling[1 : n - 2]
        bands[0, 3::2] = -coupling[1 : n - 2]
        bands[4, 0:-2:2] = -slope * coupling[1 : n - 2]
        bands[4, 1:-2:2] = -coupling[1 : n - 2]
        right[0::2] = (area + empty * local)[inner]
        right[1::2] = (empty * local)[inner]
        local[inner] = solve_banded((2, 2), bands, right)[0::2]
        return local


def _transposed(bands: np.ndarray) -> np.ndarray:
    found = bands.copy()
    found[0, 1:], found[2, :-1] = bands[2, :-1], bands[0, 1:]
    return found


@dataclass(frozen=True)
class Curve:
    """States of a trial that converged, mean gaps rising."""

    pressure: np.ndarray  # Pa
    gap: np.ndarray  # m
    area: np.ndarray
    balance: np.ndarray  # mean of the local pressures (Pa)

    def at(self, pressure: float) -> tuple[float, float, float]:
        """Area, mean gap, local over mean pressure at the largest gap that carries a pressure; else no numbers."""
        crossings = np.flatnonzero((self.pressure[:-1] > pressure) & (self.pressure[1:] <= pressure))
        if crossings.size == 0:
            return np.nan, np.nan, np.nan
        piece = slice(max(crossings[-1] - 3, 0), crossings[-1] + 5)
        falling = self.pressure[piece]
        if not np.all(np.diff(falling) < 0):
            piece = slice(crossings[-1], crossings[-1] + 2)
            falling = self.pressure[piece]
        area, gap, balance = (
            float(PchipInterpolator(falling[::-1], of[piece][::-1])(pressure))
            for of in (self.area, self.gap, self.balance)
        )
        return area, gap, balance / pressure


def curve(flow: EdgeFlow, trial: Trial, contact_distance: float) -> Curve:
    """The states of a trial at the mean gaps of an edge flow's curve."""
    own = TrialProblem(flow._problem, trial)
    order = reversed(flow.equilibria) if trial.outward else flow.equilibria
    found: list[tuple[Equilibrium, float]] = []
    for state in order:
        start = found[-1][0].response if found and (trial.branch or trial.outward) else state.response
        solved = own.solve(state.gap, start)
        if solved[0].change < _CONVERGED:
            found.append(solved)
    found.sort(key=lambda one: one[0].gap)
    states = [state for state, _ in found]
    if len(states) < 6:
        return Curve(*np.empty((4, 0)))
    gaps = np.array([state.gap for state in states])
    if trial.branch:  # no energy is stationary there
        pressure = -np.array([traction for _, traction in found])
    else:
        potential = flow.law.potential(own.x)
        energies = [float(state.weights @ potential) + state.elastic for state in states]
        pressure = -make_interp_spline(gaps, energies, k=5)(gaps, 1)
    unit = flow.contact_modulus
    nodes = GapNodes(flow.law, own.x)
    areas = [
        GapState(("trial",), nodes, flow.length, unit, gap, 0.0, 0.0, state.weights, True).fraction_below(
            contact_distance
        )
        for gap, state in zip(gaps * flow.length, states, strict=True)
    ]
    balance = np.array([-float(state.weights @ own.traction) for state in states])
    return Curve(pressure * unit, (gaps - flow.law.equilibrium_distance) * flow.length, np.array(areas), balance * unit)


def table_of(given: argparse.Namespace) -> pd.DataFrame:
    """A trial, a law and a pressure a row."""
    surfaces = given.surfaces
    cases = make_study(study(surfaces, POINTS, RATIOS)).cases
    found = []
    for number, ratio in enumerate(RATIOS):
        case = cases[number * surfaces]
        every = [realise(one).measured_spectrum() for one in cases[number * surfaces : (number + 1) * surfaces]]
        spectrum = RadialSpectrum(every[0].wavevectors, np.mean([one.variances for one in every], axis=0))
        highest = max(1.1e9 * max(PRESSURES), spectrum_stress(spectrum, case))
        flow = edge_flow(spectrum, case.solid, case.law, highest, gaps=GAPS, scales=SCALES)
        for trial in (one for one in trials() if ratio <= one.strongest):
            print(f"{ratio:g} ε0, {trial.words}", file=sys.stderr, flush=True)
            line = curve(flow, trial, case.contact_distance)
            found += [(trial.words, ratio, pressure, *line.at(1e9 * pressure)) for pressure in PRESSURES]
    columns = ["model", "ratio", "pressure_GPa", *SHOWN, "pressures"]
    return pd.DataFrame(found, columns=columns).assign(surfaces=surfaces)


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: mean signed error in per cent from 0.2 GPa on, a trial and a well depth a line."""
    simulated = pd.read_csv(SIMULATIONS)
    simulated = simulated[simulated["model"] == "continuum"]
    heads = [f"{symbol}, {branch}" for symbol in SHOWN.values() for branch in BRANCHES]
    yield head("changed", "well depth", *heads, "local / mean pressure")
    table = table[table["pressure_GPa"] >= LEAST]
    for (words, ratio), part in table.groupby(["model", "ratio"], sort=False):
        own, cells = part.set_index("pressure_GPa"), []
        for name in SHOWN:
            for branch in BRANCHES:
                chosen = (
                    (simulated["ratio"] == ratio) & (simulated["branch"] == branch) & (simulated["quantity"] == name)
                )
                truth = simulated[chosen].set_index("pressure_GPa")["mean"].reindex(own.index)
                error = 100 * (own[name] / truth - 1)
                cells.append(minus(f"{error.mean():+.1f} %") if error.notna().all() else "–")
        balance = float(own["pressures"].loc[PRESSURE])
        yield row(words, f"{ratio:g} ε0", *cells, f"{balance:.2f}" if np.isfinite(balance) else "–")


main = tabulated(table_of, rows, Option("--surfaces", 12, "number of surfaces, the first of the simulations' ones"))

if __name__ == "__main__":
    sys.exit(main())
