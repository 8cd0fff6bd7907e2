"""The studies of the datasets as the keys that they set, and the starts of the models."""

from typing import Any

from contact_study.campaign.record import key_values
from contact_study.report.models import TARGET, entry_of, spectrum_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.text.wording import key_value, listed, varied
from contact_study.study.schema.dotted_keys import SECTIONS, all_keys

_UNITS = {"Pa": "Pa", "J": "J", "J/m^2": "J m-2", "K": "K", "s": "s", "kg": "kg"}


def settings(inputs: Inputs) -> list[tuple[str, str]]:
    """Keys of the studies that differ from their defaults, each with its values over all cases."""
    known = {f"{section}.{name}": (declared.kind, default) for section, name, declared, default in all_keys()}
    sections = [name for name in SECTIONS if name not in ("study", "output")]
    found: dict[str, list[Any]] = {}
    for study in inputs.studies.values():
        for case in study.cases:
            for key, value in key_values(case, sections):
                found.setdefault(key, []).append(value)
    return [
        (key, varied(_shown(key, value, _unit(inputs, key, known[key][0])) for value in values))
        for key, values in found.items()
        if any(value not in (None, known[key][1]) for value in values)
    ]


def _unit(inputs: Inputs, key: str, kind: str) -> str:
    if key == "loading.path":
        return "Pa" if inputs.control == "pressure" else "m"
    return "m" if kind in ("m", "m or [y, x]", "list of m") else _UNITS.get(kind.removeprefix("list of "), "1")


def _shown(key: str, value: Any, units: str) -> str:
    if value is None:
        return "not given"
    if isinstance(value, tuple | list):
        between = " × " if key in ("surface.size", "surface.shape") else ", "
        return between.join(_shown(key, one, units) for one in value)
    return key_value(key.partition(".")[2], value, units) if not isinstance(value, dict) else str(value)


def starts(inputs: Inputs) -> list[str]:
    """Starting configurations of the models, those of the simulations that start others first."""
    # A dataset joined of parts names the predictor of each, a line each.
    lines = {name: str(inputs.models[name].attrs.get("predictor", "")).splitlines() for name in inputs.simulations}
    fields = {name: listed(line.partition(" ")[0] for line in own) if own else "" for name, own in lines.items()}
    found = [
        (entry_of(name).start_predicted if fields[name] else entry_of(name).start).format(predictor=fields[name])
        for name in sorted(fields, key=lambda name: bool(fields[name]))
    ]
    adhesive = any(law.attracts for law in inputs.laws)
    return found + [entry_of(name).start for name in inputs.models if adhesive and name not in inputs.simulations]


def uses_target(inputs: Inputs) -> bool:
    """Whether a theory beside simulations is fed with the spectrum that surfaces are made from."""
    theories = [name for name in inputs.models if not entry_of(name).simulation]
    cases = {name: inputs.studies[entry_of(name).file].cases for name in theories}
    return bool(inputs.seeds) and any(
        (spectrum_of(name) or case.spectra[0]) == TARGET for name, own in cases.items() for case in own
    )
