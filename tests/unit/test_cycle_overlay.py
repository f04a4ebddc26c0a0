"""The upper body of a cycle on any walk: itself at its own pace, joined and level elsewhere."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from people import GROUND, person, the_walk
from stride_numbers import apart
from test_cycle import cycle as any_cycle

from gaitsmith.conventions import SIDES
from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.geometry.rotations import IDENTITY, exp, log, multiply, rotate
from gaitsmith.plan.pace import Pace
from gaitsmith.plan.straight import Stance, plan_straight
from gaitsmith.synthesis.cycle_overlay import CycleOverlay, scaled, shared
from gaitsmith.synthesis.gaits import neutral
from gaitsmith.synthesis.overlay import stride_of, upper_joints
from gaitsmith.synthesis.step import prepare_walk
from gaitsmith.synthesis.straight import StraightGenerator
from gaitsmith.walks.model import StepRequest

MAN = subject()


def asked(body, length, duration, **changes):
    values = {
        "side": 0,
        "previous_length": length,
        "length": length,
        "next_length": length,
        "duration": duration,
    }
    return StepRequest(**values | changes)


def laid(overlay, body, request):
    return overlay(body, request, the_walk().step(body, request))


def two_strides():
    """A stride of the man's, twice; the second time his arms hang still."""
    one = neutral_cycle()
    still = np.array(one.rotations)
    for name in (f"{side}{part}" for side in SIDES for part in ("UpperArm", "LowerArm")):
        joint = one.skeleton.index(name)
        fade = np.sin(np.pi * np.arange(len(still)) / len(still)) ** 2
        first = still[0, joint]
        away = multiply(first * [-1, -1, -1, 1], still[:, joint])
        still[:, joint] = multiply(first, _powered(away, 1.0 - fade))
    return one.with_(
        rotations=np.concatenate([one.rotations, still]),
        center=np.concatenate([one.center, one.center]),
        strides=2,
    )


def _powered(q, share):
    return exp(share[:, None] * log(q))


@pytest.mark.parametrize("kind", ["neutral", "any", "two strides"])
@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("stride", [0, 1])
def test_at_its_own_pace_on_its_own_body_it_is_the_cycle(kind, side, stride):
    cycle = {"neutral": neutral_cycle, "any": any_cycle, "two strides": two_strides}[kind]()
    body = MAN if kind != "any" else person(1.75)
    overlay = CycleOverlay(cycle, body.leg_length)
    length, duration = 0.5 * cycle.stride_length, 0.5 * cycle.duration
    length = min(length, body.leg_length)
    step = the_walk().step(body, asked(body, length, duration, side=side))
    request = asked(body, 0.5 * cycle.stride_length, duration, side=side, stride=stride)
    got = overlay(body, request, step)
    right = cycle.events[1, 0]
    phase = step.phase * right if side == 0 else right + step.phase * (1.0 - right)
    center, rotations = cycle.at(phase + stride % cycle.strides)
    index = cycle.skeleton.index
    assert apart(exp(got.pelvis), rotations[:, index("hips")]).max() < 1e-3
    for k, name in enumerate(upper_joints(body)):
        assert apart(exp(got.upper[:, k]), rotations[:, index(name)]).max() < 1e-3, name
    hips = [cycle.skeleton.offsets[index(f"{s}UpperLeg"), 0] for s in SIDES]
    sway = (center[:, 0] - cycle.center[:, 0].mean()) * body.hip_width / (hips[0] - hips[1])
    np.testing.assert_allclose(got.sway, sway, atol=1e-9)


@pytest.mark.parametrize("make", [neutral_cycle, two_strides])
def test_steps_of_different_length_and_pace_join(make):
    """Where a step ends the next begins; both know the length and the duration between them."""
    overlay, body = CycleOverlay(make(), MAN.leg_length), person(1.6)
    strides = make().strides
    paces = [(0.0, 0.9), (0.5, 0.7), (0.7, 0.55), (0.75, 0.42), (0.6, 0.6), (0.6, 0.5), (0.0, 0.8)]
    last = None
    for i, (length, duration) in enumerate(paces[1:], 1):
        kind = "start" if i == 1 else "stop" if length == 0.0 else "walk"
        request = asked(
            body,
            length,
            duration,
            side=(i + 1) % 2,
            previous_length=paces[i - 1][0],
            kind=kind,
            stride=((i - 1) // 2) % strides,
            previous_duration=None if i == 1 else paces[i - 1][1],
        )
        now = laid(overlay, body, request)
        if last is not None:
            assert apart(exp(last.pelvis[-1]), exp(now.pelvis[0])) < 1e-3
            assert apart(exp(last.upper[-1]), exp(now.upper[0])).max() < 1e-3
            assert last.sway[-1] == pytest.approx(now.sway[0], abs=1e-6)
        last = now


@pytest.mark.parametrize("length", [0.3, 0.5, 0.72, 0.85])
@pytest.mark.parametrize("duration", [0.38, 0.55, 0.9])
def test_the_head_stays_level_whatever_the_trunk_below_it_does(length, duration):
    overlay = neutral().overlay
    got = laid(overlay, MAN, asked(MAN, length, duration))
    turned, names = exp(got.pelvis), upper_joints(MAN)
    for name in ("spine", "chest", "upperChest", "neck", "head"):
        turned = multiply(turned, exp(got.upper[:, names.index(name)]))
    nose, ear = (rotate(turned, np.array(v)) for v in ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]))
    assert np.degrees(np.abs(np.arcsin(nose[:, 1]))).max() < 3.0
    assert np.degrees(np.abs(np.arctan2(nose[:, 0], nose[:, 2]))).max() < 4.0
    assert np.degrees(np.abs(np.arcsin(ear[:, 1]))).max() < 3.0


