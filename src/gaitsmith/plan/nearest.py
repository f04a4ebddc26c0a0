"""Where feet that cannot stand at a place would stand near it: what refusals say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.plan.footing import footing

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground

#: How far around (m) a place is sought, in steps of this; as said, so that it can be typed.
AROUND, FINE = 0.8, 0.02
#: Share of the sole that may hang over and meters that its line may sink in there; steepness.
HANGING, SUNK, STEEP = 0.25, 0.008, float(np.tan(np.radians(30.0)))
#: Feet of one stance are no farther apart in height, meters.
EVEN = 0.03


def nearest_stand(
    ground: Ground,
    body: Body,
    feet: Float[np.ndarray, "k 2"],
    heading: Float[np.ndarray, "k"],
    along: Float[np.ndarray, "2"] | None = None,
) -> Float[np.ndarray, "2"] | None:
    """x,z of the middle nearest to that of ``feet`` from which all of them stand, in whole cm.

    ``along``: only straight ahead and back from there. None where there is none within
    :data:`AROUND`.
    """
    middle = feet.mean(axis=0)
    steps = np.arange(-AROUND, AROUND + 0.5 * FINE, FINE)
    if along is None:
        x, z = np.meshgrid(steps, steps, indexing="ij")
        shift = np.column_stack([x.ravel(), z.ravel()])
    else:
        shift = steps[:, None] * along
    places = np.round(middle + shift, 2)
    far = ((places - middle) ** 2).sum(-1)
    places = places[np.argsort(far, kind="stable")]
    fits, heights = np.ones(len(places), dtype=np.bool_), []
    for foot, faces in zip(feet - middle, heading, strict=True):
        found = footing(ground, places + foot, np.full(len(places), faces), body.foot)
        fits &= found.stands & (found.hangs <= HANGING) & (found.sinks <= SUNK)
        fits &= found.slope <= STEEP
        heights.append(found.height)
    fits &= np.ptp(heights, axis=0) <= EVEN
    return places[int(fits.argmax())] if fits.any() else None


def said(place: Float[np.ndarray, "2"] | None, whose: str) -> str:
    """What a refusal adds about ``place``."""
    if place is None:
        return f"; there is no place for {whose} within {AROUND:g} m"
    x, z = place + 0.0
    return f"; the nearest place for {whose} is ({x:.2f}, {z:.2f})"
