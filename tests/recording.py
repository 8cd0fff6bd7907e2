"""What a campaign would keep of the points that a model yields."""

from pathlib import Path

from contact_study.campaign.record import recorded
from contact_study.problem.bins import bins_of
from contact_study.problem.study import Study


def bins_of_case(case):
    return bins_of(Study({}, Path(), (case,), {}))


def recorded_path(case, points):
    bins = bins_of_case(case)
    return [recorded(point, bins, case.output.fields) for point in points]
