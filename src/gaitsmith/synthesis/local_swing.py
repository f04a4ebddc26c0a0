"""Way of the swinging foot in a local step, seen from above: [KB93] section 5.2."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.planar import feet_apart

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Foot

#: A straight way that passes nearer to the stance ankle than this goes round it, meters.
PASSING = 0.12
#: Distance of the feet's axes in passing over stature; narrower footsteps keep their own.
APART = 0.085 / 1.75
#: The same of a foot that comes from across the other, and how soon it gets there.
ACROSS = 0.17 / 1.75
#: The way is pushed aside in such parts (m), at most so many, straight outward or so far from it.
PUSH, MOST_PUSHES = 0.01, 40
AROUND = np.radians([0.0, 40.0, -40.0, 75.0, -75.0, 100.0, -100.0])
AROUND.flags.writeable = False


def swing_way(
    start: Float[np.ndarray, "2"],
    end: Float[np.ndarray, "2"],
    stance: Float[np.ndarray, "2"],
    outward: Float[np.ndarray, "2"],
    hip_width: float,
    share: Float[np.ndarray, "T"],
) -> Float[np.ndarray, "T 2"]:
    """Ankles at ``share`` of the way: straight, or round the stance leg.

    [KB93] Figure 5: where the legs would collide, a curve of second degree with D2 displaced
    from the stance ankle by 2 lambda perpendicular to the way, to the side ``outward`` of the
    body.
    """
    chord = end - start
    size = float(chord @ chord)
    along = float(np.clip((stance - start) @ chord / size, 0.0, 1.0)) if size > 1e-12 else 0.0
    u = share[:, None]
    straight = start + u * chord
    if float(np.linalg.norm(start + along * chord - stance)) >= PASSING or not 0.0 < along < 1.0:
        return straight
    across = np.array([chord[1], -chord[0]]) / np.sqrt(size)
    if across @ outward < 0.0:
        across = -across
    control = stance + hip_width * across
    return (1.0 - u) ** 2 * start + 2.0 * u * (1.0 - u) * control + u**2 * end


def kept_apart(
    way: Float[np.ndarray, "T 2"],
    heading: Float[np.ndarray, "T"],
    stance: Float[np.ndarray, "2"],
    stance_heading: float,
    outward: Float[np.ndarray, "2"],
    shape: Float[np.ndarray, "T"],
    foot: Foot,
    stature: float,
) -> Float[np.ndarray, "T 2"]:
    """``way`` pushed aside, by ``shape``, by the least that keeps the feet from touching.

    Outward, or outward and round the toes or the heel: the first of these that helps. A foot that
    comes from across the other one goes farther round, or the shins would meet.
    """

    def apart(
        paths: Float[np.ndarray, "k n 2"], turned: Float[np.ndarray, "n"]
    ) -> Float[np.ndarray, "k n"]:
        rows = paths.reshape(-1, 2)
        many = len(rows)
        gaps = feet_apart(
            rows,
            np.tile(turned, len(paths)),
            np.tile(stance, (many, 1)),
            np.full(many, stance_heading),
            back=foot.heel,
            front=foot.ball + foot.toes,
        )
        return gaps.reshape(len(paths), -1)

    ends = apart(way[None, [0, -1]], heading[[0, -1]])[0]
    want = np.full(len(way), min(APART * stature, float(ends.min())))
    if float((way[0] - stance) @ outward) < 0.0:
        wide = np.minimum(ends[0] + ACROSS * shape, ends[1] + ACROSS * shape)
        want = np.maximum(want, np.minimum(ACROSS * stature, wide))
    if float((apart(way[None], heading)[0] - want).min()) >= -1e-4:
        return way
    along = np.array([-outward[1], outward[0]])
    unit = np.cos(AROUND)[:, None] * outward + np.sin(AROUND)[:, None] * along
    size = PUSH * (1.0 + np.arange(MOST_PUSHES))
    moved = size[:, None, None] * unit
    paths = way + shape[:, None] * moved.reshape(-1, 1, 2)
    gaps = (apart(paths, heading) - want).min(axis=1)
    enough = np.flatnonzero(gaps >= -1e-4)
    if len(enough):
        return paths[enough[0]]
    # no way is wide enough: the widest, a longer one only where it gains
    cost = 0.15 * np.repeat(size, len(AROUND))
    return paths[int((gaps - cost).argmax())]
