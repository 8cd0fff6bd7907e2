"""Derivatives of what a state gives, by adjoint solves with the linearised equations of the contact."""
