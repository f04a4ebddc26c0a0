"""Step length, cadence and speed: any two give the third, fewer are filled in as people do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.conventions import GRAVITY
from gaitsmith.errors import InfeasibleSpeedError, InvalidInputError

if TYPE_CHECKING:
    from gaitsmith.body.body import Body

#: Froude number v^2 / (g leg) people prefer (0.20-0.25: Kuo & Donelan review; Alexander 1989).
PREFERRED_FROUDE = 0.20
#: Above this people run; above the other a walk is unusual.
LARGEST_FROUDE, UNUSUAL_FROUDE = 0.5, 0.4
#: Walk ratio, meters per (step per minute), of an adult whose hips are 0.9275 m high (1.75 m
#: tall): 0.0060-0.0072 in the literature (Sekiya & Nagasaki 1998; Murakami & Otaka 2017).
WALK_RATIO, REFERENCE_HIP = 0.0066, 0.9275
#: The three given values may disagree by this share.
AGREEMENT = 0.01


@dataclass(frozen=True)
class Pace:
    """A steady pace: ``step_length`` (m) at ``cadence`` (steps per minute)."""

    step_length: float
    cadence: float

    @property
    def speed(self) -> float:
        """Meters per second."""
        return self.step_length * self.cadence / 60.0

    @property
    def step_duration(self) -> float:
        """Seconds."""
        return 60.0 / self.cadence


def froude(body: Body, speed: float) -> float:
    """Froude number of a walk: ``v^2 / (g leg)``, leg from hip to sole."""
    return speed**2 / (GRAVITY * body.hip_height)


def walk_ratio(body: Body) -> float:
    """Step length over cadence that people keep at any speed, m per (step per minute).

    Lengths scale with the leg and cadence with its inverse square root, so the ratio scales
    with the leg to the power 3/2: equal Froude numbers give similar gaits.
    """
    return WALK_RATIO * (body.hip_height / REFERENCE_HIP) ** 1.5


def preferred_pace(body: Body) -> Pace:
    """The pace ``body`` takes when nothing is asked for."""
    speed = float(np.sqrt(PREFERRED_FROUDE * GRAVITY * body.hip_height))
    return _by_walk_ratio(walk_ratio(body), speed)


def _by_walk_ratio(ratio: float, speed: float) -> Pace:
    return Pace(float(np.sqrt(60.0 * speed * ratio)), float(np.sqrt(60.0 * speed / ratio)))


def choose_pace(
    body: Body,
    *,
    step_length: float | None = None,
    cadence: float | None = None,
    speed: float | None = None,
    usual: Pace | None = None,
) -> Pace:
    """The pace that fits what was asked for.

    ``usual`` is the pace of a gait that has one: it then is the preferred one, and its walk
    ratio is the law's. Nothing: the preferred pace. Speed alone: the walk-ratio law. Step length
    alone: the cadence goes with the square root of the length, for short steps are quick ones,
    between the constant cadence and the constant walk ratio. Cadence alone: the preferred step
    length.
    Two: the third follows. Three: they must agree within 1 %.

    Raises
    ------
    InvalidInputError
        If a value is not positive or three values contradict each other.
    InfeasibleSpeedError
        Above Froude number 0.5.
    """
    given = {
        name: positive(name, value, unit)
        for name, value, unit in (
            ("step_length", step_length, "meters"),
            ("cadence", cadence, "steps per minute"),
            ("speed", speed, "meters per second"),
        )
        if value is not None
    }
    ratio = walk_ratio(body) if usual is None else usual.step_length / usual.cadence
    usual = preferred_pace(body) if usual is None else usual
    if set(given) == {"speed"}:
        pace = _by_walk_ratio(ratio, given["speed"])
    elif set(given) == {"step_length"}:
        length = given["step_length"]
        pace = Pace(length, usual.cadence * float(np.sqrt(length / usual.step_length)))
    elif set(given) == {"cadence"}:
        pace = Pace(usual.step_length, given["cadence"])
    elif set(given) == {"step_length", "speed"}:
        pace = Pace(given["step_length"], 60.0 * given["speed"] / given["step_length"])
    elif set(given) == {"cadence", "speed"}:
        pace = Pace(60.0 * given["speed"] / given["cadence"], given["cadence"])
    elif given:
        pace = Pace(given["step_length"], given["cadence"])
        wanted = given.get("speed", pace.speed)
        if abs(pace.speed - wanted) > AGREEMENT * wanted:
            raise InvalidInputError(
                f"step length {pace.step_length:g} m at cadence {pace.cadence:g}/min is "
                f"{pace.speed:.3f} m/s, not the speed of {wanted:g} m/s asked for; give any two "
                "of the three"
            )
    else:
        pace = usual
    number = froude(body, pace.speed)
    if number > LARGEST_FROUDE:
        available = float(np.sqrt(LARGEST_FROUDE * GRAVITY * body.hip_height))
        raise InfeasibleSpeedError(
            speed=pace.speed, froude=number, limit=LARGEST_FROUDE, available=available
        )
    return pace
