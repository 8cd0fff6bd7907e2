"""Forms on a hard wall against closed forms of contact without adhesion."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe, ellipk

from bem_adhesion import HardWall, rough_contact
from contact_study import composite_surface

MODULUS, SIDE, POINTS = 1.0, 1.0, 96

# Keys of each shape of rotation, and the slope of its profile at a radius.
PROFILES = {
    "sphere": ({"radius": 1.2}, lambda r: r / np.sqrt(1.2**2 - r**2)),
    "paraboloid": ({"radii": 1.2}, lambda r: r / 1.2),
    "cone": ({"slope": 0.2}, lambda r: 0.2),
    "punch": ({"flat_radius": 0.2, "edge_radius": 0.5}, lambda r: max(r - 0.2, 0.0) / 0.5),
}


def pressed(form, force, offset=(0.0, 0.0), boundary="free"):
    """State under a force, and the approach of the form's highest point."""
    flat = {"kind": "flat", "size": SIDE, "shape": [POINTS, POINTS]}
    heights = composite_surface(flat, {**form, "offset": list(offset)}).sampled
    contact = rough_contact(heights, SIDE, MODULUS, HardWall(), boundary=boundary)
    found = contact.step(contact.separated(), force / SIDE**2)
    assert found.converged
    return found, heights.max() - found.plane if boundary == "free" else 0.0


@pytest.mark.parametrize("kind", PROFILES)
def test_force_approach_and_area_of_shapes_of_rotation(kind):
    """I. N. Sneddon, Int. J. Eng. Sci. 3, 47 (1965): d = a ∫ f'(r) dr / √(a² − r²), F = 2E* ∫ x g'(x) dx, g = d(x)."""
    keys, slope = PROFILES[kind]

    def depth(radius):
        # r = a sin φ leaves no singularity.
        return radius * quad(lambda angle: slope(radius * np.sin(angle)), 0, np.pi / 2, points=[0.5])[0]

    radius = 0.33
    approach = depth(radius)
    force = 2 * MODULUS * (radius * approach - quad(depth, 0, radius)[0])
    if kind == "cone":
        assert force == pytest.approx(np.pi / 2 * radius**2 * 0.2)  # the closed form
    found, lowered = pressed({"kind": kind, **keys}, force, (5 / 96, -3 / 96))
    # The grid's error is of the second order in its spacing over the radius, 0.03: a tenth of its square.
    assert lowered == pytest.approx(approach, rel=2e-4)
    assert np.sqrt(found.relative_contact_area / np.pi) == pytest.approx(radius, rel=0.006)  # a fifth of a spacing


def test_an_elliptic_contact_in_any_direction():
    """Hertz's ellipse of given half axes and peak pressure, by complete elliptic integrals K and E."""
    a, b, peak = 0.36, 0.2, 0.15
    squared = 1 - (b / a) ** 2
    whole, second = ellipk(squared), ellipe(squared)
    scale = 2 * peak * b / (MODULUS * squared * a**2)
    radii = 1 / (scale * (whole - second)), 1 / (scale * ((a / b) ** 2 * second - whole))
    force, approach = 2 / 3 * peak * np.pi * a * b, peak * b * whole / MODULUS
    for rotation in (0.0, 0.6):
        found, lowered = pressed({"kind": "paraboloid", "radii": list(radii), "rotation": rotation}, force)
        assert lowered == pytest.approx(approach, rel=2e-4)  # as above
        y, x = np.argwhere(found.pressure > 0).T / POINTS - 0.5
        # The longer axis is along y before the turn, from x to y.
        assert 0.5 * np.arctan2(2 * np.mean(x * y), np.mean(y**2) - np.mean(x**2)) == pytest.approx(-rotation, abs=0.02)


def test_a_row_of_cylinders_in_line_contact():
    """Hertz's a² = 4FR/πE*, F a length; the next cylinders, at nL, add π²a²/6L² of the curvature to the first order."""
    force, radius = 0.0003, 30.0
    half = np.sqrt(4 * force * radius / (np.pi * MODULUS))
    half /= np.sqrt(1 + np.pi**2 / 6 * (half / SIDE) ** 2)
    found, _ = pressed({"kind": "cylinder", "radius": radius}, force, boundary="periodic")
    across, _ = pressed({"kind": "cylinder", "radius": radius, "rotation": np.pi / 2}, force, boundary="periodic")
    np.testing.assert_allclose(across.pressure, found.pressure.T, atol=1e-7 * found.pressure.max())  # the tolerance
    # The next order of neighbours is (a/L)⁴, 1e-4; the grid's 3e-4 at nine spacings in half the width.
    assert found.pressure.max() == pytest.approx(2 * force / (np.pi * half), rel=1e-3)
    assert np.count_nonzero(found.pressure[0]) / POINTS == pytest.approx(2 * half, abs=1 / POINTS)
