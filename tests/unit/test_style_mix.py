"""Mixing: exact where it must be, linear where it says so, and never a walk that is none."""

from __future__ import annotations

import numpy as np
import pytest
from styles import apart, kink, library, synthetic

from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.gait.cycle import Cycle
from gaitsmith.gait.neutral import subject
from gaitsmith.geometry.rotations import exp, multiply
from gaitsmith.motion.kinematics import forward_kinematics
from gaitsmith.style.components import decompose
from gaitsmith.style.examples import examples_of
from gaitsmith.style.mix import mixed
from gaitsmith.style.parts import PARTS
from gaitsmith.style.restyle import restyled
from gaitsmith.style.retarget import stride_by_feet
from gaitsmith.style.rules import RULES
from gaitsmith.style.weights import Mix, PartMix

ENGINES = [("dense", "cubic"), ("keys", "cubic"), ("keys", "slerp")]


@pytest.fixture(scope="module")
def found():
    return decompose(library())


@pytest.mark.parametrize(("engine", "base"), ENGINES)
@pytest.mark.parametrize("j", [0, 3, 9])
def test_weight_1_is_the_example(found, engine, base, j):
    """A4, A8: pose, stride, time, feet."""
    cycle = library().cycles[j]
    out = mixed(library(), Mix({f"s{j}": 1.0}, engine=engine, base=base), found).cycle
    assert apart(out.rotations, cycle.rotations).max() < 1e-9
    np.testing.assert_allclose(out.center, cycle.center, atol=1e-9)
    np.testing.assert_allclose(out.events, cycle.events, atol=1e-12)
    assert out.stride_length == pytest.approx(cycle.stride_length, abs=1e-12)
    assert out.duration == pytest.approx(cycle.duration, abs=1e-12)


def test_a_mix_closes_and_is_smooth():
    examples = library()
    for a, b in ((0, 1), (3, 7), (8, 9)):
        out = mixed(examples, Mix({f"s{a}": 0.5, f"s{b}": 0.5})).cycle
        assert isinstance(out, Cycle)
        assert kink(out) <= 2.0 * max(kink(examples.cycles[k]) for k in (a, b))


def test_contacts_and_times_are_means_by_weight():
    """A9."""
    examples, weights = library(), {"s1": 0.9, "s2": 0.3, "s5": 0.6}
    out = mixed(examples, Mix(weights))
    shares = np.array([0.5, 1.0 / 6.0, 1.0 / 3.0])
    contacts = np.array([examples.timings[j].contacts for j in (1, 2, 5)])
    np.testing.assert_allclose(out.timing.contacts, np.tensordot(shares, contacts, 1), atol=1e-9)
    speeds = np.array([examples.cycles[j].speed for j in (1, 2, 5)])
    assert out.cycle.speed == pytest.approx(shares @ speeds, rel=1e-12)


@pytest.mark.parametrize("weight", [0.5, 1.5, -0.4])
def test_a_weight_scales_what_is_unlike_the_mean(weight):
    """A8: the logs about the mean of all, by exactly the weight."""
    examples = library()
    parts = {part: PartMix({"s4": weight}) for part in PARTS if "leg" not in part}
    out = mixed(examples, Mix({"s4": 1.0}, parts=parts)).cycle
    logs, own = examples.logs(out.rotations), examples.logs(examples.cycles[4].rotations)
    upper = [j for part in parts for j in examples.parts[part]]
    np.testing.assert_allclose(logs[:, upper], weight * own[:, upper], atol=1e-9)


def test_steps_grow_with_the_weight_and_speed_stays():
    """A8, the paper's figure 6."""
    walks = [mixed(library(), Mix({"s6": w})).cycle for w in (0.85, 1.0, 1.5)]
    lengths = [walk.stride_length for walk in walks]
    assert lengths == sorted(lengths)
    assert lengths[0] < 0.8 * lengths[2]
    assert [walk.duration for walk in walks] == sorted(walk.duration for walk in walks)
    assert walks[0].speed == pytest.approx(walks[2].speed, rel=1e-9)
    for walk in walks:
        assert stride_by_feet(walk) == pytest.approx(walk.stride_length, rel=0.05)


def test_steps_nobody_takes_are_slowed_and_that_is_said():
    out = mixed(library(), Mix({"s6": 0.3}))
    assert 2.0 / out.cycle.duration == pytest.approx(2.6)
    assert any("steps/s" in note for note in out.notes)
    assert any("weights of root sum to 0.30" in note for note in out.notes)


def test_speed_is_what_is_asked():
    out = mixed(library(), Mix({"s1": 0.5, "s2": 0.5}, speed=1.1)).cycle
    assert out.speed == pytest.approx(1.1, rel=1e-12)


