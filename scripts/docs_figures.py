"""Draw the figures of the documentation that explain a concept, from small runs of the models themselves.

python -m scripts.docs_figures                 # all but those that need results of make paper
python -m scripts.docs_figures geometry laws   # some
python -m scripts.docs_figures overview        # from results/yang2008-paper
"""

import argparse
from collections.abc import Callable
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bem_adhesion import (
    Dugdale,
    Exponential,
    HalfSpace,
    LennardJones93,
    LennardJones104,
    Morse,
    rough_contact,
)
from contact_study.plots.style import COLOURS, STYLE
from scripts.docs_charts import ROOT, SOLID, choosing_tree, load_step, performance, row_of_axes, waterfall

IMAGES = ROOT / "docs" / "images"
PAPER = ROOT / "results" / "yang2008-paper"
MODULUS, WORK, LENGTH = 93.7e9, 2.77, 3.28e-10  # the paper's block at four times its adhesion
RIGID, RED = "#8c8c8c", "#c1121f"
CHARTS = waterfall, performance, choosing_tree, load_step
FIGURES: dict[str, Callable[[], Figure]] = {draw.__name__: draw for draw in CHARTS}


def figure(draw: Callable[[], Figure]) -> Callable[[], Figure]:
    """Enter a figure under the name of its function."""
    FIGURES[draw.__name__] = draw
    return draw


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(FIGURES)}; default all")
    parser.add_argument("--folder", type=Path, default=IMAGES, help="where to write (default docs/images)")
    given = parser.parse_args()
    unknown = set(given.names) - set(FIGURES)
    if unknown:
        parser.error(f"{', '.join(sorted(unknown))}: expected {', '.join(FIGURES)}")
    for name in given.names or [name for name in FIGURES if name != "overview" or PAPER.is_dir()]:
        with matplotlib.rc_context(STYLE):
            path = given.folder / f"{name}.png"
            FIGURES[name]().savefig(path, dpi=160, metadata={"Software": None})
        print(path)
    return 0


def _line(points: int = 512) -> tuple[np.ndarray, np.ndarray]:
    """A rough profile that does not change along y: positions (m) and heights (m)."""
    x = np.linspace(0, 50e-9, points, endpoint=False)
    rng = np.random.default_rng(4)
    height = sum(
        rng.normal() * np.cos(2 * np.pi * mode * x / 50e-9 + rng.uniform(0, 2 * np.pi)) / mode**1.5
        for mode in range(1, 9)
    )
    return x, 0.7e-9 * height / height.std()


def _pressed(pressure: float, points: int = 512) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, heights and the solid's surface of a profile under a mean pressure (m)."""
    x, height = _line(points)
    rows = np.tile(height, (8, 1))
    contact = rough_contact(rows, (50e-9 * 8 / points, 50e-9), HalfSpace(MODULUS), LennardJones104(WORK, LENGTH))
    found = contact.step(contact.separated(), pressure)
    return x, height, height + found.gap[0]


def _section(axes: Axes, x: np.ndarray, height: np.ndarray, surface: np.ndarray, top: float) -> None:
    """Draw a section through both bodies, in nm."""
    axes.fill_between(x, height.min() - 1.0, height, color=RIGID, linewidth=0)
    axes.fill_between(x, surface, top, color=SOLID, linewidth=0)
    axes.plot(x, height, color="black", linewidth=0.9)
    axes.plot(x, surface, color=COLOURS[0], linewidth=1.1)
    axes.set(xlabel="x (nm)", ylabel="z (nm)", xlim=(x[0], x[-1]), ylim=(height.min() - 1.0, top + 1.0))
    axes.grid(False)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], style: str = "<->", colour: str = RED):
    axes.annotate("", end, start, arrowprops={"arrowstyle": style, "color": colour, "shrinkA": 0, "shrinkB": 0})


