"""The run of cases: one case step by step, and averages over thermal states."""
