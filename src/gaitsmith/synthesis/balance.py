"""Where the mass of the upper body goes as it bends, and how far the hips go the other way."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.masses import segments_of
from gaitsmith.body.rig import skeleton_of
from gaitsmith.geometry.rotations import exp
from gaitsmith.motion.kinematics import forward_kinematics
from gaitsmith.synthesis.overlay import upper_joints

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body

#: How far the knee goes along when the hips move over feet that stay.
KNEE = 0.5


class Balance:
    """The masses of ``body`` above the hips, and what of the legs moves with them."""

    def __init__(self, body: Body) -> None:
        self._skeleton, segments = skeleton_of(body), segments_of(body)
        index = self._skeleton.index
        self._upper = [index(name) for name in upper_joints(body)]
        weights, legs = np.zeros(len(self._skeleton)), 0.0
        for segment in segments:
            share = segment.mass / body.mass
            part = segment.name.partition("_")[2]
            if part in ("thigh", "shank", "foot"):
                moved = {"thigh": (1.0, KNEE), "shank": (KNEE, 0.0), "foot": (0.0, 0.0)}[part]
                legs += share * (moved[0] + segment.com * (moved[1] - moved[0]))
                continue
            weights[index(segment.proximal)] += share * (1.0 - segment.com)
            weights[index(segment.distal)] += share * segment.com
        self._weights = weights
        #: How far the center of mass goes along with the hips.
        self.share = float(weights.sum()) + legs

    def moment(
        self, pelvis: Float[np.ndarray, "F 4"], upper: Float[np.ndarray, "F U 3"]
    ) -> Float[np.ndarray, "F 3"]:
        """The upper body's part of the center of mass, against the hips, meters.

        Axes are those that ``pelvis`` turns the pelvis in.
        """
        turned = np.zeros((len(pelvis), len(self._skeleton), 4))
        turned[..., 3] = 1.0
        turned[:, 0] = pelvis
        turned[:, self._upper] = exp(upper)
        positions, _ = forward_kinematics(self._skeleton, np.zeros((len(pelvis), 3)), turned)
        return np.einsum("fjc,j->fc", positions, self._weights)

    def counter(
        self,
        before: tuple[Float[np.ndarray, "F 4"], Float[np.ndarray, "F U 3"]],
        after: tuple[Float[np.ndarray, "F 4"], Float[np.ndarray, "F U 3"]],
    ) -> Float[np.ndarray, "F 3"]:
        """How the hips move so that bending leaves the center of mass over the same point.

        Level, meters; ``before`` and ``after`` the bend are pelvis and upper body.
        """
        out = (self.moment(*before) - self.moment(*after)) / self.share
        out[:, 1] = 0.0
        return out