@pytest.mark.parametrize("count", [1, 2, 5])
def test_other_spines_share_the_turn_of_the_trunk(count):
    overlay, request = CycleOverlay(neutral_cycle(), MAN.leg_length), asked(MAN, 0.7, 0.6)
    body = replace(MAN, spine_segments=count)
    there, here = laid(overlay, MAN, request), laid(overlay, body, request)

    def chest(got, who):
        turned, names = exp(got.pelvis), upper_joints(who)
        for k in range(names.index("neck")):
            turned = multiply(turned, exp(got.upper[:, k]))
        return turned

    assert apart(chest(there, MAN), chest(here, body)).max() < 1e-6
    np.testing.assert_allclose(here.upper[:, count:], there.upper[:, 3:], atol=1e-12)


def test_arms_swing_more_with_length_and_with_cadence():
    overlay = CycleOverlay(neutral_cycle(), MAN.leg_length)
    arm = upper_joints(MAN).index("leftUpperArm")

    def size(length, duration):
        got = laid(overlay, MAN, asked(MAN, length, duration))
        return apart(exp(got.upper[0, arm]), exp(got.upper[-1, arm]))

    usual = size(0.72, 0.57)
    assert size(0.5, 0.57) < 0.8 * usual
    assert size(0.72, 0.8) < 0.9 * usual
    assert size(0.8, 0.5) > 1.15 * usual


def test_arms_that_are_held_somewhere_are_held_in_standing_too():
    def standing(cycle):
        request = asked(MAN, 0.5, 0.9, previous_length=0.0, kind="start")
        got = laid(CycleOverlay(cycle, MAN.leg_length), MAN, request)
        arm = upper_joints(MAN).index("leftUpperArm")
        return rotate(exp(got.upper[0, arm]), np.array([1.0, 0.0, 0.0]))

    usual = neutral_cycle()
    rotations = np.array(usual.rotations)
    rotations[:, usual.skeleton.index("leftUpperArm")] = IDENTITY
    assert standing(usual) @ [0.0, -1.0, 0.0] > 0.95
    assert abs(standing(usual)[2]) < 0.01
    np.testing.assert_allclose(standing(usual.with_(rotations=rotations)), [1, 0, 0], atol=1e-9)


@pytest.mark.parametrize("start", ["stand", "walk"])
def test_a_loop_of_two_strides_is_walked_in_turn(start):
    """Arms repeat every four steps; every other stride of ``two_strides`` has still ones."""
    plan = plan_straight(
        distance=10.0,
        pace=Pace(0.72, 105.0),
        stance=Stance(0.1, (0.0, 0.0)),
        ground=GROUND,
        start=start,
        stop="walk",
    )
    generator = StraightGenerator(the_walk(), GROUND, CycleOverlay(two_strides(), MAN.leg_length))
    walk = prepare_walk(plan, generator, MAN, GROUND)
    strikes = [t for s, t in zip(plan.side, plan.time, strict=True) if s == 0 and t > 1.9][:5]
    swings = []
    for first, last in pairwise(strikes):
        poses = walk.poses(np.linspace(first, last, 30))
        arm = poses.upper[:, upper_joints(MAN).index("leftUpperArm")]
        swings.append(np.ptp(arm, axis=0).max())
    assert swings[0] == pytest.approx(swings[2], rel=0.02)
    assert swings[1] == pytest.approx(swings[3], rel=0.02)
    assert max(swings[:2]) > 1.2 * min(swings[:2])


@pytest.mark.parametrize("start", ["stand", "walk"])
def test_strides_are_counted_from_left_heel_strikes(start):
    plan = plan_straight(
        distance=6.0,
        pace=Pace(0.7, 100.0),
        stance=Stance(0.1, (0.0, 0.0)),
        ground=GROUND,
        start=start,
    )
    numbers = [(step.stance.side, stride_of(step)) for step in plan.steps()]
    for (side, stride), (_, following) in pairwise(numbers):
        assert following - stride == side


def test_sharing_and_scaling():
    rng = np.random.default_rng(3)
    chain = [exp(0.3 * rng.standard_normal((5, 3))) for _ in range(3)]
    total = multiply(multiply(chain[0], chain[1]), chain[2])
    for got, joint in zip(shared(chain, total), chain, strict=True):
        assert apart(got, joint).max() < 1e-6
    wanted = exp(0.3 * rng.standard_normal((5, 3)))
    one, two, three = shared(chain, wanted)
    assert apart(multiply(multiply(one, two), three), wanted).max() < 1e-6
    assert apart(scaled(IDENTITY, wanted, np.ones(5)), wanted).max() < 1e-6
    np.testing.assert_allclose(scaled(IDENTITY, wanted, np.zeros(5)), np.tile(IDENTITY, (5, 1)))
