"""Progress on stderr: a bar on a terminal, a line per finished step elsewhere."""

import sys
import time
import warnings
from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from typing import Any, TypeVar

from tqdm import tqdm

# Seconds without a word while the program reads and writes.
_SILENCE = 5.0

T = TypeVar("T")


class Progress:
    """Counts finished steps.

    Parameters
    ----------
    name : str
        The command's name, in front of every line.
    wording : callable, optional
        What becomes of a message before it is shown.
    """

    def __init__(self, name: str, wording: Callable[[str], str] = str):
        self._name = name
        self._wording = wording
        self._bar: tqdm | None = None
        self._total = 0
        self._done = 0

    def start(self, total: int, done: int) -> None:
        """Begin with ``done`` of ``total`` steps finished."""
        self._total, self._done = total, done
        if sys.stderr.isatty():
            self._bar = tqdm(
                total=total, initial=done, desc=self._name, unit="step", file=sys.stderr, dynamic_ncols=True
            )
        if done:
            self.report(f"{done} of {total} steps were finished before")

    def step(self, label: str, point: str, summary: dict[str, Any], seconds: float) -> None:
        """One more step is finished, at a point of the path of the case with a label."""
        self._done += 1
        area = summary.get("relative_contact_area")
        text = f"{label + ': ' if label else ''}{point}"
        if summary.get("detached"):
            text += f", {summary.get('message') or 'detached'}"
        elif area is not None:
            text += f", contact area {float(area):.4f}"
        if not summary.get("converged", True):
            text += f", NOT CONVERGED ({summary.get('message') or 'see residual'})"
        if self._bar is not None:
            self._bar.set_postfix_str(text, refresh=False)
            self._bar.update()
        else:
            self.report(f"[{self._done}/{self._total}] {text} ({seconds:.1f} s)")

    def through(self, items: Collection[T], words: str) -> Iterator[T]:
        """Hand items on, one after the other, and show how many where that takes its time."""
        if sys.stderr.isatty():
            about = f"{self._name}: {words}"
            yield from tqdm(items, about, file=sys.stderr, dynamic_ncols=True, leave=False, delay=_SILENCE)
            return
        said = time.monotonic()
        for number, item in enumerate(items):
            if time.monotonic() - said > _SILENCE:
                said = time.monotonic()
                self.report(f"{words}: {number} of {len(items)}")
            yield item

    def report(self, text: str) -> None:
        """A line of its own."""
        with suppress(OSError):  # whoever read along may have gone; the run matters more
            tqdm.write(f"{self._name}: {self._wording(text)}", file=sys.stderr)
            sys.stderr.flush()

    def warn(self, note: str) -> None:
        """Something to be known of the study or a step."""
        self.report(f"warning: {note}")

    def close(self) -> None:
        """No more steps."""
        if self._bar is not None:
            self._bar.close()


class Warnings(Progress):
    """Shows no steps; warnings are Python's."""

    def __init__(self, wording: Callable[[str], str] = str) -> None:
        super().__init__("", wording)

    def start(self, total: int, done: int) -> None:
        pass

    def through(self, items: Collection[T], words: str) -> Iterator[T]:
        yield from items

    def step(self, label: str, point: str, summary: dict[str, Any], seconds: float) -> None:
        pass

    def report(self, text: str) -> None:
        pass

    def warn(self, note: str) -> None:
        warnings.warn(self._wording(note), UserWarning, stacklevel=4)  # at the caller of the library
