"""An elastic solid of your own
============================

A graded solid is stiff at depth and soft at its surface; the solvers know it by its stiffness K(q). The figure shows
that long waves feel the stiff interior, so the graded solid has less contact than its soft skin alone.
"""

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import Elasticity, HalfSpace, HardWall, rough_contact


class Graded(Elasticity):
    """Stiffness of a wave: that of a half-space, ten times as large for long waves."""

    def stiffness(self, wavenumber):
        q = np.asarray(wavenumber)
        return 0.5 * self.contact_modulus * q * (1 + 9 * np.exp(-q * 2e-8))


rng = np.random.default_rng(1)
waves = np.hypot(np.fft.fftfreq(128, 1 / 128)[:, None], np.fft.rfftfreq(128, 1 / 128))
height = np.fft.irfft2(np.fft.rfft2(rng.standard_normal((128, 128))) * (1 + waves) ** -1.8 * (waves < 16))
height *= 1e-9 / height.std()  # m

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
pressures = np.geomspace(0.3, 100, 10)  # MPa
for name, solid in (("homogeneous", HalfSpace(1e9)), ("graded", Graded(1e9))):
    contact = rough_contact(height, 200e-9, solid, HardWall())
    areas = [contact.step(contact.separated(), 1e6 * pressure).relative_contact_area for pressure in pressures]
    axes.loglog(pressures, areas, "o-", label=name)
axes.set(xlabel="pressure (MPa)", ylabel="relative contact area")
axes.legend(frameon=False)
figure.savefig("own_solid.png", dpi=150)
