"""What was run, in plain words that hold for every case of the studies that the datasets carry."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from contact_study.comparison.labels import coordinate_label
from contact_study.comparison.read.datasets import Inputs
from contact_study.comparison.read.path_points import AVERAGED
from contact_study.comparison.say.findings import MODEL_WORDS
from contact_study.comparison.wording import control_unit, length, listed, listed_points, number, pressure_unit, varied
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.keys import keys_of
from contact_study.problem.units import quantity


def study_paragraphs(inputs: Inputs) -> list[tuple[str, str]]:
    """Heading and text of each part of the question."""
    return [
        ("Surface", _surface(inputs)),
        ("Block", _block(inputs.cases)),
        ("Interaction", " ".join(_interaction(inputs))),
        ("Loading", _loading(inputs)),
        ("Models", " ".join(_models(inputs))),
    ]


def _over(cases: Sequence[Case], show: Callable[[Case], str], last: str = "and") -> str:
    """One value of every case in words, different ones side by side."""
    return varied((show(case) for case in cases), last)


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
        return _over(self.cases, self._of, last or "and")

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
    size = case.surface.size
    return f"{length(size[0])} × {length(size[1])}" if size else "the size of its height map"


def _realisations(inputs: Inputs, cases: Sequence[Case]) -> str:
    seeds = [seed for seed in dict.fromkeys(case.surface.realisation for case in cases) if seed is not None]
    if not seeds:
        return ""
    words = f"; {len(seeds)} realisation{'s' if len(seeds) > 1 else ''} (seed {', '.join(map(str, seeds))})"
    for name, own in inputs.seeds.items():
        if set(own) != set(seeds):
            words += f", {MODEL_WORDS[name]} on seed {', '.join(map(str, own))} only"
    return words


def _block(cases: Sequence[Case]) -> str:
    kinds: dict[str, list[Case]] = {}
    for case in cases:
        kinds.setdefault(case.elasticity.kind, []).append(case)
    solids = [some[0].elasticity.words.format_map(_Values(some, "elasticity")) for some in kinds.values()]
    solid = "".join(solids) if len(solids) == 1 else " or ".join(words or "a half-space, " for words in solids)
    return (
        f"Elastic, {solid}E = {_over(cases, lambda case: _modulus(case.material.youngs_modulus))}, "
        f"ν = {_over(cases, lambda case: f'{case.material.poissons_ratio:g}')}, hence contact modulus "
        f"E* = E/(1 − ν²) = {_over(cases, lambda case: _modulus(case.material.contact_modulus))}."
    )


def _modulus(value: float) -> str:
    unit = pressure_unit(value)
    return f"{number(value / unit.size, 5)} {unit.name}"


def _interaction(inputs: Inputs) -> Iterator[str]:
    hard = [case for case in inputs.cases if not case.law.attracts]
    adhesive = [case for case in inputs.cases if case.law.attracts]
    if not adhesive:
        yield "Hard wall without adhesion; contact is where the pressure is positive."
        return
    models = inputs.models
    users = [
        words
        for words, there in (("continuum", "continuum" in models), ("gap-flow theory", "gap_flow" in models))
        if there
    ]
    of_pairs = [case for case in adhesive if case.law.of_pairs]
    if of_pairs:
        pair = ""
        depths = [case.interaction.well_depth for case in of_pairs if case.interaction.well_depth is not None]
        if depths:
            meV = quantity("1 meV", "J", "well_depth")
            pair = f" of atoms with ε₀ = {varied(f'{depth / meV:.4g} meV' for depth in depths)}"
        made = listed(case.law.words for case in of_pairs)
        yield (
            f"Lennard-Jones{pair}, r₀ = {_over(of_pairs, lambda case: length(case.law.length))}"
            f"{f'; {made} traction-separation law for {listed(users)}' if users else ''}."
        )
    for law in inputs.laws:
        if law.attracts and not law.of_pairs:
            own = [case for case in adhesive if isinstance(case.law, law)]
            yield f"{law.words}, of length {_over(own, lambda case: length(case.law.length))}."
    yield f"Work of adhesion Δγ = {_over(adhesive, lambda case: f'{case.work_of_adhesion:.4g}')} J/m²."
    by_distance = [case for case in adhesive if case.contact_distance > 0]
    if by_distance:
        yield f"Gaps below {_over(by_distance, lambda case: length(case.contact_distance))} count as contact."
    if len(by_distance) < len(adhesive):
        yield "At a wall that attracts, points that touch it count as contact."
    if hard:
        where = listed_points(_label(inputs, case) for case in hard)
        yield f"At {where} a wall without adhesion, where points under positive pressure count as contact."


def _label(inputs: Inputs, case: Case) -> str:
    """The point of the sweep of a case, its seed aside."""
    units = {name: swept.units for study in inputs.studies.values() for name, swept in study.sweep.items()}
    return ", ".join(
        coordinate_label(name, value, units[name]) for name, value in case.coordinates.items() if name != AVERAGED
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
    if "theory" in inputs.models and any(law.attracts for law in inputs.laws):
        words += " Persson's theory starts on the adhered branch, each state from the one before."
    if "gap_flow" in inputs.models:
        words += " The gap-flow theory gives the equilibrium at each point, whatever came before."
    return words


def _starts(inputs: Inputs) -> str:
    """Where the states of the simulations start: adhesion leaves several, and the start chooses among them."""
    atoms = inputs.models.get("atomistic")
    predictor = str(atoms.attrs.get("predictor", "")).partition(" ")[0] if atoms is not None else ""
    if predictor:
        own = " The continuum starts from separation and follows the path." if "continuum" in inputs.models else ""
        return (
            f"{own} The atoms start each state from the continuum's gap field ({predictor}): where adhesion leaves "
            "them several states, this chooses the continuum's branch, not that of their own way from separation."
        )
    if atoms is not None or "continuum" in inputs.models:
        return " The simulations start from separated surfaces and follow the path."
    return ""


def _models(inputs: Inputs) -> Iterator[str]:
    """Each model's own choices, of all cases of its own study."""
    if "continuum" in inputs.studies:
        yield _continuum(inputs.studies["continuum"].cases)
    if "atomistic" in inputs.studies:
        yield _atoms(inputs.studies["atomistic"].cases)
    if "theory" in inputs.studies:
        yield _theories(inputs.studies["theory"].cases)


