"""Step length and height of elevation data on a body: f(ds) of [SM01] section 5.1."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.walks.elevation import FOOT, PELVIS, SHANK, THIGH, pelvis_height
from gaitsmith.walks.round_heel import RoundHeel, turned

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body

_LEVEL = 0.5 * np.pi


@dataclass(frozen=True, eq=False)
class PlanarFigure:
    """The body from aside, as f sees it.

    Attributes
    ----------
    shin, thigh, pelvis
        Meters: knee to ankle, hip to knee, hips' middle to the top of the pelvis.
    sole
        The foot.
    foot
        Meters from heel to ball, for the printed formula.
    """

    shin: float
    thigh: float
    pelvis: float
    sole: RoundHeel
    foot: float

    @classmethod
    def of(cls, body: Body) -> PlanarFigure:
        """The figure of ``body``."""
        return cls(
            body.shin, body.thigh, pelvis_height(body), RoundHeel.of(body.foot), body.foot.heel_ball
        )


def step_of(
    figure: PlanarFigure,
    stance: Float[np.ndarray, "*n 4"],
    swing: Float[np.ndarray, "*n 4"],
    slope: Float[np.ndarray, "*n"] | float = 0.0,
) -> Float[np.ndarray, "*n 2"]:
    """Step (length, height) of elevations at the end of a step, meters.

    From N of the stance foot, that stands on its toes, up to the pelvis, down to the other
    foot, to where its N comes to lie when it has rolled flat on the data's own ``slope``.

    Parameters
    ----------
    figure
        Whose step.
    stance, swing
        ``(*n, 4)`` the data at 1/2 and at 0 (= 1) of the stride.
    slope
        ``(*n,)`` of the ground the data are of, radians.

    Notes
    -----
    [SM01] Eq. 10 runs from the stance toe to the swing ankle, which is no step length
    (:func:`printed_step_of`; docs/papers/errata.md). Complex numbers pass through.
    """
    stance, swing, slope = np.asarray(stance), np.asarray(swing), np.asarray(slope)
    at = turned(figure.sole.stand(stance[..., FOOT] - _LEVEL - slope), slope)
    at = at - figure.shin * down(stance[..., SHANK]) - figure.thigh * down(stance[..., THIGH])
    shift = figure.pelvis * (np.tan(swing[..., PELVIS]) - np.tan(stance[..., PELVIS]))
    at = at + np.stack([shift, np.zeros_like(shift)], axis=-1)
    at = at + figure.thigh * down(swing[..., THIGH]) + figure.shin * down(swing[..., SHANK])
    return at - turned(figure.sole.stand(swing[..., FOOT] - _LEVEL - slope), slope)


def printed_step_of(
    figure: PlanarFigure, stance: Float[np.ndarray, "*n 4"], swing: Float[np.ndarray, "*n 4"]
) -> Float[np.ndarray, "*n 2"]:
    """[SM01] Eq. 10 as printed, (length, height) in meters: from the toe to the other ankle."""
    lengths = (figure.foot, figure.shin, figure.thigh, figure.pelvis)
    up = [-size * down(stance[..., i]) for i, size in enumerate(lengths)]
    back = [size * down(swing[..., i]) for i, size in enumerate(lengths) if i > 0]
    return np.sum(np.stack([*up, *back]), axis=0)


def down(elevation: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n 2"]:
    """Unit (forward, up) vector of a segment from its proximal to its distal end, by elevation."""
    return np.stack([np.sin(elevation), -np.cos(elevation)], axis=-1)
