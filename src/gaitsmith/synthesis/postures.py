"""How a body bends to get past things: ducking under, leaning aside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, SIDES
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import about, exp, inverse, log, multiply
from gaitsmith.synthesis.balance import Balance
from gaitsmith.synthesis.overlay import upper_joints

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body


def _deg(angle: float) -> float:
    return float(np.radians(angle))


#: The deepest duck: tilt of the pelvis, flexion of the spine, how far the head still looks down,
#: radians; how far the hips come down, over leg length.
TILT, FLEXION, BOWED, DOWN = _deg(38.0), _deg(56.0), _deg(38.0), 0.28
#: A shallow duck is a nod and soft knees: the head is bowed by this part of the duck.
NOD = 0.45
#: Part of the trunk's tilt that hanging arms take back.
HANGING = 0.85
#: Flexion of the elbows in the deepest duck, radians, which keeps hands off the floor.
ELBOWS = _deg(30.0)
#: Part of the balance of a duck that the hips keep by going back; the walk's momentum the rest.
BACK = 0.7
#: The farthest lean aside: roll of the trunk, and turn of the near shoulder to the rear, radians.
ROLL, TURN = _deg(27.0), _deg(15.0)
#: Part of it that neck and head take back.
UPRIGHT = 0.6
#: Part of a lean by which the near arm is held in, and after which the trunk begins to lean.
ARM_IN, TRUNK_AFTER = 0.65, 0.05
#: Part of the lean that the near and the far arm take back.
PRESSED, PLUMB = 0.65, 0.8
#: The arm that is held in: forward, apart from the body, turned inward, and the elbow's flexion.
HELD = (_deg(24.0), _deg(-8.0), _deg(42.0), _deg(76.0))


@dataclass(frozen=True, eq=False)
class Amounts:
    """How much of each posture, 0 to 1, at F instants.

    ``aside`` has a column for what is on the [left, right]: the trunk leans the other way.
    """

    duck: Float[np.ndarray, "F"]
    aside: Float[np.ndarray, "F 2"]

    @staticmethod
    def none(count: int) -> Amounts:
        """Upright."""
        return Amounts(np.zeros(count), np.zeros((count, 2)))


class Postures:
    """Bends ``body``; ``standing`` is its pelvis and upper body at ease, for its balance."""

    def __init__(
        self, body: Body, standing: tuple[Float[np.ndarray, "4"], Float[np.ndarray, "U 3"]]
    ) -> None:
        self.body = body
        self._names = upper_joints(body)
        self._spine = len(spine_names(body.spine_segments))
        # the hips' way back is a curve of the depth alone, so that it costs nothing a frame
        self._depths = np.linspace(0.0, 1.0, 33)
        pelvis = np.tile(standing[0], (33, 1))
        upper = np.tile(standing[1], (33, 1, 1))
        amounts = Amounts(self._depths, np.zeros((33, 2)))
        after = (multiply(pelvis, about("x", self.tilt(self._depths))), self.upper(upper, amounts))
        self._back = BACK * Balance(body).counter((pelvis, upper), after)[:, 2]

    def tilt(self, duck: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
        """Forward tilt of the pelvis, radians."""
        return TILT * duck**1.2

    def hips(self, amounts: Amounts) -> Float[np.ndarray, "F 3"]:
        """Shift of the hips to the left, up and ahead, meters."""
        out = np.zeros((len(amounts.duck), 3))
        out[:, 1] = -DOWN * self.body.leg_length * amounts.duck
        out[:, 2] = np.interp(amounts.duck, self._depths, self._back)
        return out

    def upper(
        self, upper: Float[np.ndarray, "F U 3"], amounts: Amounts
    ) -> Float[np.ndarray, "F U 3"]:
        """The joints above the pelvis, bent."""
        out, duck = np.array(upper), amounts.duck
        lean = smoothstep((amounts.aside - TRUNK_AFTER) / (1.0 - TRUNK_AFTER)) @ [1.0, -1.0]
        tilt, flexion = self.tilt(duck), FLEXION * duck
        bowed = BOWED * smoothstep(duck / NOD)
        turn = np.stack([flexion, TURN * lean, ROLL * lean], axis=-1)
        back = np.stack([bowed - tilt - flexion, -TURN * lean, -UPRIGHT * ROLL * lean], axis=-1)
        for i in range(self._spine):
            self._turn(out, i, turn / self._spine)
        for i in (self._spine, self._spine + 1):
            self._turn(out, i, 0.5 * back)
        for side in (LEFT, RIGHT):
            self._hold(out, side, smoothstep(amounts.aside[:, side] / ARM_IN))
            hang = np.zeros_like(turn)
            hang[:, 0] = -HANGING * (tilt + flexion)
            # the far arm hangs plumb; the near one is pressed to the body
            near = SIDE_SIGN[side] * lean > 0.0
            hang[:, 2] = -ROLL * np.where(near, PRESSED, PLUMB) * lean
            self._turn(out, self._names.index(f"{SIDES[side]}UpperArm"), hang)
            bent = np.zeros_like(turn)
            bent[:, 1] = -float(SIDE_SIGN[side]) * ELBOWS * duck
            self._turn(out, self._names.index(f"{SIDES[side]}LowerArm"), bent)
        return out

    @staticmethod
    def _turn(
        upper: Float[np.ndarray, "F U 3"], joint: int, turn: Float[np.ndarray, "F 3"]
    ) -> None:
        upper[:, joint] = log(multiply(exp(turn), exp(upper[:, joint])))

    def _hold(
        self, upper: Float[np.ndarray, "F U 3"], side: int, share: Float[np.ndarray, "F"]
    ) -> None:
        """Bring one arm in front of the body by ``share``."""
        if not share.any():
            return
        s, (forward, apart, inward, elbow) = float(SIDE_SIGN[side]), HELD
        hang = multiply(about("x", -forward), about("z", -s * (0.5 * np.pi - apart)))
        goals = {
            "UpperArm": multiply(hang, about("x", inward)),
            "LowerArm": about("y", -s * elbow),
        }
        for part, goal in goals.items():
            i = self._names.index(f"{SIDES[side]}{part}")
            now = exp(upper[:, i])
            way = log(multiply(inverse(now), np.broadcast_to(goal, now.shape)))
            upper[:, i] = log(multiply(now, exp(share[:, None] * way)))