@figure
def concept_geometry() -> Figure:
    made, (axes,) = row_of_axes(height=3.0)
    x, height, surface = (1e9 * values for values in _pressed(0.5e9))
    top = surface.max() + 1.6
    _section(axes, x, height, surface, top)
    at = int(np.argmax(surface - height))
    _arrow(axes, (x[at], height[at]), (x[at], surface[at]))
    axes.text(x[at] + 0.5, surface[at] - 0.15, "gap u = z − h", color=RED, va="top")
    for place in np.linspace(4, 46, 8):
        _arrow(axes, (place, top + 0.75), (place, top - 0.1), "->", "black")
    axes.text(1, top + 0.8, "pressure p > 0 compresses, p < 0 pulls", va="bottom")
    axes.text(1, top - 0.5, "elastic solid: E*, K(q)", color=COLOURS[0], va="top")
    axes.text(1, height.min() - 0.9, "rigid rough surface h(x, y)", color="white", va="bottom")
    axes.set_ylim(height.min() - 1.0, top + 1.4)
    return made


@figure
def concept_laws() -> Figure:
    made, (left, right) = row_of_axes(columns=2)
    work, length = 1.0, 1.0
    for (name, law), colour in zip(
        {
            "Lennard-Jones 10-4": LennardJones104(work, length),
            "Lennard-Jones 9-3": LennardJones93(work, length),
            "Morse": Morse(work, length, range=0.3),
        }.items(),
        COLOURS,
        strict=False,
    ):
        gap = np.linspace(0.9, 2.6, 700)
        left.plot(gap, law.traction(gap), color=colour, label=name)
    law = LennardJones104(work, length)
    left.plot(law.peak_distance, law.peak_tensile_stress, "o", color=COLOURS[0], markersize=4)
    left.annotate(
        "σ_max",
        (law.peak_distance, law.peak_tensile_stress),
        (1.5, 1.95),
        arrowprops={"arrowstyle": "-", "color": "0.4"},
    )
    left.annotate("d_eq", (1.0, 0.0), (1.4, -0.9), arrowprops={"arrowstyle": "-", "color": "0.4"})
    left.axvline(2 ** (1 / 6), color="0.6", linestyle=":", linewidth=0.9)
    left.text(2 ** (1 / 6) + 0.02, -1.9, "contact_distance", color="0.4", rotation=90, va="bottom", fontsize=6.5)
    left.set(xlabel="gap u / length", ylabel="traction φ′ (Δγ / length)", ylim=(-2, 2.3), title="smooth laws")
    gap = np.linspace(0, 3, 900)
    for (name, law), colour in zip(
        {"exponential": Exponential(work, length), "Dugdale": Dugdale(work, length)}.items(), COLOURS[3:], strict=False
    ):
        right.plot(gap, law.traction(gap), color=colour, label=name)
    right.axvline(0, color="black", linewidth=2.5)
    right.text(0.06, -0.35, "hard wall", va="center")
    _arrow(right, (0, 0.62), (1.0, 0.62), colour="0.4")
    right.text(0.5, 0.66, "range", color="0.4", ha="center")
    right.set(xlabel="gap u / length", ylim=(-0.6, 1.4), xlim=(-0.2, 3), title="attraction outside a hard wall")
    for axes in (left, right):
        axes.axhline(0, color="black", linewidth=0.6)
        axes.legend(loc="upper right")
    return made


