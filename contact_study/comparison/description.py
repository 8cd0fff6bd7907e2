"""What was run, in plain words, from the studies that the datasets carry."""

from collections.abc import Collection, Iterator

from contact_study.comparison.cases import coordinate_label
from contact_study.comparison.datasets import Inputs
from contact_study.comparison.path_points import AVERAGED
from contact_study.comparison.wording import control_unit, length, number, pressure_unit
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.study import Study
from contact_study.problem.units import quantity


def study_paragraphs(inputs: Inputs) -> list[tuple[str, str]]:
    """Heading and text of each part of the question."""
    study = inputs.study
    case = study.cases[0]
    return [
        ("Surface", _surface(study)),
        ("Block", _block(case)),
        ("Interaction", _interaction(study, inputs.models)),
        ("Loading", _loading(inputs)),
        ("Models", " ".join(_models(inputs))),
    ]


def _surface(study: Study) -> str:
    section = study.cases[0].surface
    size = f"{length(section.size[0])} × {length(section.size[1])}" if section.size else "the size of its height map"
    words = {
        "self_affine": "Rigid, periodic, randomly rough",
        "file": f"Rigid, periodic, height map {section.path}",
        "sphere": f"A rigid sphere of radius {length(section.radius or 0)}",
        "wavy": f"A rigid wavy surface of amplitude {length(section.amplitude or 0)}, modes {section.modes}",
        "flat": "Rigid and flat",
    }[section.kind]
    words += f", {size}"
    if section.kind == "self_affine" and section.rms_height is not None:
        exact = "each sample exactly" if section.normalisation == "realised" else "in the mean over samples"
        words += (
            f": self-affine with Hurst exponent {section.hurst_exponent:g} between {section.roll_off_mode:g} and "
            f"{section.cutoff_mode:g} times 2π/L, flat spectrum from {section.low_mode:g} to {section.roll_off_mode:g} "
            f"times 2π/L, h_rms = {length(section.rms_height)} ({exact})"
        )
    seeds = study.sweep["seed"].values if "seed" in study.sweep else (section.seed,)
    if section.kind == "self_affine":
        listed = ", ".join(str(seed) for seed in seeds)
        words += f"; {len(seeds)} realisation{'s' if len(seeds) > 1 else ''} (seed {listed})"
    return words + "."


def _block(case: Case) -> str:
    material = case.material
    return (
        f"Elastic, E = {_modulus(material.youngs_modulus)}, ν = {material.poissons_ratio:g}, hence contact modulus "
        f"E* = E/(1 − ν²) = {_modulus(material.contact_modulus)}."
    )


def _modulus(value: float) -> str:
    unit = pressure_unit(value)
    return f"{number(value / unit.size, 5)} {unit.name}"


def _interaction(study: Study, models: Collection[str]) -> str:
    case = study.cases[0]
    if case.interaction.law == "hard_wall":
        return "Hard wall without adhesion; contact is where the pressure is positive."
    works = list(dict.fromkeys(f"{case.work_of_adhesion:.4g}" for case in study.cases))
    given = case.interaction
    pair = ""
    if given.well_depth is not None:
        meV = quantity("1 meV", "J", "well_depth")
        pair = f" of atoms with ε₀ = {given.well_depth / meV:.4g} meV"
    law = given.law.removeprefix("lennard_jones_").replace("_", "-")
    # The 10-4 law is what one layer of atoms on either side gives; the 9-3 law is prescribed.
    made = "smeared into" if law == "10-4" else "in"
    users = " and ".join(
        words
        for words, there in (("continuum", "continuum" in models), ("gap-flow theory", "gap_flow" in models))
        if there
    )
    smeared = f"; {made} the {law} traction-separation law for {users}" if users else ""
    return (
        f"Lennard-Jones{pair}, r₀ = {length(given.length or 0)}{smeared}. "
        f"Work of adhesion Δγ = {', '.join(works)} J/m². Gaps below {length(case.contact_distance)} count as contact."
    )


def _loading(inputs: Inputs) -> str:
    """Each different path, with the points of the sweep that take it."""
    study, unit = inputs.study, control_unit(inputs.models, inputs.control)
    paths: dict[tuple[float, ...], list[str]] = {}
    for case in study.cases:
        label = ", ".join(coordinate_label(key, value) for key, value in case.coordinates.items() if key != AVERAGED)
        paths.setdefault(case.loading.path, []).append(label)
    back = ", then back through the same values" if study.cases[0].loading.unload else ""
    listed = []
    for path, labels in paths.items():
        values = ", ".join(number(value / unit.size, 5) for value in path)
        where = f" ({', '.join(dict.fromkeys(labels))})" if len(paths) > 1 else ""
        listed.append(f"{values} {unit.name}{where}{back}")
    words = f"Prescribed mean {inputs.control}, in this order: {'; '.join(listed)}."
    words += _starts(inputs)
    if "theory" in inputs.models and study.cases[0].interaction.law != "hard_wall":
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
    if "continuum" in inputs.studies:
        case = inputs.studies["continuum"].cases[0]
        shape = case.surface.shape
        points = f"{shape[0]} × {shape[1]} points" if shape else "the height map's points"
        tolerance = number(case.solver.tolerance, 3)
        if case.interaction.law == "hard_wall":
            yield f"Continuum: {points}, contact condition violated by less than {tolerance} h_rms."
        else:
            yield f"Continuum: {points}, residual stress below {tolerance} E*."
    if "atomistic" in inputs.studies:
        yield _atoms(inputs.studies["atomistic"].cases[0])
    if "theory" in inputs.studies:
        chosen = inputs.studies["theory"].cases[0].theory
        spectrum = "the target spectrum" if chosen.spectrum == "analytic" else "the spectrum of the very surface"
        cap = ", σ_a limited to σ_max" if chosen.cap_detachment_stress else ""
        yield (
            f"Theories: {spectrum}; in Persson's theory elastic energy weight “{chosen.energy_weight}” "
            f"(β = {chosen.beta:g}), true area “{chosen.true_area}”, α = {chosen.alpha:g}{cap}."
        )


def _atoms(case: Case) -> str:
    try:
        (rows, columns), (site_rows, site_columns) = case.atoms, case.substrate_sites
    except InputError:
        return "Atoms: as their dataset says."
    layers = case.atomistic.layers or max(rows, columns)
    return (
        f"Atoms: bottom layer of {rows} × {columns} atoms (lattice constant "
        f"{length(case.material.lattice_constant or 0)}) on {site_rows} × {site_columns} substrate sites, block of "
        f"{layers} layers ({rows * columns * layers:,} atoms) condensed exactly, potential cut off at "
        f"{case.atomistic.cutoff:g} r₀, temperature 0 K."
    )
