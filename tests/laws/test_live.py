"""Live control: what a person who is steered keeps, however it is steered."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass

import numpy as np
import pytest
from judge import broken, judge

import gaitsmith
from gaitsmith import Controls, LiveWalker
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.ground import Flat, HeightField, Slope, Stairs
from gaitsmith.measures.promises import promises

#: Acceptance 7.8: 1.5 times the 12 deg per 1/60 s of steady walking.
JOINTS = 18.0
#: The root's acceleration over that of the frames around it, as the referee asks.
ROOT_STEP = 4.0


@dataclass(frozen=True)
class Said:
    """One command, and for how long it holds."""

    seconds: float
    controls: Controls


def whims(seed, *, seconds=12.0, leg=0.9):
    """Random commands at random instants: many within one step, then none for a while."""
    rng, told, out = np.random.default_rng(seed), 0.0, []
    fastest = math.sqrt(0.38 * 9.81 * leg)
    while told < seconds:
        span = float(rng.uniform(*[(0.005, 0.1), (0.1, 0.6), (0.5, 3.0)][rng.integers(3)]))
        said = {}
        if rng.random() < 0.8:
            said["heading"] = float(rng.uniform(-np.pi, np.pi))
        pace = rng.integers(4)
        if pace == 0:
            said["speed"] = float(rng.uniform(0.35, 1.0) * fastest)
        elif pace == 1:
            said["step_length"] = float(rng.uniform(0.35, 0.95) * leg)
        elif pace == 2:
            said["cadence"] = float(rng.uniform(70.0, 130.0))
        said["stop"] = bool(rng.random() < 0.12)
        out.append(Said(span, Controls(**said)))
        told += span
    return [*out, Said(3.5, Controls(stop=True))]


def steered(schedule, **asked):
    walker = LiveWalker(**asked)
    for said in schedule:
        walker.advance(said.seconds, said.controls)
    return walker


def root_step(motion):
    """Acceleration of the root over the median of 13 frames around it, as the referee has it."""
    second = np.linalg.norm(np.diff(motion.root_position, 2, axis=0), axis=-1)
    around = np.lib.stride_tricks.sliding_window_view(np.pad(second, 6, mode="edge"), 13)
    return float((second / np.maximum(np.median(around, -1), 3.0 / motion.fps**2)).max())


def kept(motion, *, but=()):
    assert broken(motion, but=but) == {}
    assert judge(motion)["joint_deg_per_60th"] <= JOINTS
    assert root_step(motion) <= ROOT_STEP


def hills(seed):
    """Smooth hills: relief to 0.15 m, slopes to 12 deg."""
    rng, cell = np.random.default_rng(seed), 0.25
    x, z = np.meshgrid(np.arange(97) * cell, np.arange(97) * cell)
    height = np.zeros(x.shape)
    for _ in range(5):
        wave, way = rng.uniform(0.4, 1.5), rng.uniform(0.0, 2.0 * np.pi)
        phase = wave * (np.cos(way) * x + np.sin(way) * z) + rng.uniform(0.0, 6.0)
        height += np.sin(phase) / wave
    height *= 0.15 / np.ptp(height)
    steep = np.hypot(*np.gradient(height, cell)).max()
    height *= min(1.0, np.tan(np.radians(12.0)) / steep)
    return HeightField(height, cell, (-12.0, -12.0))


# ------------------------------------------------------------------------------------- promises


@pytest.mark.parametrize("seed", range(5))
def test_every_promise_is_kept_however_it_is_steered(seed):
    kept(steered(whims(seed)).motion())


@pytest.mark.slow
@pytest.mark.parametrize("walker", ["kinematic", "elevation"])
@pytest.mark.parametrize(("seed", "deg"), [(20, 8.0), (21, -11.0)])
def test_on_slopes_too(seed, deg, walker):
    kept(steered(whims(seed, seconds=5.0), ground=Slope(deg), walker=walker).motion())


@pytest.mark.slow
def test_on_hills_too():
    # a sole on curved ground may touch, by chance, with what is not flagged
    schedule = whims(30, seconds=5.0)
    kept(steered(schedule, ground=hills(30)).motion(), but=("unflagged_bearing",))


@pytest.mark.parametrize(("seed", "gait"), [(40, "winter"), (41, "sneaky"), (42, "proud")])
def test_in_any_gait_and_body(seed, gait):
    body = 1.3 + 0.3 * (seed - 40)
    schedule = whims(seed, seconds=5.0, leg=0.4 * body)
    kept(steered(schedule, gait=gait, body=body).motion())


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 140))
def test_every_promise_is_kept_in_many_walks(seed):
    rng = np.random.default_rng(seed)
    ground = ["flat", Slope(float(rng.uniform(-12.0, 12.0))), hills(seed)][seed % 3]
    body = float(rng.uniform(1.2, 2.1))
    gait = str(rng.choice(["neutral", "winter", "tired", "hurried"]))
    walker = steered(whims(seed, leg=0.5 * body), ground=ground, body=body, gait=gait)
    kept(walker.motion(), but=("unflagged_bearing",) if seed % 3 == 2 else ())


@pytest.mark.slow
@pytest.mark.parametrize("rise", [0.15, -0.15])
def test_a_flight_of_stairs_is_walked_by_heading_alone(rise):
    walker = steered(
        [Said(9.0, Controls(heading=0.1)), Said(3.0, Controls(stop=True))],
        ground=Stairs(rise, 0.30, 5),
    )
    kept(walker.motion(), but=("footsteps_unseen",))
    assert walker.motion().root_position[-1, 1] == pytest.approx(5 * rise + 0.9, abs=0.1)


def test_in_the_middle_of_a_step_its_motion_is_whole():
    """Saved, read again and measured as any other; the foot in the air is a footstep to come."""
    walker = steered([Said(2.3, Controls(heading=0.4)), Said(1.37, Controls(heading=-0.3))])
    motion = walker.motion()
    assert motion.labels.footstep_time[-1] > motion.duration
    assert not walker.standing
    assert promises(motion, Flat())


# --------------------------------------------------------------------------------- determinism


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3])
def test_how_often_it_is_called_changes_nothing(seed):
    """The same commands at the same times, advanced whole or in crumbs: 1e-9."""
    schedule, rng = whims(seed, seconds=4.0), np.random.default_rng(seed)
    whole, crumbs = LiveWalker(), LiveWalker()
    for said in schedule:
        whole.advance(said.seconds, said.controls)
        cuts = np.sort(rng.uniform(0.0, said.seconds, 1 + int(20 * said.seconds)))
        crumbs.advance(0.0, said.controls)
        for part in np.diff([0.0, *cuts, said.seconds]):
            crumbs.advance(float(part))
    a, b = whole.motion(), crumbs.motion()
    assert len(a) == len(b)
    assert np.abs(a.root_position - b.root_position).max() < 1e-9
    assert np.abs(a.rotations - b.rotations).max() < 1e-9
    assert np.array_equal(a.contacts, b.contacts)


def test_the_same_commands_give_the_same_bytes():
    """Acceptance 7.7."""
    a, b = (steered(whims(5, seconds=6.0)).motion() for _ in range(2))
    assert a.rotations.tobytes() == b.rotations.tobytes()
    assert a.root_position.tobytes() == b.root_position.tobytes()
    assert a.labels.recipe == b.labels.recipe


def test_what_was_shown_stays():
    walker, before = LiveWalker(), None
    for said in whims(7, seconds=6.0):
        pose = walker.advance(said.seconds, said.controls)
        motion = walker.motion()
        if before is not None:
            count = len(before)
            assert np.array_equal(motion.rotations[:count], before.rotations)
            assert np.array_equal(motion.root_position[:count], before.root_position)
        before = motion
        assert pose.time == walker.time


def test_the_pose_between_two_frames_is_between_them():
    walker = LiveWalker(fps=30)
    walker.advance(2.0)
    pose = walker.advance(0.5 / 30)
    walker.advance(0.5 / 30)
    motion = walker.motion()
    middle = 0.5 * (motion.root_position[60] + motion.root_position[61])
    assert pose.root_position == pytest.approx(middle, abs=2e-3)


# ------------------------------------------------------------------------------------ obedience


def test_it_goes_where_and_as_fast_as_it_is_told():
    walker = LiveWalker()
    walker.advance(4.0, Controls(heading=0.8, speed=1.0))
    a = walker.advance(0.0).root_position
    b = walker.advance(3.0).root_position
    way = (b - a)[[0, 2]]
    assert math.atan2(way[0], way[1]) == pytest.approx(0.8, abs=0.02)
    assert np.linalg.norm(way) / 3.0 == pytest.approx(1.0, rel=0.03)
    walker.advance(2.0, Controls(heading=0.8, step_length=0.5))
    walker.advance(1.0)
    steps = np.linalg.norm(np.diff(walker.motion().labels.footstep_position[-4:-1], axis=0), axis=1)
    assert steps == pytest.approx(math.hypot(0.5, 0.1), abs=0.01)


def test_it_stops_and_stands_still_and_goes_on():
    walker = LiveWalker()
    walker.advance(3.0, Controls(speed=1.3))
    walker.advance(2.2, Controls(stop=True))
    assert walker.standing
    a = walker.advance(0.0)
    b = walker.advance(1.0)
    assert np.array_equal(a.rotations, b.rotations)
    assert np.array_equal(a.root_position, b.root_position)
    walker.advance(2.0, Controls(heading=2.0))
    assert not walker.standing
    walker.advance(2.5, Controls(speed=0.0))
    assert walker.standing
    kept(walker.motion())


def test_it_stands_until_it_is_told_to_go():
    walker = LiveWalker()
    walker.advance(1.0, Controls(stop=True))
    assert walker.standing
    assert np.ptp(walker.motion().root_position, axis=0).max() == 0.0


@pytest.mark.slow
def test_a_foot_under_way_still_turns_and_later_does_not():
    """The commit horizon: two thirds of a step."""

    def landed(at):
        walker = LiveWalker()
        walker.advance(3.0, Controls(heading=0.0))
        times = walker.motion().labels.footstep_time
        last, following = times[times <= 3.0][-1], times[-1]
        # from a landing on, so that the share of the step is known
        walker = LiveWalker()
        walker.advance(last + at * (following - last), Controls(heading=0.0))
        walker.advance(1.0, Controls(heading=0.5))
        labels = walker.motion().labels
        return labels.footstep_heading[np.argmin(np.abs(labels.footstep_time - following))]

    straight = landed(0.95)
    assert abs(landed(0.75) - straight) < 1e-9
    assert abs(landed(0.1) - straight) > 0.2
    assert abs(landed(0.55) - straight) > 0.1


def test_it_follows_its_path_again_when_no_heading_is_wished():
    walker = LiveWalker(path=[(0, 0), (0, 12)])
    walker.advance(2.0)
    walker.advance(1.2, Controls(heading=0.5))
    off = abs(float(walker.advance(0.0).root_position[0]))
    walker.advance(4.0, Controls())
    assert off > 0.1
    assert abs(float(walker.advance(0.0).root_position[0])) < 0.05


@pytest.mark.slow
def test_before_what_cannot_be_walked_it_stops():
    """A wall in the way: it stands before it, and goes another way when told."""
    walker = LiveWalker(ground=Stairs(0.6, 0.5, 3))
    walker.advance(7.0, Controls(heading=0.0))
    assert walker.standing
    assert walker.advance(0.0).root_position[2] < 1.0
    walker.advance(3.0, Controls(heading=np.pi))
    assert not walker.standing


# -------------------------------------------------------------------------------------- the rest


def test_what_cannot_be_is_refused_and_nothing_changes():
    walker = LiveWalker()
    walker.advance(1.0)
    for bad in (-0.1, np.nan, 1e9):
        with pytest.raises(InvalidInputError, match="dt"):
            walker.advance(bad)
    with pytest.raises(InvalidInputError, match="heading"):
        Controls(heading=np.nan)
    with pytest.raises(InvalidInputError, match="speed"):
        Controls(speed=-1.0)
    with pytest.raises(InfeasibleError, match="Froude"):
        walker.advance(0.1, Controls(speed=9.0))
    with pytest.raises(InvalidInputError, match="fps"):
        LiveWalker(fps=1.0)
    with pytest.raises(InvalidInputError, match="start"):
        LiveWalker(start="walk")
    assert walker.controls == Controls()
    assert walker.time == 1.0


def test_its_recipe_says_what_was_told_and_when():
    walker = steered([Said(1.0, Controls(speed=1.2)), Said(1.0, Controls(heading=0.3))])
    told = json.loads(walker.motion().labels.recipe)["controls"]
    assert [time for time, _ in told] == [0.0, 1.0]
    assert told[0][1]["speed"] == 1.2
    assert told[1][1]["heading"] == 0.3


def test_it_is_saved_as_any_motion(tmp_path):
    walker = steered([Said(2.0, Controls(speed=1.2)), Said(2.5, Controls(stop=True))])
    for suffix in ("npz", "bvh"):
        gaitsmith.save(walker.motion(), tmp_path / f"live.{suffix}")
    again = gaitsmith.load(tmp_path / "live.npz")
    assert np.allclose(again.rotations, walker.motion().rotations, atol=1e-7)


def test_who_stands_where_no_step_can_be_taken_is_told_so():
    with pytest.raises(InfeasibleError, match=r"start \(0.00, 0.00\): no step can be taken"):
        LiveWalker(ground=Slope(45.0))