@figure
def concept_spectrum() -> Figure:
    from contact_study import make_study, realise

    made, (left, right) = row_of_axes(columns=2)
    low, roll_off, cutoff, hurst = 1.0, 4.0, 64.0, 0.8
    wavevector = np.array([low, roll_off, cutoff, cutoff])
    density = np.array([1.0, 1.0, (cutoff / roll_off) ** (-2 * (1 + hurst)), 1e-6])
    left.loglog(wavevector, density, color=COLOURS[0])
    for place, name in ((low, "q_L longest"), (roll_off, "q_0 roll-off"), (cutoff, "q_1 shortest")):
        left.axvline(place, color="0.6", linestyle=":", linewidth=0.9)
        left.text(place * 1.06, 2e-6, name, rotation=90, va="bottom", fontsize=6.5, color="0.3")
    left.text(18, 3e-2, "slope −2(1 + H)", color=COLOURS[0])
    left.set(xlabel="wavevector q (2π / size)", ylabel="spectral density C(q) / C(q_0)", ylim=(1e-6, 4))
    case = make_study(
        {
            "surface": {
                "kind": "self_affine",
                "size": 1e-6,
                "shape": [256, 256],
                "rms_height": 1e-8,
                "hurst_exponent": hurst,
                "roll_off_mode": roll_off,
                "cutoff_mode": cutoff,
            },
            "material": {"youngs_modulus": 1e9, "poissons_ratio": 0.3},
            "interaction": {"law": "hard_wall"},
            "loading": {"path": [1e6]},
        }
    ).cases[0]
    image = right.imshow(1e9 * realise(case).sampled, origin="lower", extent=(0, 1, 0, 1), cmap="cividis")
    made.colorbar(image, ax=right, label="height h (nm)")
    right.set(xlabel="x / size", ylabel="y / size")
    right.grid(False)
    return made


@figure
def concept_contact() -> Figure:
    made, (axes,) = row_of_axes(height=2.8)
    x, height, surface = (1e9 * values for values in _pressed(2e9))
    top = surface.max() + 0.5
    _section(axes, x, height, surface, top)
    gap = surface - height
    for inside, colour, name in (
        (gap < 0.328, COLOURS[1], "compressed: u < d_eq, p > 0"),
        ((gap >= 0.328) & (gap < 0.368), COLOURS[4], "contact under tension: d_eq ≤ u < contact_distance"),
        ((gap >= 0.368) & (gap < 0.8), COLOURS[2], "attracted, no contact"),
    ):
        axes.plot(x, np.where(inside, height, np.nan), color=colour, linewidth=3.5, solid_capstyle="butt", label=name)
    axes.legend(loc="upper right")
    axes.set_ylim(height.min() - 0.3, top + 1.6)
    return made


@figure
def concept_distances() -> Figure:
    made, (axes,) = row_of_axes(height=3.2)
    x, height, surface = (1e9 * values for values in _pressed(0.5e9))
    top = surface.max() + 1.4
    _section(axes, x, height, surface, top)
    mean_height, mean_surface = float(height.mean()), float(surface.mean())
    for level, colour in ((mean_height, "black"), (mean_surface, COLOURS[0])):
        axes.axhline(level, color=colour, linestyle="--", linewidth=0.8)
    axes.text(50.4, mean_height, "mean of h", va="center")
    axes.text(50.4, mean_surface, "mean of z", va="center", color=COLOURS[0])
    _arrow(axes, (27, mean_height), (27, mean_surface))
    axes.text(27.4, mean_height + 0.05, "⟨u⟩ = mean gap + d_eq", color=RED, va="bottom")
    touch = float(height.max()) + 0.328
    axes.axhline(touch, color=COLOURS[2], linestyle=":", linewidth=1)
    axes.text(50.4, touch, "undeformed solid\nat first contact", va="center", color=COLOURS[2])
    _arrow(axes, (6, touch), (6, mean_surface), "->", COLOURS[2])
    axes.text(6.4, (touch + mean_surface) / 2, "approach", color=COLOURS[2], va="center")
    at = int(np.argmax(surface - height))
    _arrow(axes, (x[at], height[at]), (x[at], surface[at]), colour="black")
    axes.text(x[at] + 0.4, height[at] + 0.4, "local gap u", va="center")
    return made


