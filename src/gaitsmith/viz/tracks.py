"""What the pictures need to know about a motion: facing, progress, strides, joint angles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES, ahead
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import inverse, multiply, rotate
from gaitsmith.ground import Flat, ground_from_json
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions
from gaitsmith.skin.build import build_skin
from gaitsmith.skin.t_pose import in_t_pose
from gaitsmith.viz.around import surroundings_of
from gaitsmith.viz.terrain import Land

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.ground import Ground
    from gaitsmith.motion.motion import Motion
    from gaitsmith.plan.surroundings import Surroundings
    from gaitsmith.skin.mesh import SkinMesh

#: Pelvis rotation and sway of a step vanish in a mean over about one stride, seconds.
_STRIDE_TIME = 1.1


@dataclass(frozen=True, eq=False)
class Tracks:
    """A motion with its world positions, facing and figure.

    Attributes
    ----------
    motion
        What is drawn; at least one frame. A person has VRM names and rests in the T-pose.
    positions, world
        ``(F, J, 3)`` meters and ``(F, J, 4)`` world rotations of the joints.
    figure
        The skin of its skeleton.
    """

    motion: Motion
    positions: Float[np.ndarray, "frames joints 3"]
    world: Float[np.ndarray, "frames joints 4"]
    figure: SkinMesh

    def joint(self, name: str) -> int | None:
        """Index of the joint called ``name``, or None."""
        names = self.motion.skeleton.names
        return names.index(name) if name in names else None

    @cached_property
    def stature(self) -> float:
        """How tall the figure is, meters; what is no person: how high it rises in its motion."""
        if self.figure.lasts != (None, None):
            return self.figure.stature
        root = self.motion.root_position
        level = self.ground(root[:, 0], root[:, 2])
        return max(1.05 * float((self.positions[..., 1].max(axis=1) - level).max()), 0.1)

    @cached_property
    def root(self) -> Float[np.ndarray, "frames 3"]:
        """Smoothed way of the root joint, meters: sway and bounce of the steps taken out."""
        return smooth(self.motion.root_position, _STRIDE_TIME * self.motion.fps)

    @cached_property
    def heading(self) -> Float[np.ndarray, "frames"]:
        """Which way the figure faces, smoothed over a stride, radians, without jumps."""
        front = rotate(self.world[:, 0], np.array([0.0, 0.0, 1.0]))
        front = smooth(front, _STRIDE_TIME * self.motion.fps)
        return np.unwrap(np.arctan2(front[:, 0], front[:, 2]))

    @cached_property
    def progress(self) -> Float[np.ndarray, "frames"]:
        """Meters walked forward since the first frame; spread by time if hardly any."""
        move = np.diff(self.motion.root_position, axis=0)
        heading = 0.5 * (self.heading[1:] + self.heading[:-1])
        forward = np.concatenate([[0.0], np.cumsum((move * ahead(heading)).sum(1))])
        if np.ptp(forward) < 0.3 * max(self.distance, 1e-9) or np.ptp(forward) < 0.2:
            return 0.5 * self.motion.times
        return forward

    @cached_property
    def distance(self) -> float:
        """Length of the smoothed way of the root over the ground, meters."""
        return float(np.linalg.norm(np.diff(self.root[:, [0, 2]], axis=0), axis=1).sum())

    @cached_property
    def soles(self) -> Float[np.ndarray, "frames 2 3 3"] | None:
        """World [left, right] x [heel, ball, toe tip], meters; None if the skeleton has none."""
        if self.motion.skeleton.soles is None or self.joint("leftFoot") is None:
            return None
        if self.joint("rightFoot") is None:
            return None
        return sole_positions(self.motion.skeleton, self.positions, self.world)

    def ground(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """Height of the ground, meters, from the labels; else the level of the lowest foot."""
        return self.surface.height(x, z)

    @cached_property
    def land(self) -> Land:
        """The ground and the obstacles on it, as they are drawn."""
        return Land.of(self.surface, self.around.obstacles)

    @cached_property
    def around(self) -> Surroundings:
        """What stands around, from the recipe."""
        return surroundings_of(self.motion)

    @cached_property
    def surface(self) -> Ground:
        """The ground of the labels; without one that is known, level at the lowest foot."""
        if self.motion.labels is not None:
            try:
                return ground_from_json(self.motion.labels.ground)
            except InvalidInputError:
                pass  # a picture of the motion is worth having all the same
        if self.soles is None:
            return Flat(float(self.positions[..., 1].min()))
        # some foot is down in most frames; a measured one may dip below the ground in a few
        lowest = self.soles[..., 1].reshape(len(self.soles), -1).min(axis=1)
        return Flat(float(np.quantile(lowest, 0.1)))


def tracks_of(motion: Motion) -> Tracks:
    """Tracks of ``motion``; InvalidInputError if it has no frames."""
    if len(motion) == 0:
        raise InvalidInputError("there is nothing to draw: the motion has no frames")
    motion = in_t_pose(motion)
    positions, world = motion_kinematics(motion)
    return Tracks(motion, positions, world, build_skin(motion.skeleton))


def smooth(values: Float[np.ndarray, "frames *c"], width: float) -> Float[np.ndarray, "frames *c"]:
    """Mean over about ``width`` frames; the ends are continued by point reflection."""
    half = min(int(width / 2), len(values) - 1)
    if half < 1:
        return np.array(values, dtype=np.float64)
    head = 2.0 * values[0] - values[half:0:-1]
    tail = 2.0 * values[-1] - values[-2 : -half - 2 : -1]
    total = np.cumsum(np.concatenate([np.zeros_like(values[:1]), head, values, tail]), axis=0)
    return (total[2 * half + 1 :] - total[: -2 * half - 1]) / (2 * half + 1)


def stride_frames(motion: Motion, phases: int) -> tuple[Int[np.ndarray, "n"], bool]:
    """Frames of ``phases`` even instants of one stride in the middle of ``motion``.

    Returns the frames and whether they are a stride: without footsteps in the labels they
    are spread over the whole motion.
    """
    last = len(motion) - 1
    labels = motion.labels
    if labels is not None:
        time, side = labels.footstep_time, labels.footstep_side
        starts = [
            (abs(time[k] + time[k + 2] - motion.duration), k)
            for k in range(2, len(time) - 2)
            if side[k] == side[k + 2] and time[k + 2] > time[k]
        ]
        if starts:
            k = min(starts)[1]
            at = np.linspace(time[k], time[k + 2], phases, endpoint=False)
            return np.clip(np.round(at * motion.fps), 0, last).astype(int), True
    count = min(phases, last + 1)
    return np.round(np.linspace(0, last, count)).astype(int), False


def flexion(tracks: Tracks, which: str) -> Float[np.ndarray, "frames 2"] | None:
    """Sagittal angle of the [left, right] ``which`` (hip, knee or ankle), degrees.

    Hip: thigh forward of the pelvis. Knee: shank behind the thigh. Ankle: toes up
    (dorsiflexion). All zero in the rest pose. None if a joint is missing.
    """
    upper, lower, child = {
        "hip": ("hips", "UpperLeg", "LowerLeg"),
        "knee": ("UpperLeg", "LowerLeg", "Foot"),
        "ankle": ("LowerLeg", "Foot", None),
    }[which]
    out = np.empty((len(tracks.motion), 2))
    for s, side in enumerate(SIDES):
        above = tracks.joint("hips" if upper == "hips" else side + upper)
        joint = tracks.joint(side + lower)
        below = None if child is None else tracks.joint(side + child)
        if above is None or joint is None or (child is not None and below is None):
            return None
        turn = multiply(inverse(tracks.world[:, above]), tracks.world[:, joint])
        if below is None:
            front = rotate(turn, np.array([0.0, 0.0, 1.0]))
            out[:, s] = np.arctan2(front[:, 1], front[:, 2])
            continue
        bone = tracks.motion.skeleton.offsets[below]
        down = rotate(turn, bone / max(float(np.linalg.norm(bone)), 1e-9))
        sign = -1.0 if which == "knee" else 1.0
        out[:, s] = sign * np.arctan2(down[:, 2], -down[:, 1])
    return np.rad2deg(np.unwrap(out, axis=0))
