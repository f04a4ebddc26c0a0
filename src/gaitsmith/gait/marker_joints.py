"""Joint centers and feet from markers on the skin, walking along +Z over the ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, SIDES, UP
from gaitsmith.errors import InfeasibleError
from gaitsmith.gait.marker_names import Point, has_pelvis, legs_in, points_of
from gaitsmith.geometry.rotations import about, rotate
from gaitsmith.geometry.signals import butterworth_zero_lag

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.motion.motion import Markers

#: Hz of the low-pass for noisy paths, and the least rate at which it is used.
CUTOFF, LEAST_RATE = 7.0, 48.0
#: Meters of noise in a coordinate, by its fourth differences, from which a path is noisy.
NOISY = 0.0006
#: Hip joint centers in the frame of the pelvis, origin between the ASIS: behind by a share of
#: the pelvic depth (between the middles of ASIS and PSIS), below and aside by shares of the
#: pelvic width (between the ASIS), each with a constant, meters. Harrington et al. 2007,
#: J. Biomech. 40:595-602, the equations of one variable each (adults and children).
_BACK, _DOWN, _ASIDE = (0.24, 0.0099), (0.30, 0.0109), (0.33, 0.0073)
#: The trochanter's marker lies so much outside the hip joint, share of leg length: half of
#: Drillis & Contini's bitrochanteric width less half of our hip width, 0.045 of stature.
_TROCHANTER = 0.092
#: A belt slower than this is none, m/s; a walk that gets ahead at more than this share of the
#: speed of its bearing feet is over ground.
_BELT, _OVER_GROUND = 0.25, 0.4
#: Share of frames in which ball or heel of a foot is low: less than any stance.
_LOW = 0.35


@dataclass(frozen=True, eq=False)
class MarkerLeg:
    """One leg, ``(F, 3)`` meters: joint centers and points of the foot.

    Attributes
    ----------
    hip, knee, ankle, heel, ball, tip
        ``tip`` is None without a marker on the toes.
    aim
        Point ahead of the heel in the middle of the foot, None if no marker tells.
    """

    hip: Float[np.ndarray, "F 3"]
    knee: Float[np.ndarray, "F 3"]
    ankle: Float[np.ndarray, "F 3"]
    heel: Float[np.ndarray, "F 3"]
    ball: Float[np.ndarray, "F 3"]
    tip: Float[np.ndarray, "F 3"] | None
    aim: Float[np.ndarray, "F 3"] | None

    @property
    def length(self) -> float:
        """Hip to ankle along the bones, mean, meters."""
        thigh, shin = self.knee - self.hip, self.ankle - self.knee
        return float((np.linalg.norm(thigh, axis=-1) + np.linalg.norm(shin, axis=-1)).mean())


@dataclass(frozen=True, eq=False)
class MarkerWalker:
    """Who wears the markers, walking along +Z over the ground.

    Attributes
    ----------
    legs
        By side; one or both.
    tilt
        ``(F,)`` how far the pelvis leans forward, radians, or None if it is not told.
    speed
        Of the walk, m/s.
    rate
        Frames per second.
    flat
        Whether the table is sagittal: x is 0.
    """

    legs: dict[int, MarkerLeg]
    tilt: Float[np.ndarray, "F"] | None
    speed: float
    rate: float
    flat: bool

    def turned(self, heading: float) -> MarkerWalker:
        """The same, the direction ``heading`` turned to +Z."""
        turn = about("y", -heading)
        legs = {
            side: MarkerLeg(
                *(rotate(turn, p) for p in (g.hip, g.knee, g.ankle, g.heel, g.ball)),
                tip=None if g.tip is None else rotate(turn, g.tip),
                aim=None if g.aim is None else rotate(turn, g.aim),
            )
            for side, g in self.legs.items()
        }
        return MarkerWalker(legs, self.tilt, self.speed, self.rate, self.flat)


def walker_of(markers: Markers, unsaid: int, notes: list[str]) -> MarkerWalker:
    """Joint centers of whoever wears ``markers``.

    Parameters
    ----------
    markers
        Any names, any direction, over ground or on a treadmill.
    unsaid
        Side to take where the names say none.
    notes
        What is done to the data is added.

    Raises
    ------
    InfeasibleError
        If there is no whole leg, or nobody walks.
    """
    points = points_of(markers.names)
    sides = legs_in(points, markers.names)
    if len(markers.positions) < 8:
        raise InfeasibleError(
            f"{len(markers.positions)} frames of markers are no stride; one needs about 1.2 s"
        )
    paths = _smooth(markers, points, notes)
    if sides == [None]:
        notes.append(f"the markers name no side: taken as the {SIDES[unsaid]} leg")
        paths |= {(unsaid, role): path for (side, role), path in paths.items() if side is None}
    found = [unsaid if side is None else side for side in sides]
    flat = bool((markers.positions[..., 0] == 0.0).all())
    paths, speed = _over_ground(paths, found, markers.rate, notes)
    if not flat and _left_handed(paths):
        notes.append("left is on the right of the walk: left-handed axes, seen in a mirror")
        paths = {point: path * [-1.0, 1.0, 1.0] for point, path in paths.items()}
    hips, tilt = _hips(paths, found, flat, notes)
    legs = {side: _leg(paths, side, hips[side], flat) for side in found}
    return MarkerWalker(legs, tilt, speed, markers.rate, flat)


def _smooth(
    markers: Markers, points: dict[Point, str], notes: list[str]
) -> dict[Point, Float[np.ndarray, "F 3"]]:
    """Paths of the points, low-passed if they are noisy."""
    paths = {point: markers[name] for point, name in points.items()}
    if markers.rate < LEAST_RATE:
        return paths
    noise = [_noise(path) for path in paths.values()]
    if float(np.median(noise)) < NOISY:
        return paths
    notes.append(f"noisy paths: low-pass of {CUTOFF:g} Hz, no lag")
    return {
        point: butterworth_zero_lag(path, cutoff=CUTOFF, rate=markers.rate)
        for point, path in paths.items()
    }


def _noise(path: Float[np.ndarray, "F 3"]) -> float:
    """Standard deviation of the noise in a path's coordinates, meters.

    The fourth difference of white noise has 70 times its variance; a walk's is next to nothing.
    """
    moving = path[:, np.ptp(path, axis=0) > 0.0]
    return float(np.sqrt((np.diff(moving, n=4, axis=0) ** 2).mean() / 70.0)) if moving.size else 0.0


def _ball(paths: dict[Point, Float[np.ndarray, "F 3"]], side: int) -> list[str]:
    """Roles whose mean is the ball of the foot, the best that there are."""
    for roles in (("mt1", "mt5"), ("ball",), ("mt2",), ("mt3",), ("mt5",), ("mt1",), ("mt4",)):
        if all((side, role) in paths for role in roles):
            return list(roles)
    return ["toe"]


def _mean(
    paths: dict[Point, Float[np.ndarray, "F 3"]], side: int, roles: list[str]
) -> Float[np.ndarray, "F 3"]:
    return np.mean([paths[side, role] for role in roles], axis=0)


def _over_ground(
    paths: dict[Point, Float[np.ndarray, "F 3"]],
    sides: list[int],
    rate: float,
    notes: list[str],
) -> tuple[dict[Point, Float[np.ndarray, "F 3"]], float]:
    """The paths along +Z, carried by the belt's speed where they do not get ahead; the speed.

    The belt moves as the bearing feet do, backward.
    """
    low = list[np.ndarray]()
    for side in sides:
        ball = _mean(paths, side, _ball(paths, side))
        velocity = np.gradient(ball, axis=0)[:, [0, 2]] * rate
        bears, heel = (
            path[:, 1] <= np.quantile(path[:, 1], _LOW) for path in (ball, paths[side, "heel"])
        )
        # a flat foot moves as the belt does, one that rolls lags; who walks on the toes has none
        flat = bears & heel
        if flat.sum() >= 5:
            tilt = np.abs(np.gradient(ball[:, 1] - paths[side, "heel"][:, 1]))
            bears = flat & (tilt <= np.median(tilt[flat]))
        low.append(velocity[bears])
    belt = np.median(np.concatenate(low), axis=0)
    trunk = _mean(paths, sides[0], _trunk(paths, sides[0]))[:, [0, 2]]
    time = np.arange(len(trunk)) / rate
    net = (trunk[-1] - trunk[0]) / time[-1]
    pace = float(np.hypot(*belt))
    if pace >= _BELT and np.hypot(*net) <= _OVER_GROUND * pace:
        notes.append(f"walks on a treadmill: carried over the ground at {pace:.2f} m/s")
        shift = np.zeros((len(time), 3))
        shift[:, [0, 2]] = time[:, None] * belt
        paths = {point: path - shift for point, path in paths.items()}
        trunk = trunk - shift[:, [0, 2]]
        net = -belt
    window = min(len(trunk) - 1, max(1, round(rate)))
    speed = np.linalg.norm(trunk[window:] - trunk[:-window], axis=-1) * rate / window
    speed = float(np.quantile(speed, 0.75))
    if speed < 0.1:
        raise InfeasibleError("nobody walks in this clip: the hips hardly get ahead")
    turn = about("y", -float(np.arctan2(*net)))
    return {point: rotate(turn, path) for point, path in paths.items()}, speed


def _left_handed(paths: dict[Point, Float[np.ndarray, "F 3"]]) -> bool:
    """Whether what is left, or on the outside of a leg, is on the wrong side of it."""

    def beside(one: Point, other: Point) -> list[float]:
        there = one in paths and other in paths
        return [float((paths[one] - paths[other])[:, 0].mean())] if there else []

    apart = [
        d for role in ("asis", "hip", "hip center") for d in beside((LEFT, role), (RIGHT, role))
    ]
    if not apart:
        pairs = (("knee", "knee medial"), ("ankle", "ankle medial"), ("mt5", "mt1"))
        apart = [
            float(SIDE_SIGN[side]) * d
            for side in (LEFT, RIGHT)
            for outer, inner in pairs
            for d in beside((side, outer), (side, inner))
        ]
    return bool(apart) and float(np.mean(apart)) < 0.0


def _trunk(paths: dict[Point, Float[np.ndarray, "F 3"]], side: int) -> list[str]:
    """A marker of the side that gets ahead evenly."""
    return [next(r for r in ("hip center", "hip", "asis", "psis", "knee") if (side, r) in paths)]


def _hips(
    paths: dict[Point, Float[np.ndarray, "F 3"]],
    sides: list[int],
    flat: bool,
    notes: list[str],
) -> tuple[dict[int, Float[np.ndarray, "F 3"]], Float[np.ndarray, "F"] | None]:
    """Hip joint centers, and how far the pelvis leans forward if its markers tell."""
    if all((side, "hip center") in paths for side in sides):
        return {side: paths[side, "hip center"] for side in sides}, None
    if not flat and has_pelvis(paths):
        left, right = paths[LEFT, "asis"], paths[RIGHT, "asis"]
        if (LEFT, "psis") in paths and (RIGHT, "psis") in paths:
            behind = 0.5 * (paths[LEFT, "psis"] + paths[RIGHT, "psis"])
        else:
            behind = next(p for (_, role), p in paths.items() if role == "sacrum")
        notes.append("hip joint centers from ASIS and PSIS by Harrington et al. 2007")
        return _harrington(left, right, behind)
    out = dict[int, np.ndarray]()
    for side in sides:
        path = np.array(paths[side, "hip"])
        if not flat:
            leg = np.linalg.norm(path - paths[side, _first(paths, side, "ankle")], axis=-1).max()
            path[:, 0] -= SIDE_SIGN[side] * _TROCHANTER * leg
        out[side] = path
    return out, None


def _harrington(
    left: Float[np.ndarray, "F 3"],
    right: Float[np.ndarray, "F 3"],
    behind: Float[np.ndarray, "F 3"],
) -> tuple[dict[int, Float[np.ndarray, "F 3"]], Float[np.ndarray, "F"]]:
    middle = 0.5 * (left + right)
    across = left - right
    width = float(np.linalg.norm(across, axis=-1).mean())
    x = across / np.linalg.norm(across, axis=-1, keepdims=True)
    front = middle - behind
    depth = float(np.linalg.norm(front, axis=-1).mean())
    z = front - (front * x).sum(-1, keepdims=True) * x
    z = z / np.linalg.norm(z, axis=-1, keepdims=True)
    y = np.cross(z, x)
    back = _BACK[0] * depth + _BACK[1]
    down, aside = (share * width + more for share, more in (_DOWN, _ASIDE))
    base = middle - back * z - down * y
    lean = np.arcsin(np.clip(-(z @ UP), -1.0, 1.0))
    return {side: base + SIDE_SIGN[side] * aside * x for side in (LEFT, RIGHT)}, lean


def _first(paths: dict[Point, Float[np.ndarray, "F 3"]], side: int, joint: str) -> str:
    return next(r for r in (f"{joint} center", joint, f"{joint} medial") if (side, r) in paths)


def _leg(
    paths: dict[Point, Float[np.ndarray, "F 3"]],
    side: int,
    hip: Float[np.ndarray, "F 3"],
    flat: bool,
) -> MarkerLeg:
    def joint(name: str) -> Float[np.ndarray, "F 3"]:
        both = [name, f"{name} medial"]
        if (side, f"{name} center") not in paths and all((side, r) in paths for r in both):
            return _mean(paths, side, both)
        return paths[side, _first(paths, side, name)]

    roles = _ball(paths, side)
    ball = _mean(paths, side, roles)
    tip = paths.get((side, "toe")) if roles != ["toe"] else None
    aim = ball
    if len(roles) == 1 and roles[0] not in ("toe", "mt2", "mt3"):
        # beside the middle of the foot, as a marker on the big toe is on the other side
        aim = 0.5 * (ball + tip) if tip is not None else ball if roles == ["ball"] else None
    return MarkerLeg(
        hip, joint("knee"), joint("ankle"), paths[side, "heel"], ball, tip, None if flat else aim
    )
