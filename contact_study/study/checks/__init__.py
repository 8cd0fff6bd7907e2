"""Warnings of a study before it runs: ineffective keys, implausible values, suspicious height maps.

Errors of single keys are raised by their sections.
"""
