"""A rough sphere with free boundaries
===================================

One rough sphere on an endless half-space: roughness adds to the shape, and free boundaries remove the periodic
images. The contact map shows that roughness breaks the contact of the smooth sphere into patches.
"""

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import HalfSpace, HardWall, rough_contact

size, points, radius = 2e-6, 128, 10e-6  # m
x = (np.arange(points) - points / 2) * size / points
sphere = -(x[:, None] ** 2 + x**2) / (2 * radius)
waves = np.hypot(np.fft.fftfreq(points, 1 / points)[:, None], np.fft.rfftfreq(points, 1 / points))
noise = np.fft.rfft2(np.random.default_rng(2).standard_normal((points, points)))
rough = np.fft.irfft2(noise * (waves + 1) ** -1.8 * (waves > 3) * (waves < 30))
rough *= 3e-9 / rough.std()

figure, panels = plt.subplots(1, 2, figsize=(7, 3.4), layout="constrained")
for axes, (name, height) in zip(panels, (("smooth", sphere), ("rough", sphere + rough)), strict=True):
    contact = rough_contact(height, size, HalfSpace(2e9), HardWall(), boundary="free")
    found = contact.step(contact.separated(), 1e7)  # force over the area of the cell
    image = axes.imshow(found.pressure / 1e6, origin="lower", extent=[-1, 1, -1, 1], cmap="magma")
    axes.set(title=f"{name}: A/A₀ = {found.relative_contact_area:.3f}", xlabel="x (µm)", ylabel="y (µm)")
figure.colorbar(image, label="pressure (MPa)")
figure.savefig("free_rough_sphere.png", dpi=150)
