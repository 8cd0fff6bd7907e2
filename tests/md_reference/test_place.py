import numpy as np
import pytest

from contact_study.errors import InputError
from md_reference.thermal.checkpoint import Frame, TrajectoryState
from md_reference.thermal.langevin import Motion

FRAMES = [Frame(1e-12, 2e-9, 3e8, 300.0, 5.0), Frame(2e-12, 1.9e-9, 4e8, 310.0, 6.0)]


def place():
    rng = np.random.default_rng(1)
    motion = Motion(rng.standard_normal((3, 7)), rng.standard_normal((3, 7)), 2e-9, -300.0, 2e-12)
    return TrajectoryState(motion, rng, 3, True, 2, 20, 412, list(FRAMES))


def test_a_place_put_aside_is_the_same_again():
    before = place()
    after = TrajectoryState.unpack(before.pack())
    np.testing.assert_array_equal(after.motion.displacement, before.motion.displacement)
    np.testing.assert_array_equal(after.motion.velocity, before.motion.velocity)
    assert (after.motion.top, after.motion.top_velocity, after.motion.time) == (2e-9, -300.0, 2e-12)
    assert (after.point, after.touched, after.frame, after.frames, after.steps) == (3, True, 2, 20, 412)
    assert after.series == FRAMES
    assert after.generator.random() == before.generator.random()


def test_what_another_version_has_put_aside_is_refused():
    kept = place().pack()
    kept["series"] = kept["series"][:, :3]
    with pytest.raises(InputError, match="of another version of this program; drop it with --overwrite"):
        TrajectoryState.unpack(kept)
