"""A texture that doubles pull-off, or takes most of it
====================================================

Which texture, of at most 0.2 nm and without short waves, makes a nominally flat rough contact stick twice as well,
or as little as possible? An optimiser follows the gradient of the pull-off pressure by all heights. A full loop
checks it.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.optimize import minimize

from bem_adhesion import LennardJones104, fold_gradient, rough_contact

points, size, modulus, most = 48, 16e-9, 20e9, 0.2e-9
law = LennardJones104(work_of_adhesion=0.1, length=3.3e-10)
rough = gaussian_filter(np.random.default_rng(1).standard_normal((points, points)), 3, mode="wrap")
rough *= 0.3e-9 / rough.std()


def texture_of(unknown):
    """Return the texture of unconstrained numbers, smooth and within the limit (m)."""
    return most * np.tanh(gaussian_filter(unknown.reshape(points, points), 2, mode="wrap"))


def pull_off(heights):
    """Return the pull-off pressure and its derivatives, from the last state before it."""
    contact = rough_contact(heights, size, modulus, law, tolerance=1e-11)
    last, held, lost = contact.step(contact.separated(), 1e9), 0.0, -law.peak_tensile_stress
    while held - lost > 1e-6 * law.peak_tensile_stress:
        found = contact.step(last, 0.5 * (held + lost))
        held, lost, last = (held, 0.5 * (held + lost), last) if found.detached else (0.5 * (held + lost), lost, found)
    return fold_gradient(contact, last)


def missed(unknown, wanted):
    """Return half the square of what is missing from the pull-off wanted, and its gradient."""
    texture = texture_of(unknown)
    found = pull_off(rough + texture)
    excess = (found.value - wanted) / untouched
    by_unknown = found.heights * most * (1 - (texture / most) ** 2) * excess / untouched
    return 0.5 * excess**2, gaussian_filter(by_unknown, 2, mode="wrap").ravel()


untouched = pull_off(rough).value
options = {"maxfun": 20}
figure, axes = plt.subplots(1, 4, figsize=(11.5, 3), layout="constrained", width_ratios=(1, 1, 1, 1.3))
for title, factor, image, colour in zip(
    ("as it is", "twice", "least"), (1, 2, 0), axes, ("0.4", "C0", "C3"), strict=False
):
    texture = np.zeros((points, points))
    if factor != 1:
        wanted = factor * untouched
        found = minimize(missed, texture.ravel(), wanted, jac=True, method="L-BFGS-B", options=options)
        texture = texture_of(found.x)
    shown = image.imshow(1e9 * (rough + texture), origin="lower", extent=[0, 16, 0, 16], vmin=-0.9, vmax=0.9)
    image.set(title=title, xlabel="x (nm)", yticks=[])
    # The loop, in which every gap is prescribed.
    contact = rough_contact(rough + texture, size, modulus, law, control="gap", tolerance=1e-9)
    state, gaps, pressures = contact.separated(), np.linspace(1.6e-9, 0.1e-9, 61), []
    for gap in (*gaps, *gaps[::-1]):
        state = contact.step(state, gap)
        pressures.append(state.pressure.mean() / 1e6)
    axes[3].plot(1e9 * np.concatenate([gaps, gaps[::-1]]), pressures, color=colour, label=title)
    axes[3].axhline(pull_off(rough + texture).value / 1e6, color=colour, ls=":")
figure.colorbar(shown, ax=axes[2], label="height (nm)")
axes[3].set(xlabel="mean gap (nm)", ylabel="pressure (MPa)", ylim=(-60, 60))
axes[3].legend(title="dotted: pull-off", frameon=False)
figure.savefig("texture_for_pull_off.png", dpi=150)
