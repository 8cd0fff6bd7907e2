"""Mechanical equilibria at zero temperature: energy, Newton steps, linear solver, overdamped relaxation, the contact.

Studies, cases and temperature are in the rooms above.
"""
