"""Work begun by other threads: done once, results and errors with the one that asks, nobody waits idly."""

import subprocess
import sys
import threading
import time

import pytest

from theory.numerics.background import BackgroundExecutor

# Seconds after which threads that should meet never will.
_LOST = 20


def test_work_is_done_once_by_whoever_comes_first():
    done = []
    ahead = BackgroundExecutor(3)
    pieces = [ahead.begin(lambda number=number: done.append(number) or number**2) for number in range(50)]
    assert [piece.result() for piece in pieces] == [number**2 for number in range(50)]
    assert [piece.result() for piece in reversed(pieces)] == [number**2 for number in reversed(range(50))]
    assert sorted(done) == list(range(50))


def test_other_threads_begin_before_anyone_asks():
    ahead, meeting = BackgroundExecutor(3), threading.Barrier(3, timeout=_LOST)
    pieces = [ahead.begin(meeting.wait) for _ in range(2)]
    meeting.wait()
    assert sorted(piece.result() for piece in pieces) < [0, 1, 2]


def test_whoever_waits_does_what_else_is_to_be_done():
    ahead, opened = BackgroundExecutor(2), threading.Event()
    here = threading.get_ident()
    first = ahead.begin(lambda: opened.wait(_LOST))
    second = ahead.begin(lambda: opened.set() or threading.get_ident())
    assert first.result()
    assert second.result() == here


def test_one_thread_does_work_when_it_is_asked_for():
    done = []
    ahead = BackgroundExecutor(1)
    pieces = [ahead.begin(lambda number=number: done.append(number)) for number in range(3)]
    assert done == []
    pieces[2].result()
    pieces[0].result()
    assert done == [2, 0]
    assert ahead.take() is None  # it keeps nothing that nobody asks for


@pytest.mark.parametrize("threads", [1, 2])
def test_an_error_is_raised_where_the_result_is_asked_for(threads):
    def fail():
        raise ValueError("broken")

    ahead = BackgroundExecutor(threads)
    piece = ahead.begin(fail)
    for _ in range(2):
        with pytest.raises(ValueError, match="broken"):
            piece.result()
    assert ahead.begin(lambda: 7).result() == 7


def test_an_interrupt_ends_the_one_that_waits():
    """Of another's work that it does meanwhile, too: it is nobody's result."""

    def interrupted():
        raise KeyboardInterrupt

    ahead, ended = BackgroundExecutor(2), threading.Event()
    first = ahead.begin(lambda: ended.wait(_LOST))
    ahead.begin(interrupted)
    with pytest.raises(KeyboardInterrupt):
        first.result()
    ended.set()
    assert first.result()


def test_threads_end_when_nothing_waits():
    before = threading.active_count()
    ahead = BackgroundExecutor(3)
    for _ in range(3):
        assert [piece.result() for piece in [ahead.begin(lambda: 1) for _ in range(9)]] == [1] * 9
    deadline = time.monotonic() + _LOST
    while threading.active_count() > before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert threading.active_count() == before


def test_nobody_waits_for_work_at_the_end_of_a_process():
    program = (
        "import time; from theory.numerics.background import BackgroundExecutor\n"
        "BackgroundExecutor(2).begin(lambda: time.sleep(600))\nraise SystemExit(130)"
    )
    assert subprocess.run([sys.executable, "-c", program], timeout=120).returncode == 130
