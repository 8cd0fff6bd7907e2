"""What holds for all tests."""

from hypothesis import settings

# No test is timed: the first example of a test may compile kernels, and the machine may be busy.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
