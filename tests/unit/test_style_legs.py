"""Ranks and planes of components, and leg weights that leave the feet where they were."""

from __future__ import annotations

import numpy as np
import pytest
from styles import apart, kink, rule_library, slide

from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import exp, inverse, log, multiply
from gaitsmith.style.components import decompose
from gaitsmith.style.composition import composition
from gaitsmith.style.legs import _Feet, leg_weights, right_jacobian
from gaitsmith.style.mix import mixed
from gaitsmith.style.parts import PARTS
from gaitsmith.style.ranks import PLANES, displacements, planes, ranked
from gaitsmith.style.weights import Mix, PartMix

#: Roots and legs that do not belong together, in stride, crouch and feet.
PAIRS = [("sad", "angry"), ("angry", "sad"), ("elderly", "happy"), ("fearful", "hurried")]


@pytest.fixture(scope="module")
def found():
    return decompose(rule_library())


@pytest.fixture(scope="module")
def moves(found):
    return displacements(rule_library(), found)


def exchange(root, legs, how="given"):
    return Mix({root: 1.0}, parts={"legs": PartMix({legs: 1.0})}, legs=how)


def test_a_component_left_out_that_is_0_moves_nothing(found):
    """[KN12] Eq. 5 (A10)."""
    examples = rule_library()
    one = found["left_arm"]
    none = one.mix * (np.arange(len(one)) != 2)
    without = type(one)(one.joints, one.mean, one.unmix, none, one.keys, one.converged)
    moved = displacements(examples, {"left_arm": without})["left_arm"]
    assert (moved[:, 2] == 0.0).all()
    assert (np.delete(moved, 2, axis=1) > 0.0).all()


def test_ranks_do_not_hang_on_signs_or_order(found, moves):
    for part in PARTS:
        one = found[part]
        order = np.arange(len(one))[::-1]
        other = one.permuted(order, np.ones(len(one), dtype=bool))
        again = displacements(rule_library(), {part: other})[part]
        np.testing.assert_allclose(again, moves[part][:, order], atol=1e-12)
        best = ranked(moves[part])
        assert (np.diff(moves[part].sum(0)[best]) <= 0.0).all()


def test_ranks_are_of_the_examples_that_count(moves):
    orders = {tuple(ranked(moves["left_leg"], [j]).tolist()) for j in range(10)}
    assert len(orders) > 5


def test_every_component_has_a_plane(found):
    """[KN12] Table 2: legs and arms of walkers mostly swing ahead and back."""
    where = planes(rule_library(), found)
    for part in PARTS:
        assert len(where[part]) == len(found[part])
        assert set(where[part]) <= set(PLANES)
    assert where["left_leg"].count("sagittal") >= 3


def test_the_right_jacobian_is_that_of_the_exponential_map():
    rng = np.random.default_rng(0)
    for size in (1e-6, 1e-3, 0.5, 2.5):
        v = rng.normal(size=3)
        v *= size / np.linalg.norm(v)
        d = rng.normal(size=3) * 1e-6
        moved = log(multiply(inverse(exp(v)), exp(v + d)))
        np.testing.assert_allclose(moved, right_jacobian(v) @ d, atol=1e-11)


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("at_keys", [True, False])
def test_the_jacobian_of_the_feet_is_exact(found, side, at_keys):
    examples = rule_library()
    part = ("left_leg", "right_leg")[side]
    rng = np.random.default_rng(side)
    root = np.zeros(10)
    root[[1, 3]] = 0.7, 0.3
    start = 0.3 * rng.normal(size=(10, len(found[part])))
    mix = Mix({examples.names[1]: 0.7, examples.names[3]: 0.3})
    feet = _Feet(examples, mix, found[part], root, start, side, np.arange(10), 0.0, at_keys=at_keys)
    jacobian = feet.jacobian(start)
    change = 1e-6 * rng.normal(size=start.shape)
    seen = feet.residual(start + change) - feet.residual(start - change)
    np.testing.assert_allclose(2.0 * np.tensordot(jacobian, change, 2), seen, atol=1e-9, rtol=1e-6)


