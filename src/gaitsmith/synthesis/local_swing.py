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
#: The way is pushed aside in such parts (m), at most so many.
PUSH, MOST_PUSHES = 0.01, 30


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
    """``way`` pushed outward, by ``shape``, by the least that keeps the feet from touching."""
    count = len(way)
    stands, turned = np.tile(stance, (count, 1)), np.full(count, stance_heading)

    def apart(path: Float[np.ndarray, "T 2"]) -> Float[np.ndarray, "T"]:
        return feet_apart(
            path, heading, stands, turned, back=foot.heel, front=foot.ball + foot.toes
        )

    plain = apart(way)
    want = min(APART * stature, float(plain[0]), float(plain[-1]))
    short = max(0.0, want - float(plain.min()))
    best, pushed = way, 0.0
    for _ in range(MOST_PUSHES):
        if short <= 1e-4:
            break
        pushed += PUSH
        path = way + (pushed * shape)[:, None] * outward
        missing = want - float(apart(path).min())
        if missing < short:
            best, short = path, missing
    return best
