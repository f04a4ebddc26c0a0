"""A stretch of motion closed on itself, and mirrors."""

from __future__ import annotations

import numpy as np
import pytest
from puppet import Puppet
from rigs import other_side
from scipy.spatial.transform import Rotation

from gaitsmith.gait.loop import average, closed, mirrored, read_pose
from gaitsmith.geometry.rotations import inverse, log, multiply

SHIFT = np.array([0.0, 0.0, 1.3])


@pytest.fixture(scope="module")
def clip():
    """A puppet that tires: every stride a little lower and more turned than the last."""
    motion = Puppet().clip(4.0)
    fading = np.linspace(0.0, 1.0, len(motion))
    q = np.array(motion.rotations)
    q[:, 3] = Rotation.from_euler("xyz", fading[:, None] * [0.2, 0.1, -0.1]).as_quat()
    return motion.with_(
        root_position=motion.root_position - fading[:, None] * [0.02, 0.03, 0.0], rotations=q
    )


def test_the_pose_at_a_frame_is_that_frame(clip):
    position, q = read_pose(clip, np.array([0.5, 1.25]))
    np.testing.assert_allclose(position, clip.root_position[[30, 75]], atol=1e-12)
    np.testing.assert_allclose(q, clip.rotations[[30, 75]], atol=1e-12)


def test_the_end_runs_on_into_the_start(clip):
    """First and second differences at the seam are as small as elsewhere."""
    center, q = closed(clip, 0.8, 1.9, 0.5, SHIFT, 128)  # between two landings
    for table in (center, q.reshape(128, -1)):
        tiled = np.concatenate([table, table])
        speed = np.abs(np.diff(tiled, axis=0)).max(axis=1)
        jerk = np.abs(np.diff(tiled, 2, axis=0)).max(axis=1)
        assert speed[127] < 1.3 * np.quantile(speed[:120], 0.95)
        assert jerk[126:128].max() < 2.0 * np.quantile(jerk[:120], 0.95)


def test_beyond_the_blend_it_is_the_clip(clip):
    center, q = closed(clip, 0.55, 1.65, 0.5, SHIFT, 128)
    times = 0.55 + np.arange(128) / 128 * 1.1
    late = times > 1.06
    position, turned = read_pose(clip, times[late])
    share = np.arange(128)[late] / 128
    np.testing.assert_allclose(center[late], position - share[:, None] * SHIFT, atol=1e-12)
    assert np.abs(log(multiply(inverse(turned), q[late]))).max() < 1e-9


def test_at_the_seam_the_pose_is_that_of_the_later_stance(clip):
    center, q = closed(clip, 0.55, 1.65, 0.5, SHIFT, 128)
    position, turned = read_pose(clip, np.array([1.65]))
    np.testing.assert_allclose(center[0], position[0] - SHIFT, atol=1e-12)
    assert np.abs(log(multiply(inverse(turned[0]), q[0]))).max() < 1e-9


def test_a_mirror_twice_is_nothing(clip):
    q = clip.rotations[::10]
    np.testing.assert_array_equal(mirrored(clip.skeleton, mirrored(clip.skeleton, q)), q)


def test_a_mirror_exchanges_sides(clip):
    q = clip.rotations[::10]
    seen = mirrored(clip.skeleton, q)
    flip = np.diag([-1.0, 1.0, 1.0])
    for joint, name in enumerate(clip.skeleton.names):
        other = clip.skeleton.index(other_side(name))
        wanted = flip @ Rotation.from_quat(np.array(q[:, other])).as_matrix() @ flip
        np.testing.assert_allclose(
            Rotation.from_quat(seen[:, joint]).as_matrix(), wanted, atol=1e-12
        )


def test_the_average_lies_half_way():
    one, two = (Rotation.from_euler("y", a, degrees=True).as_quat() for a in (10.0, 50.0))
    np.testing.assert_allclose(
        average(one, -two), Rotation.from_euler("y", 30.0, degrees=True).as_quat(), atol=1e-12
    )
