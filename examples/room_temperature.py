"""Atoms at room temperature
=========================

Hybrid Monte Carlo samples a block of atoms at each temperature. The figure shows that thermal motion takes contact
away; error bars are standard errors over correlated samples.
"""

import matplotlib.pyplot as plt

from contact_study import run

temperatures = [75, 150, 300]  # K
study = {
    "surface": {
        "kind": "self_affine",
        "size": "41.6 angstrom",
        "shape": [32, 32],
        "rms_height": "1 angstrom",
        "cutoff_mode": 4,
    },
    "material": {"youngs_modulus": "77.2 GPa", "poissons_ratio": 0.42, "lattice_constant": "2.6 angstrom"},
    "interaction": {"work_of_adhesion": "0.69 J/m^2", "length": "3.28 angstrom", "contact_distance": "3.68 angstrom"},
    "loading": {"path": ["1 GPa"]},
    "atomistic": {"method": "sampling"},
    "sampling": {"trajectories": 100, "equilibration": 20},
    "sweep": {"atomistic.temperature": [f"{kelvin} K" for kelvin in temperatures]},
}
found = run(study, "atomistic").isel(step=0)

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
error = found.relative_contact_area_standard_error
axes.errorbar(temperatures, found.relative_contact_area, error, fmt="o-", capsize=3)
axes.set(xlabel="temperature (K)", ylabel="relative contact area", title="1 GPa")
figure.savefig("room_temperature.png", dpi=150)
