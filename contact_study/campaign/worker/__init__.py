"""The run of cases: their distribution over an engine, one case step by step, averages over thermal states.

Models solve the steps; engines only call tasks.
"""
