"""A study file: read, checked and expanded into cases, and the bins of its distributions.

Ranges of bins follow from spectra, moduli, laws and paths: two seeds of one study have the same.
"""

import itertools
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from contact_study.inputs import plugins
from contact_study.inputs.errors import InputError
from contact_study.inputs.files import refuse_endless
from contact_study.inputs.units import length
from contact_study.numerics.distributions import Bins
from contact_study.physics.laws import LAWS, TractionLaw
from contact_study.physics.process_zone import JKR_LIKE, SHARE_OF_HEIGHT, longest_range
from contact_study.physics.solids import Elasticity
from contact_study.physics.spheres.numbers import tabor_parameter
from contact_study.physics.surfaces.surface import SurfaceScales
from contact_study.study import sweep
from contact_study.study.case import Case
from contact_study.study.schema.absent_surface import AbsentSurface
from contact_study.study.schema.bodies import ADDED_SECTIONS, bind_added, composed
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, bare_numbers, is_sweep, replace_keys
from contact_study.study.schema.elasticity import ELASTICITIES, importable
from contact_study.study.schema.interaction import AUTO, INTERACTIONS, LENGTH, InteractionSection
from contact_study.study.schema.keys import TaggedUnion, bind, keys_of
from contact_study.study.schema.sections import POISSONS_RATIO
from contact_study.study.schema.surface import SurfaceSection
from contact_study.study.tables import TABLE, with_columns, with_drawn_spectra, with_spectrum
from contact_study.study.uncertainty import with_draws


@dataclass(frozen=True)
class Study:
    """A study file, checked."""

    table: dict[str, Any]  # the whole input, overrides included, as TOML would hold it
    directory: Path  # where relative paths of the study start
    cases: tuple[Case, ...]  # every point of the sweep, the last swept key running fastest
    sweep: dict[str, sweep.SweptKey]  # by the last part of a key: the leading dimensions of every dataset
    notes: tuple[str, ...] = ()  # what in the file has no effect, or is likely to mean something else
    choices: tuple[str, ...] = ()  # what the file left to be chosen, and what was

    @property
    def title(self) -> str:
        return self.cases[0].study.title

    @cached_property
    def scales(self) -> tuple[SurfaceScales, ...]:
        """Scales of the surface of each case, calculated once for equal surfaces."""
        known: dict[SurfaceSection, SurfaceScales] = {}
        for case in self.cases:
            case.__dict__.setdefault("scales", known.get(case.geometry) or case.scales)
            known[case.geometry] = case.scales
        return tuple(case.scales for case in self.cases)

    @cached_property
    def bins(self) -> Bins:
        """The bins of all distributions, one set for all cases; InputError if a height map cannot be used."""
        ranges = (_ranges(case, scale) for case, scale in zip(self.cases, self.scales, strict=True))
        tension, compression, gap = (max(values) for values in zip(*ranges, strict=True))
        output = self.cases[0].output
        if output.pressure_range is not None:
            pressure_edges: np.ndarray = np.linspace(*output.pressure_range, output.pressure_bins + 1)
        else:
            # Points out of contact carry no stress, or next to none of either sign: an edge at zero would part them at
            # random. Zero is in the middle of a bin, one half of it on the side of tension.
            width = (_rounded(tension) + _rounded(compression)) / output.pressure_bins
            below = round(_rounded(tension) / width - 0.5) + 0.5
            pressure_edges = (np.arange(output.pressure_bins + 1) - below) * width
        gap_range = output.gap_range or (0.0, _rounded(gap))
        return Bins(pressure_edges, np.linspace(*gap_range, output.gap_bins + 1))

    @property
    def toml(self) -> str:
        return tomli_w.dumps(self.table)


