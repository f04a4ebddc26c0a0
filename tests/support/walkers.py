"""Bodies, walks and yardsticks that several tests share."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import strategies as st

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.presets import KB92B_FIGURE, KB92B_SUBJECT, body_from_height
from gaitsmith.conventions import SIDE_SIGN
from gaitsmith.geometry.rotations import rotate
from gaitsmith.ground import GROUNDS
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.straight import Stance, footstep_positions
from gaitsmith.walks import KinematicWalk, SagittalStep, StepRequest
from gaitsmith.walks.files import built_in

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.contact import Poses
    from gaitsmith.walks.data import Character, WalkData

PROTOTYPE = built_in("winter_step")

BODIES: dict[str, Body] = {
    "adult": body_from_height(1.75),
    "child": body_from_height(1.20),
    "tall": body_from_height(1.95),
    "kb92b-subject": KB92B_SUBJECT,
    "kb92b-figure": KB92B_FIGURE,
}

#: Step length over leg length for which the laws are asserted; no angle meets its floor.
ratios = st.floats(0.5, 1.3)


@st.composite
def bodies(draw: st.DrawFn) -> Body:
    """One of the five, each segment up to a tenth longer or shorter."""
    body = draw(st.sampled_from(list(BODIES.values())))
    stretch = st.floats(0.9, 1.1)
    foot = Foot(
        ankle_height=draw(stretch) * body.foot.ankle_height,
        heel=draw(stretch) * body.foot.heel,
        ball=draw(stretch) * body.foot.ball,
        toes=draw(stretch) * body.foot.toes,
    )
    return replace(
        body, thigh=draw(stretch) * body.thigh, shin=draw(stretch) * body.shin, foot=foot
    )


@st.composite
def characters(draw: st.DrawFn) -> Character:
    """Ways of walking around the measured one, gains and powers included."""
    c = PROTOTYPE.character
    return replace(
        c,
        knee=c.knee - draw(st.floats(0.0, 0.2)),
        strike_pitch=c.strike_pitch + draw(st.floats(-0.1, 0.1)),
        off_pitch=c.off_pitch + draw(st.floats(-0.2, 0.2)),
        off_meta=c.off_meta + draw(st.floats(-0.2, 0.2)),
        kappa=draw(st.floats(0.4, 0.6)),
        gains=(
            draw(st.floats(0.0, 0.3)),
            draw(st.floats(0.0, 0.4)),
            draw(st.floats(0.0, 0.6)),
            draw(st.floats(0.0, 0.4)),
        ),
        bounce_power=draw(st.floats(0.0, 2.5)),
        swing_power=draw(st.floats(0.0, 1.0)),
    )


@st.composite
def walks(draw: st.DrawFn) -> WalkData:
    """The measured samples with any character: what the laws are about is the map."""
    return PROTOTYPE.with_(character=draw(characters()))


def assert_walks_equal(one: WalkData, other: WalkData, *, atol: float = 1e-12) -> None:
    """All six sequences, both lengths and the body's legs and foot."""
    near = {"rtol": 0, "atol": atol}
    lengths = [[w.previous_length, w.length, w.body.thigh, w.body.shin] for w in (one, other)]
    np.testing.assert_allclose(*lengths, **near, err_msg="lengths")
    feet = [[getattr(w.body.foot, f.name) for f in fields(Foot)] for w in (one, other)]
    np.testing.assert_allclose(*feet, **near, err_msg="foot")
    for name, sequence in one.sequences.items():
        theirs = other.sequences[name]
        np.testing.assert_array_equal(sequence.times, theirs.times)
        np.testing.assert_allclose(sequence.values, theirs.values, **near, err_msg=name)


