"""The models as figures, tables and sentences show them: one frozen entry each, in the order in which they stand.

To show another model is to add its entry. A name here is the ``model`` attribute of a dataset, or a label of its
dimension ``theory``.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from contact_study.results.schema import SPECTRUM_MARK

_PRESSED = "the surfaces are pressed closer than this distance on average"

_OWN = "this project's own, unpublished"

# Between the name of a model and the file that tells one of its datasets from another: "continuum:coarse".
_OF = ":"

FORMATS = ("png", "pdf", "svg")
"""Formats of figures."""

FIGURE_TITLES = {
    "stress_distribution": "Stress distribution",
    "gap_distribution": "Gap distribution",
    "contact_area": "Contact area",
    "mean_gap": "Mean gap",
    "gap_map": "Gap fields",
    "interface": "Interface",
    "magnification": "Magnification",
    "atoms": "Atoms",
}
"""Figures of a report by name, in their order."""

TARGET = "analytic"  # the spectrum that surfaces are made from

# What a theory's other spectra add to its label, words and short name.
_SPECTRA = {
    "surface": ("own spectrum", "with the surface's own spectrum", "own"),
    TARGET: ("target spectrum", "with the target spectrum", "target"),
    "table": ("tabulated spectrum", "with the tabulated spectrum", "table"),
}


@dataclass(frozen=True)
class ShownModel:
    """One model as a reader meets it.

    Attributes
    ----------
    name : str
        In datasets.
    file : str
        The ``model`` attribute of the datasets that hold it.
    label, words, short : str
        In a legend, inside a sentence (with its article), at the head of a narrow column.
    trust : int
        A model is compared with those of more trust; what has none is no reference.
    colour, line, marker : str
        As matplotlib knows them; no marker: lines alone, no line ("none"): markers alone. The colour is used where
        colours mean nothing else.
    marker_size, line_width : float
        In points.
    hollow : bool
        Whether its markers are not filled.
    simulation : bool
        Whether it is of one surface, point by point; theories know a spectrum and reach beyond any sampling.
    measured : bool
        Whether its constants are measured on itself, not given.
    feels_law : bool
        Whether the traction-separation law acts in it at every gap.
    about, about_adhesion, about_hard_wall : str
        What it is; what of it holds with adhesion, and at a hard wall.
    status : str
        Whether a theory is published, said wherever it is ranked.
    start : str
        Where its states come from.
    start_predicted : str
        The same where they start from the fields of another dataset, ``{predictor}``.
    densities, area, negative_gap : str
        What is to be known of its distributions, of its contact area, and of a mean gap below zero; without the first
        two it counts as the simulations do.
    settings : str
        Macro of ``templates/settings.j2`` that puts its settings into words.
    """

    name: str
    file: str
    label: str
    words: str
    short: str
    trust: int
    colour: str
    line: str
    marker: str
    about: str
    start: str
    marker_size: float = 3.2
    line_width: float = 1.4
    hollow: bool = False
    simulation: bool = False
    measured: bool = False
    feels_law: bool = False
    about_adhesion: str = ""
    about_hard_wall: str = ""
    status: str = ""
    start_predicted: str = ""
    densities: str = ""
    area: str = ""
    negative_gap: str = _PRESSED
    settings: str = ""


MODELS = (
    ShownModel(
        name="atomistic",
        settings="atoms",
        file="atomistic",
        label="atoms",
        words="the atoms",
        short="atoms",
        trust=2,
        colour="#000000",
        line="none",
        marker="s",
        marker_size=5.5,
        hollow=True,
        simulation=True,
        measured=True,
        about="A harmonic block of atoms whose bottom layer feels one layer of substrate sites through the pair "
        "potential. It knows nothing of the law: its modulus, work of adhesion and largest tensile stress are measured "
        "on it and listed below. It adds to the continuum what a lattice has: discrete sites, lateral displacement, "
        "pair forces that feel the slope of the surface.",
        start="The atoms start from separation and follow the path.",
        start_predicted="The atoms start each state from the continuum's gap field ({predictor}): where adhesion "
        "leaves them several states, this chooses the continuum's branch, not that of their own way from separation.",
    ),
    ShownModel(
        name="continuum",
        settings="continuum",
        file="continuum",
        label="continuum",
        words="the continuum",
        short="continuum",
        trust=1,
        colour="#0072B2",
        line="-",
        line_width=0.8,
        marker="o",
        simulation=True,
        feels_law=True,
        about="The linearly elastic solid of contact modulus E* on the rigid surface of small slopes.",
        about_adhesion="Every gap feels the traction–separation law; the state is a local minimum of the energy, "
        "followed along the loading path.",
        about_hard_wall="At the hard wall no gap is negative, no pressure is, only points that touch carry any, and "
        "the state is the only one at its load.",
        start="The continuum starts from separation and follows the path.",
    ),
    ShownModel(
        name="persson",
        settings="theories",
        file="theory",
        label="Persson's theory",
        words="Persson's theory",
        short="Persson",
        trust=0,
        colour="#D55E00",
        line="--",
        marker="",
        status="published",
        about="The theory of the paper: the stress distribution diffuses with the roughness added at growing "
        "magnification and is absorbed where the tension reaches that of a crack. It knows the spectrum, not the "
        "surface, and takes the range of the law to be zero.",
        start="Persson's theory starts on the adhered branch, each state from the one before.",
        densities="Persson's theory counts the stress in contact only, so that its integral is A/A₀; it has no "
        "distribution of gaps.",
        area="its real contact area at the highest magnification",
        negative_gap="its energy U(p) somewhere falls with growing p, ū = ∫dU/p, and ū is no distance of surfaces",
    ),
    ShownModel(
        name="gap_flow",
        settings="theories",
        file="theory",
        label="gap-flow theory",
        words="the gap-flow theory",
        short="gap\u00a0flow",
        trust=0,
        colour="#009E73",
        line=":",
        marker="",
        feels_law=True,
        status=_OWN,
        about="Roughness is added scale by scale, from fine to coarse, to the law itself. It keeps the law's range, "
        "knows the spectrum only, and gives an equilibrium with two metastable branches on either side.",
        start="The gap-flow theory gives the equilibrium at each point, whatever came before.",
    ),
    ShownModel(
        name="edge_flow",
        settings="theories",
        file="theory",
        label="edge flow",
        words="the edge flow",
        short="edge\u00a0flow",
        trust=0,
        colour="#CC79A7",
        line="-.",
        marker="",
        feels_law=True,
        status=_OWN,
        about="The gap flow whose response to each scale costs the elastic energy of its own modulation, so that "
        "contact has edges. It knows the spectrum only and gives one state at each mean gap, without hysteresis; its "
        "pressure is the slope of its energy, from which the mean of its local pressures differs by its own error.",
        start="The edge flow gives one state at each point, whatever came before.",
    ),
)


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


def known(name: str) -> bool:
    """Whether a model has an entry."""
    return any(entry.name == kind_of(name) for entry in MODELS) and spectrum_of(name) in ("", *_SPECTRA)


def is_simulated(file: str) -> bool:
    """Whether a kind of file, or one of several files of it, holds a simulation."""
    return any(entry.simulation for entry in MODELS if entry.file == kind_of(file))


def of_file(name: str, file: str) -> str:
    """The name of a model or of a kind of file where several files of it stand side by side."""
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
    """What the ``model`` attribute of a dataset may say, the most trusted first."""
    return list(dict.fromkeys(entry.file for entry in MODELS))
