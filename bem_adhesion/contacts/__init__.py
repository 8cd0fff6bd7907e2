"""Contacts that a user steps through a load: rough, with free boundaries, plastic, viscoelastic, overdamped.

They combine the solvers of :mod:`bem_adhesion.adhesive` and :mod:`bem_adhesion.hard_wall`; loading paths are in
:mod:`bem_adhesion.study`.
"""
