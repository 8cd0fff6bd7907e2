"""The elastic block of atoms: condensed to its surface, or explicit and coarsened with depth.

No interface, load or time integration is here, except the kernels that move nodes in one pass with their forces.
"""
