"""An adhesive law of your own
===========================

Retarded van der Waals forces between half-spaces fall as 1/d³ in energy; a new law needs only its potential. The
figure shows that the contact area hardly differs from that of the 10-4 law: the work of adhesion decides here, not
the range.
"""

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import LennardJones104, TractionLaw, rough_contact


class Retarded(TractionLaw):
    """Energy −Δγ (2x − x²), x = (r₀/d)³."""

    def potential(self, gap):
        x = (self.length / gap) ** 3
        return self.work_of_adhesion * (x**2 - 2 * x)


x = 2 * np.pi * np.arange(96) / 96
height = 0.4e-9 * (np.cos(x)[:, None] * np.cos(2 * x) + np.cos(3 * x)[:, None])  # m
pressures = np.geomspace(2e7, 2e9, 9)  # Pa

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for name, law in (("10-4", LennardJones104(0.1, 0.33e-9)), ("retarded", Retarded(0.1, 0.33e-9))):
    contact = rough_contact(height, 30e-9, elasticity=20e9, law=law)
    state, areas = contact.separated(), []
    for pressure in pressures:
        state = contact.step(state, pressure)
        areas.append(state.relative_contact_area)
    axes.semilogx(pressures / 1e6, areas, "o-", label=name)
axes.set(xlabel="pressure (MPa)", ylabel="relative contact area")
axes.legend(title="law", frameon=False)
figure.savefig("own_law.png", dpi=150)
