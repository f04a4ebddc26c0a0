"""A gait of several Cycles: each where its step length is walked, blended between."""

from __future__ import annotations

import json
import warnings
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from judge import broken
from people import person

from gaitsmith.composing import compose
from gaitsmith.errors import GaitsmithWarning, InvalidInputError
from gaitsmith.geometry.rotations import exp, inverse, log, multiply
from gaitsmith.io import save
from gaitsmith.learning import learn
from gaitsmith.pipeline import walk
from gaitsmith.plan.script import Tempo, WalkTo
from gaitsmith.style.restyle import rule_gait
from gaitsmith.synthesis.asking import Asker
from gaitsmith.synthesis.cycle_overlay import CycleOverlay
from gaitsmith.synthesis.gaits import learned
from gaitsmith.walks.learned import gait_from_dict, gait_to_dict, read_gait, with_others, write_gait
from gaitsmith.walks.model import StepRequest


@cache
def several():
    """`sad` as usual, `careful` for shorter and `happy` for longer steps: easily told apart."""
    usual, shorter, longer = (rule_gait(n) for n in ("sad", "careful", "happy"))
    return with_others(usual, [longer.stride, shorter.stride])


def request_of(body, previous, length, **changes):
    return StepRequest(
        previous_length=previous,
        length=length,
        duration=0.6,
        **{"next_length": length, "side": 0, "stride": 0} | changes,
    )


def laid(gait, request):
    body = several().body
    step = gait.walk.step(body, request)
    return gait.overlay(body, request, step)


def apart(one, two):
    return np.linalg.norm(log(multiply(inverse(exp(one)), exp(two))), axis=-1).max()


@pytest.mark.parametrize("name", ["sad", "careful", "happy"])
def test_a_step_of_a_cycles_length_is_that_cycle(name):
    gait, own = learned(several()), learned(rule_gait(name))
    length = 0.5 * rule_gait(name).cycle.stride_length
    request = request_of(several().body, length, length)
    one, two = laid(gait, request), laid(own, request)
    # walk data and cycle are rounded apart: the lengths differ by a tenth of a micrometer
    assert apart(one.upper, two.upper) < 1e-6
    assert apart(one.pelvis, two.pelvis) < 1e-6
    np.testing.assert_allclose(one.sway, two.sway, atol=1e-6)
    ankles = [g.walk.step(several().body, request).ankle for g in (gait, own)]
    np.testing.assert_allclose(*ankles, atol=1e-6)


def test_between_two_cycles_it_is_between_both():
    body, gait = several().body, learned(several())
    lengths = [0.5 * rule_gait(n).cycle.stride_length for n in ("sad", "happy")]
    middle = 0.5 * sum(lengths)
    request = request_of(body, middle, middle)
    both = laid(gait, request)
    one, two = (
        CycleOverlay(rule_gait(n).cycle, body.leg_length)(
            body, request, gait.walk.step(body, request)
        )
        for n in ("sad", "happy")
    )
    away = [apart(both.upper, each.upper) for each in (one, two)]
    assert away[0] == pytest.approx(away[1], rel=1e-6)
    assert max(away) < 0.51 * apart(one.upper, two.upper)


