"""Work begun by other threads: done once, results and errors with the one that asks, nobody waits idly."""

import threading
import time

import pytest

from theory.numerics.background import BackgroundExecutor

_LOST = 20  # seconds after which threads that should meet never will


def test_work_is_done_once_by_whoever_comes_first_and_threads_end_when_nothing_waits():
    done, before = [], threading.active_count()
    ahead = BackgroundExecutor(3)
    pieces = [ahead.begin(lambda number=number: done.append(number) or number**2) for number in range(50)]
    for order in (pieces, pieces[::-1]):
        assert {piece: piece.result() for piece in order} == {pieces[n]: n**2 for n in range(50)}
    assert sorted(done) == list(range(50))
    deadline = time.monotonic() + _LOST
    while threading.active_count() > before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert threading.active_count() == before


def test_other_threads_begin_before_anyone_asks_and_whoever_waits_does_what_else_is_to_be_done():
    ahead, meeting = BackgroundExecutor(3), threading.Barrier(3, timeout=_LOST)
    pieces = [ahead.begin(lambda: (meeting.wait(), threading.current_thread().daemon)) for _ in range(2)]
    meeting.wait()
    assert [piece.result()[1] for piece in pieces] == [True, True]
    ahead, opened = BackgroundExecutor(2), threading.Event()
    first = ahead.begin(lambda: opened.wait(_LOST))
    second = ahead.begin(lambda: opened.set() or threading.get_ident())
    assert first.result()
    assert second.result() == threading.get_ident()


@pytest.mark.parametrize("threads", [1, 2])
def test_an_error_is_raised_where_the_result_is_asked_for(threads):
    piece = BackgroundExecutor(threads).begin(lambda: 1 / 0)
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            piece.result()


def test_an_interrupt_in_work_done_meanwhile_ends_the_one_that_waits():
    def interrupted():
        raise KeyboardInterrupt

    ahead, ended = BackgroundExecutor(2), threading.Event()
    first = ahead.begin(lambda: ended.wait(_LOST))
    ahead.begin(interrupted)
    with pytest.raises(KeyboardInterrupt):
        first.result()
    ended.set()
    assert first.result()
