"""By how much adhesion steepens ln p over the mean gap: the polymer contact at the end of Yang et al. 2008.

The paper finds some 20 % for the system of Benz et al., J. Phys. Chem. B 110, 11884 (2006), and gives none of the
inputs. In units of the contact modulus the ratio of the slopes with and without adhesion depends on the pressure, on
the shape of the spectrum, and on θ = Δγ S/U_full, what full contact gains over what it costs. EVERY input below is an
assumption of this script; none is from Benz et al.

Two ratios: of −d ln p/dū of flat surfaces, 1/(dU/dp), and of −d ln F/dD of a large sphere, whose load at the distance D
is F = 2πR ∫ p dū = 2πR [U(p) − U(0)] by Derjaguin's integration, without flattening of its bulk; p is that at the apex.

python -m research.polymer_contact --figure polymer_contact.png
"""

import argparse
import sys
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_study.plots.style import styled
from scripts.harness import FIGURE, head, program, row, save
from theory import PerssonTheory, SelfAffineSpectrum, criteria

ASSUMED_PRESSURE = 2e-4  # p/E*
ASSUMED_CUTOFF = 72.0  # q₁/q₀
ASSUMED_THETA = (0.05, 0.1, 0.2, 0.3, 0.4)
# The box of the map: Young's modulus (Pa), work of adhesion (J/m²), and one surface.
ASSUMED_MODULI = (1e8, 1e10)
ASSUMED_WORKS = (1e-3, 0.2)
ASSUMED_POISSON = 0.4
ASSUMED_HEIGHT = 3e-9  # rms (m)
ASSUMED_ROLL_OFF = 2 * np.pi / 1e-6  # q₀ (1/m)

# Half the step of the derivative in ln p, and the tolerance that its difference of energies needs.
_STEP, _TOLERANCE = 0.2, 1e-9


@dataclass(frozen=True)
class Shape:
    """Shape of a spectrum, flat from q_L to q₀, and its rms slope, all assumed."""

    hurst_exponent: float = 0.8
    flat_part: float = 3.0  # q₀/q_L
    rms_slope: float = 0.1

    def spectrum(self) -> SelfAffineSpectrum:
        """A spectrum of this shape; its lengths do not matter."""
        unit = SelfAffineSpectrum(self.hurst_exponent, 1.0, 1 / self.flat_part, 1.0, ASSUMED_CUTOFF)
        return SelfAffineSpectrum(
            self.hurst_exponent, self.rms_slope / unit.rms_slope, 1 / self.flat_part, 1.0, ASSUMED_CUTOFF
        )


SHAPES = (Shape(), Shape(hurst_exponent=0.7), Shape(hurst_exponent=0.9), Shape(flat_part=1.0), Shape(rms_slope=0.3))


def slope_ratios(spectrum: SelfAffineSpectrum, theta: float, pressure: float = ASSUMED_PRESSURE) -> tuple[float, float]:
    """Slopes with adhesion over those without, of flat surfaces and of a sphere, at p/E*."""
    work = theta / criteria.persson_tosatti_ratio(spectrum, 1.0, 1.0)
    bare, adhesive = (_energies(PerssonTheory(spectrum, 1.0, each), pressure) for each in (0.0, work))
    return bare[0] / adhesive[0], bare[1] / adhesive[1]


def _energies(theory: PerssonTheory, pressure: float) -> tuple[float, float]:
    """dU/dp, and U over p: without sticking U(0) is zero."""
    steps = pressure * np.exp([-_STEP, 0.0, _STEP])
    below, here, above = (theory.at_pressure(float(p), tolerance=_TOLERANCE).energy for p in steps)
    return (above - below) / (steps[2] - steps[0]), here / pressure


def run(given: argparse.Namespace) -> None:
    print(f"Assumed: p/E* = {ASSUMED_PRESSURE:g}, q₁/q₀ = {ASSUMED_CUTOFF:g}, and the shapes in the columns.\n")
    heads = [f"H = {s.hurst_exponent:g}, q₀/q_L = {s.flat_part:g}, slope {s.rms_slope:g}" for s in SHAPES]
    print(head("θ", *heads, "first, sphere"))
    for theta in ASSUMED_THETA:
        ratios = [slope_ratios(shape.spectrum(), theta) for shape in SHAPES]
        print(row(f"{theta:g}", *(f"{flat:.3f}" for flat, _ in ratios), f"{ratios[0][1]:.3f}"))
    if given.figure:
        save(drawn(), given.figure)


@styled
def drawn() -> Figure:
    """The ratio over θ, and over modulus and work of adhesion of one surface."""
    figure = Figure(figsize=(7.0, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2)
    _draw_curves(left)
    _draw_map(figure, right)
    return figure


def _draw_curves(axes: Axes) -> None:
    theta = np.linspace(0.02, 0.4, 12)
    for shape in SHAPES:
        found = [slope_ratios(shape.spectrum(), float(each))[0] for each in theta]
        words = f"$H$ = {shape.hurst_exponent:g}, $q_0/q_L$ = {shape.flat_part:g}, slope {shape.rms_slope:g}"
        axes.plot(theta, found, label=words)
    axes.axhline(1.2, color="#909090", lw=0.8)
    axes.set(xlabel=r"$\theta$", ylabel=r"ratio of the slopes of $\ln p(\bar{u})$", title="spectra, all assumed")
    axes.title.set_fontsize(7)
    axes.legend(fontsize=6)


def _draw_map(figure: Figure, axes: Axes) -> None:
    """The ratio over modulus and work of adhesion, one surface: both enter by θ alone."""
    low = ASSUMED_ROLL_OFF / Shape().flat_part
    surface = SelfAffineSpectrum(0.8, ASSUMED_HEIGHT, low, ASSUMED_ROLL_OFF, ASSUMED_CUTOFF * ASSUMED_ROLL_OFF)
    theta = np.linspace(0.0, 0.45, 16)
    ratios = [1.0, *(slope_ratios(surface, float(each))[0] for each in theta[1:])]
    modulus, work = np.geomspace(*ASSUMED_MODULI, 121), np.geomspace(*ASSUMED_WORKS, 121)
    contact_modulus = modulus[None, :] / (1 - ASSUMED_POISSON**2)
    here = work[:, None] * criteria.persson_tosatti_ratio(surface, 1.0, 1.0) / contact_modulus
    shown = np.ma.masked_where(here > theta[-1], np.interp(here, theta, ratios))
    mesh = axes.pcolormesh(modulus / 1e9, 1e3 * work, shown, vmin=1, vmax=2, cmap="viridis", rasterized=True)
    lines = axes.contour(modulus / 1e9, 1e3 * work, shown, [1.05, 1.2, 1.5], colors="white", linewidths=0.8)
    axes.clabel(lines, fontsize=6)
    height, wave = 1e9 * ASSUMED_HEIGHT, 2e6 * np.pi / ASSUMED_ROLL_OFF
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="Young's modulus (GPa), assumed",
        ylabel="work of adhesion (mJ/m²), assumed",
        title=rf"assumed: $h_\mathrm{{rms}}$ {height:g} nm, $2\pi/q_0$ {wave:g} µm; white: near sticking",
    )
    axes.title.set_fontsize(7)
    axes.grid(False)
    figure.colorbar(mesh, ax=axes, label="ratio", extend="max")


main = program(run, FIGURE)

if __name__ == "__main__":
    sys.exit(main())
