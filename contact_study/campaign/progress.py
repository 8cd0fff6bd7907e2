"""Progress on stderr: a bar on a terminal, a line per finished step elsewhere."""

import sys
import time
import warnings
from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from typing import Any, TypeVar

from contact_study.campaign.memory import duration

_HALF_MINUTE = 30.0
_SILENCE = 5.0  # seconds between lines while the program reads and writes

T = TypeVar("T")


class Progress:
    """Counter of finished steps, and printer of messages, which ``wording`` may change, after the command's name.

    Without a name nothing is printed, and warnings are Python's.
    """

    def __init__(self, name: str, wording: Callable[[str], str] = str):
        self._name = name
        self._wording = wording
        self._bar: Any = None
        self.total = self.done = self._before = 0
        self.expected = 0.0  # seconds that all unfinished steps usually take
        self._began = self._quiet_since = time.monotonic()

    def _on_terminal(self) -> bool:
        return bool(self._name) and sys.stderr.isatty()

    def start(self, total: int, done: int) -> None:
        """Begin with ``done`` of ``total`` steps finished."""
        self.total, self.done, self._before = total, done, done
        self._began = self._quiet_since = time.monotonic()
        if self._on_terminal():
            from tqdm import tqdm  # slow to import

            form = "{desc}: {n_fmt}/{total_fmt} steps [{elapsed}<{remaining}]{postfix}"
            options = {"file": sys.stderr, "dynamic_ncols": True, "bar_format": form}
            self._bar = tqdm(total=total, initial=done, desc=self._name, **options)
        if done:
            self.report(f"{done} of {total} steps were finished before")

    def step(self, label: str, point: str, summary: dict[str, Any], seconds: float | None) -> None:
        """Count one more finished step, at a point of the path of the case with this label; without seconds it runs."""
        where, now = f"{label}: {point}" if label else point, time.monotonic()
        if seconds is None:
            residual = "" if summary["residual"] is None else f", residual {summary['residual']:.1e}"
            text = f"iteration {summary['iterations']}{residual}{self._time_left(now)}; {where}"
            if self._bar is not None:
                self._bar.set_postfix_str(text)
            elif now - self._quiet_since >= _HALF_MINUTE:
                self._quiet_since = now
                self.report(f"[{self.done}/{self.total}] at work: {text}")
            return
        self.done += 1
        self._quiet_since = now
        area = summary.get("relative_contact_area")
        if summary.get("detached"):
            where += f", {summary.get('message') or 'detached'}"
        elif area is not None:
            where += f", contact area {float(area):.4f}"
        if not summary.get("converged", True):
            where += f", NOT CONVERGED ({summary.get('message') or 'see residual'})"
        if self._bar is not None:
            self._bar.set_postfix_str(where, refresh=False)
            self._bar.update()
        else:
            self.report(f"[{self.done}/{self.total}] {where} ({seconds:.1f} s)")

    def _time_left(self, now: float) -> str:
        """Estimate the time for all steps: by those that this run has finished, before by what is usual."""
        finished, spent = self.done - self._before, now - self._began
        left = spent / finished * (self.total - self.done) if finished else self.expected - spent
        return f", about {duration(left)} left" if left > 0 else ""

    def through(self, items: Collection[T], words: str) -> Iterator[T]:
        """Yield items one after the other; show their number if that takes long."""
        if self._on_terminal():
            from tqdm import tqdm

            about = f"{self._name}: {words}"
            yield from tqdm(items, about, file=sys.stderr, dynamic_ncols=True, leave=False, delay=_SILENCE)
            return
        shown = time.monotonic()
        for number, item in enumerate(items):
            if time.monotonic() - shown > _SILENCE:
                shown = time.monotonic()
                self.report(f"{words}: {number} of {len(items)}")
            yield item

    def report(self, text: str) -> None:
        if not self._name:
            return
        line = f"{self._name}: {self._wording(text)}"
        with suppress(OSError):  # the reader of the log may be gone; the run continues
            if self._bar is not None:
                self._bar.write(line, file=sys.stderr)
            else:
                print(line, file=sys.stderr)
            sys.stderr.flush()

    def warn(self, note: str) -> None:
        if self._name:
            self.report(f"warning: {note}")
        else:
            warnings.warn(self._wording(note), UserWarning, stacklevel=4)  # at the caller of the library

    def close(self) -> None:
        """Remove the bar."""
        if self._bar is not None:
            self._bar.close()
