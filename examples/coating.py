"""A soft coating on a stiff solid
===============================

A rough surface presses on a coating whose base is fifty times as stiff. The figure shows the contact area at one
pressure between the limits of the base and of the coating material alone.
"""

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import HalfSpace, HardWall, Layered, rough_contact

size, points = 1e-6, 128
waves = np.hypot(np.fft.fftfreq(points, 1 / points)[:, None], np.fft.rfftfreq(points, 1 / points))
noise = np.fft.rfft2(np.random.default_rng(3).standard_normal((points, points)))
height = np.fft.irfft2(noise * (waves + 1) ** -1.8 * (waves < 20))
height *= 5e-9 / height.std()


def area(solid):
    """Return the relative contact area at one pressure."""
    contact = rough_contact(height, size, solid, HardWall())
    return contact.step(contact.separated(), 2e6).relative_contact_area


soft, stiff = 1e8, 5e9  # contact moduli (Pa)
thickness = np.geomspace(0.01, 3, 12) * size

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
axes.semilogx(thickness / size, [area(Layered(soft, 0.3, d, stiff, 0.3)) for d in thickness], "o-", label="coating")
for name, modulus, colour in (("coating material", soft, "C2"), ("base", stiff, "C3")):
    axes.axhline(area(HalfSpace(modulus)), linestyle="--", color=colour, label=f"{name} alone")
axes.set(xlabel="thickness over cell", ylabel="relative contact area", title="2 MPa")
axes.legend(frameon=False)
figure.savefig("coating.png", dpi=150)
