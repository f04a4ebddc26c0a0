"""Built-in styles by rule: each is what it says, walks anywhere, and mixes with the others."""

from __future__ import annotations

import warnings
from functools import cache

import numpy as np
import pytest
from judge import broken, posed
from people import person
from styles import apart, slide

from gaitsmith.body.masses import center_of_mass, segments_of
from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import GRAVITY
from gaitsmith.errors import GaitsmithWarning, UnknownNameError
from gaitsmith.gait.neutral import subject
from gaitsmith.geometry.rotations import multiply, rotate
from gaitsmith.motion.kinematics import forward_kinematics
from gaitsmith.pipeline import walk
from gaitsmith.plan.pace import froude
from gaitsmith.plan.paths import Path
from gaitsmith.style.restyle import restyled, rule_gait
from gaitsmith.style.rules import RULES, Rule
from gaitsmith.synthesis.gaits import GAITS
from gaitsmith.walks.learned import gait_to_dict

STYLES = sorted(RULES)
BODIES = ("1.75 m", "child", "2.0 m")
WAYS = {
    "circle": Path.arc(1.2, 2.0 * np.pi),
    "s-curve": Path.of_turns([(1.5, 0.0), (1.57, 0.7), (2.0, 0.0), (1.57, -0.7), (1.0, 0.0)]),
}


def body_of(name):
    return person(1.12 if name == "child" else float(name.split()[0]))


@cache
def facts(name):
    """How a style stands and moves, radians and meters, over a stride of the neutral man."""
    cycle = restyled(RULES[name]) if name in RULES else restyled(Rule())
    skeleton, index = cycle.skeleton, cycle.skeleton.index
    places, world = forward_kinematics(skeleton, cycle.center, cycle.rotations)

    def pitch(joint):
        ahead = rotate(world[:, index(joint)], np.array([0.0, 0.0, 1.0]))
        return float(-np.arcsin(ahead[:, 1].mean()))

    arm = places[:, index("leftLowerArm")] - places[:, index("leftUpperArm")]
    swing = np.arctan2(arm[:, 2], -arm[:, 1])
    up = rotate(world[:, index("upperChest")], np.array([0.0, 1.0, 0.0]))
    elbow = 2.0 * np.arccos(np.abs(cycle.rotations[:, index("leftLowerArm"), 3])).mean()
    # of the left leg in the middle of its stance
    knee = 2.0 * np.arccos(np.abs(cycle.rotations[:, index("leftLowerLeg"), 3]))
    toes = places[:, index("leftToes"), 1]
    return {
        "speed": cycle.speed,
        "step": 0.5 * cycle.stride_length,
        "cadence": 120.0 / cycle.duration,
        "lean": pitch("upperChest"),
        "head": pitch("head"),
        "swing": float(np.ptp(swing)),
        "out": float(np.arctan2(arm[:, 0], -arm[:, 1]).mean()),
        "elbow": float(elbow),
        "bounce": float(np.ptp(cycle.center[:, 1])),
        "knee": float(knee[32]),
        "sway": float(np.ptp(cycle.center[:, 0])),
        "roll": float(np.ptp(up[:, 0])),
        "lift": float(np.ptp(toes)),
    }


#: What findings say of each, against neutral: quantity and on which side of it (a factor or, for
#: angles, degrees more).
FINDINGS = {
    "angry": ("speed>1.2", "step>1.05", "lean+8", "elbow+20", "swing>1.2"),
    "careful": ("step<0.7", "speed<0.65", "head+8", "swing<0.6"),
    "childlike": ("cadence>1.1", "bounce>1.2", "swing>1.2", "lift>1.1"),
    "elderly": ("speed<0.8", "step<0.8", "lean+15", "swing<0.8", "knee+5"),
    "fearful": ("cadence>1.05", "step<0.75", "elbow+50", "swing<0.6", "knee+5"),
    "happy": ("speed>1.1", "bounce>1.2", "swing>1.3", "lean-2"),
    "hurried": ("cadence>1.15", "speed>1.2", "elbow+30", "lean+4"),
    "proud": ("cadence<0.95", "lean-8", "head-5", "out+8", "roll>1.5"),
    "sad": ("speed<0.75", "swing<0.6", "head+12", "lean+5", "sway>1.2", "bounce<0.8"),
    "sneaky": ("speed<0.55", "knee+15", "lean+10", "lift>1.2", "cadence<0.7"),
    "swagger": ("out+10", "sway>1.2", "roll>1.5", "speed<1.0"),
    "tired": ("speed<0.85", "head+8", "sway>1.2", "lean+10", "swing<0.9"),
}


@pytest.mark.parametrize("name", STYLES)
def test_it_is_what_the_findings_say(name):
    own, neutral = facts(name), facts("neutral")
    for finding in FINDINGS[name]:
        at = next(i for i, letter in enumerate(finding) if letter in "<>+-")
        what, bar = finding[:at], float(finding[at + 1 :])
        kind = finding[at]
        if kind in "<>":
            ratio = own[what] / neutral[what]
            assert ratio < bar if kind == "<" else ratio > bar, (finding, ratio)
        else:
            more = np.degrees(own[what] - neutral[what]) * (1.0 if kind == "+" else -1.0)
            assert more > bar, (finding, more)


@pytest.mark.parametrize("name", STYLES)
def test_it_is_labelled(name):
    cycle = restyled(RULES[name])
    assert "made by rule" in cycle.source
    assert cycle.license == restyled(Rule()).license
    assert RULES[name].sources


