"""What was run, in plain words that hold for every case of the studies that the datasets carry."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from contact_study.physics.laws import TractionLaw
from contact_study.plots.units import pressure_unit
from contact_study.report.labels import coordinate_label
from contact_study.report.model_settings import over
from contact_study.report.models import TARGET, entry_of, spectrum_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.wording import control_unit, length, listed, listed_points, number, varied
from contact_study.study.case import Case
from contact_study.study.schema.keys import keys_of
from contact_study.units import quantity


def study_paragraphs(inputs: Inputs) -> list[tuple[str, str]]:
    """Heading and text of each part of the question."""
    return [
        ("Surface", _surface(inputs)),
        ("Block", _block(inputs.cases)),
        ("Interaction", " ".join(_interaction(inputs))),
        ("Loading", _loading(inputs)),
        ("Models", " ".join(_models(inputs))),
    ]


def _surface(inputs: Inputs) -> str:
    kinds: dict[str, list[Case]] = {}
    for case in inputs.cases:
        kinds.setdefault(case.surface.kind, []).append(case)
    words = "; ".join(_surfaces_of_a_kind(inputs, cases) for cases in kinds.values())
    return f"{words[0].upper()}{words[1:]}."


def _surfaces_of_a_kind(inputs: Inputs, cases: Sequence[Case]) -> str:
    words = cases[0].surface.words.format_map(_Values(cases, "surface"))
    return words + _realisations(inputs, cases)


class _Values(dict[str, "_Value"]):
    """What stands for a key of a section in the words of its kind."""

    def __init__(self, cases: Sequence[Case], section: str):
        self._cases = cases
        self._section = section

    def __missing__(self, name: str) -> "_Value":
        return _Value(self._cases, self._section, name)


@dataclass(frozen=True)
class _Value:
    """The values of a key over cases, joined by "and" or as the format says."""

    cases: Sequence[Case]
    section: str
    name: str

    def __format__(self, last: str) -> str:
        return over(self.cases, self._of, last or "and")

    def _of(self, case: Case) -> str:
        if self.name == "size":
            return _size(case)
        section = getattr(case, self.section)
        value = getattr(section, self.name)
        if isinstance(value, float):
            in_metres = keys_of(type(section))[self.name].kind == "m"
            return length(value) if in_metres else f"{value:g}"
        return case.surface.phrases.get(value, str(value))


def _size(case: Case) -> str:
    size = case.surface.stated_cell
    return f"{length(size[0])} × {length(size[1])}" if size else "its size from the file"


def _realisations(inputs: Inputs, cases: Sequence[Case]) -> str:
    seeds = [seed for seed in dict.fromkeys(case.surface.realisation for case in cases) if seed is not None]
    if not seeds:
        return ""
    words = f"; {len(seeds)} realisation{'s' if len(seeds) > 1 else ''} (seed {', '.join(map(str, seeds))})"
    for name, own in inputs.seeds.items():
        if set(own) != set(seeds):
            words += f", {entry_of(name).words} on seed {', '.join(map(str, own))} only"
    return words


def _block(cases: Sequence[Case]) -> str:
    kinds: dict[str, list[Case]] = {}
    for case in cases:
        kinds.setdefault(case.elasticity.kind, []).append(case)
    solids = [some[0].elasticity.words.format_map(_Values(some, "elasticity")) for some in kinds.values()]
    solid = "".join(solids) if len(solids) == 1 else " or ".join(words or "a half-space, " for words in solids)
    moduli = over(cases, lambda case: _modulus(case.solid.contact_modulus))
    isotropic = all(case.solid.contact_modulus == case.material.contact_modulus for case in cases)
    return (
        f"Elastic, {solid}E = {over(cases, lambda case: _modulus(case.material.youngs_modulus))}, "
        f"ν = {over(cases, lambda case: f'{case.material.poissons_ratio:g}')}, hence contact modulus "
        f"{'E* = E/(1 − ν²)' if isotropic else 'E*'} = {moduli}."
        + _boundary({case.elasticity.boundary for case in cases})
    )


def _boundary(boundaries: set[str]) -> str:
    if boundaries == {"periodic"}:
        return ""
    free = " The surface ends with its cell and the block goes on: free boundaries"
    return f"{free}." if boundaries == {"free"} else f"{free}, or both are repeated, as `boundary` says."


def _without_adhesion(inputs: Inputs, law: type[TractionLaw]) -> str:
    if law.has_wall:
        return "Hard wall without adhesion; contact is where the pressure is positive."
    own = [case for case in inputs.cases if isinstance(case.law, law)]
    distance = over(own, lambda case: length(case.contact_distance))
    return f"{law.words[0].upper()}{law.words[1:]} without adhesion; gaps below {distance} count as contact."


def _modulus(value: float) -> str:
    unit = pressure_unit(value)
    return f"{number(value / unit.size, 5)} {unit.name}"


def _interaction(inputs: Inputs) -> Iterator[str]:
    hard = [case for case in inputs.cases if case.law.has_wall and not case.law.attracts]
    soft = [case for case in inputs.cases if not case.law.has_wall and not case.law.attracts]
    adhesive = [case for case in inputs.cases if case.law.attracts]
    if not adhesive:
        yield from (_without_adhesion(inputs, law) for law in inputs.laws)
        return
    users = [entry_of(name).label for name in inputs.models if entry_of(name).feels_law]
    of_pairs = [case for case in adhesive if case.law.of_pairs]
    if of_pairs:
        pair = ""
        depths = [case.interaction.well_depth for case in of_pairs if case.interaction.well_depth is not None]
        if depths:
            meV = quantity("1 meV", "J", "well_depth")
            pair = f" of atoms with ε₀ = {varied(f'{depth / meV:.4g} meV' for depth in depths)}"
        made = listed(case.law.words for case in of_pairs)
        yield (
            f"Lennard-Jones{pair}, r₀ = {over(of_pairs, lambda case: length(case.law.length))}"
            f"{f'; {made} traction-separation law for {listed(users)}' if users else ''}."
        )
    for law in inputs.laws:
        if law.attracts and not law.of_pairs:
            own = [case for case in adhesive if isinstance(case.law, law)]
            yield f"{law.words}, of length {over(own, lambda case: length(case.law.length))}."
    yield f"Work of adhesion Δγ = {over(adhesive, lambda case: f'{case.law.work_of_adhesion:.4g}')} J/m²."
    by_distance = [case for case in adhesive if case.contact_distance > 0]
    if by_distance:
        yield f"Gaps below {over(by_distance, lambda case: length(case.contact_distance))} count as contact."
    if len(by_distance) < len(adhesive):
        yield "At a wall that attracts, points that touch it count as contact."
    if hard:
        where = listed_points(_label(inputs, case) for case in hard)
        yield f"At {where} a wall without adhesion, where points under positive pressure count as contact."
    if soft:
        where = listed_points(_label(inputs, case) for case in soft)
        yield f"At {where} a soft repulsion without adhesion."


def _label(inputs: Inputs, case: Case) -> str:
    """The point of the sweep of a case, its seed aside."""
    units = {name: swept.units for study in inputs.studies.values() for name, swept in study.sweep.items()}
    return ", ".join(
        coordinate_label(name, value, units[name]) for name, value in case.coordinates.items() if name != inputs.average
    )


def _loading(inputs: Inputs) -> str:
    """Each different path, with the points of the sweep that take it."""
    unit = control_unit(inputs.models, inputs.control)
    paths: dict[tuple[tuple[float, ...], bool], list[str]] = {}
    for case in inputs.cases:
        paths.setdefault((case.loading.path, case.loading.unload), []).append(_label(inputs, case))
    ways = []
    for (path, unload), labels in paths.items():
        values = ", ".join(number(value / unit.size, 5) for value in path)
        where = f" ({listed_points(labels)})" if len(paths) > 1 else ""
        ways.append(f"{values} {unit.name}{where}{', then back through the same values' if unload else ''}")
    words = f"Prescribed mean {inputs.control}, in this order: {'; '.join(ways)}."
    words += _starts(inputs)
    theories = [entry_of(name) for name in inputs.models if not entry_of(name).simulation]
    adhesive = any(law.attracts for law in inputs.laws)
    return words + "".join(f" {theory.start}" for theory in theories if adhesive)


def _starts(inputs: Inputs) -> str:
    """Where the states of the simulations start: adhesion leaves several, and the start chooses among them."""
    simulations = {name: entry_of(name) for name in inputs.models if entry_of(name).simulation}
    # A dataset joined of parts names the predictor of each, a line each.
    lines = {name: str(inputs.models[name].attrs.get("predictor", "")).splitlines() for name in simulations}
    fields = {name: listed(line.partition(" ")[0] for line in own) if own else "" for name, own in lines.items()}
    if len(simulations) > 1 and not any(fields.values()):
        return " The simulations start from separated surfaces and follow the path."
    ways = [
        (model.start_predicted if fields[name] else model.start, fields[name]) for name, model in simulations.items()
    ]
    # What starts the others comes first.
    ways.sort(key=lambda way: bool(way[1]))
    return "".join(f" {words.format(predictor=field)}" for words, field in ways)


def _models(inputs: Inputs) -> Iterator[str]:
    """Each model's own choices, of all cases of its own study; once where several share a file."""
    choices = dict.fromkeys((entry_of(name).file, entry_of(name).choices) for name in inputs.models)
    for file, words in choices:
        if words is not None:
            _, _, tail = file.partition(":")
            yield (f"{tail}: " if tail else "") + words(inputs.studies[file].cases)