@figure
def concept_loop() -> Figure:
    """A loop of one asperity under a prescribed gap."""
    made, (axes,) = row_of_axes(width=4.6, height=3.0)
    x = np.linspace(0, 1, 64, endpoint=False)
    height = 2.5e-9 * (np.cos(2 * np.pi * x)[:, None] + np.cos(2 * np.pi * x)[None, :])
    contact = rough_contact(height, 100e-9, HalfSpace(3e8), Exponential(0.1, 1e-9), control="gap")
    gaps = np.linspace(9e-9, 1.2e-9, 70)
    state, curves = contact.separated(), []
    for way in (gaps, gaps[::-1]):
        curve = []
        for gap in way:
            found = contact.step(state, float(gap))
            state = found.state
            curve.append((gap, found.pressure.mean()))
        curves.append(np.array(curve))
    (loading, unloading), names = curves, ("loading", "unloading")
    for curve, colour, style, name in zip(curves, COLOURS, ("-", "--"), names, strict=False):
        axes.plot(1e9 * curve[:, 0], 1e-6 * curve[:, 1], style, color=colour, label=name)
    axes.fill_between(1e9 * gaps, 1e-6 * loading[:, 1], 1e-6 * unloading[::-1, 1], color="0.9", linewidth=0)
    jump = int(np.argmax(np.abs(np.diff(loading[:, 1]))))
    lowest = int(np.argmin(unloading[:, 1]))
    low, high = axes.get_ylim()
    for name, (gap, pressure), (right, up) in (
        ("jump-in", loading[jump], (0.5, 0.12)),
        ("pull-off", unloading[lowest], (0.8, 0.04)),
    ):
        axes.annotate(
            name,
            (1e9 * gap, 1e-6 * pressure),
            (1e9 * gap + right, 1e-6 * pressure + up * (high - low)),
            arrowprops={"arrowstyle": "-", "color": "0.4"},
        )
    axes.axhline(0, color="black", linewidth=0.6)
    axes.set(xlabel="mean gap (nm)", ylabel="mean pressure (MPa)")
    axes.legend(title="grey: dissipated energy", loc="lower right")
    return made