def turned(forward: float, up: float, pitch: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n 2"]:
    """A vector of the level foot, turned toes up by ``pitch``: complex arithmetic, no matrix."""
    z = (forward + 1j * up) * np.exp(1j * np.asarray(pitch))
    return np.stack([z.real, z.imag], axis=-1)


@dataclass(frozen=True)
class RigidFoot:
    """Points of a foot placed by its ankle, sole pitch and the bend of its toes, ``(*n, 2)``."""

    heel: Float[np.ndarray, "*n 2"]
    ball: Float[np.ndarray, "*n 2"]
    toe_joint: Float[np.ndarray, "*n 2"]
    toe: Float[np.ndarray, "*n 2"]

    @staticmethod
    def at(
        foot: Foot,
        ankle: Float[np.ndarray, "*n 2"],
        pitch: Float[np.ndarray, "*n"],
        bend: Float[np.ndarray, "*n"],
    ) -> RigidFoot:
        """Where the sole of a rigid foot is; ``body.sole.roll`` is not asked."""
        up, h = foot.ankle_height, foot.toe_joint_height
        joint = ankle + turned(foot.ball, h - up, pitch)
        return RigidFoot(
            heel=ankle + turned(-foot.heel, -up, pitch),
            ball=ankle + turned(foot.ball, -up, pitch),
            toe_joint=joint,
            toe=joint + turned(foot.toes, -h, np.asarray(pitch) + np.asarray(bend)),
        )


def chain(
    walk: KinematicWalk, body: Body, lengths: Sequence[float], *, stand: bool = False
) -> list[tuple[StepRequest, SagittalStep]]:
    """Steps of these lengths, each begun at the hip height where the last one ended.

    ``stand``: the first starts from standing and one more closes to standing. Otherwise the
    first length is that of the step before.
    """
    steps: list[tuple[StepRequest, SagittalStep]] = []
    height = None
    if stand:
        pairs = [(0.0, lengths[0], "start"), *((a, b, "walk") for a, b in pairwise(lengths))]
        pairs.append((lengths[-1], 0.0, "stop"))
    else:
        pairs = [(a, b, "walk") for a, b in pairwise(lengths)]
    for i, (before, length, kind) in enumerate(pairs):
        following = pairs[i + 1][1] if i + 1 < len(pairs) else 0.0
        request = StepRequest(i % 2, before, length, following, 0.5, 0.0, height, kind)
        step = walk.step(body, request)
        steps.append((request, step))
        height = float(step.center[-1, 1])
    return steps


def plan_of(
    body: Body,
    lengths: Sequence[float],
    *,
    stand: bool,
    durations: Sequence[float] | None = None,
    width: float = 0.1,
    toe_out: float = 0.1,
) -> StepPlan:
    """Footsteps straight ahead, each ``lengths[i]`` from the last; see :func:`chain`."""
    if stand:
        along = np.concatenate([[0.0, 0.0], np.cumsum(lengths)])
        along = np.append(along, along[-1])
        kinds = ("start", *["walk"] * (len(lengths) - 1), "stop")
    else:
        along = np.concatenate([[-lengths[0], 0.0], np.cumsum(lengths[1:])])
        kinds = ("walk",) * (len(lengths) - 1)
    side = (np.arange(len(along)) + 1) % 2
    stance = Stance(width, toe_out)
    position = footstep_positions(along, side, stance, (0.0, 0.0), 0.0, GROUNDS["flat"]())
    seconds = [0.5] * len(kinds) if durations is None else list(durations)
    return StepPlan(
        side=side,
        position=position,
        heading=SIDE_SIGN[side] * toe_out,
        direction=np.zeros(len(along)),
        time=np.concatenate([[0.0, 0.0], np.cumsum(seconds)]),
        kinds=kinds,
    )


def points_of(body: Body, poses: Poses) -> Float[np.ndarray, "F 11 3"]:
    """World positions of hips, and of knee, ankle, heel, ball and toe tip of both legs."""
    foot = body.foot
    half = 0.5 * body.hip_width * rotate(poses.pelvis, np.array([1.0, 0.0, 0.0]))
    out = [poses.center]
    for side in (0, 1):
        hip = poses.center + SIDE_SIGN[side] * half
        knee = hip + rotate(poses.thigh[:, side], np.array([0.0, -body.thigh, 0.0]))
        ankle = knee + rotate(poses.shin[:, side], np.array([0.0, -body.shin, 0.0]))
        q, up = poses.foot[:, side], -foot.ankle_height
        heel = ankle + rotate(q, np.array([0.0, up, -foot.heel]))
        ball = ankle + rotate(q, np.array([0.0, up, foot.ball]))
        c, s = np.cos(poses.bend[:, side]), np.sin(poses.bend[:, side])
        h = foot.toe_joint_height
        toes = np.stack([0.0 * c, foot.toes * s - h * c, foot.toes * c + h * s], axis=-1)
        joint = ankle + rotate(q, np.array([0.0, up + h, foot.ball]))
        out += [knee, ankle, heel, ball, joint + rotate(q, toes)]
    return np.stack(out, axis=1)