def test_it_is_made_the_same_every_time():
    gait = rule_gait("sneaky")
    assert any("made by rule" in note for note in gait.notes)
    rule_gait.cache_clear()
    assert gait_to_dict(rule_gait("sneaky")) == gait_to_dict(gait)


@pytest.mark.parametrize("name", ["neutral", *STYLES])
def test_its_feet_stand_still_and_nobody_runs(name):
    cycle = restyled(RULES.get(name, Rule()))
    assert slide(cycle, until="heel_off") < 0.002
    assert froude(subject(), cycle.speed) < 0.4


def test_no_rule_is_neutral():
    gait = rule_gait("neutral")
    assert gait.step_lengths[0] == pytest.approx(gait.step_lengths[1], abs=1e-6)
    with pytest.raises(UnknownNameError, match=r"unknown style 'sadd'.*Did you mean 'sad'"):
        rule_gait("sadd")


def test_left_and_right_are_mirror_images():
    cycle = restyled(RULES["swagger"])
    left, right = (
        multiply(
            cycle.rotations[:, cycle.skeleton.index(f"{side}Shoulder")],
            cycle.rotations[:, cycle.skeleton.index(f"{side}UpperArm")],
        )
        for side in ("left", "right")
    )
    mirrored = np.roll(right, 64, axis=0) * [1.0, -1.0, -1.0, 1.0]
    assert apart(left, mirrored).max() < 0.05


@pytest.mark.parametrize("name", ["sneaky", "angry"])
def test_it_walks_a_circle(name):
    assert broken(walked(name, "circle", "1.75 m")) == {}


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("name", STYLES)
def test_every_promise_is_kept(name, body, way):
    assert broken(walked(name, way, body), but=("unflagged_bearing",)) == {}


def walked(name, way, body):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)
        return walk(path=WAYS[way], gait=name, body=body_of(body), fps=120)


@pytest.mark.parametrize(
    "radius", [1.2, *(pytest.param(r, marks=pytest.mark.slow) for r in (2.0, 5.0))]
)
@pytest.mark.parametrize(
    "name", ["sneaky", *(pytest.param(n, marks=pytest.mark.slow) for n in STYLES if n != "sneaky")]
)
def test_it_leans_as_the_curve_asks(name, radius):
    """[KB92a] Eq. 4 to 10 %, low walks too."""
    body = person(1.75)
    path = Path.arc(radius, max(12.0 / radius, 4.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)  # of curves, which shorten steps
        motion = walk(path=path, gait=name, body=body, fps=120, start="walk", stop="walk")
    positions, _, _ = posed(motion)
    mass = center_of_mass(motion.skeleton, positions, segments_of(body))
    labels, center = motion.labels, np.array([radius, 0.0])
    a, b = np.round(labels.footstep_time[[6, 10]] * 120).astype(int)
    out = np.hypot(*(mass[a:b, [0, 2]] - center).T).mean()
    feet = np.hypot(*(labels.footstep_position[6:10, [0, 2]] - center).T).mean()
    speed = np.hypot(*np.diff(mass[a:b, [0, 2]], axis=0).T).mean() * 120
    lean = np.arctan((feet - out) / mass[a:b, 1].mean())
    assert lean == pytest.approx(np.arctan(speed**2 / (GRAVITY * out)), rel=0.1)


def strides_of(motion, right):
    """Local rotations of the joints but the root at 32 phases of every inner left stride."""
    labels, out = motion.labels, []
    left = [i for i in range(2, len(labels.footstep_side) - 2) if labels.footstep_side[i] == 0]
    for i in left[1:-1]:
        share = np.interp(np.arange(32) / 32, [0.0, right, 1.0], labels.footstep_time[i : i + 3])
        frames = np.clip(np.round(share * motion.fps).astype(int), 0, len(motion) - 1)
        out.append(motion.rotations[frames][:, 1:])
    return out


@pytest.mark.slow
def test_styles_survive_curves():
    """A stride on a tight circle or an S is nearest to the straight stride of its own style."""
    hits = recognized()
    assert len(hits) > 60
    assert np.mean(hits) >= 0.9


@pytest.mark.slow
def test_legs_alone_tell_the_style_on_curves():
    """Though they lean, turn and take shorter steps there."""
    assert np.mean(recognized(("UpperLeg", "LowerLeg", "Foot", "Toes"))) >= 0.9


def recognized(joints=("",)):
    """Whether each stride on curves is nearest to its own style's straight one in ``joints``."""
    centers, strides = in_strides()
    names = skeleton_of(person(1.75)).names[1:]
    kept = [i for i, name in enumerate(names) if name.endswith(joints)]
    hits = []
    for name, stride in strides:
        away = (apart(centers[:, :, kept], stride[:, kept]) ** 2).sum((1, 2))
        hits.append(STYLES[int(away.argmin())] == name)
    return hits


@cache
def in_strides():
    """The straight stride of each style, and every stride on curves with its style."""
    body = person(1.75)
    straight = [
        strides_of(walk(distance=9.0, gait=name, body=body, fps=120), 0.5)[1] for name in STYLES
    ]
    curved = [
        (name, stride)
        for name in STYLES
        for way in WAYS
        for stride in strides_of(walked(name, way, "1.75 m"), 0.5)
    ]
    return np.stack(straight), curved


def test_built_in_gaits_are_a_table():
    assert list(GAITS)[:2] == ["neutral", "winter"]
    assert len(GAITS) == len(list(GAITS)) == 2 + len(RULES)
    assert "sad" in GAITS
    assert "sadd" not in GAITS
    with pytest.raises(UnknownNameError, match=r"unknown gait 'tird'.*Did you mean 'tired'"):
        walk(distance=1.0, gait="tird")