def test_components_are_vacuous_with_equal_weights_and_not_with_others(found):
    """A5, A5b: ICA, PCA, any start and the plain mix agree, unless weights are by component."""
    rng = np.random.default_rng(7)
    names = [f"s{k}" for k in range(4)]
    table = {n: float(w) for n, w in zip(names, rng.normal(0.3, 0.3, 4), strict=True)}
    others = [decompose(library(), method="pca"), decompose(library(), seed=5)]

    def arms(components, vectors):
        many = {n: tuple(rng_free(n, len(components["left_arm"]))) for n in names}
        mix = Mix({"s0": 1.0}, parts={"left_arm": PartMix(many if vectors else table)})
        return mixed(library(), mix, components).cycle

    def rng_free(name, count):
        return np.random.default_rng(names.index(name)).normal(size=count)

    plain = mixed(library(), Mix({"s0": 1.0}, parts={"left_arm": PartMix(table)})).cycle
    for components in (found, *others):
        assert apart(arms(components, False).rotations, plain.rotations).max() < 1e-9
    by_component = {n: tuple([table[n]] * len(found["left_arm"])) for n in names}
    same = Mix({"s0": 1.0}, parts={"left_arm": PartMix(by_component)})
    assert apart(mixed(library(), same, found).cycle.rotations, plain.rotations).max() < 1e-9
    differ = apart(arms(found, True).rotations, arms(others[0], True).rotations)
    assert differ.max() > 0.1


def test_order_and_sign_of_components_change_nothing(found):
    """A6."""
    one = found["right_arm"]
    order = np.arange(len(one))[::-1]
    other = found | {"right_arm": one.permuted(order, order % 2 == 0)}
    weights = np.linspace(-0.5, 1.5, len(one))
    a, b = (
        mixed(library(), Mix({"s1": 1.0}, parts={"right_arm": PartMix({"s2": tuple(w)})}), c).cycle
        for w, c in ((weights, found), (weights[order], other))
    )
    assert apart(a.rotations, b.rotations).max() < 1e-12


def test_keys_and_dense_agree_but_for_details(found):
    table = {"s2": 0.5, "s3": 0.5}
    a = mixed(library(), Mix(table)).cycle
    b = mixed(library(), Mix(table, engine="keys"), found).cycle
    assert np.degrees(apart(a.rotations, b.rotations).max()) < 7.0
    # the same weights for the details, given: nothing changes
    c = mixed(library(), Mix(table, offsets=table)).cycle
    assert apart(a.rotations, c.rotations).max() < 1e-9


@pytest.mark.parametrize(("engine", "base"), ENGINES)
def test_offsets_vanish_at_the_keys_and_scale(found, engine, base):
    """Key frames are the same whatever the details; without them it is smoother (cubic)."""
    examples = library()

    def arms(scale):
        parts = {"arms": PartMix({"s5": 1.0}, offset_scale=scale)}
        mix = Mix({"s5": 1.0}, parts=parts, engine=engine, base=base)
        return mixed(examples, mix, found).cycle

    with_, without = arms(1.0), arms(0.0)
    joints = [*examples.parts["left_arm"], *examples.parts["right_arm"]]
    at = examples.key_phases(5)
    a, b = with_.at(at)[1][:, joints], without.at(at)[1][:, joints]
    assert np.degrees(apart(a, b).max()) < 0.5  # keys lie between samples
    assert apart(with_.rotations[:, joints], without.rotations[:, joints]).max() > 0.002


def test_an_upper_body_is_swapped_without_touching_the_feet():
    """A12."""
    parts = {"arms": PartMix({"s3": 1.0}), "torso_head": PartMix({"s7": 1.3})}
    base = mixed(library(), Mix({"s1": 1.0})).cycle
    out = mixed(library(), Mix({"s1": 1.0}, parts=parts)).cycle
    legs = [0, *library().parts["left_leg"], *library().parts["right_leg"]]
    np.testing.assert_array_equal(out.rotations[:, legs], base.rotations[:, legs])
    np.testing.assert_allclose(out.center, base.center, atol=1e-12)
    assert out.stride_length == pytest.approx(base.stride_length, abs=1e-12)


def musical(seed):
    """Arms that repeat every two strides."""
    cycle = synthetic(seed)
    turned = np.concatenate([cycle.rotations, cycle.rotations])
    j, phase = cycle.skeleton.index("leftUpperArm"), np.arange(len(turned)) / len(cycle.center)
    swing = 0.3 * np.sin(np.pi * phase)[:, None] * np.array([1.0, 0.0, 0.0])
    turned[:, j] = multiply(turned[:, j], exp(swing))
    return cycle.with_(center=np.tile(cycle.center, (2, 1)), rotations=turned, strides=2)


