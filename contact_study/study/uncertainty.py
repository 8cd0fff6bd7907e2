"""Section ``[uncertainty]``: distributions of keys of a study, and the quasi-random draws that become its cases.

Draw 0 is the central case, every key at its median. The others are points of a scrambled Sobol sequence, so that more
draws continue fewer. A draw is one value of the swept key ``uncertainty.draw``.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, read, split
from contact_study.study.schema.keys import keys_of, suggestion

SECTION, DRAW = "uncertainty", "uncertainty.draw"
_PARAMETERS = {
    "normal": ("mean", "error", "relative_error"),
    "lognormal": ("mean", "median", "error", "relative_error"),
    "uniform": ("low", "high"),
    "loguniform": ("low", "high"),
    "values": ("values",),
}
_NOT_DRAWN = ("theory.spectrum_path", "surface.spectrum_path", "loading.path", "loading.unload")
# Share of a distribution beyond which a key need not accept its values: a draw of millions.
_BEYOND = 1e-6


@dataclass(frozen=True)
class Distribution:
    """The distribution of one key: its kind and two numbers in SI, or the values among which draws choose."""

    kind: str
    first: float = 0.0  # mean, mean of the logarithm, or lower end
    second: float = 0.0  # standard deviation, that of the logarithm, or upper end
    values: tuple[Any, ...] = ()

    def at(self, share: float) -> Any:
        """Value below which this share of the distribution lies; of ``values`` the one in its place."""
        if self.kind == "values":
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        if self.kind in ("normal", "lognormal"):
            found = self.first + self.second * float(ndtri(share))
        else:
            ends = (self.first, self.second) if self.kind == "uniform" else np.log([self.first, self.second])
            found = float(ends[0] + (ends[1] - ends[0]) * share)
        return math.exp(found) if self.kind in ("lognormal", "loguniform") else found


@dataclass(frozen=True)
class Uncertainty:
    """The distributions of a study by their dotted keys, and their draws."""

    distributions: Mapping[str, Distribution]
    seed: int = 1
    correlation: tuple[tuple[str, str, float], ...] = field(default=())

    @property
    def keys(self) -> tuple[str, ...]:
        return tuple(self.distributions)

    @cached_property
    def _root(self) -> np.ndarray:
        """Cholesky factor of the correlation of the normal scores."""
        matrix = np.eye(len(self.keys))
        for one, other, value in self.correlation:
            places = self.keys.index(one), self.keys.index(other)
            matrix[places] = matrix[places[::-1]] = value
        try:
            return np.linalg.cholesky(matrix)
        except np.linalg.LinAlgError:
            raise InputError(
                "uncertainty.correlation: no distribution has these correlations; make them smaller"
            ) from None

    def shares(self, draws: Sequence[int]) -> np.ndarray:
        """Share of each key's distribution below its value, shape (draws, keys); one half at draw 0."""
        points = _sobol(len(self.keys), self.seed, max(draws, default=0))
        found = np.vstack([np.full(len(self.keys), 0.5), points])[list(draws)]
        return ndtr(ndtri(found) @ self._root.T) if self.correlation else found

    def values(self, draws: Sequence[int]) -> list[dict[str, Any]]:
        """Value of each key at each draw, as a study's table holds it, numbers in SI."""
        rows = self.shares(draws).tolist()
        distributions = self.distributions.items()
        return [{key: one.at(share) for (key, one), share in zip(distributions, row, strict=True)} for row in rows]


@lru_cache(maxsize=4)
def _sobol(dimensions: int, seed: int, count: int) -> np.ndarray:
    """The first points of a scrambled Sobol sequence, shape (count, dimensions), none at 0 or 1."""
    from scipy.stats import qmc  # slow to import

    power = max(0, math.ceil(math.log2(max(count, 1))))
    points = qmc.Sobol(dimensions, seed=np.random.default_rng(seed)).random_base2(power)[:count]
    return np.clip(points, 1e-12, 1 - 1e-12)