@figure
def process_zone_grids() -> Figure:
    """One contact edge on grids of one, two and four points per process zone."""
    import warnings

    made, panels = row_of_axes(height=2.5, columns=3)
    zone = 5e-9
    law = Exponential(0.05, 2e-9)
    modulus = zone * (law.peak_tensile_stress**2) / 0.05
    for axes, per_zone in zip(panels, (1, 2, 4), strict=True):
        points = 16 * per_zone
        size = points * zone / per_zone
        x = (np.arange(points) + 0.5) * size / points
        height = 8e-9 * np.cos(2 * np.pi * x / size)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            contact = rough_contact(np.tile(height, (4, 1)), (4 * size / points, size), HalfSpace(modulus), law)
            found = contact.step(contact.separated(), 0.0 + 1e-3 * modulus)
        axes.step(1e9 * x, -1e-6 * found.pressure[0], where="mid", color=COLOURS[0])
        axes.plot(1e9 * x, -1e-6 * found.pressure[0], "o", color=COLOURS[0], markersize=2.5)
        axes.axhline(1e-6 * law.peak_tensile_stress, color="0.5", linestyle=":", linewidth=0.9)
        edge = 1e9 * x[int(np.argmin(found.pressure[0][: points // 2]))]
        axes.axvspan(edge, edge + 1e9 * zone, color=COLOURS[4], alpha=0.25, linewidth=0)
        axes.set(title=f"{per_zone} point{'s' if per_zone > 1 else ''} per process zone", xlabel="x (nm)")
        axes.set_xlim(edge - 2e9 * zone, edge + 4e9 * zone)
    panels[0].set_ylabel("tension (MPa)")
    return made


@figure
def height_map_pipeline() -> Figure:
    """A map of an instrument, step by step."""
    from scipy.ndimage import gaussian_filter

    from contact_study.numerics.grid import Grid
    from contact_study.physics.height_maps.preparation import detrended, filled, lowpassed, mirrored

    rng = np.random.default_rng(3)
    size = 1e-6
    smooth = gaussian_filter(rng.normal(size=(128, 128)), 5)
    raw = 5e-9 * smooth / smooth.std() + 0.4e-9 * rng.normal(size=smooth.shape)
    raw += np.linspace(0, 4e-8, 128)[None, :] + np.linspace(0, 1.5e-8, 128)[:, None]
    raw[40:52, 70:90] = np.nan
    level = detrended(raw, 1)
    whole = filled(level, (size / 128, size / 128))
    joined = mirrored(whole)
    steps = (
        ("raw", raw),
        ("detrend", level),
        ("fill", whole),
        ("edges: mirror", joined),
        ("lowpass", lowpassed(joined, Grid(joined.shape, (2 * size, 2 * size)), 6e-8)),
    )
    made, panels = row_of_axes(height=1.7, columns=len(steps))
    for axes, (name, heights) in zip(panels, steps, strict=True):
        axes.imshow(heights, origin="lower", cmap="cividis")
        axes.set(title=name, xticks=[], yticks=[])
        axes.grid(False)
    return made


@figure
def overview() -> Figure:
    """The problem, a gap map and contact area against pressure, from the datasets of make paper."""
    import xarray as xr

    continuum, atoms, theory = (xr.open_dataset(PAPER / f"{name}.nc") for name in ("bem", "md", "theory"))
    made = Figure(figsize=(10.5, 3.3), layout="constrained")
    left, middle, right = made.subplots(1, 3, width_ratios=(1.25, 1, 1.15))
    case = continuum.sel(well_depth_ratio=4).squeeze()
    state = case.isel(step=int(np.nanargmin(np.abs(case.applied_pressure.values - 1e9))))
    height = continuum.height.isel({name: 0 for name in continuum.height.dims if name not in ("y", "x")})
    gap = state.gap.values
    row = int(np.argmax((gap < 3.68e-10).mean(axis=1)))
    x, profile = 1e9 * height.x.values, 1e9 * height.values[row]
    surface = profile + 1e9 * gap[row]
    some = slice(0, x.size * 2 // 3)
    top = surface[some].max() + 2.5
    _section(left, x[some], profile[some], surface[some], top)
    at = int(np.argmax((surface - profile)[some]))
    _arrow(left, (x[at], profile[at]), (x[at], surface[at]))
    left.text(x[at] + 1, (profile[at] + surface[at]) / 2, "gap u = z − h", color=RED, va="center")
    for place in np.linspace(x[some][15], x[some][-15], 6):
        _arrow(left, (place, top + 0.9), (place, top - 0.6), "->", "black")
    left.text(x[some][4], top + 1.0, "p > 0 compresses, p < 0 pulls")
    left.text(x[some][4], top - 1.7, "elastic solid, E*", color=COLOURS[0])
    left.set(title="(a) the problem: one section", ylim=(profile.min() - 1, top + 2))
    colours = matplotlib.colormaps["cividis"].copy()
    colours.set_bad("black")
    shown = np.ma.masked_less(1e9 * gap, 0.368)
    image = middle.imshow(shown, origin="lower", extent=(0, x[-1], 0, x[-1]), cmap=colours)
    made.colorbar(image, ax=middle, label="gap u (nm), contact black", shrink=0.9)
    middle.set(xlabel="x (nm)", ylabel="y (nm)", title="(b) gap and contact, 1 GPa")
    middle.grid(False)
    for ratio, colour in zip((1, 4, 8), COLOURS, strict=False):
        for dataset, style in ((atoms, "s"), (continuum, "-"), (theory, "--")):
            one = dataset.sel(well_depth_ratio=ratio)
            one = one.sel(theory="persson") if "theory" in one.dims else one
            pressure = one.applied_pressure.squeeze().values / 1e9
            area = one.relative_contact_area.squeeze().values
            inside = pressure > 0
            order = np.argsort(pressure[inside])
            right.loglog(
                pressure[inside][order], area[inside][order], style, color=colour, markerfacecolor="none", markersize=5
            )
        right.plot([], [], color=colour, label=f"Δγ = {0.692 * ratio:.2g} J/m²")
    for style, label in (("ks", "atoms"), ("k-", "boundary elements"), ("k--", "Persson's theory")):
        right.plot([], [], style, markerfacecolor="none", label=label)
    right.set(xlabel="pressure p (GPa)", ylabel="contact area A/A₀", title="(c) one surface, three models")
    right.legend(fontsize=6.5)
    return made


if __name__ == "__main__":
    raise SystemExit(main())
