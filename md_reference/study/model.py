"""The atomistic model of a case: its measured constants and its states along the loading path; the command."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from contact_study.campaign.memory import Need
from contact_study.campaign.model import MODELS
from contact_study.inputs.errors import InputError, refuse
from contact_study.inputs.units import length
from contact_study.numerics.grid import Grid
from contact_study.physics.surfaces.surface import Surface, SurfaceScales
from contact_study.results import overdamped_path
from contact_study.results.schema import heights_on
from contact_study.results.state import Value
from contact_study.study.case import Case
from contact_study.study.checks import contact_stress, idle_motion, squeeze
from contact_study.study.study import Study
from contact_study.study.sweep import points
from md_reference.block.condensed import effective_contact_modulus
from md_reference.block.multiscale import level_layers, node_count
from md_reference.interface.pairs import INSIDE, flat_adhesion
from md_reference.parallel_rows import ATOMS_FOR_THREADS
from md_reference.study import cold, dynamics, sampling
from md_reference.study.system import Predictor, Restart, States, build_stiffness

# Word of ``atomistic.method`` -> function of case, surface, restart, first point and predictor.
METHODS: Mapping[str, Callable[[Case, Surface, Restart, int, Predictor], States]] = {
    "quasi_static": cold.quasi_static,
    "overdamped": cold.overdamped,
    "sampling": sampling.solve_path,
    "dynamics": dynamics.solve_path,
}

_COLD = {"quasi_static": "finds equilibria at zero temperature", "overdamped": "is a motion without noise"}
MODEL = MODELS["atomistic"]
POINTS_FOR_THREADS = ATOMS_FOR_THREADS

# Displacements, forces, Hessians, stiffness, transforms and substrate of one atom, as scripts/benchmark_atoms.py finds.
_BYTES_PER_ATOM = 1000
# Displacements before and after a step, velocities, a checkpoint, and the nodes that are kept.
_BYTES_PER_NODE = 300

# The springs' Lamé modulus grows as 1/(1 − 2ν): five digits nearer to 0.5 than this, rounding makes moduli negative.
_MOST_INCOMPRESSIBLE = 0.49999

# Range of the pairs over the distance of the substrate's sites below which these are no layer any more: the work of
# adhesion of flat on flat is then 0.3 % below the law's, at 0.2 it is 5 %, at 0.1 the layers have no equilibrium.
_SHORTEST = 0.3


def check(case: Case) -> None:
    """Raise InputError unless the atomistic model can compute a case."""
    given, law, control = case.atomistic, case.interaction.law, case.loading.control
    kind, boundary, ratio = case.elasticity.kind, case.elasticity.boundary, case.material.poissons_ratio
    other_method, other_kind = given.method != "dynamics", kind not in ("half_space", "layer")
    approach, heated = control == "approach", given.method in _COLD and given.temperature > 0
    refuse(
        {
            f'interaction.law = "{law}": the atomistic model has Lennard-Jones pairs; use "lennard_jones_10_4", the '
            "law that follows from them": law != "lennard_jones_10_4",
            f'elasticity.kind = "{kind}": the block of atoms is a half-space or a layer': other_kind,
            f'elasticity.boundary = "{boundary}": the block of atoms is periodic': boundary != "periodic",
            'loading.control = "approach": the block of atoms takes "pressure", or its separation as "gap"': approach,
            "material.counter_youngs_modulus: atoms make one elastic body; leave it out": case.material.counter_modulus
            is not None,
            "material.hardness: the block of atoms is elastic; leave it out": case.material.hardness is not None,
            f'adhesion_map.kind = "{case.adhesion_map.kind}": the sites of the atoms are alike; use "none"': (
                case.adhesion_map.kind != "none"
            ),
            f"material.poissons_ratio = {ratio:.12g}: springs cannot make a block incompressible; use at most "
            f"{_MOST_INCOMPRESSIBLE}": ratio > _MOST_INCOMPRESSIBLE,
            f'atomistic.temperature = {given.temperature:g} K: atomistic.method = "{given.method}" '
            f'{_COLD.get(given.method)}; "sampling" and "dynamics" take a temperature': heated,
            'atomistic.method = "sampling": needs an atomistic.temperature above 0 K; at zero temperature the atoms '
            'are at rest, use "quasi_static"': given.method == "sampling" and given.temperature == 0,
            'atomistic.block = "nonlinear_springs": only a linear block can be condensed to its bottom layer; use '
            'atomistic.method = "dynamics"': given.block == "nonlinear_springs" and other_method,
            'output.atoms = "block": the nodes of the block are explicit in atomistic.method = "dynamics" only; use '
            '"surface"': case.output.atoms == "block" and other_method,
        }
    )
    if other_method:
        case.require_gap()
    else:
        dynamics.check(case)
    if given.method == "overdamped":
        overdamped_path.check(case, "atomistic.method")
    _ = case.block_layers  # raises where no number of cells makes the layer
    spacing = max(case.lattice.site_spacing)
    if case.law.length < _SHORTEST * spacing:
        raise InputError(
            f"interaction.length = {length(case.law.length)}: atoms would fall between the substrate's sites, "
            f"{length(spacing)} apart; use at least {length(_SHORTEST * spacing)}, or a smaller "
            "material.lattice_constant"
        )


def needs(case: Case) -> Iterator[Need]:
    """Yield the least memory of the parts of a case."""
    rows, columns = case.lattice.atoms
    yield Need(
        rows * columns * _BYTES_PER_ATOM,
        f"material.lattice_constant = {case.material.lattice_constant:g} m: a layer of {rows} x {columns} atoms",
        "a larger one or a smaller cell",
    )
    if case.atomistic.method == "dynamics":
        nodes = node_count(case.lattice.atoms, level_layers(case.lattice.atoms, case.block_layers))
        yield Need(
            nodes * _BYTES_PER_NODE,
            f'atomistic.method = "dynamics": a block of {nodes:.3g} nodes',
            "a larger material.lattice_constant, a smaller cell or fewer atomistic.layers",
        )


def review(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Return notes on a study; InputError if the pair potential is too weak to hold the atoms out of the substrate."""
    notes = idle_motion(study.cases)
    if any(case.solver.path == "overdamped" != case.atomistic.method for case in study.cases):
        notes.append('solver.path = "overdamped": atoms do not read it; their method is atomistic.method')
    ringing = [case for case in study.cases if case.atomistic.method == "dynamics" and case.dynamics.damping == 0]
    if ringing:
        notes.append(
            f"dynamics.damping = 0{points(ringing, len(study.cases))}: nothing takes the energy of the descent, the "
            "block rings without end; its numbers are means over the second half of dynamics.frames"
        )
    filtered = []
    for case, scale in zip(study.cases, scales, strict=True):
        # Six deviations of the stress in full contact, to which the highest pressures of a rough contact come near.
        stress = 6 * scale.full_contact_stress(case.solid)
        closest = squeeze(case.law, max(stress, contact_stress(case)))
        if closest < INSIDE:
            raise InputError(
                f"interaction: against stresses of up to {stress:.3g} Pa the pair potential lets atoms come to "
                f"{closest:.2g} of interaction.length, where they count as inside the substrate; check well_depth "
                "(work_of_adhesion) and well_depth_ratio"
            )
        spacing = max(case.lattice.site_spacing)
        if scale.shortest_wave < 2 * spacing:
            filtered.append((case, scale.shortest_wave, spacing))
    if not filtered:
        return notes
    case, wave, spacing = filtered[0]
    where = points([case for case, *_ in filtered], len(study.cases))
    return [
        *notes,
        f"surface: its shortest wave, {wave:.3g} m, is below two distances of the substrate's sites, {spacing:.3g} m"
        f"{where}: what the sites cannot carry is left out",
    ]


