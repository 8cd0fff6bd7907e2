"""Leakage of a rough seal
=======================

A rough surface is pressed on an elastic block, and a fluid flows through the gap that is left. The figure shows that
the hydraulic gap falls faster than the mean gap, to zero where contact closes the last path.
"""

import matplotlib.pyplot as plt

import contact_study

study = {
    "surface": {
        "kind": "self_affine",
        "size": "100 um",
        "shape": [128, 128],
        "rms_height": "1 um",
        "roll_off_mode": 2,
        "cutoff_mode": 24,
    },
    "material": {"youngs_modulus": "10 MPa", "poissons_ratio": 0.5},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": [f"{p} MPa" for p in (0.03, 0.06, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 1)]},
    "output": {"leakage": True, "fields": True},
}
found = contact_study.run(study)

figure, (curve, image) = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
flows, pressure = found.hydraulic_gap_x > 0, found.mean_pressure / 1e6
curve.semilogy(pressure, found.mean_gap * 1e6, "s-", markersize=4, label="mean gap")
hydraulic = found.hydraulic_gap_x[flows] * 1e6
curve.semilogy(pressure[flows], hydraulic, "o-", markersize=4, label="hydraulic gap along x")
curve.axvline(pressure[~flows].min(), color="0.4", linestyle=":", label="first without flow")
curve.set(xlabel="pressure (MPa)", ylabel="gap (µm)", ylim=(None, 6))
curve.legend(framealpha=1, edgecolor="none", loc="upper right")
last = found.isel(step=int(flows.sum()) - 1)
gap = (last.gap.where(last.gap > 0) * 1e6).assign_coords(x=last.x * 1e6, y=last.y * 1e6)
gap.plot.pcolormesh(ax=image, cmap="viridis", cbar_kwargs={"label": "gap (µm), contact white"}, rasterized=True)
image.set(title=f"last flow along x, {pressure[flows].max():.2g} MPa", xlabel="x (µm)", ylabel="y (µm)", aspect=1)
figure.savefig("leakage.png", dpi=150)
