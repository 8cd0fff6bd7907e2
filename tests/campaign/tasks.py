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


def until(path):
    deadline = time.monotonic() + 60
    while not path.exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert path.exists()


def meet(mine, others, report):
    mine.touch()
    until(others)
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
    until(path)
    report("seen")
    report("ended")
    path.with_name("ended").touch()


def states(dask_worker):
    return [task.state for task in dask_worker.state.tasks.values()]


def finish(dask_worker):
    """Wait until the worker's only thread is free."""
    dask_worker.executors["default"].submit(int).result(timeout=30)
