"""Linear problems of one Newton step: conjugate gradients, preconditioners, contact stiffness.

They see the law only as a curvature at each point; the descent itself is in :mod:`bem_adhesion.adhesive`.
"""
