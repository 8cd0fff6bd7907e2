"""Tables of the documentation that the code itself makes: variables, keys, symbols, messages.

python -m scripts.reference_tables variables
python -m scripts.reference_tables keys
python -m scripts.reference_tables symbols
python -m scripts.reference_tables messages
"""

import argparse
import ast
import dataclasses
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

from contact_study.report.align import regime
from contact_study.report.align.regime import MEANINGS
from contact_study.results import observables, schema
from contact_study.results.schema import CONSTANTS, COORDINATES, OF_A_MEAN, VARIABLES
from contact_study.study.schema.bodies import ADDED
from contact_study.study.schema.dotted_keys import SECTIONS, all_keys
from contact_study.study.schema.keys import TaggedUnion, as_written, keys_of
from scripts.harness import ROOT, Option, head, program


def run(given: argparse.Namespace) -> None:
    print("\n".join(TABLES[given.table]()))


def _variables() -> Iterable[str]:
    yield head("variable", "dimensions", "unit", "meaning")
    for known in (CONSTANTS, {name: it for name, it in VARIABLES.items() if name not in CONSTANTS}, COORDINATES):
        for name, it in known.items():
            units = "" if it.units == "1" else it.units
            yield f"| `{name}` | {', '.join(it.dims)} | {units} | {_cell(it.long_name)} |"
    for suffix, (unit, words) in OF_A_MEAN.items():
        units = "of the mean" if unit is None else "" if unit == "1" else unit
        yield f"| `<name>{suffix}` | of the mean | {units} | {_cell(words)} |"


def _keys() -> Iterable[str]:
    section = None
    for own, name, declaration, default in all_keys():
        if SECTIONS[own] is ADDED and name != ADDED.tag:
            continue
        if own != section:
            section = own
            yield from ("", f"**`[{section}]`**", "", head("key", "kind", "default", "meaning"))
        given = default not in (None, dataclasses.MISSING)
        shown = f"`{as_written(default)}`" if given else ""
        meaning = _cell(declaration.description)
        if SECTIONS[own] is ADDED:
            meaning += f"; its keys are those of `[surface]`, whose {', '.join(ADDED.inherited)} are the defaults here"
        yield f"| `{name}` | {_cell(declaration.kind)} | {shown} | {meaning} |"


# Symbols of the field, each with the quantity of a dataset, the key of a study ("section.key") or the number of a
# comparison ("regime/name") that it stands for; meaning, unit and place follow from there.
SYMBOLS = (
    ("h", "height"),
    ("h_rms", "rms_height"),
    ("h′", "rms_slope"),
    ("C(q)", "power_spectrum"),
    ("H", "surface.hurst_exponent"),
    ("q_L", "surface.low_mode"),
    ("q_0", "surface.roll_off_mode"),
    ("q_1", "surface.cutoff_mode"),
    ("R", "surface.radius"),
    ("E", "material.youngs_modulus"),
    ("ν", "material.poissons_ratio"),
    ("E*", "contact_modulus"),
    ("E*(q)", "contact_modulus_at"),
    ("a", "material.lattice_constant"),
    ("m", "material.atom_mass"),
    ("T", "atomistic.temperature"),
    ("ε₀", "interaction.well_depth"),
    ("ε/ε₀", "interaction.well_depth_ratio"),
    ("r₀, z₀, ρ", "interaction.length"),
    ("Δγ", "work_of_adhesion"),
    ("d_eq", "equilibrium_distance"),
    ("d_c", "contact_distance"),
    ("σ_max", "peak_tensile_stress"),
    ("p", "mean_pressure"),
    ("σ", "pressure"),
    ("P(σ)", "pressure_pdf"),
    ("u", "gap"),
    ("P(u)", "gap_pdf"),
    ("ū", "mean_gap"),
    ("A/A₀", "relative_contact_area"),
    ("U_el", "elastic_energy"),
    ("U_int", "interaction_energy"),
    ("−dp/dū", "contact_stiffness"),
    ("ζ", "magnification"),
    ("A(ζ)/A₀", "relative_contact_area_at"),
    ("σ_a(ζ)", "detachment_stress"),
    ("γ_eff(ζ)", "effective_work_of_adhesion"),
    ("α", "theory.alpha"),
    ("β", "theory.beta"),
    ("μ", "regime/tabor_parameter"),
    ("θ", "regime/adhesion_over_elastic_energy"),
    ("E*Δγ/σ_max²", "regime/process_zone"),
)


