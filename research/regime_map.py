"""Where the example studies stand among the regimes of adhesive contact, as a Markdown table and a map.

The Tabor parameter at the scale of the roughness says whether the range of adhesion is short against what it deforms;
the ratio of adhesion to the elastic energy of full contact whether surfaces stay together without load:

python -m research.regime_map --figure docs/images/regime_map.png
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files

import numpy as np
from matplotlib.figure import Figure

from contact_study.physics.process_zone import DMT_LIKE, JKR_LIKE
from contact_study.physics.spheres.numbers import tabor_parameter
from contact_study.plots.style import COLOURS, DOUBLE, styled
from contact_study.report.align.regime import roughness
from contact_study.report.text.wording import coordinate_label, number
from contact_study.study.case import Case, realise
from contact_study.study.study import Study, read_study
from scripts.harness import FIGURE, head, program, row, save

STUDIES = ("first", "yang2008_quick", "yang2008", "rubber")
X_LIMITS, Y_LIMITS = (0.008, 20.0), (0.003, 30.0)
# What the parts of the map mean, at their places there.
WORDS = (
    (0.028, 8.0, "together without load,\nwith little deformed by attraction"),
    (7.5, 8.0, "together\nwithout load;\njumps, hysteresis"),
    (0.028, 0.008, "together under load,\nwith little deformed by attraction"),
    (7.5, 0.008, "together\nunder load;\njumps, hysteresis"),
)


@dataclass(frozen=True)
class Place:
    """One case of a study on the map: Tabor parameter, adhesion over elastic energy, grid spacing over process zone."""

    label: str
    tabor: float
    adhesion: float
    pixel: float


def run(given: argparse.Namespace) -> None:
    folder = files("contact_study").joinpath("example_studies")
    found = {name: list(places(read_study(str(folder.joinpath(f"{name}.toml"))))) for name in STUDIES}
    print(head("study", "", "Tabor parameter μ", "adhesion over elastic energy θ", "grid spacing over process zone"))
    for name, several in found.items():
        for place in several:
            print(row(f"`{name}`", place.label, *(number(x, 3) for x in (place.tabor, place.adhesion, place.pixel))))
    if given.figure:
        save(draw(found), given.figure)


def places(study: Study) -> Iterator[Place]:
    """Every case of a study of rough surfaces."""
    for case in study.cases:
        label = ", ".join(
            coordinate_label(name, value, study.sweep[name].units) for name, value in case.coordinates.items()
        )
        yield Place(label, *numbers_of(case))


def numbers_of(case: Case) -> tuple[float, float, float]:
    """μ, θ and the continuum's grid spacing over the process zone, as ``contact-compare`` has them."""
    surface, modulus, law = realise(case), case.solid.contact_modulus, case.law
    found = roughness(surface.sampled, surface.size, case.solid)
    reach = law.length if law.has_wall else law.equilibrium_distance
    tabor = tabor_parameter(2 / found.rms_laplacian, modulus, case.work_of_adhesion, reach)
    zone = modulus * case.work_of_adhesion / law.peak_tensile_stress**2
    energy = modulus * found.conformal_energy
    return tabor, case.work_of_adhesion * found.area_factor / energy, max(surface.grid.spacing) / zone


@styled
def draw(found: dict[str, list[Place]]) -> Figure:
    """The map."""
    figure = Figure(figsize=(DOUBLE, 4.2), layout="constrained")
    axes = figure.subplots()
    for name, colour in zip(found, COLOURS, strict=False):
        x, y = (np.array([getattr(place, what) for place in found[name]]) for what in ("tabor", "adhesion"))
        axes.plot(x, y, "o-", color=colour, ms=5, lw=0.8, label=name)
    axes.axvspan(DMT_LIKE, JKR_LIKE, color="0.92", lw=0, zorder=0)
    axes.axhline(1, color="0.5", lw=0.8, zorder=1)
    for x, y, words in WORDS:
        axes.text(x, y, words, ha="center", va="center", fontsize=7.5, color="0.3")
    between = "range and\ndeformation\nalike"
    axes.text(np.sqrt(DMT_LIKE * JKR_LIKE), 0.008, between, ha="center", va="center", fontsize=7, color="0.4")
    axes.set(xscale="log", yscale="log", xlim=X_LIMITS, ylim=Y_LIMITS)
    axes.set_xlabel(r"Tabor parameter $\mu = (R\,\Delta\gamma^2/E^{*2}r_0^3)^{1/3}$ of the roughness")
    axes.set_ylabel(r"adhesion over elastic energy of full contact $\theta$")
    figure.legend(loc="outside upper center", ncols=len(found))
    return figure


main = program(run, FIGURE)

if __name__ == "__main__":
    sys.exit(main())
