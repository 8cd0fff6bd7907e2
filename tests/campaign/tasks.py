"""Tasks for engines, in a module that a worker imports in no time."""

import os
import time


def square(number, report):
    report(number, number**2)
    report(number, os.getpid())


def fail(report):
    raise ValueError("broken")


def die(report):
    os._exit(3)


def wait_for(path, report):
    """Report, wait for a file, report twice and leave another file."""
    report("begun")
    deadline = time.monotonic() + 60
    while not path.exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    report("seen")
    report("ended")
    path.with_name("ended").touch()
