"""What a campaign would keep of the points that a model yields, and runs that are stopped on the way."""

from pathlib import Path

from contact_study.results.observables import recorded
from contact_study.study.study import Study


def bins_of_case(case):
    return Study({}, Path(), (case,), {}).bins


def recorded_path(case, points):
    bins = bins_of_case(case)
    return [recorded(point, bins, case.output.fields) for point in points]


def stopper(monkeypatch, owner, name):
    """What makes the n-th call of a method from now on raise KeyboardInterrupt, and the list of calls since."""
    go_on, taken = getattr(owner, name), []

    def stop_at(number):
        def counted(self, *arguments):
            taken.append(number)
            if len(taken) == number:
                raise KeyboardInterrupt
            return go_on(self, *arguments)

        taken.clear()
        monkeypatch.setattr(owner, name, counted)

    return stop_at, taken