def test_two_strides_where_an_example_that_has_them_has_a_say():
    examples = examples_of({"even": synthetic(1), "odd": musical(2)}, subject())
    assert examples.keys.shape[1] == 16
    both = mixed(examples, Mix({"even": 1.0}, parts={"arms": PartMix({"odd": 1.0})})).cycle
    assert both.strides == 2
    assert mixed(examples, Mix({"even": 1.0})).cycle.strides == 1
    alone = mixed(examples, Mix({"odd": 1.0})).cycle
    assert apart(alone.rotations, examples.cycles[1].rotations).max() < 1e-9
    components = decompose(examples)
    keyed = mixed(examples, Mix({"odd": 1.0}, engine="keys"), components).cycle
    assert apart(keyed.rotations, examples.cycles[1].rotations).max() < 1e-9


def test_symmetric_on_request():
    out = mixed(library(), Mix({"s1": 0.5, "s4": 0.5}, symmetric=True)).cycle
    assert out.events[1, 0] == pytest.approx(0.5)
    left, right = (out.rotations[:, out.skeleton.index(f"{s}UpperArm")] for s in ("left", "right"))
    mirrored = np.roll(right, 64, axis=0) * [1.0, -1.0, -1.0, 1.0]
    assert apart(left, mirrored).max() < 1e-6


@pytest.mark.parametrize(
    ("mix", "match"),
    [
        ({"root": {}}, "no weights"),
        ({"root": {"s0": 1.0, "s1": -1.0}}, "more than 0, they sum to 0"),
        ({"root": {"s0": float("nan")}}, "finite number"),
        ({"root": {"s0": 1.0}, "engine": "sparse"}, "engine must be one of dense, keys"),
        ({"root": {"s0": 1.0}, "parts": {"tail": PartMix({})}}, "'tail' is no part"),
        (
            {"root": {"s0": 1.0}, "parts": {"arms": PartMix({}), "left_arm": PartMix({})}},
            "arms or left_arm",
        ),
        ({"root": {"s0": 1.0}, "speed": -1.0}, "speed must be a positive number"),
    ],
)
def test_wrong_weights_are_refused(mix, match):
    with pytest.raises(InvalidInputError, match=match):
        Mix(**mix)


def test_all_that_is_wrong_is_said_at_once():
    with pytest.raises(InvalidInputError) as error:
        Mix({"a": "x"}, speed=0.0, engine="none", parts={"tail": PartMix({"b": float("inf")})})
    for word in ("'a' in root", "speed", "engine", "'tail' is no part", "'b' in tail"):
        assert word in str(error.value)


def test_unknown_examples_and_missing_components_are_said():
    with pytest.raises(InvalidInputError, match="unknown example 's99'"):
        mixed(library(), Mix({"s99": 1.0}))
    parts = {"arms": PartMix({"s1": (1.0, 2.0)})}
    with pytest.raises(InvalidInputError, match="nothing was decomposed"):
        mixed(library(), Mix({"s0": 1.0}, parts=parts))


def test_a_mix_whose_feet_do_not_walk_is_refused():
    with pytest.raises(InfeasibleError, match="ahead in a stride"):
        mixed(library(), Mix({"s0": 1.0}, parts={"legs": PartMix({"s0": -0.5})}))
    with pytest.raises(InfeasibleError, match="in order"):
        mixed(library(), Mix({"s0": 30.0, "s3": -29.0}))


def arm_in_space(cycle, side="left"):
    """Mean direction of the upper arm: forward and to its side, over down."""
    places, _ = forward_kinematics(cycle.skeleton, cycle.center, cycle.rotations)
    index = cycle.skeleton.index
    bone = (places[:, index(f"{side}LowerArm")] - places[:, index(f"{side}UpperArm")]).mean(axis=0)
    return bone[2] / -bone[1], bone[0] / -bone[1]


@pytest.mark.parametrize("trunk", ["sad", "sneaky"])
def test_arms_hang_as_they_did_on_another_trunk(trunk):
    """Arms of who leans back do not trail behind who leans forward, nor stand off to the side."""
    rules = {name: restyled(RULES[name]) for name in ("proud", trunk)}
    examples = examples_of(rules, subject())
    mix = Mix({trunk: 1.0}, parts={"arms": PartMix({"proud": 1.0})})
    own = examples.cycles[examples.index("proud")]
    out = mixed(examples, mix).cycle
    for side in ("left", "right"):
        np.testing.assert_allclose(arm_in_space(out, side), arm_in_space(own, side), atol=0.06)