def constants(case: Case, surface: Surface) -> Mapping[str, Value]:
    """Return moduli and adhesion measured on the atoms, and the surface under their rest positions."""
    stiffness = build_stiffness(case)
    pairs = case.well_depth, case.law.length, case.atomistic.cutoff
    heights = surface.heights(case.lattice.atoms)
    found = {
        "contact_modulus": effective_contact_modulus(stiffness, heights),
        "contact_distance": case.contact_distance,
        "rms_height": surface.rms_height,
        "rms_slope": surface.rms_slope,
        "pixel": stiffness.lattice_constant,
        **flat_adhesion(case.lattice.site_spacing, stiffness.area_per_atom, *pairs),
        **heights_on(stiffness.grid, heights),
        "wavevector": stiffness.grid.wavenumber[0, 1:],
        "contact_modulus_at": stiffness.contact_modulus[0, 1:],
    }
    if case.output.atoms == "none":
        return found
    sites = Grid(case.lattice.substrate_sites, case.lattice.size)
    found |= heights_on(sites, surface.heights(sites.shape), "site_y", "site_x", "substrate_height")
    if case.material.atom_mass is not None:
        found["atom_mass"] = case.material.atom_mass
    if case.output.atoms == "block":
        block = dynamics.build_block(case)
        found |= {"node_level": block.node_levels, "node_mass": block.node_masses}
    return found


def solve_path(
    case: Case, surface: Surface, restart: Restart = None, start: int = 0, predictor: Predictor = None
) -> States:
    """Yield states along the loading path, from the point ``start`` on, by the case's method."""
    return METHODS[case.atomistic.method](case, surface, restart, start, predictor)
