"""The part of a campaign that runs in a worker process: one case, step by step."""