def uncertainty_of(table: Mapping[str, Any]) -> Uncertainty | None:
    """The distributions that a study's table declares, None if it declares none; InputError if one cannot be used."""
    section = table.get(SECTION, {})
    found: dict[str, Distribution] = {}
    for dotted, given in _flat(section).items():
        name, key = split(dotted, SECTION)
        if name in (*WHOLE_STUDY, SECTION) or dotted in _NOT_DRAWN:
            raise InputError(f"uncertainty.{dotted}: is one for the whole study and cannot be drawn")
        if dotted in table.get("sweep", {}):
            raise InputError(f"uncertainty.{dotted}: is swept, too; leave it out of [sweep] or of [uncertainty]")
        found[dotted] = _distribution(dotted, given, table.get(name, {}).get(key))
    if not found:
        return None
    made = Uncertainty(found, int(section.get("seed", 1)), tuple(_correlations(section.get("correlation", []), found)))
    _ = made._root
    return made


def with_draws(table: dict[str, Any]) -> dict[str, Any]:
    """The table with its number of draws replaced by a sweep over them; InputError if they cannot be made."""
    section = table.get(SECTION)
    if not section:
        return table
    swept, given = dict(table.get("sweep", {})), {**section, **_flat(section)}
    for name in {dotted.partition(".")[0] for dotted in _flat(section)}:
        given.pop(name, None)  # written without quotes, material.youngs_modulus = …
    draws = given.pop("draws", None)
    if draws is not None:
        keys_of(SECTIONS[SECTION])["draws"].read(draws, "uncertainty.draws")
    found = {**table, SECTION: given}
    if uncertainty_of(found) is None:
        raise InputError('uncertainty: names no key; give one, such as "material.youngs_modulus" = { distribution = …')
    if DRAW not in swept and "draw" not in given:
        if draws is None:
            raise InputError("missing key uncertainty.draws (integer: number of draws beside the central case)")
        found["sweep"] = {**swept, DRAW: list(range(draws + 1))}
    return found


def _flat(section: Mapping[str, Any]) -> dict[str, Any]:
    """The distributions of a section by dotted keys, with or without quotes in the file."""
    found = {}
    own = keys_of(SECTIONS[SECTION])
    for name, given in section.items():
        if name in own or name == "correlation":
            continue
        if "." in name:
            found[name] = given
        elif name in SECTIONS and isinstance(given, Mapping):
            found |= {f"{name}.{key}": value for key, value in given.items()}
        else:
            close = suggestion(name, [*own, "correlation", *SECTIONS])
            raise InputError(f'unknown key uncertainty.{name}{close}; expected "section.key" = {{ distribution = … }}')
    return found


def _distribution(dotted: str, given: Any, own: Any) -> Distribution:
    """Read the distribution of a key whose study has the value ``own``, if any."""
    where = f"uncertainty.{dotted}"
    if not isinstance(given, Mapping):
        raise InputError(f'{where} = {given!r}: expected {{ distribution = "normal", mean = …, error = … }}')
    kind = given.get("distribution")
    if kind not in _PARAMETERS:
        raise InputError(f"{where}: distribution = {kind!r}: expected one of {', '.join(_PARAMETERS)}")
    known = _PARAMETERS[kind]
    for name in given:
        if name != "distribution" and name not in known:
            close = suggestion(name, known)
            raise InputError(f'{where}.{name}: distribution = "{kind}" takes {", ".join(known)}{close}')
    if kind == "values":
        return _of_values(dotted, given.get("values"))
    made = _of_ends(dotted, kind, given) if "low" in known else _of_error(dotted, kind, given, own)
    for share in (_BEYOND, 0.5, 1 - _BEYOND) if kind in ("normal", "lognormal") else (0.0, 1.0):
        try:
            read(dotted, made.at(share))
        except InputError as error:
            remedy = '; use "lognormal", or a smaller error' if kind == "normal" else ""
            raise InputError(
                f"{where}: its {kind} distribution reaches a value that the key refuses: {error}{remedy}"
            ) from None
    return made


