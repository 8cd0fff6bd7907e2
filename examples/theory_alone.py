"""Theory from a spectrum
======================

Persson's theory and the gap flow need nothing but a spectrum. The figure shows the contact area of both at three works
of adhesion: the gap flow, which counts what touches within the range of attraction, has more contact throughout.
"""

import matplotlib.pyplot as plt
import numpy as np

from theory import LennardJones104, PerssonTheory, SelfAffineSpectrum, gap_flow

size, modulus = 1e-6, 5e9
first = 2 * np.pi / size
spectrum = SelfAffineSpectrum(hurst_exponent=0.8, rms_height=2e-9, low=first, roll_off=4 * first, cutoff=64 * first)
pressures = np.geomspace(1e6, 300e6, 12)

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for work, colour in ((0.01, "C0"), (0.03, "C1"), (0.06, "C2")):
    law = LennardJones104(work, length=1e-9)
    persson = PerssonTheory(spectrum, modulus, work)
    areas = [persson.at_pressure(p).relative_contact_area for p in pressures]
    axes.loglog(pressures / 1e6, areas, "--", color=colour)
    flow = gap_flow(spectrum, modulus, law, gaps=400, scales=400)
    areas = [flow.at_pressure(p).fraction_below(1.12 * law.length) for p in pressures]
    axes.loglog(pressures / 1e6, areas, "-", color=colour, label=f"{work * 1e3:.0f} mJ/m²")
axes.plot([], [], "-", color="0.4", label="gap flow")
axes.plot([], [], "--", color="0.4", label="Persson 2008")
axes.set(xlabel="pressure (MPa)", ylabel="relative contact area", title=f"rms slope {spectrum.rms_slope:.3f}")
axes.legend(frameon=False)
figure.savefig("theory_alone.png", dpi=150)
