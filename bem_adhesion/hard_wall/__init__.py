"""Contact with a hard wall by active sets, elastic or with a hardness: convex problems with one solution.

Walls with attraction are in :mod:`bem_adhesion.adhesive`, the memory of plastic indentation in
:mod:`bem_adhesion.contacts`.
"""
