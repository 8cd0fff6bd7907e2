"""What was found of random studies, one by one and together."""

from dataclasses import dataclass, field


@dataclass
class Verdict:
    """What was found of one study.

    Parameters
    ----------
    number : int
        Its number.
    law : str
        Its law of interaction.
    subjects : tuple of str
        What else it is about, see :data:`~scripts.state_checks.drawing.SUBJECTS`.
    """

    number: int
    law: str
    subjects: tuple[str, ...] = ()
    states: int = 0
    detached: int = 0
    flagged: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    narrow: int = 0
    balance: float = 0.0
    return_error: float = 0.0


@dataclass
class Tally:
    """Sums over studies."""

    studies: int = 0
    states: int = 0
    detached: int = 0
    flagged: int = 0
    narrow: int = 0
    wrong: int = 0
    balance: float = 0.0
    return_error: float = 0.0

    def add(self, verdict: Verdict) -> None:
        """Count one study."""
        self.studies += 1
        self.states += verdict.states
        self.detached += verdict.detached
        self.flagged += len(verdict.flagged)
        self.narrow += verdict.narrow
        self.wrong += len(verdict.faults)
        self.balance = max(self.balance, verdict.balance)
        self.return_error = max(self.return_error, verdict.return_error)

    def cells(self) -> tuple[object, ...]:
        """A line of the table."""
        counts = self.studies, self.states, self.detached, self.flagged, self.narrow, self.wrong
        return *counts, f"{self.balance:.0e}", f"{self.return_error:.0e}"
