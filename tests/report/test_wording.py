"""Numbers as a reader wants them."""

import pytest

from contact_study.report.text.wording import (
    coordinate_label,
    fixed,
    length,
    number,
    percent_of,
    pressure_unit,
    varied,
    with_error,
)


@pytest.mark.parametrize(
    ("found", "shown"),
    [
        (number(-0.00532, 3), "−0.00532"),
        (number(1e-8, 3), "10⁻⁸"),
        (number(7.5e-5, 3), "7.5 · 10⁻⁵"),
        (number(0.25, 2, True), "+0.25"),
        (number(-3e-7, 2, True), "−3 · 10⁻⁷"),
        # No more digits than it means.
        (percent_of(-0.4449, plus=True), "−44 %"),
        (percent_of(0.0449, plus=True), "+4.5 %"),
        (percent_of(0.5), "50 %"),
        (percent_of(0.0449, 0.003, plus=True), "+4.5 ± 0.3 %"),
        (percent_of(-0.4449, 0.0004, True), "−44.49 ± 0.04 %"),
        # An error is never rounded to nothing.
        (with_error(1.638, 0.0003, 3), "1.6380 ± 0.0003"),
        (with_error(1.638, 0.02, 3), "1.638 ± 0.020"),
        (with_error(-0.5, 0.00097, 3), "−0.5000 ± 0.0010"),
        (with_error(2.0, 0.0, 3), "2.000 ± 0.000"),
        (with_error(2.0, float("nan"), 3), "2.000"),
        (fixed(-1e-9, 3), "0.000"),
        (varied(["1", "1"]), "1"),
        (varied(["1", "2", "1"]), "1 and 2"),
        (varied([str(value) for value in range(12)]), "0 to 11 (12 values)"),
        (coordinate_label("well_depth_ratio", 1.0), "ε = ε₀"),
        (coordinate_label("well_depth_ratio", 1.5), "ε = 1.5 ε₀"),
        (coordinate_label("rms_height", 5e-10, "m"), "h_rms = 5 Å"),
        (coordinate_label("youngs_modulus", 77.2e9, "Pa"), "E = 77.2 GPa"),
        (coordinate_label("work_of_adhesion", 0.69, "J m-2"), "Δγ = 0.69 J/m²"),
        (coordinate_label("well_depth", 18.6 * 1.602176634e-22, "J"), "ε = 18.6 meV"),
        (coordinate_label("law", "lennard_jones_9_3"), "law = 9-3"),
        (coordinate_label("kind", "self_affine"), "kind = self affine"),
        (coordinate_label("low_mode", 2.0), "q_L L/2π = 2"),
        *zip(map(length, (1040e-10, 3.28e-10, 1e-6, 0.1)), ("104 nm", "3.28 Å", "1 µm", "100 mm"), strict=True),
        *((pressure_unit(value).name, name) for value, name in ((1e9, "GPa"), (1e6, "MPa"), (3.0, "Pa"), (0.0, "Pa"))),
    ],
)
def test_words(found, shown):
    assert found == shown