def read_study(path: Path | str, overrides: Mapping[str, Any] | None = None) -> Study:
    """Read a study file.

    Parameters
    ----------
    path : path-like
        A TOML file.
    overrides : mapping, optional
        Dotted keys ("section.key") and their values, in place of the file's. A swept key takes a value or a list; a
        list for a key that takes one value sweeps it.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        If the file cannot be read or any key is unknown, missing or impossible.

    Examples
    --------
    >>> import contact_study
    >>> study = contact_study.read_study("study.toml", {"surface.seed": 2})  # doctest: +SKIP
    """
    plugins.load()
    path = Path(path)
    try:
        refuse_endless(path)
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "is no text"
        raise InputError(f"{path}: cannot be read ({reason}); expected a study file (TOML)") from None
    except ValueError as error:  # also of a number of more digits than Python reads
        raise InputError(f"{path}: is no valid TOML: {error}") from None
    _check_structure(table)
    replace_keys(table, overrides or {})
    study = make_study(table, path.parent)
    return replace(study, notes=study.notes + bare_numbers(table, study.cases[0].loading))


def make_study(table: dict[str, Any], directory: Path | str = ".") -> Study:
    """Check a study and expand its sweep; errors as :func:`read_study`.

    Parameters
    ----------
    table : dict
        The study as TOML would hold it.
    directory : path-like, optional
        Start of relative paths.

    Returns
    -------
    Study

    Examples
    --------
    >>> import contact_study
    >>> study = contact_study.make_study({
    ...     "surface": {"kind": "wavy", "size": "1 um", "shape": [16, 16], "amplitude": "1 nm"},
    ...     "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3},
    ...     "interaction": {"law": "hard_wall"},
    ...     "loading": {"path": ["1 MPa"]},
    ... })
    >>> len(study.cases)
    1
    """
    plugins.load()
    _check_structure(table)
    folder = Path(directory)
    table = with_draws(table)
    table = with_drawn_spectra(with_spectrum(table, folder), folder)
    for section, declared in SECTIONS.items():  # what a study holds decides its numbers, not a file
        if isinstance(declared, TaggedUnion) and section in table:
            kind = declared.section_of(table[section])
            table[section] = with_columns(table[section], section, getattr(kind, "columns", {}), folder)
            table[section] = getattr(kind, "recorded", dict)(table[section])
    swept = table.get("sweep", {})
    places = list(itertools.product(*(range(len(values)) for values in swept.values())))  # the last key runs fastest
    points = [{key: swept[key][i] for key, i in zip(swept, place, strict=True)} for place in places]
    merged, notes = sweep.sections_at(table, points)
    scales: dict[SurfaceSection, SurfaceScales] = {}
    choices: dict[str, None] = {}
    cases = tuple(_case(*each, folder, scales, choices) for each in zip(merged, points, places, strict=True))
    longest = max(len(case.path) for case in cases)
    for number in cases[0].output.field_steps or ():
        if not -longest <= number < longest:
            raise InputError(
                f"output.field_steps: {number} is no point of the path, which has {longest}: 0 to {longest - 1}, or "
                "-1 for the last"
            )
    keys = {dotted.rpartition(".")[2]: sweep.swept_key(dotted, written, cases) for dotted, written in swept.items()}
    return Study(table, folder, cases, keys, notes, tuple(choices))


def _check_structure(table: dict[str, Any]) -> None:
    """Sections, sweep and overrides are what they should be, and every value alone can be read."""
    for section, content in table.items():
        if (section in SECTIONS or section == "sweep") and not isinstance(content, dict):
            raise InputError(f"{section} = {content!r}: expected a section, [{section}]")
        if section not in (*SECTIONS, "sweep", "override"):
            raise InputError(f"unknown section [{section}]; known: {', '.join(SECTIONS)}, sweep, override")
    for section, declared in SECTIONS.items():
        for name, value in table.get(section, {}).items() if section not in WHOLE_STUDY else ():
            dotted = f"{section}.{name}"
            if name in keys_of(declared) and is_sweep(dotted, value, value):
                raise InputError(
                    f"{dotted} = {value!r}: takes one value; to run a case for each, put the list into [sweep], "
                    f'"{dotted}" = [...]'
                )
    sweep.check(table)


