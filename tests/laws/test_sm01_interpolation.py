"""[SM01] section 5: which mix takes a step; the paper's cache and what it does to the answers."""

from __future__ import annotations

import numpy as np
import pytest

from gaitsmith.body.presets import body_from
from gaitsmith.errors import InvalidInputError
from gaitsmith.gait.neutral import subject
from gaitsmith.walks import paper_interp
from gaitsmith.walks.elevation import SAMPLES
from gaitsmith.walks.elevation_sets import built_in_sets
from gaitsmith.walks.interpolate import LEAST_WEIGHT, ElevInterp
from gaitsmith.walks.paper_interp import PaperInterp
from gaitsmith.walks.step_of import PlanarFigure, step_of

SETS = built_in_sets()
MAN = ElevInterp(SETS, subject())
BODIES = {"adult": body_from(1.75), "small": body_from(1.2), "large": body_from(2.1)}


def degrees_apart(one, other):
    """Largest difference of foot, shank and thigh over the stride."""
    angles = np.stack([s.angles[:, :3] for s in MAN.sets])
    return np.degrees(np.abs(np.tensordot(one - other, angles, axes=1)).max())


def inside(count, seed=0, steps=MAN.steps):
    return np.random.default_rng(seed).dirichlet(np.ones(len(steps)), count) @ steps


def wandering(count):
    """Steps asked for frame by frame, as a walk over hills asks."""
    turn = np.linspace(0.0, 6.0 * np.pi, count)
    return np.stack(
        [0.67 + 0.08 * np.cos(turn) * np.cos(0.1 * turn), 0.06 * np.sin(1.3 * turn)], axis=-1
    )


