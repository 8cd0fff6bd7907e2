"""What tests of the comparison share."""

import pytest

from contact_study.report import figures


@pytest.fixture
def unrendered(monkeypatch):
    """Every figure is made and goes where it should, but empty: pixels are most of a report's time."""
    monkeypatch.setattr(figures, "saved", lambda figure, kind, name="": f'<svg width="500pt" id="{name}"/>'.encode())