def _of_values(dotted: str, values: Any) -> Distribution:
    if not isinstance(values, list) or not values:
        raise InputError(f"uncertainty.{dotted}: needs values = [...], a list of at least one")
    for value in values:
        read(dotted, value, "uncertainty: ")
    return Distribution("values", values=tuple(values))


def _of_ends(dotted: str, kind: str, given: Mapping[str, Any]) -> Distribution:
    low, high = _numbers(dotted, given, "low", "high")
    if not low < high or (kind == "loguniform" and low <= 0):
        positive = " and be positive" if kind == "loguniform" else ""
        raise InputError(
            f"uncertainty.{dotted}: low = {given['low']!r} must be below high = {given['high']!r}{positive}"
        )
    return Distribution(kind, low, high)


def _of_error(dotted: str, kind: str, given: Mapping[str, Any], own: Any) -> Distribution:
    where = f"uncertainty.{dotted}"
    centres = [name for name in ("mean", "median") if name in given]
    errors = [name for name in ("error", "relative_error") if name in given]
    if len(centres) > 1 or len(errors) != 1:
        names = centres if len(centres) > 1 else errors
        words = f"{' and '.join(names)}: give one of the two" if names else "missing error, the standard deviation"
        raise InputError(f"{where}: {words}")
    if not centres and own is None:
        raise InputError(f"{where}: missing mean; the study gives no value of {dotted} either")
    given = given if centres else {**given, "mean": own}
    centre_name = centres[0] if centres else "mean"
    if errors[0] == "error":
        centre, error = _numbers(dotted, given, centre_name, "error")
    else:
        (centre,) = _numbers(dotted, given, centre_name)
        error = abs(centre) * quantity(given["relative_error"], "1", f"{where}.relative_error")
    if error <= 0:
        raise InputError(f"{where}: {errors[0]} = {given[errors[0]]!r}: must be positive")
    if kind == "normal":
        return Distribution(kind, centre, error)
    if centre <= 0:
        raise InputError(
            f"{where}: {centre_name} = {given[centre_name]!r}: a lognormal distribution needs a positive one"
        )
    ratio = (error / centre) ** 2
    if centre_name == "median":  # variance = median² w (w − 1), w = exp of the logarithm's variance
        return Distribution(kind, math.log(centre), math.sqrt(math.log(0.5 * (1 + math.sqrt(1 + 4 * ratio)))))
    spread = math.log1p(ratio)
    return Distribution(kind, math.log(centre) - 0.5 * spread, math.sqrt(spread))


def _numbers(dotted: str, given: Mapping[str, Any], *names: str) -> list[float]:
    """Numbers of a distribution in SI; InputError unless all have the key's unit, or none has one."""
    where = f"uncertainty.{dotted}"
    section, key = split(dotted, SECTION)
    unit = keys_of(SECTIONS[section])[key].unit or "1"
    for name in names:
        if name not in given:
            raise InputError(f"{where}: missing {name}")
    if len({isinstance(given[name], str) for name in names if given[name] != 0}) > 1:
        words = " and ".join(f"{name} = {given[name]!r}" for name in names)
        raise InputError(f"{where}: units mixed, {words}: give both with a unit, or both without")
    return [quantity(given[name], unit, f"{where}.{name}") for name in names]


def _correlations(given: Any, found: Mapping[str, Distribution]) -> list[tuple[str, str, float]]:
    """Read pairs of keys with the correlation of their normal scores."""
    if not isinstance(given, list) or not all(isinstance(item, list) and len(item) == 3 for item in given):
        raise InputError('uncertainty.correlation: expected a list of ["section.key", "section.key", number]')
    for one, other, value in given:
        if lacking := [key for key in (one, other) if key not in found]:
            raise InputError(f"uncertainty.correlation: {lacking[0]!r} has no distribution")
        if one == other or not -1 < quantity(value, "1", "uncertainty.correlation") < 1:
            raise InputError(
                f"uncertainty.correlation: [{one}, {other}, {value!r}] needs two keys and a number in (-1, 1)"
            )
    return [(one, other, float(value)) for one, other, value in given]