def _case(
    merged: dict[str, Any],
    point: dict[str, Any],
    index: tuple[int, ...],
    directory: Path,
    scales: dict[SurfaceSection, SurfaceScales],
    choices: dict[str, None],
) -> Case:
    """Bind the sections of a point; collects the scales of surfaces that choose a key, and the choices in words."""
    bound: dict[str, Any] = {}
    for name in sorted(SECTIONS, key=lambda name: name != "theory"):  # which says whether there must be a surface
        if name == "surface" and not merged[name] and bound["theory"].spectra == (TABLE,):
            bound[name] = AbsentSurface(wavevectors=bound["theory"].wavevectors, density=bound["theory"].density)
        elif name in ADDED_SECTIONS:
            bound[name] = bind_added(merged[name], name, bound["surface"])
        else:
            bound[name] = bind(SECTIONS[name], merged[name], name)
    surface = composed(bound["surface"], *(bound[name] for name in ("form", *ADDED_SECTIONS)))
    if bound["interaction"].length == AUTO:
        solid = bound["elasticity"].solid(bound["material"])
        scales[surface] = scales.get(surface) or surface.scales(directory)
        bound["interaction"], words = _with_length(bound["interaction"], scales[surface], solid.contact_modulus)
        choices[words] = None
    if bound["loading"].has_forces:
        cell = surface.cell(directory)
        if cell is None:
            raise InputError("loading.path: forces act on a cell, which needs surface.size; give pressures")
        bound["loading"] = bound["loading"].spread(math.prod(cell))
    case = Case(**bound, coordinates=sweep.coordinates_of(point), index=index, directory=directory)
    if surface in scales:
        case.__dict__["scales"] = scales[surface]
    return case


def _with_length(
    given: InteractionSection, scales: SurfaceScales, contact_modulus: float
) -> tuple[InteractionSection, str]:
    """Replace ``length = "auto"`` by the longest that leaves contacts JKR-like, and say which."""
    if not LAWS[given.law].attracts:
        raise InputError(f'{LENGTH} = "{AUTO}": law = "{given.law}" does not attract; leave it out')
    if given.work_of_adhesion is None:
        raise InputError(
            f'{LENGTH} = "{AUTO}": needs interaction.work_of_adhesion, which pairs of atoms would make of it'
        )
    about = contact_modulus, given.work_of_adhesion * given.well_depth_ratio
    try:
        longest = longest_range(scales.rms_curvature, scales.rms_height, *about)
    except ValueError as error:
        raise InputError(f'{LENGTH} = "{AUTO}": {error}; give the length of the interaction') from None
    tabor = float(tabor_parameter(1 / scales.rms_curvature, *about, longest))
    why = (
        f"the longest of a Tabor parameter above {JKR_LIKE:g}"
        if tabor / JKR_LIKE * longest < SHARE_OF_HEIGHT * scales.rms_height
        else "a tenth of the rms height"
    )
    words = f'range of adhesion ({LENGTH} = "{AUTO}"): {length(longest)}, {why}; Tabor parameter {tabor:.2g}: JKR-like'
    return replace(given, length=longest), words


