"""What tests of the campaign share."""

import pytest

from tests.campaign.toy_study import STUDY


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path
