"""The stance foot of [SM01] section 4.1: it rolls over its heel, lies flat, raises its heel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith.geometry.curves import smoothstep
from gaitsmith.synthesis.exact_figure import (
    X,
    Y,
    Z,
    about,
    apply,
    elevation,
    sagittal,
    turn_to_elevation,
)

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.synthesis.exact_figure import ExactFigure

#: Share of the stride over which a landing's error in height fades.
_FADE = 0.08
#: Pitches this near to flat (radians) are flat.
_FLAT = 1e-9


class StanceFoot(NamedTuple):
    """F instants of a foot that bears.

    Attributes
    ----------
    turned, toes
        ``(F, 3, 3)`` orientation of the foot and of its toes.
    ankle
        ``(F, 3)`` meters.
    toe
        ``(F,)`` toes against the foot, radians: heel up is negative.
    corner
        ``(F,)`` index of the sole's corner that bears; -1 while the foot lies or stands on its
        toes.
    bears
        ``(F, 3)`` the point of the ground that it stands on: that corner, or the toe joint.
    """

    turned: Float[np.ndarray, "F 3 3"]
    toes: Float[np.ndarray, "F 3 3"]
    ankle: Float[np.ndarray, "F 3"]
    toe: Float[np.ndarray, "F"]
    corner: Int[np.ndarray, "F"]
    bears: Float[np.ndarray, "F 3"]


@dataclass(frozen=True, eq=False)
class Landing:
    """A foot that has just come down, and how it will roll flat on a plane.

    Attributes
    ----------
    flat
        ``(3, 3)`` its orientation when it lies: forward, the plane's normal, right.
    axis
        ``(3,)`` it rolls about the normal of the sagittal plane at landing.
    pitch
        Radians, toes up, at landing.
    gap
        Meters that it landed too high; fades.
    lead
        Radians by which it landed with more pitch than the data ask for; fades.
    pitches, corners, places
        The corners that it rolls over: each bears from its own pitch down to the next one's;
        ``(k,)``, ``(k,)`` and ``(k, 3)``.
    """

    flat: Float[np.ndarray, "3 3"]
    axis: Float[np.ndarray, "3"]
    pitch: float
    gap: float
    lead: float
    pitches: Float[np.ndarray, "k"]
    corners: Int[np.ndarray, "k"]
    places: Float[np.ndarray, "k 3"]

    def moved(self, shift: Float[np.ndarray, "3"]) -> Landing:
        """The same elsewhere."""
        return replace(self, places=self.places + shift)

    def lies(self, figure: ExactFigure) -> Float[np.ndarray, "3"]:
        """Where the ankle comes to be when the foot lies flat, before the gap fades."""
        return self.places[-1] - self.flat @ figure.sole[self.corners[-1]]


def land(
    figure: ExactFigure,
    turned: Float[np.ndarray, "3 3"],
    ankle: Float[np.ndarray, "3"],
    heading: float,
    normal: Float[np.ndarray, "3"],
    asked: float,
) -> Landing:
    """A foot that comes down with its ankle at ``ankle``, on the plane through 0 with ``normal``.

    It bears on its lowest corner where that is: nothing moves along the ground. ``asked`` is
    the pitch that the data have then.
    """
    axis = sagittal(np.array(heading))[1]
    pitch = -_turn_into(turned @ X, axis, normal)
    flat = about(axis, np.array(-pitch)) @ turned
    heights = figure.sole @ (turned.T @ normal)
    corner = int(heights.argmin())
    place = ankle + turned @ figure.sole[corner]
    gap = float(place @ normal) / float(normal[1])
    rows = [(pitch, corner, place)]
    while (event := _next_corner(figure, flat, axis, normal, rows[-1])) is not None:
        rows.append(event)
    pitches, corners, places = (list(column) for column in zip(*rows, strict=True))
    return Landing(
        flat,
        axis,
        pitch,
        gap,
        pitch - asked,
        np.array(pitches),
        np.array(corners),
        np.array(places),
    )


def stand(
    figure: ExactFigure,
    landing: Landing,
    wanted: Float[np.ndarray, "F"],
    heading: Float[np.ndarray, "F"],
    time: Float[np.ndarray, "F"],
) -> StanceFoot:
    """The foot at ``time`` (of its stride, rising from 0) with elevations ``wanted``.

    Those count from the ground: flat is 90 deg whatever its slope. [SM01] section 4.1. A foot
    that rolls never rolls back, and toes never dig in: where data ask for that, the elevation
    is not kept.
    """
    axis = np.broadcast_to(landing.axis, (len(time), 3))
    front = np.broadcast_to(landing.flat @ X, (len(time), 3))
    fades = 1.0 - smoothstep(time / _FADE)
    seen = elevation(front, sagittal(heading)[0]) - 0.5 * np.pi
    wanted = wanted + seen + landing.lead * fades
    pitch = turn_to_elevation(front, axis, wanted, heading, landing.pitch)
    pitch = np.minimum.accumulate(np.clip(pitch, 0.0, landing.pitch))
    pitch = np.where(pitch < _FLAT, 0.0, pitch)
    rolls = pitch > 0.0
    across = np.broadcast_to(landing.flat @ Z, (len(time), 3))
    toe = turn_to_elevation(front, across, wanted, heading, 0.0)
    toe = np.where(rolls, 0.0, np.minimum(toe, 0.0))
    rolled = about(axis, pitch) @ landing.flat
    turned = np.where(rolls[:, None, None], rolled, about(across, toe) @ landing.flat)
    row = np.searchsorted(-landing.pitches, -pitch, side="right") - 1
    row = np.clip(row, 0, len(landing.pitches) - 1)
    corner, place = landing.corners[row], landing.places[row]
    on_heel = place - apply(rolled, figure.sole[corner])
    joint = landing.lies(figure) + landing.flat @ figure.joint
    ankle = np.where(rolls[:, None], on_heel, joint - apply(turned, figure.joint))
    bears = np.where(rolls[:, None], place, joint)
    down = (landing.gap * (1.0 - fades))[:, None] * Y
    toes = np.where(rolls[:, None, None], rolled, landing.flat)
    return StanceFoot(turned, toes, ankle - down, toe, np.where(rolls, corner, -1), bears - down)


def _turn_into(
    vector: Float[np.ndarray, "3"], axis: Float[np.ndarray, "3"], normal: Float[np.ndarray, "3"]
) -> float:
    """Smaller angle about ``axis`` that lays ``vector`` into the plane."""
    a, b, c = _wave(vector, axis, normal)
    middle, spread = np.arctan2(b, a), np.arccos(np.clip(-c / np.hypot(a, b), -1.0, 1.0))
    both = [(middle + sign * spread + np.pi) % (2.0 * np.pi) - np.pi for sign in (-1.0, 1.0)]
    return float(min(both, key=abs))


def _next_corner(
    figure: ExactFigure,
    flat: Float[np.ndarray, "3 3"],
    axis: Float[np.ndarray, "3"],
    normal: Float[np.ndarray, "3"],
    now: tuple[float, int, Float[np.ndarray, "3"]],
) -> tuple[float, int, Float[np.ndarray, "3"]] | None:
    """The pitch below the present one at which another corner becomes as low; None if none."""
    pitch, corner, place = now
    arms = (figure.sole - figure.sole[corner]) @ flat.T
    a, b, c = _wave(arms, axis, normal)
    size = np.hypot(a, b)
    level = size < 1e-9
    size = np.where(level, 1.0, size)
    middle, spread = np.arctan2(b, a), np.arccos(np.clip(-c / size, -1.0, 1.0))
    angles = np.stack([middle - spread, middle + spread])
    angles = (angles + np.pi) % (2.0 * np.pi) - np.pi
    # it must come down as the foot rolls on, from above
    falls = b * np.cos(angles) - a * np.sin(angles) > 1e-9 * size
    meets = falls & ~level & (np.abs(c) <= size) & (angles > _FLAT) & (angles < pitch - 1e-9)
    if not meets.any():
        return None
    first = np.where(meets, angles, -np.inf)
    other = int(first.max(axis=0).argmax())
    angle = float(first[:, other].max())
    return angle, other, place + about(axis, np.array(angle)) @ arms[other]


def _wave(
    vector: Float[np.ndarray, "*n 3"],
    axis: Float[np.ndarray, "3"],
    normal: Float[np.ndarray, "3"],
) -> tuple[Float[np.ndarray, "*n"], Float[np.ndarray, "*n"], Float[np.ndarray, "*n"]]:
    """a, b, c of the height ``a cos + b sin + c`` of vectors as they turn about ``axis``."""
    along = (vector @ axis) * (axis @ normal)
    return vector @ normal - along, vector @ np.cross(normal, axis), along
