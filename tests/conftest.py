"""What holds for all tests."""

import signal

from hypothesis import settings

# No test is timed: the first example of a test may compile kernels, and the machine may be busy.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

# Tests that run in the background of a shell have interrupts ignored, and so would the commands that they interrupt.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    """The folder of long tests comes first: at the end one worker would run them while the other waits."""
    items.sort(key=lambda item: "tests/validation/" not in item.nodeid)