@pytest.mark.parametrize(("root", "legs"), PAIRS)
def test_found_weights_keep_feet_and_swing(found, root, legs):
    """A10: all weights free."""
    examples = rule_library()
    base = mixed(examples, Mix({root: 1.0})).cycle
    asked = mixed(examples, exchange(root, legs)).cycle
    best = leg_weights(examples, exchange(root, legs), found)
    out = mixed(examples, exchange(root, legs), found, legs=best.weights).cycle
    for before, after in zip(best.before, best.after, strict=True):
        assert after <= before
        assert after <= 0.012
    assert slide(out, until="heel_off") <= 0.08
    assert max(np.abs(w).max() for w in best.weights.values()) < 2.0
    assert kink(out) <= 4.0 * max(kink(examples.cycles[examples.index(n)]) for n in (root, legs))
    # what was asked of the swing is still there
    joints = list(examples.parts["left_leg"])
    logs = [examples.logs(c.rotations)[:, joints] for c in (out, base, asked)]
    swing = np.arange(128) / 128 > out.events[0, 3]
    got, want = ((one - logs[1])[swing] for one in (logs[0], logs[2]))
    assert (got * want).sum() / (want**2).sum() >= 0.45


def test_with_the_active_weights_alone_the_base_comes_back(found):
    """A10: the plain minimum of Eq. 6, whatever was asked."""
    examples, mix = rule_library(), exchange("sad", "angry")
    best = leg_weights(examples, mix, found, free="active", at="keys", damping=0.0)
    assert max(best.after) ** 2 < 1e-10  # square meters: 1e-6 square centimeters
    out = mixed(examples, mix, found, legs=best.weights).cycle
    base = mixed(examples, Mix({"sad": 1.0})).cycle
    stands = np.arange(128) / 128 <= out.events[0, 3]
    leg = list(examples.parts["left_leg"])
    away = apart(out.rotations, base.rotations)[stands][:, leg]
    assert np.degrees(away.max()) < 0.01


def test_a_strong_pull_leaves_the_asked_weights(found):
    """A10: what is left of the change falls with the pull, to nothing."""
    mix = exchange("sad", "angry")
    asked = np.zeros(10)
    asked[rule_library().index("angry")] = 1.0

    def away(damping):
        best = leg_weights(rule_library(), mix, found, at="keys", damping=damping)
        one = found["left_leg"]
        change = best.weights["left_leg"] - asked[:, None]
        logs = np.einsum("jk,jkn->nk", change, one.keys) @ one.mix.T
        return np.degrees(np.linalg.norm(logs.reshape(len(logs), -1, 3), axis=-1).max())

    def usual(root, legs):
        """Root mean square of what a pull of 1e6 square centimeters leaves, degrees."""
        best = leg_weights(rule_library(), exchange(root, legs), found, at="keys", damping=1e2)
        out = []
        for part in ("left_leg", "right_leg"):
            asked = np.array([[float(n == legs)] for n in rule_library().names])
            one = found[part]
            logs = np.einsum("jk,jkn->nk", best.weights[part] - asked, one.keys) @ one.mix.T
            out.append((logs.reshape(len(logs), -1, 3) ** 2).sum(-1).mean())
        return np.degrees(np.sqrt(np.mean(out)))

    assert max(usual(*pair) for pair in PAIRS) <= 0.2
    strong, stronger = away(1e2), away(1e3)
    assert strong < 1.0
    assert stronger == pytest.approx(0.1 * strong, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["greedy", "joint"])
def test_the_papers_search_gets_nearer(found, method):
    mix = exchange("elderly", "happy")
    best = leg_weights(rule_library(), mix, found, method=method, at="keys", damping=0.0)
    for before, after in zip(best.before, best.after, strict=True):
        assert after < 0.5 * before


def test_a_composition_finds_its_legs(found):
    out = composition(rule_library(), exchange("sad", "angry", "optimized"))
    assert any("leg weights found" in note for note in out.notes)
    again = composition(rule_library(), exchange("sad", "angry", "optimized"), found)
    assert out.cycle.rotations.tobytes() == again.cycle.rotations.tobytes()
    plain = composition(rule_library(), exchange("sad", "sad", "optimized"), found)
    base = mixed(rule_library(), Mix({"sad": 1.0})).cycle
    assert apart(plain.cycle.rotations, base.rotations).max() < 1e-6


@pytest.mark.parametrize(
    ("asked", "match"),
    [({"method": "random"}, "method must be"), ({"damping": -1.0}, "damping"), ({"at": "x"}, "at")],
)
def test_what_makes_no_sense_is_refused(found, asked, match):
    with pytest.raises(InvalidInputError, match=match):
        leg_weights(rule_library(), exchange("sad", "angry"), found, **asked)
