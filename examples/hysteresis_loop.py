"""Loading and unloading
=====================

A rough surface with strong adhesion approaches and retracts under control of the mean gap. The figure shows that
the two ways differ: contact forms in jumps and breaks in jumps at larger gaps, and the area between is lost energy.
"""

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import LennardJones104, rough_contact

size, points, steps = 40e-9, 320, 25
waves = np.hypot(np.fft.fftfreq(points, 1 / points)[:, None], np.fft.rfftfreq(points, 1 / points))
noise = np.fft.rfft2(np.random.default_rng(2).standard_normal((points, points)))
height = np.fft.irfft2(noise * (waves < 6))
height *= 0.55e-9 / height.std()
contact = rough_contact(height, size, 94e9, LennardJones104(5.6, 0.33e-9), control="gap")

approach = np.linspace(1.6e-9, 0.1e-9, steps)
path = np.concatenate([approach, approach[-2::-1]])
state, pressure = contact.separated(), []
for gap in path:
    state = contact.step(state, gap)
    pressure.append(state.pressure.mean())
lost = -np.trapezoid(pressure, path)

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
axes.axhline(0, color="0.8", lw=0.8)
axes.plot(path[:steps] * 1e9, np.array(pressure[:steps]) / 1e9, "o-", ms=3, label="approach")
axes.plot(path[steps - 1 :] * 1e9, np.array(pressure[steps - 1 :]) / 1e9, "s-", ms=3, label="retraction")
axes.set(xlabel="mean gap (nm)", ylabel="pressure (GPa)", title=f"{lost * 1e3:.0f} mJ/m² lost in the cycle")
axes.legend(frameon=False)
figure.savefig("hysteresis_loop.png", dpi=150)
