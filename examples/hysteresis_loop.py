"""Loading and unloading
=====================

Approach and retraction of a rough surface with strong adhesion: the loop of pressure and mean gap, and its loss::

    python examples/hysteresis_loop.py -o hysteresis_loop.png
"""

import argparse

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import LennardJones104, rough_contact

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("-o", "--output", default="hysteresis_loop.png", help="figure")
parser.add_argument("--points", type=int, default=320, help="grid points a side")
parser.add_argument("--steps", type=int, default=25, help="states of each branch")
arguments = parser.parse_args()

size, points = 40e-9, arguments.points
waves = np.fft.fftfreq(points, 1 / points)[:, None], np.fft.rfftfreq(points, 1 / points)
noise = np.fft.rfft2(np.random.default_rng(2).standard_normal((points, points)))
height = np.fft.irfft2(noise * (np.hypot(*waves) < 6), (points, points))
height *= 0.55e-9 / height.std()

law = LennardJones104(work_of_adhesion=5.6, length=0.33e-9)
contact = rough_contact(height, size, 94e9, law, control="gap")

gaps = np.linspace(1.6e-9, 0.1e-9, arguments.steps)
path = np.concatenate([gaps, gaps[-2::-1]])
state, pressure = contact.separated(), []
for gap in path:
    solution = contact.step(state, gap)
    state = solution.state
    pressure.append(solution.pressure.mean())
pressure = np.array(pressure)
dissipated = np.trapezoid(pressure, path)  # work put in on the way down, less what comes back on the way up

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
axes.axhline(0, color="0.8", lw=0.8)
axes.plot(path[: gaps.size] * 1e9, pressure[: gaps.size] / 1e9, "o-", ms=3, label="approach")
axes.plot(path[gaps.size - 1 :] * 1e9, pressure[gaps.size - 1 :] / 1e9, "s-", ms=3, label="retraction")
axes.set(xlabel="mean gap (nm)", ylabel="pressure (GPa)", title=f"{-dissipated * 1e3:.0f} mJ/m² lost in the cycle")
axes.legend(frameon=False)
figure.savefig(arguments.output, dpi=150)
