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


def meet(mine, others, report):
    mine.touch()
    deadline = time.monotonic() + 60
    while not others.exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert others.exists()
    report(os.getpid())


def report_on(seconds, report):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        report("on")
        time.sleep(0.02)
    raise AssertionError


def leave(path, report):
    path.touch()


def wait_for(path, report):
    report("begun")
    deadline = time.monotonic() + 60
    while not path.exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert path.exists()
    report("seen")
    report("ended")
    path.with_name("ended").touch()
