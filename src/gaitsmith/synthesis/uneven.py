"""Any walker on any ground: it walks level, and is lifted onto the ground step by step."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.contact import StepCurves
from gaitsmith.contact.standing import standing
from gaitsmith.conventions import HEEL, LOCAL_KINDS, UP, ahead
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import exp, log, multiply
from gaitsmith.synthesis.overlay import upper_joints
from gaitsmith.synthesis.step import BatchGenerator, PreparedStep, TabledStep, WalkerState
from gaitsmith.synthesis.uphill import heel_rises, held_back, holding, with_risen_heels

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Body
    from gaitsmith.contact import ReferenceStep
    from gaitsmith.contact.foothold import Footholds
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import Footstep, PlannedStep
    from gaitsmith.synthesis.step import StepGenerator

#: Lean of the trunk over the slope: forward uphill (0.5-0.8), backward downhill (0.1-0.3);
#: the pelvis has half of it.
LEAN_UP, LEAN_DOWN, PELVIS_SHARE = 0.6, 0.2, 0.5
#: Part of the pitch of a landing sole that a slope (rise per meter) takes away uphill: midfoot
#: contact from about 15 deg.
MOST_FLAT, FLAT_SLOPE = 0.85, 0.27
#: Rises over the leg: a foot lands flat on a step up of this; down, heel first up to the first,
#: ball first from the second on (kerbs and drops: 5-15 cm, 25 cm), with soles so steep.
FLAT_RISE, HEEL_FIRST, BALL_FIRST, TOES_DOWN = 0.08, 0.10, 0.20, float(np.radians(17.0))
#: A sole that would land flatter lands flat.
NEARLY_FLAT = float(np.radians(2.5))
#: Part of the step in which a heel comes down after the ball.
HEEL_DOWN = 0.3
#: The heel that stays above on a deep step comes up so much more (radians).
HEEL_UP = float(np.radians(24.0))
#: The same in steps that turn or go aside: toes that bend farther would have to be quick.
HEEL_UP_ASIDE = float(np.radians(18.0))
#: Part of the height of what one foot alone steps on that the hips do not rise: its knee bends.
SPARED = 0.25
#: A lower rise (m) is no step.
LEAST_STEP = 0.02


@dataclass(frozen=True, eq=False)
class Lie:
    """How the ground lies at k footsteps, as the walker takes it.

    Attributes
    ----------
    place
        ``(k, 2)`` x,z beside the footstep on the walk's line.
    level
        ``(k,)`` meters there.
    gradient
        ``(k, 2)`` rise per meter along x and z.
    slope
        ``(k,)`` rise per meter along the walk.
    rise
        ``(k,)`` meters from the footstep before, of the other foot.
    stepped
        ``(k,)`` whether an edge lies between them.
    heel_hangs
        ``(k,)`` whether there is no ground under the heel.
    level_walk
        Whether the walk knows nothing of slopes: how soles land and where hips are is yet to
        be done.
    """

    place: Float[np.ndarray, "k 2"]
    level: Float[np.ndarray, "k"]
    gradient: Float[np.ndarray, "k 2"]
    slope: Float[np.ndarray, "k"]
    rise: Float[np.ndarray, "k"]
    stepped: Bool[np.ndarray, "k"]
    heel_hangs: Bool[np.ndarray, "k"]
    level_walk: bool = True

    def plane(self, i: int, at: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n"]:
        """Height over x,z ``at`` of the plane through footstep ``i``."""
        return self.level[i] + (at - self.place[i]) @ self.gradient[i]


class UnevenGenerator:
    """Walks on ``ground`` with any generator that walks on a level floor.

    Parameters
    ----------
    inner
        Asked for the same steps, all footsteps level.
    ground
        What is walked on.
    climbs
        Whether its walk steps otherwise up and down hill by itself
        (:class:`~gaitsmith.walks.model.ClimbingWalk`).
    """

    def __init__(self, inner: StepGenerator, ground: Ground, *, climbs: bool = False) -> None:
        self._inner, self._ground, self._climbs = inner, ground, climbs

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        return self.prepare_all(body, state, [step])[0]

    def prepare_all(
        self, body: Body, state: WalkerState, steps: Sequence[PlannedStep]
    ) -> list[PreparedStep]:
        """See :meth:`gaitsmith.synthesis.step.BatchGenerator.prepare_all`."""
        feet = list({id(f): f for s in steps for f in _feet(s)}.values())
        number = {id(f): i for i, f in enumerate(feet)}
        lie, stands = _lie(steps, feet, number, body, self._ground)
        level = _levelled(steps)
        if self._climbs:
            lie = replace(lie, level_walk=False)
            level = _climbing(level, steps, lie, number)
        if isinstance(self._inner, BatchGenerator):
            prepared = self._inner.prepare_all(body, state, level)
        else:
            prepared = []
            for step in level:
                prepared.append(self._inner.prepare(body, state, step))
                state = prepared[-1].end
        picks = [[number[id(f)] for f in _feet(s)] for s in steps]
        references = [p.reference for p in prepared]
        lifted = _leaned(
            [
                _lifted(s, r, lie, pick, body)
                for s, r, pick in zip(steps, references, picks, strict=True)
            ],
            body,
        )
        behind = np.array([pick[:2] for pick in picks] + [picks[-1][1:]])
        rises = np.zeros(len(behind))
        if not self._climbs:
            rises = heel_rises(steps, references, lifted, stands, behind, body)
        kinds = [step.kind for step in steps]
        walks = np.array([kind not in LOCAL_KINDS for kind in (*kinds, kinds[-1])])
        most = np.where(walks, HEEL_UP, HEEL_UP_ASIDE)
        on_steps = lie.stepped[behind[:, 1]]
        rises[on_steps] = [
            most[k] * _heel_rise(lie, behind[k, 1], body) for k in np.flatnonzero(on_steps)
        ]
        lifted = [
            with_risen_heels(r, *two)
            for r, two in zip(lifted, pairwise(rises.tolist()), strict=True)
        ]
        return [
            TabledStep(step.duration, done.end, reference, body, self._ground)
            for step, done, reference in zip(steps, prepared, lifted, strict=True)
        ]


def _feet(step: PlannedStep) -> list[Footstep]:
    return [step.origin, step.stance, step.target]


def _levelled(steps: Sequence[PlannedStep]) -> list[PlannedStep]:
    """The same steps on a floor at height 0."""
    flat: dict[int, Footstep] = {}

    def on_floor(foot: Footstep | None) -> Footstep | None:
        if foot is None:
            return None
        if id(foot) not in flat:
            place = np.array(foot.position)
            place[1] = 0.0
            flat[id(foot)] = replace(foot, position=place)
        return flat[id(foot)]

    names = ("stance", "origin", "target", "before", "following")
    return [replace(s, **{n: on_floor(getattr(s, n)) for n in names}) for s in steps]


def _climbing(
    level: Sequence[PlannedStep],
    steps: Sequence[PlannedStep],
    lie: Lie,
    number: dict[int, int],
) -> list[PlannedStep]:
    """Level steps that know how far the walk rises between their footsteps; edges are no slope."""

    def climb(low: Footstep, high: Footstep) -> float:
        a, b = number[id(low)], number[id(high)]
        return 0.0 if lie.stepped[b] else float(lie.level[b] - lie.level[a])

    return [
        replace(flat, climbs=(climb(s.origin, s.stance), climb(s.stance, s.target)))
        for flat, s in zip(level, steps, strict=True)
    ]


def _lie(
    steps: Sequence[PlannedStep],
    feet: Sequence[Footstep],
    number: dict[int, int],
    body: Body,
    ground: Ground,
) -> tuple[Lie, Footholds]:
    """Levels beside the footsteps; slopes from one footstep to the next but one."""
    position = np.array([f.position for f in feet])
    stands = standing(position, np.array([f.heading for f in feet]), ground, body.foot)
    own = -stands.normal[:, [0, 2]] / stands.normal[:, 1:2]
    place = np.array([f.middle for f in feet])
    level = position[:, 1] + ((place - position[:, [0, 2]]) * own).sum(-1)
    way = ahead(np.array([f.direction for f in feet]))[:, [0, 2]]
    slope = (own * way).sum(-1)
    # feet side by side: one place and one level, between them
    for step in steps:
        pair = {"start": (step.origin, step.stance), "stop": (step.stance, step.target)}
        for kind, two in pair.items():
            if step.kind == kind:
                both = [number[id(f)] for f in two]
                place[both] = place[both].mean(axis=0)
                level[both], slope[both] = level[both].mean(), slope[both].mean()
    for step in steps:
        if step.kind in LOCAL_KINDS:
            continue
        a, b, c = (number[id(f)] for f in _feet(step))
        back, on = (float(((place[j] - place[i]) * way[b]).sum()) for i, j in ((a, b), (b, c)))
        if back > 1e-6 and on > 1e-6:  # the parabola through three levels
            d0, d1 = (level[b] - level[a]) / back, (level[c] - level[b]) / on
            slope[b] = (on * d0 + back * d1) / (back + on)
    across = own - (own * way).sum(-1, keepdims=True) * way
    rise, stepped = np.zeros(len(feet)), np.zeros(len(feet), dtype=np.bool_)
    for step in steps:
        b, c = (number[id(f)] for f in _feet(step)[1:])
        rise[c] = position[c, 1] - position[b, 1]
    if ground.stepped:
        stepped = np.abs(rise) > LEAST_STEP
        level = _over_boxes(steps, number, level, stepped)
    hangs = np.zeros_like(stepped) if stands.bears is None else ~stands.bears[:, HEEL]
    gradient = slope[:, None] * way + across
    return Lie(place, level, gradient, slope, rise, stepped, hangs), stands


def _over_boxes(
    steps: Sequence[PlannedStep],
    number: dict[int, int],
    level: Float[np.ndarray, "k"],
    stepped: Bool[np.ndarray, "k"],
) -> Float[np.ndarray, "k"]:
    """``level`` as the hips take it: what one foot alone steps on they rise less for."""
    out = np.array(level)
    for step in steps:
        a, b, c = (number[id(f)] for f in _feet(step))
        if step.kind == "walk" and stepped[b] and stepped[c]:
            peak = min(level[b] - level[a], level[b] - level[c])
            out[b] -= SPARED * max(peak, 0.0)
    return out


def _leaned(
    lifted: Sequence[tuple[ReferenceStep, Float[np.ndarray, "T"]]], body: Body
) -> list[ReferenceStep]:
    """Steps whose trunks lean for the slopes that go with them, all at once."""
    lean = _lean(np.concatenate([slope for _, slope in lifted]))
    if lean.any():
        curves = [step.curves for step, _ in lifted]
        pelvis, upper = leaning(
            body,
            np.concatenate([c.pelvis for c in curves]),
            np.concatenate([c.upper for c in curves]),
            lean,
        )
        first = 0
        for c in curves:
            own = slice(first, first := first + len(c.phase))
            c.pelvis[:], c.upper[:] = pelvis[own], upper[own]
    return [step for step, _ in lifted]


def _lifted(
    step: PlannedStep, reference: ReferenceStep, lie: Lie, pick: list[int], body: Body
) -> tuple[ReferenceStep, Float[np.ndarray, "T"]]:
    """``reference``, which is level, on the ground, not leaning yet; slope as the hips feel it."""
    curves = reference.curves
    at = curves.center[:, [0, 2]] + reference.origin[[0, 2]]
    base, blend = _base(step, lie, pick, at, curves.phase)
    slope = blend(lie.slope)
    lifted = StepCurves.trusted(curves.phase, np.array(curves.table))
    lifted.center[:] += base[:, None] * UP
    # hips of a walk that climbs know slopes, but no stairs
    felt = lie.slope if lie.level_walk else np.where(lie.stepped, lie.slope, 0.0)
    back = blend(held_back(felt, lie.stepped, body)) * holding(curves.phase, step.kind)
    lifted.center[:] -= back[:, None] * ahead(curves.heading)
    lifted.ankle[..., 1] += base[:, None]
    lifted.pitch[:], lifted.bend[:] = _landing(reference, lie, pick, body)
    foothold = np.array(reference.foothold)
    for foot in (step.origin, step.stance):
        foothold[foot.side] = foot.position
    out = reference.with_(curves=lifted, foothold=foothold, target=step.target.position)
    return out, slope


def _landing(
    reference: ReferenceStep, lie: Lie, pick: list[int], body: Body
) -> tuple[Float[np.ndarray, "T 2"], Float[np.ndarray, "T 2"]]:
    """Pitch of the soles and bend of the toes with feet that land as the ground asks for.

    A sole lands flatter uphill (the foot is as it was in space), flat on a step up, and ball
    first on a deep step down; then the heel comes down in the loading of the leg.
    """
    _, stance, target = pick
    side, curves, phase = reference.stance, reference.curves, reference.curves.phase
    pitch, bend = np.array(curves.pitch), np.array(curves.bend)
    own = pitch[:, side]
    lands = float(own[0])
    wanted = _landing_pitch(lands, lie, stance, body)
    own = np.where(own > 0.0, own * (max(wanted, 0.0) / lands if lands > 0.0 else 1.0), own)
    if wanted < min(lands, 0.0):
        own += (wanted - min(lands, 0.0)) * (1.0 - smoothstep(phase / HEEL_DOWN))
        bend[:, side] = np.maximum(-own - curves.meta[:, side], bend[:, side])
    pitch[:, side] = own
    if reference.toe_off < 1.0:
        u = (phase - reference.toe_off) / (1.0 - reference.toe_off)
        share = smoothstep((u - 0.3) / 0.7)
        lands = float(pitch[-1, 1 - side])
        wanted = _landing_pitch(lands, lie, target, body)
        pitch[:, 1 - side] += (wanted - lands) * share
        if wanted < 0.0:
            bend[:, 1 - side] += (-wanted - float(bend[-1, 1 - side])) * share
    return pitch, bend


def _heel_rise(lie: Lie, foot: int, body: Body) -> float:
    """How far the other heel is up as a foot comes down on a step, over the most."""
    drop = -float(lie.rise[foot]) / body.leg_length if lie.stepped[foot] else 0.0
    return float(smoothstep(drop / BALL_FIRST))


def _landing_pitch(lands: float, lie: Lie, foot: int, body: Body) -> float:
    """Pitch with which a sole lands at a footstep that would land with ``lands`` on the level."""
    if not lie.stepped[foot]:
        flatter = _flatter(float(lie.slope[foot])) if lie.level_walk else 0.0
        wanted = lands * (1.0 - flatter) if lands > 0.0 else lands
    else:
        rise = float(lie.rise[foot]) / body.leg_length
        deep = float(smoothstep((-rise - HEEL_FIRST) / (BALL_FIRST - HEEL_FIRST)))
        flat = float(smoothstep(rise / FLAT_RISE))
        wanted = lands * (1.0 - flat) * (1.0 - deep) - TOES_DOWN * deep
    wanted = min(wanted, 0.0) if lie.heel_hangs[foot] else wanted
    return wanted if abs(wanted) > NEARLY_FLAT or wanted == lands else 0.0


def _flatter(slope: float) -> float:
    """Part of the landing pitch that a slope takes away."""
    return MOST_FLAT * float(np.clip(slope / FLAT_SLOPE, 0.0, 1.0))


def _base(
    step: PlannedStep,
    lie: Lie,
    pick: list[int],
    at: Float[np.ndarray, "T 2"],
    phase: Float[np.ndarray, "T"],
) -> tuple[Float[np.ndarray, "T"], Callable[[Float[np.ndarray, "k"]], Float[np.ndarray, "T"]]]:
    """Level of the ground as the hips feel it; and what makes values at footsteps theirs too."""
    rear, stance, target = pick
    if step.kind in LOCAL_KINDS:
        first = 0.5 * (lie.plane(rear, at) + lie.plane(stance, at))
        last = 0.5 * (lie.plane(target, at) + lie.plane(stance, at))
        share = smoothstep(phase)
        return (
            (1.0 - share) * first + share * last,
            lambda values: (1.0 - share) * values[rear] + share * values[target],
        )

    def between(a: int, b: int) -> Float[np.ndarray, "T"]:
        way = lie.place[b] - lie.place[a]
        size = float(way @ way)
        if size < 1e-12:
            return np.zeros(len(at))
        return smoothstep((at - lie.place[a]) @ way / size)

    before, after = between(rear, stance), between(stance, target)
    if float(((lie.place[stance] - lie.place[rear]) ** 2).sum()) < 1e-12:
        before = np.ones(len(at))
    base = (1.0 - before) * lie.plane(rear, at) + before * lie.plane(stance, at)
    base = base + after * (lie.plane(target, at) - lie.plane(stance, at))

    def blend(values: Float[np.ndarray, "k"]) -> Float[np.ndarray, "T"]:
        early = values[rear] + before * (values[stance] - values[rear])
        return early + after * (values[target] - values[stance])

    return base, blend


def _lean(slope: Float[np.ndarray, "T"]) -> Float[np.ndarray, "T"]:
    """Forward lean of the trunk for a slope, radians."""
    angle = np.arctan(slope)
    return np.where(angle > 0.0, LEAN_UP, LEAN_DOWN) * angle


def leaning(
    body: Body,
    pelvis: Float[np.ndarray, "T 3"],
    upper: Float[np.ndarray, "T U 3"],
    lean: Float[np.ndarray, "T"],
) -> tuple[Float[np.ndarray, "T 3"], Float[np.ndarray, "T U 3"]]:
    """Pelvis and upper body leaning forward by ``lean`` radians, the head level, arms plumb."""
    if not lean.any():
        return pelvis, upper
    count = len(spine_names(body.spine_segments))
    out = np.array(upper)

    def about_left(angle: Float[np.ndarray, "T"]) -> Float[np.ndarray, "T 4"]:
        turn = np.zeros((len(angle), 3))
        turn[:, 0] = angle
        return exp(turn)

    def turned(angle: Float[np.ndarray, "T"], joint: Float[np.ndarray, "T 3"]) -> np.ndarray:
        return log(multiply(about_left(angle), exp(joint)))

    pelvis = turned(PELVIS_SHARE * lean, pelvis)
    for i in range(count):
        out[:, i] = turned((1.0 - PELVIS_SHARE) * lean / count, upper[:, i])
    for i in (count, count + 1):
        out[:, i] = turned(-0.5 * lean, upper[:, i])
    for i, name in enumerate(upper_joints(body)):
        if name.endswith("UpperArm"):
            out[:, i] = turned(-lean, upper[:, i])
    return pelvis, out
