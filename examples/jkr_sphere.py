"""A sphere that sticks
====================

A sphere that sticks: approach, snap-in, pull-off, and the theory of Johnson, Kendall and Roberts.

The sphere is a paraboloid in a periodic cell, so wide that its neighbours' attraction and stress stay small. At a Tabor
parameter of some units the pull-off force is near −3/2 π w R, JKR's limit of infinite Tabor parameter::

    python examples/jkr_sphere.py -o jkr_sphere.png
"""

import argparse

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import LennardJones104, rough_contact

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("-o", "--output", default="jkr_sphere.png", help="figure")
parser.add_argument("--points", type=int, default=288, help="grid points a side")
arguments = parser.parse_args()

radius, modulus, work, length = 50e-9, 1e9, 0.05, 0.4e-9  # R, E*, w, r0
tabor = (radius * work**2 / (modulus**2 * length**3)) ** (1 / 3)
size = 60e-9
axis = (np.arange(arguments.points) - arguments.points // 2) * size / arguments.points
height = -(axis[:, None] ** 2 + axis**2) / (2 * radius)

law = LennardJones104(work, length)
contact = rough_contact(height, size, modulus, law)
unit = np.pi * work * radius

loading = np.linspace(0.05, 3, 8)
unloading = np.concatenate([loading[-2::-1], np.arange(-0.1, -2, -0.1)])
state, found = contact.separated(), []
for force in np.concatenate([loading, unloading]):
    solution = contact.step(state, force * unit / size**2)
    state = solution.state
    touching = np.mean(solution.gap < 1.1 * length)
    found.append((force, np.sqrt(touching * size**2 / np.pi) if not solution.detached else 0.0, solution.detached))
    if solution.detached:
        break
force, contact_radius, _ = np.transpose(found)

# JKR: F = 4 E* a³/(3 R) − √(8 π w E* a³), in units of π w R.
a = np.linspace(0.15, 2.05, 200) * np.cbrt(np.pi * work * radius**2 / modulus)
jkr = (4 * modulus * a**3 / (3 * radius) - np.sqrt(8 * np.pi * work * modulus * a**3)) / unit

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
axes.plot(jkr, a * 1e9, "-", color="0.6", label="JKR")
turn = loading.size
axes.plot(force[:turn], contact_radius[:turn] * 1e9, "o", mfc="w", label="loading")
axes.plot(force[turn:-1], contact_radius[turn:-1] * 1e9, "s", ms=4, label="unloading")
axes.axvline(-1.5, color="0.8", lw=0.8, zorder=0)
axes.set(xlabel="force / π w R", ylabel="contact radius (nm)", title=f"Tabor parameter {tabor:.1f}")
axes.legend(frameon=False)
figure.savefig(arguments.output, dpi=150)
print(f"pull-off between {force[-2]:.2f} and {force[-1]:.2f} π w R (JKR: -1.50)")
