"""What tests of the comparison share."""

import io

import pytest
from matplotlib.figure import Figure

from contact_study.report.figures import illustrations


@pytest.fixture
def unrendered(monkeypatch):
    """Every figure is made and goes where it should, but as an empty picture: pixels are most of a report's time."""
    stream = io.BytesIO()
    Figure((1, 1), dpi=10).savefig(stream, format="png")
    monkeypatch.setattr(illustrations, "png", lambda figure: stream.getvalue())
