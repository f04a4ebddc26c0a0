"""A path becomes footsteps, [KB92a] section 3: alternate sides, half a step width beside it.

Where the path bends, steps get shorter and slower, as people's do, and the turn of one step is
limited. A *stretched* arc length, longer than the real one in curves, does it: steps are laid
out over it as over a straight line, so that on a straight path nothing changes at all.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import one_of
from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, leftward
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.ground import Flat
from gaitsmith.plan.course import course_change, course_gaze, course_lean, lean_lever
from gaitsmith.plan.footholds import tread, treads_near
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.lengths import (
    EASED_DURATION,
    MOST_STEPS,
    PATH_SPACING,
    Stance,
    stride_lengths,
)
from gaitsmith.plan.rhythm import Rhythm
from gaitsmith.plan.slopes import slope_along, speed_share, step_length_share

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Body
    from gaitsmith.conventions import StepKind
    from gaitsmith.ground import Ground
    from gaitsmith.plan.legs import Legs
    from gaitsmith.plan.pace import Pace
    from gaitsmith.plan.paths import Path

#: Radius below which people slow down, meters; their speed goes with the cube root of it
#: (Vieilledent 2001 and others: v ~ k^(-1/3)); a 90 deg corner of 0.6 m is walked at 0.58.
FREE_RADIUS = 3.0
#: Power of the slowing that goes to the step length, the rest to the cadence: linear speed
#: follows step length more (Grasso).
LENGTH_SHARE = 0.7
#: Turn of one step, radians, that steps are shortened for, and beyond which none is planned.
USUAL_TURN, LARGEST_TURN = float(np.radians(40.0)), float(np.radians(60.0))
#: Shortest step over the usual one that a curve may ask for.
SHORTEST = 0.15
#: Meters that the feet are set farther apart per radian of turn in one step.
WIDENED = 0.06
#: How far a foot may be set across the other one between opposite curves, over the step width, and
#: how often the lean is evened for that.
MOST_ACROSS, EVENINGS = 1.0, 40
#: Cells of the stretched arc length, meters.
CELL = 0.02


@dataclass(frozen=True, eq=False)
class _Stretch:
    """Arc length and stretched arc length side by side, and the slowing on the way.

    ``lasting``: how much longer than on the level steps take for the slope; None: level.
    """

    along: Float[np.ndarray, "K"]
    stretched: Float[np.ndarray, "K"]
    slowing: Float[np.ndarray, "K"]
    lasting: Float[np.ndarray, "K"] | None = None

    @property
    def whole(self) -> float:
        return float(self.stretched[-1])

    def real(self, stretched: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """Arc lengths; straight on outside."""
        if len(self.along) == 2:
            return stretched
        inside = np.interp(stretched, self.stretched, self.along)
        over = np.maximum(stretched - self.whole, 0.0) + np.minimum(stretched, 0.0)
        return inside + over


def follow(
    path: Path,
    *,
    pace: Pace,
    stance: Stance,
    ground: Ground,
    body: Body | None = None,
    outside: bool = True,
    start: str = "stand",
    stop: str = "stand",
    keep_cadence: bool = False,
    keep_length: bool = False,
    rhythm: Rhythm | None = None,
    stature: float = 1.75,
    first: int = RIGHT,
    legs: Legs | None = None,
) -> StepPlan:
    """Footsteps along ``path``.

    Parameters
    ----------
    path
        Where to walk.
    pace
        Steady step length and cadence, on straight parts.
    stance
        Step width and toe-out.
    ground
        Gives the height of every footstep.
    body
        Whose feet are set; None: on level ground any.
    outside
        The body leans into curves: the feet are set so far outside that the hips stay over the
        path. Else they are set on both sides of the path, as [KB92a] does.
    start, stop
        ``"stand"``: feet side by side, the middle of both N on the end point. ``"walk"``: frame
        0 is a heel strike at the first point; the end is the last heel strike on the path.
    keep_cadence
        Slow down in curves, and on slopes, by shorter steps alone.
    keep_length
        Steps do not get shorter on slopes ([SM01] Eqs. 11-12).
    rhythm
        What makes steps unequal; None: nothing. Those that start, stop or fit the end are left
        as they are, and the way is kept.
    stature
        Of who walks, meters: for how much step widths vary.
    first
        Side of the foot that lands first.
    legs
        Where on the way steps are shorter, quicker or slower than the pace's own; None: nowhere.

    Raises
    ------
    InfeasibleError
        If the path is too short, or turns so sharply that no step may be planned there.
    """
    one_of("start", start, ("stand", "walk"))
    one_of("stop", stop, ("stand", "walk"))
    if path.length / pace.step_length > MOST_STEPS:
        raise InvalidInputError(
            f"distance {path.length:g} m takes more than {MOST_STEPS} steps of "
            f"{pace.step_length:.3f} m; walk it in parts"
        )
    power = 1.0 if keep_cadence else LENGTH_SHARE
    stretch = _stretch(path, pace.step_length, power, legs)
    if not isinstance(ground, Flat):
        stretch = _sloping(stretch, path, ground, pace.step_length, keep_length=keep_length)
    rhythm = rhythm or Rhythm()
    trodden = None
    if body is not None and treads_near(path, stance, ground, body):
        share = np.diff(stretch.along) / np.diff(stretch.stretched)
        trodden = tread(
            path,
            length=pace.step_length,
            stance=stance,
            ground=ground,
            body=body,
            stop=stop,
            first=first,
            share=share,
        )
        real = trodden.along
    else:
        real = _landings(path, stretch, pace.step_length, start, stop, rhythm)[1]
    kinds: list[StepKind] = ["walk"] * (len(real) - 1)
    if start == "stand":
        kinds[0] = "start"
        along = np.concatenate([[0.0], real])
    else:
        along = np.concatenate([[-pace.step_length], real])
    if stop == "stand":
        kinds.append("stop")
        along[-1] = path.length
        along = np.concatenate([along, along[-1:]])
    eased = np.array([EASED_DURATION if kind != "walk" else 1.0 for kind in kinds])
    middle = 0.5 * (along[2:] + along[1:-1])
    if legs is not None:
        eased = eased * legs.duration_at(middle)
    if power < 1.0 and len(stretch.along) > 2:
        eased = eased * np.interp(middle, stretch.along, stretch.slowing) ** (power - 1.0)
        if stretch.lasting is not None and (trodden is None or not ground.stepped):
            eased = eased * np.interp(middle, stretch.along, stretch.lasting)
    if trodden is not None and ground.stepped and not keep_cadence:
        eased[: len(trodden.lasting)] *= trodden.lasting
    # the first to land is the right one; so mid-walk it is the rear one
    side = np.arange(len(along)) % 2
    side[2:] = 1 - side[2:]
    side[:2] = [LEFT, RIGHT] if start == "stand" else [RIGHT, LEFT]
    if first == LEFT:
        side = 1 - side
    steady = np.array([kind == "walk" for kind in kinds])
    if not rhythm.even:
        eased = eased * rhythm.factors(side[2:], steady)[1]
    time = np.concatenate([[0.0, 0.0], np.cumsum(eased * pace.step_duration)])
    direction = path.heading_at(along)
    count = max(2, int(np.ceil((path.length - min(along[0], 0.0)) / PATH_SPACING)) + 1)
    shown = np.linspace(float(min(along[0], 0.0)), path.length, count)
    lean, drawn_in = _lean(path, along, time, pace, start), 0.0
    middle = path.at(along)
    if trodden is not None:
        lean = np.zeros(len(along))  # feet are where there is ground for them
    if body is not None and outside and lean.any():
        lever = lean_lever(body)
        between = leftward(0.5 * (direction[1:] + direction[:-1]))[:, [0, 2]]
        own = SIDE_SIGN[side[1:]] * (np.diff(middle, axis=0) * between).sum(-1)
        room = ((1.0 + MOST_ACROSS) * stance.width + own) / lever
        room[side[1:] == side[:-1]] = np.inf  # the foot that starts goes beside itself
        lean = _uncrossed(lean, SIDE_SIGN[side], room, stop)
        beyond = leftward(direction)[:, [0, 2]]
        middle = middle - (lever * lean)[:, None] * beyond
        # the feet's own line comes in from outside as the lean goes; the hips stay on the path
        drawn_in = np.arctan(lever * course_change(lean, middle))
    width = np.full(len(along), stance.width)
    if trodden is None:
        width = stance.width + _widening(direction, kinds, stance)
    position = np.stack([middle[:, 0], np.zeros(len(along)), middle[:, 1]], axis=-1)
    steady[-2:] &= stop == "walk"  # both feet stand where the way ends
    beside = 0.5 * width + _aside(rhythm, stance, stature, np.append([False, False], steady))
    position += (beside * SIDE_SIGN[side])[:, None] * leftward(direction)
    position[:, 1] = ground.height(position[:, 0], position[:, 2])
    return StepPlan(
        side=side,
        position=position,
        heading=direction + SIDE_SIGN[side] * np.array(stance.toe_out)[side],
        direction=direction - drawn_in,
        time=time,
        kinds=tuple(kinds),
        path=path.at(shown),
        middle=middle,
        lean=lean,
        gaze=np.zeros(len(along)) if path.straight else course_gaze(path.heading_at, along),
    )


def _aside(
    rhythm: Rhythm, stance: Stance, stature: float, free: Bool[np.ndarray, "N"]
) -> Float[np.ndarray, "N"]:
    """Meters that footsteps vary outward; never so far in that the feet would touch."""
    if not rhythm.variation:
        return np.zeros(len(free))
    return np.where(free, np.maximum(rhythm.aside(len(free), stature), -0.2 * stance.width), 0.0)


def _landings(
    path: Path, stretch: _Stretch, length: float, start: str, stop: str, rhythm: Rhythm
) -> tuple[list[float], Float[np.ndarray, "n"]]:
    """Stretched step lengths, and the arc lengths at which the steps land."""
    real, sharp = np.zeros(2), np.zeros(1, dtype=np.int64)
    for _ in range(30):
        lengths = stride_lengths(stretch.whole, length, start, stop)
        lengths = lengths if rhythm.even else _unequal(lengths, length, rhythm)
        real = stretch.real(np.cumsum([0.0, *lengths]))
        sharp = np.flatnonzero(np.abs(np.diff(path.heading_at(real))) > LARGEST_TURN)
        if not sharp.size:
            return lengths, real
        stretch = _denser(stretch, real, sharp, length, path)
    raise _too_sharp(path, float(real[sharp[0]]), float(real[sharp[0] + 1]))


def _unequal(lengths: list[float], length: float, rhythm: Rhythm) -> list[float]:
    """Full steps made unequal, the way they take together kept."""
    real = np.array(lengths)
    full = np.abs(real - length) < 1e-9
    if full.sum() < 2:
        return lengths
    side = (np.arange(len(real)) + RIGHT) % 2  # the first to land is the right one
    factor, _ = rhythm.factors(side, full)
    uneven = np.where(full, length * factor, real)
    uneven[full] *= real[full].sum() / uneven[full].sum()
    return uneven.tolist()


def count_steps(path: Path, pace: Pace, *, keep_cadence: bool = False) -> int:
    """Steps that :func:`follow` takes from standing to standing, but for very sharp bends."""
    stretch = _stretch(path, pace.step_length, 1.0 if keep_cadence else LENGTH_SHARE)
    return len(stride_lengths(stretch.whole, pace.step_length, "stand", "stand")) + 1


def curve_share(path: Path, pace: Pace, *, keep_cadence: bool = False) -> float:
    """Shortest step that the curves of ``path`` allow over the pace's own; 1 where none do."""
    stretch = _stretch(path, pace.step_length, 1.0 if keep_cadence else LENGTH_SHARE)
    rise = np.diff(stretch.stretched)
    return float(np.min(np.diff(stretch.along) / rise))