def with_keys(study: Mapping[str, Any]) -> dict[str, Any]:
    """Replace laws and solids, in place of ``interaction`` or its ``law``, ``elasticity`` or its ``kind``, by keys."""
    found = dict(study)
    law, beside = _object(found.get("interaction"), "law", TractionLaw)
    if law is not None:
        name = next((name for name, known in LAWS.items() if type(law) is known), None)
        if name is None:
            raise InputError(
                f"interaction: {type(law).__name__} is no law of a study; pass TabulatedLaw.through(gaps, "
                "law.traction(gaps))"
            )
        own = {"law": name, **INTERACTIONS.declared[name].keys_from(law)}
        found["interaction"] = _joined("interaction", own, beside)
    solid, beside = _object(found.get("elasticity"), "kind", Elasticity)
    if solid is not None:
        material = found.get("material", {})
        if "youngs_modulus" in material:
            raise InputError("material.youngs_modulus: elasticity is an object with its modulus; leave it out")
        for name in ("youngs_modulus", "poissons_ratio"):
            if f"material.{name}" in found.get("sweep", {}):
                raise InputError(f"sweep.material.{name}: elasticity is an object of one material")
        kind = next((kind for kind, one in ELASTICITIES.declared.items() if one.makes is type(solid)), None)
        if kind is None and not solid.on_any_grid:
            raise InputError(
                f"elasticity: no keys of a study make a {type(solid).__name__}, known on one grid; use rough_contact"
            )
        given, ratio = material.get("poissons_ratio"), getattr(solid, "poissons_ratio", None)
        if given is not None:
            said = POISSONS_RATIO[0](given, "material.poissons_ratio")
            if ratio not in (None, said):
                raise InputError(f"material.poissons_ratio = {given!r}: the solid's is {ratio:g}; leave it out")
            ratio = said
        if ratio is None:
            raise InputError(f"missing key material.poissons_ratio: {type(solid).__name__} has a contact modulus alone")
        if kind is None:  # of a class outside of this package
            own = {"kind": "python", "object": importable(solid)}
        else:
            own = {"kind": kind, **ELASTICITIES.declared[kind].keys_from(solid, ratio)}
        found["elasticity"] = _joined("elasticity", own, beside)
        modulus = solid.contact_modulus * (1 - ratio**2)
        found["material"] = {**material, "youngs_modulus": modulus, "poissons_ratio": ratio}
    return found


def _object(section: Any, tag: str, kind: type) -> tuple[Any, dict[str, Any]]:
    """The object that a section is, or names, and the keys beside it; None without one."""
    if isinstance(section, Mapping) and isinstance(section.get(tag), kind):
        return section[tag], {name: value for name, value in section.items() if name != tag}
    return section if isinstance(section, kind) else None, {}


def _joined(section: str, own: Mapping[str, Any], beside: Mapping[str, Any]) -> dict[str, Any]:
    if twice := [name for name in beside if name in own]:
        raise InputError(f"{section}.{twice[0]}: the object in this section has its own; leave it out")
    return {**own, **beside}


def _ranges(case: Case, scales: SurfaceScales) -> tuple[float, float, float]:
    """Largest tension, compression (Pa) and gap (m) worth resolving in one case."""
    peak, stiffness, path = case.law.peak_tensile_stress, case.solid.stiffness, case.loading.path
    # Full contact has a Gaussian stress; six deviations leave 1e-9 of it outside.
    fluctuation, applied = 6 * scales.full_contact_stress(case.solid), 0.0
    if case.loading.control == "pressure":
        applied = max(map(abs, path))
    elif case.loading.control == "approach" and (compliance := case.solid.mean_compliance + case.machine_compliance):
        # What a compressible layer, or a machine, takes where no gap closes; less if one does.
        applied = min(max(0.0, *path) / compliance, case.material.hardness or np.inf)
        if (trigger := case.loading.trigger_force) is not None:
            applied = min(applied, trigger / case.nominal_area)
    # Any range suits a flat hard wall under a prescribed gap, which carries nothing.
    compression = (fluctuation + applied + peak) or case.solid.contact_modulus
    # No tension exceeds the law's peak; a quarter more shows that. Persson's theory has no peak, but its tension is at
    # most that of full contact or of its cracks, √(2α K Δγ) of the finest wave.
    cracks = 0.0
    if scales.spectrum is not None and not case.theory.cap_detachment_stress:
        finest = float(stiffness(np.array([scales.spectrum.limits[1]]))[0])
        cracks = float(np.sqrt(2 * case.theory.alpha * finest * case.law.work_of_adhesion))
    tension = max(1.25 * peak, 0.05 * compression, min(cracks, fluctuation + applied))
    # At the lightest contact the block rests on the highest peaks, far above the deepest valley; under tension it
    # bends up a little further between them.
    gap = 1.1 * scales.peak_to_valley + 4 * case.contact_distance
    if case.loading.control == "gap":
        gap += max(path)
    elif case.loading.control == "approach":
        gap += max(0.0, -min(path))
    return tension, compression, gap or 1.0


def _rounded(value: float) -> float:
    """Two significant digits, upwards."""
    scale = 10 ** (np.floor(np.log10(value)) - 1)
    return float(np.ceil(value / scale - 1e-9) * scale)
