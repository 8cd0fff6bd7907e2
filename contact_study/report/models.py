"""The models as figures, tables and text show them: one frozen entry each, in the order of ``models.toml``.

Another model is shown once its entry is there. A name is the ``model`` attribute of a dataset, or a label of its
dimension ``theory``.
"""

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from contact_study.results.schema import SPECTRUM_MARK

if TYPE_CHECKING:
    from contact_study.plots.paths import Look

_PRESSED = "the surfaces are pressed closer than this distance on average"

# Between the name of a model and the file that distinguishes its datasets: "continuum:coarse".
_OF = ":"

FORMATS = ("png", "pdf", "svg")
"""Formats of figures."""

FIGURE_TITLES = {
    "stress_distribution": "Stress distribution",
    "gap_distribution": "Gap distribution",
    "contact_area": "Contact area against pressure",
    "mean_gap": "Pressure against mean gap",
    "gap_map": "Gap, contact black",
    "interface": "Interface",
    "magnification": "Magnification",
    "atoms": "Atoms",
    "loop": "Loading and unloading",
    "force": "Force curve",
    "criteria": "Criteria of sticking",
    "leakage": "Leakage",
}
"""Figures of a report by name, in the order of their numbers."""

TARGET = "analytic"  # the spectrum that surfaces are made from

# What a theory's other spectra add to its label, words and short name.
_SPECTRA = {
    "surface": ("own spectrum", "with the surface's own spectrum", "own"),
    TARGET: ("target spectrum", "with the target spectrum", "target"),
    "table": ("tabulated spectrum", "with the tabulated spectrum", "table"),
}

# For several datasets of one model: the first has the model's own line and marker.
_OTHER_LINES: tuple[Any, ...] = ((0, (7, 1.5)), (0, (4, 1, 1, 1)), (0, (4, 1, 1, 1, 1, 1)))
_OTHER_MARKERS = ("^", "D", "P")


@dataclass(frozen=True)
class ShownModel:
    """One model as a reader meets it; ``models.toml`` has the entries."""

    name: str  # in datasets
    file: str  # ``model`` attribute of the datasets that hold it
    label: str  # in a legend
    words: str  # inside a sentence, with its article
    short: str  # at the head of a narrow column
    trust: int  # a model is compared with those of more trust; theories, which have none, are no reference
    colour: str  # where colours mean nothing else
    line: str  # "none" for markers alone
    marker: str  # empty for a line alone
    about: str  # description
    start: str  # origin of its states
    marker_size: float = 3.2  # in points, as the width of lines
    line_width: float = 1.4
    hollow: bool = False  # whether its markers are not filled
    simulation: bool = False  # whether it is of one surface, point by point; theories use a spectrum
    measured: bool = False  # whether its constants are measured on itself, not given
    feels_law: bool = False  # whether the traction-separation law acts in it at every gap
    about_adhesion: str = ""  # description with adhesion, and at a hard wall
    about_hard_wall: str = ""
    status: str = ""  # whether a theory is published, shown wherever it is ranked
    start_predicted: str = ""  # origin of states that start from the fields of another dataset, ``{predictor}``
    densities: str = ""  # peculiarity of its distributions, and of its contact area; without it counts as simulations
    area: str = ""
    negative_gap: str = _PRESSED  # meaning of a mean gap below zero


_ENTRIES = tomllib.loads(files(__package__).joinpath("models.toml").read_text(encoding="utf-8"))
MODELS = tuple(ShownModel(**entry) for entry in _ENTRIES["model"])


def entry_of(name: str) -> ShownModel:
    """The entry of a model; one of several datasets of it is called after its file, too.

    Raises
    ------
    KeyError
        If there is no such entry.
    """
    fed, _, file = name.partition(_OF)
    model, _, spectrum = fed.partition(SPECTRUM_MARK)
    entry = {entry.name: entry for entry in MODELS}[model]
    if spectrum:
        label, words, short = _SPECTRA[spectrum]
        entry = replace(
            entry,
            name=fed,
            label=f"{entry.label}, {label}",
            words=f"{entry.words} {words}",
            short=f"{entry.short}, {short}",
        )
    if not file:
        return entry
    label, words, short = (f"{text} ({file})" for text in (entry.label, entry.words, entry.short))
    return replace(entry, name=name, file=of_file(entry.file, file), label=label, words=words, short=short)


def look_of(model: str, beside: Iterable[str]) -> "Look":
    """How a model is drawn in a figure beside others; datasets of one model take turns."""
    from contact_study.plots.paths import Look  # brings Matplotlib

    entry = entry_of(model)
    line, marker = entry.line, entry.marker
    turn = [name for name in dict.fromkeys(beside) if kind_of(name) == kind_of(model)].index(model)
    if turn:
        line = line if line == "none" else _OTHER_LINES[(turn - 1) % len(_OTHER_LINES)]
        marker = _OTHER_MARKERS[(turn - 1) % len(_OTHER_MARKERS)] if marker else marker
    behind = not entry.simulation
    return Look(line, marker, entry.marker_size, entry.line_width, entry.hollow, behind, entry.label, entry.colour)


def known(name: str) -> bool:
    """Whether a model has an entry."""
    return any(entry.name == kind_of(name) for entry in MODELS) and spectrum_of(name) in ("", *_SPECTRA)


def is_simulated(file: str) -> bool:
    """Whether a kind of file, or one of several files of it, holds a simulation."""
    return any(entry.simulation for entry in MODELS if entry.file == kind_of(file))


def of_file(name: str, file: str) -> str:
    """The name of a model or of a kind of file where there are several files of it."""
    return f"{name}{_OF}{file}" if file else name


def kind_of(name: str) -> str:
    """The model of which a name may be one of several datasets, or spectra."""
    return name.partition(_OF)[0].partition(SPECTRUM_MARK)[0]


def spectrum_of(name: str) -> str:
    """The spectrum that a theory is fed with, where that is not the first of its study; else empty."""
    return name.partition(_OF)[0].partition(SPECTRUM_MARK)[2]


def in_order(names: Iterable[str]) -> list[str]:
    """Names in the order of the entries."""
    order = [entry.name for entry in MODELS]
    return sorted(names, key=lambda name: order.index(kind_of(name)))


def file_kinds() -> list[str]:
    """Values of the ``model`` attribute of a dataset, the most trusted first."""
    return list(dict.fromkeys(entry.file for entry in MODELS))