def _stretch(path: Path, length: float, power: float, legs: Legs | None = None) -> _Stretch:
    """How much each part of the path is stretched: the usual step over the one it allows."""
    ends = np.array([0.0, path.length])
    if path.straight and legs is None:
        return _Stretch(ends, ends, np.ones(2))
    s = np.linspace(0.0, path.length, int(np.ceil(path.length / CELL)) + 1)
    own = np.ones(len(s)) if legs is None else legs.length_at(s)
    if path.straight:
        return _of_share(s, own, np.ones(len(s)))
    # how much the path turns, either way, over a step's length around each cell
    bends = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path.heading_at(s))))])
    reach = 0.5 * length
    turn = np.interp(s + reach, s, bends) - np.interp(s - reach, s, bends)
    smooth = np.concatenate([[0.0], np.cumsum(0.5 * (turn[1:] + turn[:-1]) * np.diff(s))])
    low, high = np.maximum(s - reach, 0.0), np.minimum(s + reach, path.length)
    turn = (np.interp(high, s, smooth) - np.interp(low, s, smooth)) / (high - low)
    slowing = np.minimum(1.0, (length / (np.maximum(turn, 1e-9) * FREE_RADIUS)) ** (1.0 / 3.0))
    share = np.minimum(own * slowing**power, USUAL_TURN / np.maximum(turn, 1e-9))
    return _of_share(s, np.maximum(share, SHORTEST * own), slowing)


