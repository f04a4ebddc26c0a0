"""A body: the lengths that matter for walking."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from gaitsmith._checks import number, positive
from gaitsmith.errors import InvalidInputError

#: How far a body's height may differ from what its parts add up to, as a share of that.
HEIGHT_TOLERANCE = 0.25


@dataclass(frozen=True)
class Foot:
    """The foot triangle of [KB92b] Figure 7, meters. N is the sole point under the ankle.

    Attributes
    ----------
    ankle_height
        aN: ankle above N, foot flat.
    heel, ball
        hN, bN: horizontal distance from N back to the heel, forward to the ball.
    toes
        bt: ball to toe tip.
    toe_joint_height
        Height of the axis about which the toes bend above the ball's sole point; 0 in the
        papers, where the ball of the foot is the joint.
    """

    ankle_height: float
    heel: float
    ball: float
    toes: float
    toe_joint_height: float = 0.0

    def __post_init__(self) -> None:
        """Check every length."""
        for field in fields(self):
            check = number if field.name == "toe_joint_height" else positive
            value = check(f"foot.{field.name}", getattr(self, field.name), "meters")
            object.__setattr__(self, field.name, value)
        if not 0.0 <= self.toe_joint_height < self.ankle_height:
            raise InvalidInputError(
                "foot.toe_joint_height must be at least 0 and below the ankle "
                f"({self.ankle_height:.3f} m), got {self.toe_joint_height!r}"
            )

    @property
    def length(self) -> float:
        """Heel to toe tip, meters."""
        return self.heel + self.ball + self.toes

    @property
    def ankle_heel(self) -> float:
        """The paper's ah, meters."""
        return float(np.hypot(self.ankle_height, self.heel))

    @property
    def ankle_ball(self) -> float:
        """The paper's ab, meters."""
        return float(np.hypot(self.ankle_height, self.ball))

    @property
    def heel_ball(self) -> float:
        """The paper's hb, meters."""
        return self.heel + self.ball

    @property
    def heel_angle(self) -> float:
        """theta_h: interior angle at the heel, radians."""
        return float(np.arctan2(self.ankle_height, self.heel))

    @property
    def ball_angle(self) -> float:
        """theta_b: interior angle at the ball, radians."""
        return float(np.arctan2(self.ankle_height, self.ball))

    @property
    def ankle_angle(self) -> float:
        """theta_a: interior angle at the ankle, radians."""
        return float(np.pi) - self.heel_angle - self.ball_angle


@dataclass(frozen=True)
class Body:
    """Lengths (meters) and mass (kg) of one person. Everything downstream reads only this.

    Attributes
    ----------
    name
        For people to read.
    height
        Stature.
    thigh, shin
        Hip to knee, knee to ankle; their sum is the paper's leg length ``ll``.
    foot
        The foot triangle, the same for both feet.
    hip_width
        Between the hip joint centers: 2 lambda of the papers.
    trunk
        Hip center to the base of the neck, at rest.
    neck, head
        Base of the neck to the head joint; head joint to the crown.
    shoulder_width
        Between the shoulder joint centers.
    shoulder_drop
        Shoulder joints below the base of the neck.
    upper_arm, forearm, hand
        Shoulder to elbow, elbow to wrist, wrist to finger tips.
    mass
        Kilograms.
    spine_segments
        Joints the trunk is cut into: 3 in rigs, 17 as the papers' torso.
    """

    name: str
    height: float
    thigh: float
    shin: float
    foot: Foot
    hip_width: float
    trunk: float
    neck: float
    head: float
    shoulder_width: float
    shoulder_drop: float
    upper_arm: float
    forearm: float
    hand: float
    mass: float
    spine_segments: int = 3

    def __post_init__(self) -> None:
        """Check that this can be a body."""
        for field in fields(self):
            if field.name in ("name", "foot", "spine_segments"):
                continue
            unit = "kilograms" if field.name == "mass" else "meters"
            value = positive(f"body.{field.name}", getattr(self, field.name), unit)
            object.__setattr__(self, field.name, value)
        count = self.spine_segments
        if isinstance(count, bool) or not (isinstance(count, int) and 1 <= count <= 40):
            raise InvalidInputError(
                f"body.spine_segments must be a whole number from 1 to 40, got {count!r}"
            )
        wrong = self._contradictions()
        if wrong:
            raise InvalidInputError("; ".join(wrong))

    def _contradictions(self) -> list[str]:
        """Why these lengths cannot be one body together; empty if they can."""
        foot, wrong = self.foot, list[str]()
        if not 0.5 <= self.thigh / self.shin <= 2.0:
            wrong.append(
                "body.thigh must be between half and twice body.shin "
                f"({self.shin:.3f} m), got {self.thigh:.3f} m"
            )
        if foot.length >= 0.7 * self.leg_length:
            wrong.append(
                f"foot (heel to toe tip {foot.length:.3f} m) must be shorter than 0.7 of the "
                f"leg ({self.leg_length:.3f} m): no such body can roll over its foot"
            )
        if foot.ball < 0.07 * self.leg_length:
            wrong.append(
                f"foot.ball ({foot.ball:.3f} m) must be at least 0.07 of the leg "
                f"({self.leg_length:.3f} m): no such body can roll over its foot"
            )
        if foot.ankle_height >= 0.5 * self.shin:
            wrong.append(
                f"foot.ankle_height ({foot.ankle_height:.3f} m) must be below half the shin "
                f"({self.shin:.3f} m)"
            )
        if self.hip_width >= self.leg_length:
            wrong.append(
                f"body.hip_width ({self.hip_width:.3f} m) must be below the leg length "
                f"({self.leg_length:.3f} m)"
            )
        if self.shoulder_drop >= self.trunk:
            wrong.append(
                f"body.shoulder_drop ({self.shoulder_drop:.3f} m) must be below the trunk "
                f"({self.trunk:.3f} m)"
            )
        stacked = self.hip_height + self.trunk + self.neck + self.head
        if abs(self.height - stacked) > HEIGHT_TOLERANCE * stacked:
            wrong.append(
                f"body.height ({self.height:.3f} m) must be within {HEIGHT_TOLERANCE:.0%} of "
                f"ankle height, shin, thigh, trunk, neck and head together ({stacked:.3f} m)"
            )
        return wrong

    @property
    def leg_length(self) -> float:
        """``ll`` = thigh + shin, hip to ankle, meters ([KB92b] section 1)."""
        return self.thigh + self.shin

    @property
    def hip_height(self) -> float:
        """Hip joint above the sole, leg straight, meters: the leg of Froude's number."""
        return self.leg_length + self.foot.ankle_height

    def scaled(self, factor: float, name: str | None = None) -> Body:
        """The same body, every length times ``factor`` and the mass times its cube.

        The paper's alpha S: same proportions, another size.
        """
        factor = positive("factor", factor, "1")
        foot = Foot(*(getattr(self.foot, f.name) * factor for f in fields(self.foot)))
        lengths = {
            f.name: getattr(self, f.name) * factor
            for f in fields(self)
            if f.name not in ("name", "foot", "spine_segments", "mass")
        }
        mass = self.mass * factor**3
        return replace(self, name=name or self.name, foot=foot, mass=mass, **lengths)
