"""From a measured curve back to the work of adhesion
===================================================

A soft sphere on a cantilever is pressed on a flat and pulled off. Here JKR's theory makes the curve, with noise. The
inference compares three theories and gives 90 % intervals.
"""

import numpy as np

import contact_study
from contact_study import plots
from theory import JKR

stiffness, random = 0.2, np.random.default_rng(3)
states = JKR(radius=5e-6, contact_modulus=1e6, work_of_adhesion=0.03).curve(1.5e-6, 5000)
piezo = states.displacement + states.force / stiffness
fold = int(np.argmin(piezo))
moved = np.linspace(-6e-6, piezo[-1], 400)
force = np.interp(moved, piezo[fold:], states.force[fold:])
force = np.concatenate([np.where(moved > 0, force, 0.0), np.where(moved > piezo[fold], force, 0.0)[::-1]])
moved = np.concatenate([moved, moved[::-1]])
moved, deflection = (x + 2e-9 * random.normal(size=x.size) for x in (moved, force / stiffness))
header = "piezo (nm), deflection (nm)"
np.savetxt("curve.csv", 1e9 * np.array([moved, deflection]).T, "%.3f", ",", header=header, comments="")

curve = contact_study.read_force_curve("curve.csv", spring_constant=stiffness)
found = contact_study.infer(curve, fixed={"radius": "5 um"})
print("| model | w (mJ/m²) | interval | evidence |\n|---|---|---|---|")
for model in found["model"].values:
    one = found.sel(model=model)
    w, low, high = (1e3 * float(one[f"work_of_adhesion{end}"]) for end in ("", "_lower", "_upper"))
    print(f"| {model} | {w:.1f} | {low:.1f} to {high:.1f} | {float(one.weight):.1g} |")
plots.inference(found).savefig("infer_adhesion.png", dpi=150)