def _sloping(
    stretch: _Stretch, path: Path, ground: Ground, length: float, *, keep_length: bool
) -> _Stretch:
    """``stretch`` with the share that slopes leave of a step, and the time they add."""
    nodes = int(np.ceil(path.length / CELL)) + 1
    s = stretch.along if len(stretch.along) > 2 else np.linspace(0.0, path.length, nodes)
    slope = slope_along(path, ground, s, length)
    own = np.ones(len(s)) if keep_length else step_length_share(slope)
    slowing = np.interp(s, stretch.along, stretch.slowing)
    curve = np.ones(len(s))
    if len(stretch.along) > 2:
        curve = 1.0 / np.maximum(np.gradient(stretch.stretched, s), 1e-9)
    out = _of_share(s, np.maximum(curve * own, SHORTEST), slowing)
    return replace(out, lasting=own / speed_share(slope))


def _of_share(s: np.ndarray, share: np.ndarray, slowing: np.ndarray) -> _Stretch:
    """``share``: step length over the usual one at each node."""
    more = 0.5 * (1.0 / share[1:] + 1.0 / share[:-1]) * np.diff(s)
    return _Stretch(s, np.concatenate([[0.0], np.cumsum(more)]), slowing)


def _denser(
    stretch: _Stretch, real: np.ndarray, sharp: np.ndarray, length: float, path: Path
) -> _Stretch:
    """More steps where one would turn too far."""
    s = stretch.along
    share = 1.0 / np.maximum(np.gradient(stretch.stretched, s), 1e-9)
    for i in sharp:
        here = (s >= real[i] - 0.5 * length) & (s <= real[i + 1] + 0.5 * length)
        share = np.where(here, 0.8 * share, share)
        if share[here].min(initial=1.0) < SHORTEST / 2.0:
            raise _too_sharp(path, float(real[i]), float(real[i + 1]))
    return replace(_of_share(s, share, stretch.slowing), lasting=stretch.lasting)


