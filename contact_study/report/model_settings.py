"""What each model chose for itself, in a sentence that holds for all cases of its study."""

from collections.abc import Callable, Sequence

from contact_study.errors import InputError
from contact_study.report.wording import length, number, varied
from contact_study.study.case import Case


def over(cases: Sequence[Case], show: Callable[[Case], str], last: str = "and") -> str:
    """One value of every case in words, different ones side by side."""
    return varied((show(case) for case in cases), last)


def continuum(cases: Sequence[Case]) -> str:
    """Grid and tolerance."""

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
            accuracies.append(words.format(over(of_law, lambda case: number(case.solver.tolerance, 3))))
    return f"Continuum: {over(cases, points)}, {' or, at the hard wall, '.join(accuracies)}."


def atoms(cases: Sequence[Case]) -> str:
    """Lattice, block, cutoff and temperature."""

    def across(counts: tuple[int, int]) -> str:
        return f"{counts[0]} × {counts[1]}"

    def layers(case: Case) -> str:
        rows, columns = case.lattice.atoms
        count = case.block_layers
        return f"{count} layers ({rows * columns * count:,} atoms)"

    try:
        return (
            f"Atoms: bottom layer of {over(cases, lambda case: across(case.lattice.atoms))} atoms (lattice constant "
            f"{over(cases, lambda case: length(case.material.lattice_constant or 0))}) on "
            f"{over(cases, lambda case: across(case.lattice.substrate_sites))} substrate sites, block of "
            f"{over(cases, layers)} condensed exactly, potential cut off at "
            f"{over(cases, lambda case: f'{case.atomistic.cutoff:g}')} r₀, temperature 0 K."
        )
    except InputError:
        return "Atoms: as their dataset says."


def theories(cases: Sequence[Case]) -> str:
    """Spectrum, and the factors of Persson's theory."""
    words = {"analytic": "the target spectrum", "surface": "the spectrum of the very surface", "table": "a table"}

    def spectra(case: Case) -> str:
        return " and ".join(words[name] for name in case.spectra)

    caps = {False: "no limit to σ_a", True: "σ_a limited to σ_max"}
    chosen = {case.theory.cap_detachment_stress for case in cases}
    cap = "" if chosen == {False} else f", {over(cases, lambda case: caps[case.theory.cap_detachment_stress])}"
    return (
        f"Theories: {over(cases, spectra)}; in Persson's theory elastic energy "
        f"weight {over(cases, lambda case: f'“{case.theory.energy_weight}”')} "
        f"(β = {over(cases, lambda case: f'{case.theory.beta:g}')}), true area "
        f"{over(cases, lambda case: f'“{case.theory.true_area}”')}, "
        f"α = {over(cases, lambda case: f'{case.theory.alpha:g}')}{cap}."
    )
