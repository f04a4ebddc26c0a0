"""What every way of stepping must be: the contract of seam 2.

Subclass :class:`StepGeneratorContract` in one test file per generator; ``generator``,
``body`` and ``plan`` are fixtures.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from people import GROUND
from scipy.spatial.transform import Rotation

from gaitsmith.conventions import BALL, HEEL, SIDE_SIGN, TOE
from gaitsmith.synthesis.step import (
    PreparedStep,
    StepGenerator,
    WalkerState,
    prepare_walk,
)

FIELDS = (
    "center",
    "heading",
    "pelvis",
    "thigh",
    "shin",
    "foot",
    "bend",
    "knee",
    "upper",
    "contacts",
)
PHASES = np.linspace(0.0, 1.0, 61)
#: A step that stands alone lowers its hips without regard to its neighbors, so its height may
#: differ from theirs where they meet; of the leg length.
ALONE = 0.03


def turn(quaternion, vector):
    return Rotation.from_quat(np.array(quaternion)).apply(vector)


def legs(poses, body):
    """Ankles (F, 2, 3) and sole points (F, 2, 3, 3) of poses, joint by joint."""
    foot, count = body.foot, len(poses.center)
    ankles, soles = np.empty((count, 2, 3)), np.empty((count, 2, 3, 3))
    for side in (0, 1):
        hip = poses.center + turn(poses.pelvis, [0.5 * SIDE_SIGN[side] * body.hip_width, 0, 0])
        knee = hip + turn(poses.thigh[:, side], [0.0, -body.thigh, 0.0])
        ankle = knee + turn(poses.shin[:, side], [0.0, -body.shin, 0.0])
        ankles[:, side], low = ankle, -foot.ankle_height
        world = poses.foot[:, side]
        soles[:, side, HEEL] = ankle + turn(world, [0.0, low, -foot.heel])
        soles[:, side, BALL] = ankle + turn(world, [0.0, low, foot.ball])
        joint = ankle + turn(world, [0.0, low + foot.toe_joint_height, foot.ball])
        bent = Rotation.from_quat(np.array(world)) * Rotation.from_euler(
            "x", -poses.bend[:, [side]]
        )
        soles[:, side, TOE] = joint + bent.apply([0.0, -foot.toe_joint_height, foot.toes])
    return ankles, soles


def differences(poses, other):
    """Largest difference of each field."""
    return {
        name: np.abs(
            np.asarray(getattr(poses, name), dtype=float)
            - np.asarray(getattr(other, name), dtype=float)
        ).max(initial=0.0)
        for name in FIELDS
    }


class StepGeneratorContract:
    """``generator`` is any :class:`StepGenerator` that can walk ``plan``."""

    ground = GROUND

    @pytest.fixture
    def steps(self, generator, body, plan):
        """Planned and prepared steps, each from where the last one left the walker."""
        state, out = WalkerState(), []
        for planned in plan.steps():
            step = generator.prepare(body, state, planned)
            out.append((planned, step))
            state = step.end
        return out

    def test_is_a_step_generator(self, generator, steps):
        assert isinstance(generator, StepGenerator)
        for planned, step in steps:
            assert isinstance(step, PreparedStep)
            assert step.duration == planned.duration
            assert isinstance(step.end, WalkerState)

    def test_a_step_begins_where_the_one_before_ends(self, steps, body):
        for (_, before), (_, after) in pairwise(steps):
            last, first = before.poses(np.array([1.0])), after.poses(np.array([0.0]))
            np.testing.assert_allclose(legs(last, body)[1], legs(first, body)[1], atol=1e-8)
            np.testing.assert_allclose(last.upper, first.upper, atol=1e-9)
            np.testing.assert_allclose(last.pelvis, first.pelvis, atol=1e-9)
            gap = np.abs(last.center - first.center)[0]
            assert gap[[0, 2]].max() < 1e-9
            assert gap[1] < ALONE * body.leg_length

    def test_footsteps_are_where_the_plan_has_them(self, steps, body):
        """The stance foot stands on its footstep, the swing foot lands on its target."""
        for planned, step in steps:
            stance = planned.stance.side
            poses = step.poses(np.array([0.0, 0.4, 1.0]))
            soles = legs(poses, body)[1]
            for foot, side, frame in (
                (planned.stance, stance, 1),
                (planned.target, 1 - stance, 2),
            ):
                ahead = np.array([np.sin(foot.heading), 0.0, np.cos(foot.heading)])
                heel = foot.position - body.foot.heel * ahead
                np.testing.assert_allclose(soles[frame, side, HEEL], heel, atol=1e-6)

    def test_the_bearing_point_of_the_stance_foot_stays(self, steps, body):
        for planned, step in steps:
            poses, stance = step.poses(PHASES), planned.stance.side
            soles = legs(poses, body)[1]
            assert poses.contacts[:, stance].any(-1).all(), "the stance foot bears throughout"
            for point in (HEEL, BALL, TOE):
                bears = poses.contacts[:, stance, point]
                if bears.any():
                    path = soles[bears, stance, point]
                    assert np.linalg.norm(path - path[0], axis=-1).max() < 1e-3
                    assert np.abs(path[:, 1]).max() < 1e-3

    def test_no_foot_goes_below_the_ground(self, steps, body):
        for _, step in steps:
            soles = legs(step.poses(PHASES), body)[1]
            above = soles[..., 1] - self.ground.height(soles[..., 0], soles[..., 2])
            assert above.min() > -5e-4

    def test_the_swing_foot_swings(self, steps, body):
        """It leaves the ground, once, and clears it."""
        for planned, step in steps:
            poses, swing = step.poses(PHASES), 1 - planned.stance.side
            free = ~poses.contacts[:, swing].any(-1)
            assert (np.diff(free.astype(int)) == 1).sum() == 1
            assert free[-2], "it lands at the end, not before"
            assert legs(poses, body)[1][free, swing, :, 1].min(-1).max() > 1e-3

    def test_asking_again_changes_nothing(self, steps):
        for _, step in steps:
            phases = np.array(PHASES)
            first = step.poses(phases)
            step.poses(np.array([0.77]))
            again = step.poses(phases)
            for name in FIELDS:
                np.testing.assert_array_equal(getattr(first, name), getattr(again, name))
            np.testing.assert_array_equal(phases, PHASES)

    def test_the_order_of_asking_changes_nothing(self, steps):
        shuffled = np.random.default_rng(0).permutation(len(PHASES))
        for _, step in steps:
            film = step.poses(PHASES)
            for order in (slice(None, None, -1), shuffled):
                other = step.poses(PHASES[order])
                for name in FIELDS:
                    np.testing.assert_allclose(
                        np.asarray(getattr(other, name), dtype=float),
                        np.asarray(getattr(film, name), dtype=float)[order],
                        rtol=0.0,
                        atol=1e-12,
                    )

    def test_a_film_is_its_single_frames(self, steps):
        """Array in, array out: one phase at a time says the same."""
        for _, step in steps[:3]:
            film = step.poses(PHASES)
            for i in (0, 1, 17, 30, 59, 60):
                frame = step.poses(PHASES[i : i + 1])
                for name in FIELDS:
                    one, all_ = getattr(frame, name), getattr(film, name)
                    assert one.shape == (1, *all_.shape[1:])
                    np.testing.assert_allclose(
                        one[0].astype(float), all_[i].astype(float), rtol=0.0, atol=1e-12
                    )

    def test_no_phase_no_pose(self, steps):
        poses = steps[0][1].poses(np.empty(0))
        full = steps[0][1].poses(np.array([0.5]))
        for name in FIELDS:
            assert getattr(poses, name).shape == (0, *getattr(full, name).shape[1:])

    def test_everything_is_finite(self, steps):
        for _, step in steps:
            poses = step.poses(PHASES)
            for name in FIELDS:
                assert np.isfinite(getattr(poses, name)).all()

    def test_a_whole_walk_has_no_jump(self, generator, body, plan):
        """What a step alone may leave open, the prepared walk closes (< 1e-6 m and rad)."""
        walk = prepare_walk(plan, generator, body, self.ground)
        landings = walk.clock.starts[1:-1]
        before, after = walk.poses(landings - 2e-9), walk.poses(landings + 2e-9)
        apart = differences(before, after)
        apart.pop("contacts")
        assert max(apart.values()) < 1e-6, apart
        for a, b in zip(legs(before, body), legs(after, body), strict=True):
            np.testing.assert_allclose(a, b, atol=1e-6)