def test_a_step_begins_as_the_one_before_ends():
    """Also where the two that are blended change."""
    body, gait = several().body, learned(several())
    lengths = np.linspace(0.4, 1.0, 7) * body.leg_length
    before = None
    for i, (previous, length) in enumerate(pairwise(lengths.tolist())):
        now = laid(gait, request_of(body, previous, length, side=i % 2, stride=i // 2))
        if before is not None:
            assert apart(now.upper[:1], before.upper[-1:]) < 1e-9
            assert apart(now.pelvis[:1], before.pelvis[-1:]) < 1e-9
        before = now


def test_the_file_holds_all(tmp_path):
    gait = several()
    write_gait(gait, tmp_path / "x.gait.json")
    read = read_gait(tmp_path / "x.gait.json")
    assert gait_to_dict(read) == gait_to_dict(gait)
    data = json.loads((tmp_path / "x.gait.json").read_text())
    assert [o["stride_length_m"] for o in data["others"]] == sorted(
        o.cycle.stride_length for o in gait.others
    )
    assert "others" not in gait_to_dict(rule_gait("sad"))
    one, two = (walk(distance=2.0, step_length=0.6, gait=g, fps=30) for g in (gait, read))
    assert one.rotations.tobytes() == two.rotations.tobytes()
    data["others"][0].pop("walk_data")
    with pytest.raises(KeyError, match="walk_data"):
        gait_from_dict(data)


@pytest.mark.parametrize("length", [0.4, 0.62, 0.75])
def test_it_keeps_every_promise(length):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)  # of curves, which shorten steps
        motion = walk(path="0,0 0,2 1.5,3.5", step_length=length, gait=several(), fps=120)
    assert broken(motion) == {}


@pytest.mark.parametrize("height", [1.2, 2.0])
def test_on_a_curve_steps_are_asked_one_by_one(height):
    """Events move with the length between cycles: what is read from a table would smear them."""
    gait = learned(several())
    body = person(height)
    requests = [request_of(body, f * body.leg_length, f * body.leg_length) for f in (0.63, 0.71)]
    asker = Asker(gait.walk, gait.overlay)
    answers = asker.table(body, requests, 0.6 * body.leg_length)
    assert len(answers) == 2


def test_strides_that_are_alike_are_one():
    usual = rule_gait("sad")
    assert with_others(usual, [usual.stride]).others == ()


def test_a_mix_of_one_has_its_lengths():
    gait = compose(
        {"styles": {"a": "sad"}, "root": {"weights": {"a": 1.0}}}, styles={"a": several()}
    )
    assert len(gait.others) == 2
    for own, mixed in zip(several().strides, gait.strides, strict=True):
        assert mixed.cycle.stride_length == pytest.approx(own.cycle.stride_length, abs=1e-5)
        assert mixed.cycle.duration == pytest.approx(own.cycle.duration, abs=1e-5)
        away = log(multiply(inverse(own.cycle.rotations), mixed.cycle.rotations))
        assert np.linalg.norm(away, axis=-1).max() < 1e-5
        assert mixed.cycle.license == gait.cycle.license


def test_a_mix_has_the_lengths_of_its_richest_source():
    """Who has one stride shows it at every length; who has others, what lies between them."""
    recipe = {
        "styles": {"a": "sad", "b": "proud"},
        "root": {"weights": {"a": 0.5, "b": 0.5}},
        "arms": {"weights": {"b": 1.0}},
        "speed": 1.0,
    }
    gait = compose(recipe, styles={"a": several()})
    lengths = [s.cycle.stride_length for s in gait.strides]
    assert lengths[1] < lengths[0] < lengths[2]
    assert gait.cycle.speed == pytest.approx(1.0, abs=1e-5)
    # upper arms hang by the lean of the trunk, which is another at every length
    index = gait.cycle.skeleton.index("leftLowerArm")
    arms = [s.cycle.rotations[:, index].mean(axis=0) for s in gait.strides]
    assert max(np.abs(arm - arms[0]).max() for arm in arms) < 0.03
    twice = compose(recipe, styles={"a": several()})
    assert gait_to_dict(twice) == gait_to_dict(gait)
    assert broken(walk(distance=3.0, step_length=0.45 * lengths[0], gait=gait, fps=120)) == {}


@cache
def clip(length):
    """Six meters of a man who steps `length` meters."""
    return walk(distance=6.0, step_length=length, gait="neutral", fps=60)


def test_several_clips_make_one_gait():
    gait = learn([clip(0.65), clip(0.5), clip(0.8)], name="several")
    lengths = [0.5 * s.cycle.stride_length for s in gait.strides]
    np.testing.assert_allclose(lengths, [0.65, 0.5, 0.8], atol=0.02)
    assert all(s.walk_data[0].body == gait.body for s in gait.strides)
    assert broken(walk(distance=3.0, step_length=0.6, gait=gait, fps=120)) == {}


def test_strides_of_different_length_in_one_clip_make_one_gait():
    lengths = (0.65, 0.5, 0.8)
    do = [WalkTo((0.0, 5.0 * (i + 1)), Tempo(step_length=v)) for i, v in enumerate(lengths)]
    uneven = walk(do=do, gait="neutral", fps=60)
    gait = learn(uneven, lengths=3)
    found = [0.5 * s.cycle.stride_length for s in gait.strides]
    np.testing.assert_allclose(sorted(found), sorted(lengths), atol=0.03)
    assert learn(uneven).others == ()


def test_what_cannot_be_learned_together_is_said():
    with pytest.raises(InvalidInputError, match="events are seconds of one clip"):
        learn([clip(0.65), clip(0.5)], events=[])
    with pytest.raises(InvalidInputError, match="nothing to learn from"):
        learn([])
    with pytest.raises(InvalidInputError, match="lengths must be 1 or more, got 0"):
        learn(clip(0.65), lengths=0)


def test_the_command_takes_several(run, tmp_path):
    for i, length in enumerate((0.65, 0.5)):
        save(clip(length), tmp_path / f"{i}.bvh")
    code, out, err = run("learn", "0.bvh", "1.bvh", "-o", "x.gait.json", "--unit", "cm", "--json")
    assert code == 0, err
    assert len(json.loads(out)["other_stride_lengths_m"]) == 1