def _symbols() -> Iterable[str]:
    yield head("symbol", "name", "unit", "meaning", "where")
    for symbol, name in SYMBOLS:
        units, meaning, where = _known(name)
        yield f"| {_cell(symbol)} | `{name}` | {'' if units == '1' else units} | {_cell(meaning)} | `{where}` |"


def _known(name: str) -> tuple[str, str, str]:
    """Unit and meaning of a quantity, key or number, and the file that has it."""
    if name.startswith("regime/"):
        return *MEANINGS[name.removeprefix("regime/")], _file(regime)
    section, _, key = name.rpartition(".")
    if section:
        declaration = next(known for own, other, known, _ in all_keys() if (own, other) == (section, key))
        kinds = {"number": "1", "integer": "1"}
        return kinds.get(declaration.kind, declaration.kind), declaration.description, _file(_home(section, key))
    known = {**VARIABLES, **COORDINATES}[name]
    return known.units, known.long_name, _file(observables if name in observables.ENTRIES else schema)


def _home(section: str, key: str) -> ModuleType:
    """The module that declares a key of a study."""
    declared = SECTIONS[section]
    kinds = declared.declared.values() if isinstance(declared, TaggedUnion) else [declared]
    owner = next(kind for kind in kinds if key in keys_of(kind))
    # Keys that several kinds share are of a base class.
    return sys.modules[
        next(base for base in reversed(owner.__mro__) if key in vars(base).get("__annotations__", {})).__module__
    ]


def _file(module: ModuleType) -> str:
    return str(Path(str(module.__file__)).relative_to(ROOT)).removesuffix("/__init__.py")


# Rooms of the code by the subject of their messages.
ROOMS = {
    "Study files and keys": ("contact_study/study", "contact_study/inputs"),
    "Height maps, laws and solids": ("contact_study/physics", "contact_study/numerics"),
    "Running, resuming and merging": ("contact_study/campaign", "contact_study/results", "contact_study/command_line"),
    "Comparing and drawing": ("contact_study/report", "contact_study/plots"),
    "Boundary elements": ("bem_adhesion",),
    "Atoms": ("md_reference",),
    "Theories": ("theory",),
}


def _messages() -> Iterable[str]:
    for subject, folders in ROOMS.items():
        files = sorted(file for folder in folders for file in (ROOT / folder).rglob("*.py"))
        found = {text for file in files for text in _raised(ast.parse(file.read_text(encoding="utf-8")))}
        yield from ("", f"**{subject}**", "")
        yield from (f"- `{text}`" for text in sorted(found, key=lambda text: (text.strip("… =:.-").lower(), text)))


def _raised(tree: ast.Module) -> Iterable[str]:
    """Texts of the errors that a user meets, with … where a value stands; those of a single word are left out."""
    for node in ast.walk(tree):
        call = node.exc if isinstance(node, ast.Raise) else node
        named = ast.unparse(call.func) if isinstance(call, ast.Call) and call.args else ""
        if named not in ("InputError", "CampaignError", "ValueError", "MapError", "TableError") or call is node:
            reasons = call.args[0].keys if named == "refuse" and isinstance(call.args[0], ast.Dict) else []
        else:
            reasons = [call.args[0]]
        for reason in filter(None, reasons):
            text = re.sub("…(?:…| …)*", "…", _written(reason)).replace("\n", " ").replace("`", "'").strip()
            if named == "MapError":  # a fault of a file, named by the reader of maps
                text = f"surface.path: {text.format(path='…')}" if "{path}" in text else f"surface.path: … {text}"
            elif named == "TableError":  # as above, named by the reader of a map or of a force curve
                text = text.format(path="…") if "{path}" in text else f"… {text}"
            if len(re.findall(r"[a-z]{2,}", text)) > 2:
                yield text


def _written(node: ast.expr) -> str:
    if isinstance(node, ast.JoinedStr):
        return "".join(map(_written, node.values))
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return _written(node.left) + _written(node.right)
    return str(node.value) if isinstance(node, ast.Constant) else "…"


def _cell(words: str) -> str:
    return words.replace("|", "\\|")


TABLES = {"variables": _variables, "keys": _keys, "symbols": _symbols, "messages": _messages}

main = program(run, Option("table", str, "which one", choices=TABLES))

if __name__ == "__main__":
    sys.exit(main())
