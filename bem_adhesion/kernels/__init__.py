"""Local energy of the interface: adhesive laws, walls, windows and springs, by loops over the points.

One :class:`~bem_adhesion.kernels.local_energy.LocalEnergy` combines them; the elastic energy is in
:mod:`bem_adhesion.operators`.
"""
