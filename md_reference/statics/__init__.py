"""Mechanical equilibria at zero temperature: energy, Newton steps, linear solver, overdamped motion, the contact."""