def _continuum(cases: Sequence[Case]) -> str:
    def points(case: Case) -> str:
        shape = case.surface.shape
        return f"{shape[0]} × {shape[1]} points" if shape else "the height map's points"

    accuracies = []
    for hard, words in (
        (False, "residual stress below {} E*"),
        (True, "contact condition violated by less than {} h_rms"),
    ):
        of_law = [case for case in cases if case.law.attracts != hard]
        if of_law:
            accuracies.append(words.format(_over(of_law, lambda case: number(case.solver.tolerance, 3))))
    return f"Continuum: {_over(cases, points)}, {' or, at the hard wall, '.join(accuracies)}."


def _atoms(cases: Sequence[Case]) -> str:
    def across(counts: tuple[int, int]) -> str:
        return f"{counts[0]} × {counts[1]}"

    def layers(case: Case) -> str:
        rows, columns = case.lattice.atoms
        count = case.block_layers
        return f"{count} layers ({rows * columns * count:,} atoms)"

    try:
        return (
            f"Atoms: bottom layer of {_over(cases, lambda case: across(case.lattice.atoms))} atoms (lattice constant "
            f"{_over(cases, lambda case: length(case.material.lattice_constant or 0))}) on "
            f"{_over(cases, lambda case: across(case.lattice.substrate_sites))} substrate sites, block of "
            f"{_over(cases, layers)} condensed exactly, potential cut off at "
            f"{_over(cases, lambda case: f'{case.atomistic.cutoff:g}')} r₀, temperature 0 K."
        )
    except InputError:
        return "Atoms: as their dataset says."


def _theories(cases: Sequence[Case]) -> str:
    spectra = {"analytic": "the target spectrum", "surface": "the spectrum of the very surface"}
    caps = {False: "no limit to σ_a", True: "σ_a limited to σ_max"}
    chosen = {case.theory.cap_detachment_stress for case in cases}
    cap = "" if chosen == {False} else f", {_over(cases, lambda case: caps[case.theory.cap_detachment_stress])}"
    return (
        f"Theories: {_over(cases, lambda case: spectra[case.theory.spectrum])}; in Persson's theory elastic energy "
        f"weight {_over(cases, lambda case: f'“{case.theory.energy_weight}”')} "
        f"(β = {_over(cases, lambda case: f'{case.theory.beta:g}')}), true area "
        f"{_over(cases, lambda case: f'“{case.theory.true_area}”')}, "
        f"α = {_over(cases, lambda case: f'{case.theory.alpha:g}')}{cap}."
    )
