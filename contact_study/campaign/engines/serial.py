"""Engine that runs one task after the other in this process."""

from collections.abc import Sequence

from contact_study.campaign.engines.base import Report, Task


def run(tasks: Sequence[Task], workers: int, report: Report) -> None:
    """Run every task in order; this process is the only worker."""
    for task in tasks:
        task(report)