@pytest.mark.parametrize("who", BODIES)
def test_a_step_inside_is_taken_exactly_by_any_body(who):
    """Acceptance 7.4 and 7.9: f(w) = (SL, SH), the same sets for every figure."""
    plan = ElevInterp(SETS, BODIES[who])
    wanted = inside(500, steps=plan.steps)
    found = plan.find(wanted)
    assert not found.outside.any()
    assert np.abs(found.achieved - wanted).max() < 1e-12
    np.testing.assert_allclose(found.weights.sum(axis=1), 1.0, atol=1e-12)
    # the mixed set, measured by itself
    for weights, step in zip(found.weights[:5], wanted[:5], strict=True):
        dataset = plan.dataset(weights)
        ends = dataset.angles[SAMPLES // 2], dataset.angles[0]
        taken = step_of(PlanarFigure.of(BODIES[who]), *ends, dataset.slope)
        assert taken == pytest.approx(step, abs=1e-12)


def test_larger_bodies_step_longer_with_the_same_set():
    lengths = [ElevInterp(SETS, body).steps[0, 0] for body in BODIES.values()]
    leg = [body.leg_length for body in BODIES.values()]
    assert np.ptp(np.array(lengths) / leg) < 0.06


def test_each_set_is_its_own_answer():
    found = MAN.find(MAN.steps)
    np.testing.assert_allclose(found.weights, np.eye(5), atol=1e-9)


def test_slopes_of_the_step_are_those_of_differences():
    weights = np.array([0.3, 0.2, 0.1, 0.3, 0.1])
    numeric = np.stack(
        [(MAN.step(weights + d) - MAN.step(weights - d)) / 2e-6 for d in 1e-6 * np.eye(5)], axis=-1
    )
    np.testing.assert_allclose(MAN.slopes(weights), numeric, atol=1e-8)


def test_a_step_beyond_is_pulled_back_and_said_to_be_outside():
    """Never refused: the nearest on the way, no weight below -0.25."""
    wanted = np.random.default_rng(4).uniform([0.0, -1.0], [2.0, 1.0], (400, 2))
    wanted = np.concatenate([wanted, [[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]]])
    found = MAN.find(wanted)
    assert np.isfinite(found.weights).all()
    assert found.weights.min() >= LEAST_WEIGHT - 1e-9
    np.testing.assert_allclose(found.weights.sum(axis=1), 1.0, atol=1e-9)
    reached = np.abs(found.achieved - wanted).max(axis=1) < 1e-9
    assert (reached | found.outside).all()
    assert found.outside.mean() > 0.8
    np.testing.assert_allclose(found.weights[~reached].min(axis=1), LEAST_WEIGHT, atol=1e-6)


def test_a_step_just_beyond_is_taken_by_sets_continued():
    found = MAN.find(np.array([[0.93, 0.0], [0.66, 0.14], [1.4, 0.0]]))
    assert found.outside.all()
    np.testing.assert_allclose(found.achieved[:2], [[0.93, 0.0], [0.66, 0.14]], atol=1e-9)
    assert found.weights[:2].min() < -0.01
    assert found.achieved[2, 0] < 1.1


def test_the_answer_does_not_depend_on_what_was_asked_before_or_beside():
    """Acceptance 7.7, to the bit for the same question, to 1e-9 in other company."""
    wanted = inside(50, seed=3)
    first = MAN.find(wanted)
    MAN.find(wandering(100))
    again = MAN.find(wanted)
    assert np.array_equal(first.weights, again.weights)
    alone = np.concatenate([MAN.find(step[None]).weights for step in wanted])
    assert np.abs(alone - first.weights).max() < 1e-9
    shuffled = MAN.find(wanted[::-1]).weights[::-1]
    assert np.abs(shuffled - first.weights).max() < 1e-9


def test_a_small_change_of_the_step_is_a_small_change_of_the_angles():
    """Across the borders between triangles too: 0.02 deg for 0.09 mm."""
    for length in np.linspace(0.6, 0.75, 7):
        heights = np.arange(-0.06, 0.06, 9e-5)
        weights = MAN.find(np.stack([np.full_like(heights, length), heights], axis=-1)).weights
        angles = np.stack([s.angles[::4, :3] for s in MAN.sets])
        change = np.abs(np.tensordot(np.diff(weights, axis=0), angles, axes=1)).max()
        assert np.degrees(change) < 0.03


def test_too_few_sets():
    with pytest.raises(InvalidInputError, match=r"not all in line are needed, got normal, short"):
        ElevInterp(SETS[:2], subject())
    with pytest.raises(InvalidInputError, match="not all in line"):
        ElevInterp(SETS[:3], subject())


class TestPaper:
    """The cache of the printed algorithm."""

    def test_it_takes_the_step_too(self):
        plan = PaperInterp(SETS, subject())
        wanted = inside(60, seed=1)
        found = plan.find(wanted)
        kept = ~found.outside
        assert kept.mean() > 0.9
        assert np.abs(found.achieved - wanted)[kept].max() < 1e-9

    def test_true_the_search_stays_small(self):
        """Printed: "the effort to find the containing triangle [...] remains small"."""
        plan = PaperInterp(SETS, subject(), capped=False)
        plan.find(wandering(300))
        assert plan.cost.rounds / plan.cost.asked < 2.5
        assert plan.cost.walked / plan.cost.asked < 4.0

    def test_the_cache_grows_with_every_frame_unless_it_is_capped(self):
        wanted = wandering(300)
        free, capped = (PaperInterp(SETS, subject(), capped=c) for c in (False, True))
        free.find(wanted)
        capped.find(wanted)
        assert len(free.vertices) > 290
        assert len(capped.vertices) < 100

    def test_false_the_answer_depends_on_what_was_asked_before(self):
        """Degrees between a fresh and a used cache for one and the same step."""
        wanted = np.random.default_rng(0).uniform([0.58, -0.08], [0.74, 0.08], (100, 2))
        used = PaperInterp(SETS, subject()).find(wanted).weights
        apart = [
            degrees_apart(PaperInterp(SETS, subject()).find(step[None]).weights[0], row)
            for step, row in zip(wanted, used, strict=True)
        ]
        assert max(apart) > 2.0
        assert max(apart) < 8.0

    def test_false_the_answer_jumps_across_the_borders_of_triangles(self, monkeypatch):
        """Ten times what the product changes over the same 0.09 mm."""
        plan = PaperInterp(SETS, subject())
        monkeypatch.setattr(paper_interp, "NEAREST", 9.0)  # ask without adding vertices
        worst = {"paper": 0.0, "product": 0.0}
        for a, b in ((0, 1), (0, 2), (0, 3), (0, 4)):
            one, other = plan.vertices[a], plan.vertices[b]
            way = other - one
            across = 4.5e-5 * np.array([-way[1], way[0]]) / np.hypot(*way)
            for share in (0.3, 0.5, 0.7):
                pair = np.stack([one + share * way - across, one + share * way + across])
                for name, found in (("paper", plan.find(pair)), ("product", MAN.find(pair))):
                    worst[name] = max(worst[name], degrees_apart(*found.weights))
        assert worst["paper"] > 0.1
        assert worst["product"] < 0.03
