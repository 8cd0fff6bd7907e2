"""Lines of the theories of a smooth sphere beside a computed force curve, for the sphere of its study."""

import math
import tomllib
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.inputs.errors import InputError
from contact_study.physics.solids import HalfSpace
from contact_study.physics.spheres import DMT, JKR, Hertz, MaugisDugdale, SphereTheory
from contact_study.plots.style import Unit
from contact_study.study.case import Case
from contact_study.study.study import make_study

# Line of each theory.
THEORIES: dict[str, Any] = {"hertz": (0, (6, 2, 1, 2, 1, 2)), "jkr": "-.", "dmt": ":", "maugis": "-"}
_COLOUR, _WIDTH = "#707070", 1.0
_BEYOND = 0.05  # of the width of the axes: how far a line reaches beyond the states


def sphere_theories(dataset: xr.Dataset, names: Sequence[str]) -> dict[str, SphereTheory]:
    """Theories by their label, of the smooth sphere that one case of a study presses on a half-space."""
    if unknown := [name for name in names if name not in THEORIES]:
        raise ValueError(f"theories: {unknown[0]!r} is none of {', '.join(THEORIES)}")
    case = _case(dataset)
    radius = _radius(case)
    if type(case.solid) is not HalfSpace or case.material.hardness is not None:
        raise ValueError("theories: they are of an elastic half-space; this study's solid is another")
    if case.adhesion_map.kind != "none":
        raise ValueError("theories: they have one work of adhesion; this study's varies by [adhesion_map]")
    if any(name != "hertz" for name in names) and not case.law.attracts:
        raise ValueError(f'theories: interaction.law = "{case.interaction.law}" does not attract; use "hertz"')
    constants = radius, case.solid.contact_modulus
    found: dict[str, SphereTheory] = {}
    for name in names:
        if name == "hertz":
            found["Hertz"] = Hertz(*constants)
        elif name == "jkr":
            found["JKR"] = JKR(*constants, case.work_of_adhesion)
        elif name == "dmt":
            found["DMT"] = DMT(*constants, case.work_of_adhesion)
        else:
            sphere = MaugisDugdale(*constants, case.work_of_adhesion, case.law.peak_tensile_stress)
            found[f"Maugis, λ = {sphere.parameter:.2g} (σ₀: the law's peak)"] = sphere
    return found


def draw_theories(
    axes: Axes, theories: dict[str, SphereTheory], against: str, largest_force: float, units: tuple[Unit, Unit]
) -> None:
    """Draw the curve of each theory up to a force (N), as far as the axes show states; fainter where not stable.

    A line is stable as under a prescribed displacement; ``units`` are those of length and force.
    """
    length, force = units
    low, high = axes.get_xlim()
    start = low - _BEYOND * (high - low)
    for (label, theory), look in zip(theories.items(), map(_look, theories), strict=True):
        end = max(largest_force, 0.1 * abs(theory.pull_off_force))
        curve = theory.curve(end, points=2000)
        x = (curve.displacement if against == "displacement" else curve.contact_radius) / length.size
        y = np.where(x >= start, curve.force / force.size, np.nan)
        for part, alpha in ((curve.held, 1.0), (~curve.held, 0.4)):
            named = label if alpha == 1.0 else None
            drawn = np.where(part, y, np.nan)
            axes.plot(x, drawn, linestyle=look, color=_COLOUR, lw=_WIDTH, alpha=alpha, label=named, zorder=1.5)


def _look(label: str) -> Any:
    return next(look for name, look in THEORIES.items() if label.lower().startswith(name))


def _case(dataset: xr.Dataset) -> Case:
    """The case of a study that a dataset holds."""
    try:
        study = make_study(tomllib.loads(str(dataset.attrs["study_toml"])))
    except (KeyError, InputError, tomllib.TOMLDecodeError):
        raise ValueError("theories: the dataset does not hold the study of its sphere (attribute study_toml)") from None
    shown = dataset.squeeze()
    for name in study.cases[0].coordinates:
        if name in shown.dims:
            raise ValueError(f"theories: the dataset has more than one case: select one along {name!r} first")
        if name not in shown.coords:
            raise ValueError(f"theories: the dataset does not say which {name} of its study it has")
    found = [case for case in study.cases if all(_same(shown[name], one) for name, one in case.coordinates.items())]
    if len(found) != 1:
        raise ValueError("theories: the dataset holds no case of its study")
    return found[0]


def _same(coordinate: xr.DataArray, value: Any) -> bool:
    own = coordinate.item()
    return bool(own == value if isinstance(own, str) else math.isclose(float(own), float(value), rel_tol=1e-9))


def _radius(case: Case) -> float:
    """Radius of the smooth sphere (m): a surface, or a form without roughness."""
    bare = not case.surface.rough and case.detail.absent and case.counterface.absent
    if case.geometry is case.surface and case.surface.kind == "sphere":
        radii = {getattr(case.surface, "radius", 0.0)}
    else:
        known = {"sphere": ("radius",), "paraboloid": ("radii",)}.get(case.form.kind, ()) if bare else ()
        radii = {*np.ravel([getattr(case.form, name) for name in known]).tolist()}
    if len(radii) != 1:
        raise ValueError(
            'theories: the study presses no smooth sphere; use a [form], "sphere" or "paraboloid", on a flat surface'
        )
    return float(radii.pop())
