"""The frame of every command: its parser, one line for a mistake, exit status."""

import argparse
import contextlib
import io
import os
import signal
import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NoReturn

from contact_study.campaign.engines import CampaignError
from contact_study.inputs.errors import DONE, INTERRUPTED, NOT_CONVERGED, WRONG_INPUT, InputError

if TYPE_CHECKING:
    import xarray as xr


class Parser(argparse.ArgumentParser):
    """An argument parser that reports a mistake in one line, with exit status 1."""

    def error(self, message: str) -> NoReturn:
        raise InputError(message)


def complete(parser: argparse.ArgumentParser) -> None:
    """Answer the shell's request to complete a line and exit; see docs/installation.md."""
    if "_ARGCOMPLETE" in os.environ:
        with contextlib.suppress(ImportError):  # an extra
            import argcomplete

            argcomplete.autocomplete(parser)


def guarded(command: str, body: Any, interrupted: str = "finished steps are kept, continue with --resume") -> int:
    """Call ``body``; turn mistakes of input and interruption into one line on stderr and an exit status."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # not every terminal has Greek letters
    previous = signal.signal(signal.SIGTERM, _interrupt)
    try:
        return body()
    except KeyboardInterrupt:
        print(f"{command}: interrupted; {interrupted}", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        return WRONG_INPUT
    except (InputError, CampaignError, OSError) as error:
        message = str(error)
    except UnicodeEncodeError as error:
        message = (
            f"{error.object[error.start : error.end]!a} cannot be written in this locale's encoding, "
            f"{error.encoding}; try LC_ALL=C.UTF-8"
        )
    except MemoryError:
        message = "not enough memory; use fewer points, atoms or layers, or --workers 1"
    except Exception:
        import traceback

        traceback.print_exc()
        message = "this is a fault of the program, not of the input; please report it"
    finally:
        signal.signal(signal.SIGTERM, previous)
    print(f"{command}: error: {message}", file=sys.stderr)
    return WRONG_INPUT


def _interrupt(*_: Any) -> NoReturn:
    raise KeyboardInterrupt


def report_convergence(command: str, groups: "Mapping[str, xr.Dataset]") -> int:
    """Print a line for each group of a dataset with steps that did not converge; returns the exit status."""
    from contact_study.campaign.dataset.provenance import unconverged

    lines = list(unconverged(groups))
    for line in lines:
        print(f"{command}: {line}", file=sys.stderr)
    return NOT_CONVERGED if lines else DONE