def _too_sharp(path: Path, first: float, last: float) -> InfeasibleError:
    s = np.linspace(first, last, 65)
    rates = np.abs(np.diff(path.heading_at(s))) / np.maximum(np.diff(s), 1e-9)
    where = path.at(np.array([s[int(rates.argmax())]]))[0]
    turn = abs(float(np.diff(path.heading_at(np.array([first, last])))[0]))
    return InfeasibleError(
        f"the path turns by {np.degrees(turn):.0f} deg at "
        f"({where[0] + 0.0:.2f}, {where[1] + 0.0:.2f}), more "
        f"than the {np.degrees(LARGEST_TURN):.0f} deg that one step can turn, however short; "
        "round the corner (0.6 m is walked well) or set a stop there"
    )


def _lean(
    path: Path, along: np.ndarray, time: np.ndarray, pace: Pace, start: str
) -> Float[np.ndarray, "N"]:
    """Tangent of the lean at each footstep, from the path's own curvature over a stride."""
    if path.straight:
        return np.zeros(len(along))
    reach = 0.5 * pace.step_length
    s = along[:, None] + np.linspace(-1.0, 1.0, 9) * reach
    mean = path.turned((s - reach).ravel(), (s + reach).ravel()).reshape(s.shape)
    curvature = mean @ (np.array([0, 1, 2, 3, 4, 3, 2, 1, 0]) / 16.0)
    lean = course_lean(path.heading_at(along), np.diff(along), time, curvature)
    if start == "walk":  # the first two stand where the path has them
        lean[:2] = 0.0
    return lean


def _uncrossed(
    lean: Float[np.ndarray, "N"],
    sign: Float[np.ndarray, "N"],
    room: Float[np.ndarray, "N-1"],
    stop: str,
) -> Float[np.ndarray, "N"]:
    """``lean`` evened where its change would set a foot far across the other one.

    Feet are set outside by as much as the body leans; from one fast curve into its opposite that
    may be more in one step than they stand apart. ``room`` is the largest change of the tangent
    that each step may have towards the other foot's side.
    """
    free = np.ones(len(lean), dtype=np.bool_)
    free[:2] = False
    free[-2:] = stop == "walk"
    out = lean
    for _ in range(EVENINGS):
        # feet are set to the right as the lean goes to the left
        over = np.maximum(sign[1:] * np.diff(out) - room, 0.0) * (free[1:] | free[:-1])
        if not over.any():
            break
        both = np.where(free[1:] & free[:-1], 0.5, 1.0) * over * sign[1:]
        move = np.zeros_like(out)
        move[1:] -= both
        move[:-1] += both
        out = np.where(free, out + move, out)
    return out


def _widening(
    direction: Float[np.ndarray, "N"], kinds: list[StepKind], stance: Stance
) -> Float[np.ndarray, "N"]:
    """Meters that each footstep is set wider, for the turn of the steps around it."""
    turn = np.abs(np.diff(direction))
    around = np.zeros(len(direction))
    around[1:-1] = 0.5 * (turn[1:] + turn[:-1])
    if kinds[-1] == "stop":
        around[-2] = 0.0
    around[:2] = 0.0
    return WIDENED * around


__all__ = ["Stance", "count_steps", "curve_share", "follow"]
