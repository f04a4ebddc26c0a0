"""A body of average proportions for a stature, from toddlers to giants."""

from __future__ import annotations

from gaitsmith._checks import number
from gaitsmith.body.body import Body, Foot
from gaitsmith.errors import InvalidInputError

#: Statures for which proportions are known, meters.
SHORTEST, TALLEST = 0.8, 2.3
#: From here up a body has adult proportions, meters.
ADULT_FROM = 1.5

# Adults, shares of stature. Where not marked: Drillis & Contini 1966 as printed in Winter,
# Biomechanics and Motor Control of Human Movement, Figure 4.1. See data/SOURCES.md.
_HIP_HEIGHT = 0.530
_KNEE_HEIGHT = 0.285
_ANKLE_HEIGHT = 0.039
_UPPER_ARM, _FOREARM, _HAND = 0.186, 0.146, 0.108
_FOOT_LENGTH = 0.152
_SHOULDER_HEIGHT = 0.818
_HEAD_HEIGHT = 0.130  # chin to crown
# Winter's widths (.191 pelvis, .259 shoulders) are to the outside of the body. Joint centers
# as in the scaled model of Rajagopal et al. 2016: .185 and .39 m at about 1.80 m.
_HIP_WIDTH = 0.10
_SHOULDER_WIDTH = 0.22
# Ours: neck base a little below the tip of C7 on the skin (.86), head joint (atlas) a little
# below and behind the ear hole (.925); both from memory of army surveys.
_NECK_BASE = 0.845
_HEAD_JOINT = 0.910

#: Shares of foot length behind N, from N to the ball, and toes. Between the measured subject
#: of [KB92b] section 6 (.222, .470, .309) and surveys, where the ball of the big toe is .73
#: and that of the small toe .64 of the foot from the heel: the axis crosses at .70.
FOOT_SHARES = (0.24, 0.46, 0.30)

_ADULT_BMI, _CHILD_BMI, _CHILD_BMI_UP_TO = 22.5, 15.5, 1.2


def body_from_height(
    height: float, *, spine_segments: int = 3, mass: float | None = None, name: str | None = None
) -> Body:
    """Body of average proportions of a person ``height`` meters tall.

    Parameters
    ----------
    height
        Stature, 0.8 to 2.3 meters.
    spine_segments
        Joints the trunk is cut into.
    mass
        Kilograms; by :func:`mass_from_height` if not given.
    name
        The height if not given.

    Raises
    ------
    InvalidInputError
        If the height is out of range; the message says the range.

    Notes
    -----
    From 1.5 m up: adult shares of stature by Drillis & Contini 1966 (Winter, Figure 4.1), with
    widths between joint centers instead of over the skin, and neck and head cut at the joints.

    Children are not small adults. With ``u`` = 0 at 1.5 m rising to 1 at 0.8 m:

    * legs: the hip is at ``.530 - .088 u²`` of stature. It follows the sitting height, whose
      share is ``.52 + .08 u²``: .527 at 1.30 m, .54 at 1.15 m, .56 at 1.0 m (Fredriks et al.
      2005; the Aragon study of 2013 has .656 at birth, least at the onset of puberty with
      .514 boys and .519 girls, .52 and .53 adults).
    * head: chin to crown is ``.130 + .085 u^1.5`` of stature, .16 at 1.15 m.
    * feet: ``.152 + .010 u²`` of stature; arms: shorter by ``.06 u²`` of their length.

    All of it is continuous with its first derivative in ``height``, so a slider has no kinks.
    The joints stack up to ``height`` exactly. ``data/SOURCES.md`` says which numbers were
    seen in print and which are from memory.
    """
    height = number("height", height, "meters")
    if not SHORTEST <= height <= TALLEST:
        hint = f" (heights are in meters: {height / 100:g}?)" if 80.0 <= height <= 230.0 else ""
        raise InvalidInputError(
            f"height must be from {SHORTEST:g} to {TALLEST:g} meters, got {height:g}{hint}"
        )
    young = max(0.0, (ADULT_FROM - height) / (ADULT_FROM - SHORTEST))
    hip = _HIP_HEIGHT - 0.088 * young**2
    # thigh and shin keep the adult ratio to each other
    leg = (hip - _ANKLE_HEIGHT) / (_HIP_HEIGHT - _ANKLE_HEIGHT)
    arm = 1.0 - 0.06 * young**2
    foot = (_FOOT_LENGTH + 0.010 * young**2) * height
    head = (1.0 - _HEAD_JOINT) * (_HEAD_HEIGHT + 0.085 * young**1.5) / _HEAD_HEIGHT
    neck = _HEAD_JOINT - _NECK_BASE
    heel, ball, toes = FOOT_SHARES
    return Body(
        name=f"{height:g} m" if name is None else name,
        height=height,
        thigh=(_HIP_HEIGHT - _KNEE_HEIGHT) * leg * height,
        shin=(_KNEE_HEIGHT - _ANKLE_HEIGHT) * leg * height,
        foot=Foot(_ANKLE_HEIGHT * height, heel * foot, ball * foot, toes * foot),
        hip_width=_HIP_WIDTH * height,
        trunk=(1.0 - hip - neck - head) * height,
        neck=neck * height,
        head=head * height,
        shoulder_width=_SHOULDER_WIDTH * height,
        shoulder_drop=(_NECK_BASE - _SHOULDER_HEIGHT) * height,
        upper_arm=_UPPER_ARM * arm * height,
        forearm=_FOREARM * arm * height,
        hand=_HAND * arm * height,
        mass=mass_from_height(height) if mass is None else mass,
        spine_segments=spine_segments,
    )


def mass_from_height(height: float) -> float:
    """Usual mass of a person ``height`` meters tall, kilograms.

    Body mass index 22.5 kg/m² from 1.5 m up, the middle of the healthy range of adults
    (18.5-25); 15.5 up to 1.2 m, about the median of children of three to eight years in growth
    charts (from memory); a smooth step between.
    """
    u = (height - _CHILD_BMI_UP_TO) / (ADULT_FROM - _CHILD_BMI_UP_TO)
    u = min(max(u, 0.0), 1.0)
    step = u * u * (3.0 - 2.0 * u)
    return (_CHILD_BMI + (_ADULT_BMI - _CHILD_BMI) * step) * height**2


def height_from_leg(leg_length: float) -> float:
    """Stature at which :func:`body_from_height` has this thigh + shin, meters.

    Raises
    ------
    InvalidInputError
        If no stature from 0.8 to 2.3 m has such legs.
    """
    leg_length = number("leg length", leg_length, "meters")
    low, high = (body_from_height(h).leg_length for h in (SHORTEST, TALLEST))
    if not low <= leg_length <= high:
        raise InvalidInputError(
            f"thigh + shin must be from {low:.3f} to {high:.3f} meters to tell the height, "
            f"got {leg_length:g}: give the height as well"
        )
    adult = leg_length / (_HIP_HEIGHT - _ANKLE_HEIGHT)
    if adult >= ADULT_FROM:
        return adult
    shortest, tallest = SHORTEST, ADULT_FROM
    for _ in range(60):  # bisection: leg length rises with height
        middle = 0.5 * (shortest + tallest)
        if body_from_height(middle).leg_length < leg_length:
            shortest = middle
        else:
            tallest = middle
    return 0.5 * (shortest + tallest)
