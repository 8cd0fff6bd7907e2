"""Expansion of an answer in orthonormal functions of independent inputs, and the shares of its variance.

Polynomial chaos: Hermite polynomials of a normal score, Legendre polynomials of a uniform one, contrasts of a choice.
Squares of coefficients are the Sobol shares (B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008)).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.special import ndtri

NORMAL, UNIFORM = "normal", "uniform"


@dataclass(frozen=True)
class Input:
    """An input: normal or uniform score, or a choice among so many values."""

    kind: str = NORMAL
    choices: int = 0

    def functions(self, shares: np.ndarray, order: int) -> np.ndarray:
        """Orthonormal functions, shape (functions, n), of the share of the distribution below a value."""
        if self.choices:
            place = np.minimum((np.asarray(shares) * self.choices).astype(int), self.choices - 1)
            # Contrasts: a basis of what has no mean over the choices, each of mean square one.
            basis = np.linalg.qr(np.hstack([np.ones((self.choices, 1)), np.eye(self.choices)[:, 1:]]))[0][:, 1:]
            return np.sqrt(self.choices) * basis.T[:, place]
        if self.kind == NORMAL:
            x = ndtri(np.asarray(shares))
            every = [x, (x**2 - 1) / np.sqrt(2)]
        else:
            x = 2 * np.asarray(shares) - 1
            every = [np.sqrt(3) * x, np.sqrt(5) * (3 * x**2 - 1) / 2]
        return np.array(every[:order])


@dataclass(frozen=True)
class Expansion:
    """An answer as a constant and a sum of functions of the inputs, each with the inputs that it depends on."""

    inputs: tuple[Input, ...]
    order: int
    pairs: bool
    coefficients: np.ndarray
    owners: tuple[tuple[int, ...], ...]  # inputs of each coefficient but the first
    noise: float  # variance that no function explains
    points: int

    @property
    def variance(self) -> float:
        return float(np.sum(self._squares)) + self.noise

    @property
    def _squares(self) -> np.ndarray:
        """Variance by each function, less what the noise of as many points adds to it."""
        return np.maximum(self.coefficients[1:] ** 2 - self.noise / self.points, 0.0)

    def shares(self) -> tuple[np.ndarray, float, float]:
        """First-order share of each input, that of their pairs, and what the expansion leaves unexplained."""
        total = self.variance
        if total == 0:
            return np.zeros(len(self.inputs)), 0.0, 0.0
        first, joint = np.zeros(len(self.inputs)), 0.0
        for owners, square in zip(self.owners, self._squares, strict=True):
            if len(owners) == 1:
                first[owners[0]] += square
            else:
                joint += float(square)
        return first / total, joint / total, self.noise / total

    def at(self, shares: np.ndarray) -> np.ndarray:
        """The answer at shares (n, inputs) of the distributions."""
        return _columns(self.inputs, np.atleast_2d(shares), self.order, self.pairs)[0] @ self.coefficients


def expansion(inputs: Sequence[Input], shares: np.ndarray, answer: np.ndarray, largest_order: int = 2) -> Expansion:
    """Fit an expansion by least squares, with second order and pairs as far as twice as many points allow.

    Parameters
    ----------
    inputs : sequence of Input
        Inputs.
    shares : numpy.ndarray
        Share of each input's distribution below its value, shape (points, inputs).
    answer : numpy.ndarray
        The answer at each point, finite.
    largest_order : int, optional
        1 for a linear expansion.

    Returns
    -------
    Expansion

    Raises
    ------
    ValueError
        If there are fewer than two points per coefficient.

    Examples
    --------
    >>> import numpy as np
    >>> from contact_study.numerics.expansion import Input, expansion
    >>> points = np.random.default_rng(1).uniform(size=(64, 2))
    >>> found = expansion([Input("uniform"), Input("uniform")], points, points @ [1, 2])
    >>> found.shares()[0].round(3).tolist()
    [0.2, 0.8]
    """
    for order, pairs in ((2, True), (2, False), (1, False)):
        if order > largest_order:
            continue
        columns, owners = _columns(inputs, shares, order, pairs)
        count, terms = columns.shape
        if count >= 2 * terms:
            found, *_ = np.linalg.lstsq(columns, answer, rcond=None)
            left = answer - columns @ found
            noise = float(left @ left) / (count - terms)
            rounding = 1e-24 * float(answer @ answer) / count
            noise = noise if noise > rounding else 0.0
            found[1:][found[1:] ** 2 < rounding] = 0.0
            return Expansion(tuple(inputs), order, pairs, found, tuple(owners), noise, count)
    raise ValueError(f"{len(answer)} points determine no expansion in {len(inputs)} inputs; {2 * terms} do")


def _columns(
    inputs: Sequence[Input], shares: np.ndarray, order: int, pairs: bool
) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    """Functions at the points, shape (points, functions), the constant first, and the inputs of the others."""
    each = [one.functions(shares[:, number], order) for number, one in enumerate(inputs)]
    columns, owners = [np.ones(len(shares))], list[tuple[int, ...]]()
    for number, functions in enumerate(each):
        columns += [*functions]
        owners += [(number,)] * len(functions)
    plain = [number for number, one in enumerate(inputs) if not one.choices]
    for one, other in combinations(plain, 2) if pairs else ():
        columns.append(each[one][0] * each[other][0])
        owners.append((one, other))
    return np.stack(columns, axis=1), owners
