"""A study on a cluster
====================

The cases of a sweep run on the workers of a Dask cluster, here one on this machine. The figure shows the contact area
of four surfaces under five works of adhesion; with another scheduler's address the same lines use many machines.
"""

import matplotlib.pyplot as plt
from dask.distributed import LocalCluster

from contact_study import run

works = [0.02, 0.05, 0.1, 0.2, 0.4]  # J/m²
study = {
    "surface": {
        "kind": "self_affine",
        "size": "100 nm",
        "shape": [64, 64],
        "rms_height": "5 angstrom",
        "roll_off_mode": 2,
        "cutoff_mode": 8,
    },
    "material": {"youngs_modulus": "20 GPa", "poissons_ratio": 0.3},
    "interaction": {"law": "lennard_jones_10_4", "length": "6 angstrom"},
    "loading": {"path": ["50 MPa"]},
    "sweep": {"surface.seed": [1, 2, 3, 4], "interaction.work_of_adhesion": works},
}

if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        found = run(study, engine="dask", scheduler=cluster.scheduler_address)
    figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
    for seed, area in found.relative_contact_area.isel(step=0).groupby("seed"):
        axes.plot(works, area.squeeze(), "o-", label=f"surface {seed}")
    axes.set(xlabel="work of adhesion (J/m²)", ylabel="relative contact area", title="50 MPa")
    axes.legend(frameon=False)
    figure.savefig("cluster.png", dpi=150)
