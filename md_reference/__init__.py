"""Atomistic reference: a harmonic block pressed on a rigid rough Lennard-Jones substrate."""
