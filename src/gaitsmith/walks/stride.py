"""One stride of a gait and all that walkers take from it; its part of a gait file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.gait.cycle import EVENTS, Cycle
from gaitsmith.gait.elevation import SEGMENTS, ElevationData, elevation_of
from gaitsmith.walks.files import rounded_walk_data, walk_data_from_dict, walk_data_to_dict
from gaitsmith.walks.from_cycle import walk_data_of

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.learn import Standing
    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.walks.data import WalkData

#: Digits kept after the point: a micrometer, a fifth of an arc second.
_DIGITS = 6
#: Times that unit quaternions are rounded and made unit again before they stay.
_ROUNDS = 8


@dataclass(frozen=True, eq=False)
class GaitStride:
    """A closed stride and what is walked of it.

    Attributes
    ----------
    cycle
        The whole body (the legs, where only they were measured).
    walk_data
        Steps on the left and on the right foot.
    lift
        Elevation angles of the legs, or the cycle whose they are: few walkers ask for them.
    """

    cycle: Cycle
    walk_data: tuple[WalkData, WalkData]
    lift: ElevationData | Cycle

    @cached_property
    def elevation(self) -> ElevationData:
        """Elevation angles of the legs, as a file will hold them."""
        if isinstance(self.lift, ElevationData):
            return self.lift
        found = elevation_of(self.lift)
        return ElevationData(
            rounded(found.angles),
            self.cycle.stride_length,
            self.cycle.duration,
            number_of(found.leg_length),
        )

    @property
    def ratios(self) -> tuple[float, float]:
        """Length over leg length of the steps on the [left, right] foot."""
        left, right = self.walk_data
        return left.character.ratio, right.character.ratio


def stride_of(cycle: Cycle, body: Body, feet: Standing | None = None) -> GaitStride:
    """What walkers take from ``cycle`` of ``body``, exactly as a file will hold it.

    What is walked right away and what is read from the file are then the same, to the byte.
    """
    legs = cycle.legs
    left, right = walk_data_of(legs, body, feet=feet)
    filed = cycle.with_(
        center=rounded(cycle.center),
        rotations=_settled(cycle.rotations),
        events=rounded(cycle.events),
        stride_length=number_of(cycle.stride_length),
        duration=number_of(cycle.duration),
    )
    return GaitStride(filed, (rounded_walk_data(left), rounded_walk_data(right)), legs)


def _settled(rotations: Float[np.ndarray, "K J 4"]) -> Float[np.ndarray, "K J 4"]:
    """Unit quaternions that stay what they are when a file rounds them.

    Rounded and made unit again they may be rounded otherwise.
    """
    digits = rounded(rotations)
    for _ in range(_ROUNDS):
        before, digits = digits, rounded(_unit(digits))
        if np.array_equal(digits, before):
            break
    return _unit(digits)


def _unit(rotations: Float[np.ndarray, "K J 4"]) -> Float[np.ndarray, "K J 4"]:
    return rotations / np.linalg.norm(rotations, axis=-1, keepdims=True)


def rounded(value: Any) -> Float[np.ndarray, "..."]:
    """``value`` with the digits that a gait file keeps."""
    return np.round(np.asarray(value, dtype=np.float64), _DIGITS)


def number_of(value: Any) -> float:
    """The same of one number."""
    return float(rounded(value))


def stride_to_dict(stride: GaitStride) -> dict[str, Any]:
    """``stride`` as plain JSON, but for what a whole gait says itself."""
    cycle, lift = stride.cycle, stride.elevation
    return {
        "stride_length_m": number_of(cycle.stride_length),
        "duration_s": number_of(cycle.duration),
        "events": {
            side: dict(zip(EVENTS, rounded(cycle.events[i]).tolist(), strict=True))
            for i, side in enumerate(SIDES)
        },
        "cycle": {
            "strides": cycle.strides,
            "center": rounded(cycle.center).tolist(),
            "rotations": {
                joint: rounded(cycle.rotations[:, i]).tolist()
                for i, joint in enumerate(cycle.skeleton.names)
            },
        },
        "walk_data": {
            side: walk_data_to_dict(walk)
            for side, walk in zip(SIDES, stride.walk_data, strict=True)
        },
        "elevation": {
            "leg_length_m": number_of(lift.leg_length),
            "segments": list(SEGMENTS),
            "angles": {side: rounded(lift.angles[i]).tolist() for i, side in enumerate(SIDES)},
        },
    }


def stride_from_dict(
    data: dict[str, Any], skeleton: Skeleton, *, source: str, license: str
) -> GaitStride:
    """The stride that :func:`stride_to_dict` wrote; KeyError, TypeError, ValueError if none."""
    loop = data["cycle"]
    rotations = np.stack(
        [np.array(loop["rotations"][joint], dtype=np.float64) for joint in skeleton.names], axis=1
    )
    if not (np.abs(np.linalg.norm(rotations, axis=-1) - 1.0) < 1e-3).all():
        raise ValueError("rotations must be unit quaternions")
    cycle = Cycle(
        skeleton=skeleton,
        center=np.array(loop["center"], dtype=np.float64),
        rotations=_unit(rotations),
        events=np.array([[data["events"][side][event] for event in EVENTS] for side in SIDES]),
        stride_length=data["stride_length_m"],
        duration=data["duration_s"],
        strides=loop["strides"],
        source=source,
        license=license,
    )
    left, right = (walk_data_from_dict(data["walk_data"][side]) for side in SIDES)
    lift = data["elevation"]
    elevation = ElevationData(
        np.array([lift["angles"][side] for side in SIDES]),
        cycle.stride_length,
        cycle.duration,
        lift["leg_length_m"],
    )
    return GaitStride(cycle, (left, right), elevation)
