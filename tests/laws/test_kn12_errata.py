"""What [KN12] prints or claims and what is true instead; see ``docs/papers/errata.md``."""

from __future__ import annotations

import numpy as np
import pytest
from styles import apart, library, rule_library, synthetic

from gaitsmith.gait.neutral import subject
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.style.align import timing_of
from gaitsmith.style.components import decompose
from gaitsmith.style.examples import examples_of
from gaitsmith.style.mix import mixed, mixed_timing
from gaitsmith.style.weights import Mix, PartMix


@pytest.fixture(scope="module")
def found():
    return decompose(rule_library())


def test_d25_without_unwhitening_key_frames_are_wrong(found):
    """Eq. 4 as printed: the inverse of W alone."""
    examples, one = rule_library(), found["left_arm"]
    keys = examples.keys[0]
    size = np.linalg.norm(one.mix, axis=0)
    # W is a rotation, so that its inverse gives rows of unit size where A has those of the data
    printed = one.mean + one.of(keys) @ (one.mix / size).T
    ours = one.logs(one.of(keys)).reshape(len(keys), -1)
    own = keys[:, one.joints].reshape(len(keys), -1)
    assert np.degrees(np.abs(ours - own).max()) < 1e-9
    assert np.degrees(np.abs(printed - own).max()) > 20.0


def test_d26_a_linear_blend_jumps_in_speed():
    """Speed at the ends of a blend over a gap: the gap over its time, not 0."""
    u = np.array([0.0, 1e-6])
    assert np.diff(u)[0] / 1e-6 == pytest.approx(1.0)
    assert np.diff(smoothstep(u))[0] / 1e-6 < 1e-5


def test_d27_phases_are_averaged_unwrapped():
    """One walk's right foot leaves just after the stride's end, another's just before."""
    late = synthetic(0)
    early = late.with_(events=[[0.0, 0.158, 0.485, 0.66], [0.5, 0.658, 0.98, 0.16]])
    late = late.with_(events=[[0.0, 0.158, 0.485, 0.66], [0.5, 0.658, 0.02, 0.16]])
    examples = examples_of({"a": early, "b": late}, subject())
    out = mixed_timing(examples, Mix({"a": 0.5, "b": 0.5}))
    assert out.events[1, 2] in (pytest.approx(0.0, abs=1e-9), pytest.approx(1.0, abs=1e-9))
    printed = 0.5 * (early.events[1, 2] + late.events[1, 2])
    assert printed == pytest.approx(0.5)  # that foot has just landed then
    assert timing_of(early).ordered
    assert timing_of(late).ordered


def test_d32_the_same_weights_are_another_walk_in_another_set():
    """Where they do not sum to 1."""
    parts = {"arms": PartMix({"s1": 0.5})}
    walks = [
        mixed(library(count), Mix({"s1": 1.0}, parts=parts)).cycle.rotations for count in (3, 10)
    ]
    assert np.degrees(apart(*walks).max()) > 1.0
    whole = [mixed(library(count), Mix({"s1": 1.0})).cycle.rotations for count in (3, 10)]
    assert apart(*whole).max() < 1e-9


def test_kn12_a_joint_has_three_rows():
    """Random two-axis joints fill three dimensions: the rank of V says nothing of style."""
    from gaitsmith.geometry.rotations import about, log, multiply

    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(2, 200)) * 0.4
    two = log(multiply(about("x", a), about("y", b)))
    hinge = log(about("x", a))
    assert np.linalg.matrix_rank(two - two.mean(0), tol=1e-6) == 3
    assert np.linalg.matrix_rank(hinge - hinge.mean(0), tol=1e-6) == 1


def test_kn12_offsets_are_no_details(found):
    """What eight key frames miss of the examples, with cubics between them."""
    examples = rule_library()
    parts = ("torso_head", "left_arm", "right_arm", "left_leg", "right_leg")
    away = []
    for name in examples.names:
        own = {part: PartMix({name: 1.0}, offset_scale=0.0) for part in parts}
        out = mixed(examples, Mix({name: 1.0}, parts=own, engine="keys"), found).cycle
        away.append(apart(out.rotations, examples.cycles[examples.index(name)].rotations))
    assert np.degrees(np.max(away)) > 10.0
