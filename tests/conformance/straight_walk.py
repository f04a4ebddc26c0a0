"""What every straight-line walk must be: the contract of seam 1.

Subclass :class:`StraightWalkContract` in one test file per walk; ``walk`` is a fixture.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from people import person

from gaitsmith.errors import InfeasibleStepError
from gaitsmith.walks.model import SagittalStep, StepRequest, StraightWalk

STANCE, SWING = 0, 1
#: Step lengths over leg length; the first starts and the last stops.
CHAINS = {
    "equal": [0.7] * 4,
    "unequal": [0.5, 0.8, 0.55, 0.75, 0.4],
    "short": [0.3, 0.3],
    "one step": [0.45],
}
WHO = (1.75, "child", "kb92b-figure")


def turned(vector, pitch):
    """Sagittal (forward, up) after the toes rise by ``pitch``."""
    c, s = np.cos(pitch), np.sin(pitch)
    return np.array([vector[0] * c - vector[1] * s, vector[0] * s + vector[1] * c])


class StraightWalkContract:
    """``walk`` is any :class:`StraightWalk`."""

    @pytest.fixture(params=WHO, ids=str)
    def body(self, request):
        return person(request.param)

    @pytest.fixture(params=CHAINS)
    def chain(self, request, walk, body):
        """Requests and answers from standing to standing, each from where the last one left."""
        lengths = [ratio * body.leg_length for ratio in CHAINS[request.param]]
        around = [0.0, *lengths, 0.0, 0.0]
        kinds = ["start", *["walk"] * (len(lengths) - 1), "stop"]
        out, height = [], None
        for i, kind in enumerate(kinds):
            asked = StepRequest(
                side=i % 2,
                previous_length=around[i],
                length=around[i + 1],
                next_length=around[i + 2],
                duration=0.55,
                hip_height=height,
                kind=kind,
            )
            step = walk.step(body, asked)
            height = float(step.center[-1, 1])
            out.append((asked, step))
        return out

    def steady(self, body, **changes):
        length = 0.7 * body.leg_length
        asked = StepRequest(
            side=0, previous_length=length, length=length, next_length=length, duration=0.55
        )
        return replace(asked, **changes)

    def test_is_a_straight_walk(self, walk):
        assert isinstance(walk, StraightWalk)

    def test_the_heel_lands_where_the_step_ends(self, chain, body):
        """[KB92b] lemma 2, asked of every model: the foot will be flat one step ahead.

        The ankle alone cannot say: at heel strike it is still behind (Eq. 34).
        """
        for asked, step in chain:
            to_heel = np.array([-body.foot.heel, -body.foot.ankle_height])
            heel = step.ankle[-1, SWING] + turned(to_heel, step.pitch[-1, SWING])
            expected = [asked.length - body.foot.heel, 0.0]
            np.testing.assert_allclose(heel, expected, atol=1e-9)
            assert step.pitch[-1, SWING] > -1e-12, "a walk lands on its heel or flat"
            assert step.meta[-1, SWING] == 0.0

    def test_steps_join_without_a_jump(self, chain):
        """HSM+ is the next step's HSM- with the legs exchanged."""
        for (asked, step), (_, after) in pairwise(chain):
            ahead = [asked.length, 0.0]
            np.testing.assert_allclose(step.center[-1] - ahead, after.center[0], atol=1e-9)
            for mine, its in ((STANCE, SWING), (SWING, STANCE)):
                np.testing.assert_allclose(
                    step.ankle[-1, mine] - ahead, after.ankle[0, its], atol=1e-9
                )
                for name in ("pitch", "meta", "bend"):
                    here, there = getattr(step, name), getattr(after, name)
                    assert here[-1, mine] == pytest.approx(there[0, its], abs=1e-9), name

    def test_starts_from_standing(self, chain, body):
        _, step = chain[0]
        self._stands(step, 0, body)

    def test_stops_in_standing(self, chain, body):
        _, step = chain[-1]
        self._stands(step, -1, body)

    def _stands(self, step, sample, body):
        flat = [0.0, body.foot.ankle_height]
        np.testing.assert_allclose(step.ankle[sample], [flat, flat], atol=1e-9)
        np.testing.assert_allclose(step.pitch[sample], 0.0, atol=1e-9)
        np.testing.assert_allclose(step.meta[sample], 0.0, atol=1e-9)
        assert step.center[sample, 0] == pytest.approx(0.0, abs=1e-9)
        reach = (step.center[sample, 1] - body.foot.ankle_height) / body.leg_length
        assert 0.95 < reach <= 1.0, "people stand on nearly straight legs"

    def test_a_bearing_foot_stays_where_it_is(self, chain, body):
        """While pitch is positive the heel, while negative the toe tip does not move."""
        foot = body.foot
        for asked, step in chain:
            for side, begins in ((STANCE, 0.0), (SWING, -asked.previous_length)):
                down = step.phase <= (1.0 if side == STANCE else step.toe_off)
                for i in np.flatnonzero(down):
                    ankle = step.ankle[i, side] - [begins, 0.0]
                    pitch, meta = step.pitch[i, side], step.meta[i, side]
                    to_heel = turned([-foot.heel, -foot.ankle_height], pitch)
                    if pitch >= 0.0:
                        np.testing.assert_allclose(ankle + to_heel, [-foot.heel, 0.0], atol=1e-9)
                        continue
                    to_joint = turned([foot.ball, foot.toe_joint_height - foot.ankle_height], pitch)
                    to_tip = turned([foot.toes, -foot.toe_joint_height], -meta)
                    tip = ankle + to_joint + to_tip
                    np.testing.assert_allclose(tip, [foot.ball + foot.toes, 0.0], atol=1e-9)

    def test_same_question_same_answer(self, walk, body):
        """No hidden state: the model may be shared by many walkers."""
        first = walk.step(body, self.steady(body))
        walk.step(body, self.steady(body, length=0.5 * body.leg_length))
        walk.step(person("tall"), self.steady(person("tall")))
        second = walk.step(body, self.steady(body))
        for name in ("phase", "center", "ankle", "pitch", "meta", "bend"):
            np.testing.assert_array_equal(getattr(first, name), getattr(second, name))

    def test_both_sides_walk_alike(self, walk, body):
        """The seam is sagittal: left and right differ in what is laid over it."""
        left, right = (walk.step(body, self.steady(body, side=side)) for side in (0, 1))
        np.testing.assert_array_equal(left.center, right.center)
        np.testing.assert_array_equal(left.ankle, right.ankle)

    def test_everything_is_finite_and_of_human_size(self, chain, body):
        for _, step in chain:
            assert isinstance(step, SagittalStep)
            for name in ("center", "ankle", "pitch", "meta", "bend"):
                assert np.isfinite(getattr(step, name)).all()
            assert (np.abs(step.center) < 1.2 * body.hip_height).all()
            assert (step.center[:, 1] > 0.6 * body.hip_height).all()
            assert (np.diff(step.center[:, 0]) > -1e-3 * body.leg_length).all(), "walks ahead"
            assert (np.abs(step.pitch) < np.radians(100.0)).all()

    def test_phase_holds_the_events(self, chain):
        for _, step in chain:
            for event in (step.flat, step.heel_off, step.meta_off, step.toe_off):
                assert event >= 1.0 or event in step.phase

    @pytest.mark.parametrize("ratio", [1.6, 2.5, 40.0])
    @pytest.mark.parametrize("which", ["length", "previous_length"])
    def test_a_step_no_leg_can_take_is_refused(self, walk, body, ratio, which):
        length = ratio * body.leg_length
        with pytest.raises(InfeasibleStepError) as caught:
            walk.step(body, self.steady(body, **{which: length}))
        error = caught.value
        assert error.needed == pytest.approx(length)
        assert 0.5 * body.leg_length < error.available < length
        assert f"{error.available:.3f} m" in str(error)

    def test_the_longest_step_offered_instead_works(self, walk, body):
        with pytest.raises(InfeasibleStepError) as caught:
            walk.step(body, self.steady(body, length=5.0))
        walk.step(body, self.steady(body, length=caught.value.available))