def sample_notes(inputs: Inputs) -> list[str]:
    """What the deviations mean statistically: whose surfaces they are of, and what their medians are over."""
    seeds = inputs.seeds
    if not seeds:
        return []
    counts = sorted({len(own) for own in seeds.values()})
    surfaces = "one realisation" if counts == [1] else f"{listed((str(count) for count in counts), 'or')} realisations"
    notes = []
    ensembles = [name for name in inputs.models if not entry_of(name).simulation and _knows_the_target(inputs, name)]
    if ensembles:
        target, realised = _slopes(inputs, ensembles), _slopes(inputs, list(seeds))
        notes.append(
            f"A theory with the target spectrum{target} knows no surface, the simulations have {surfaces} of "
            f"it{realised}: the scatter between surfaces enters its deviations from them."
        )
    notes.append(
        f"Medians and extremes are over states of the same {'surface' if counts == [1] else 'surfaces'}, which are no "
        "independent samples."
    )
    return notes


def _knows_the_target(inputs: Inputs, model: str) -> bool:
    own = spectrum_of(model)
    return any((own or case.spectra[0]) == TARGET for case in inputs.studies[entry_of(model).file].cases)


def _slopes(inputs: Inputs, models: Sequence[str]) -> str:
    """Root-mean-square slopes of the surfaces that some models know, in brackets; nothing where none is stored."""
    stored = [inputs.models[name]["rms_slope"].values.ravel() for name in models if "rms_slope" in inputs.models[name]]
    found = np.concatenate([np.empty(0), *stored])
    found = found[np.isfinite(found)]
    if not found.size:
        return ""
    words = dict.fromkeys(number(value, 4) for value in (found.min(), found.max()))
    return f" (rms slope {' to '.join(words)})"
