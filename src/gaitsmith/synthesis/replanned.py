"""A planned contact that is planned anew while it is walked, and the clock that runs it.

What was shown stays as it was. From the present on, the curves of the old plan become those of
the new one by a weight that is 0 now and 1 when the swinging foot lands, with two derivatives
of 0 at both ends. Feet that bear stand on the same footholds in both plans and are placed there
in closed form, so they do not move; the distance from hip to ankle is a convex function, so what
both plans reach their mean does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.contact.step_curves import ROWS
from gaitsmith.geometry.curves import hermite, hermite_slopes, parabola_slopes, smoothstep
from gaitsmith.geometry.rotations import exp, left_of, turned_left

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.contact.apply import ContactPlan, Poses

#: Nodes of two plans nearer than this (of a step) are one.
SAME = 1e-7
#: A leg whose foot's goal has moved by so much (m) straightens as softly as it gets: over this part
#: of its length, to so much of it, but for the last part of the step, where the foot lands.
MUCH, SOFTER, SOFT_REACH, LANDS = 0.12, 0.008, 0.998, 0.15
#: So does one that gets straight, over its length, before this phase.
STRAIGHT, EARLY = (0.985, 0.998), 0.86
#: Rates beyond this over the mean one make a cubic run backwards.
STEEPEST_RATE = 2.9


@dataclass(frozen=True)
class Blend:
    """From when to when, in steps since the walk began, a new plan takes over."""

    begin: float
    end: float

    def share(
        self, at: Float[np.ndarray, "n"]
    ) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
        """Weight of the new plan, minimum jerk, and its change per step."""
        span = self.end - self.begin
        u = np.clip((at - self.begin) / span, 0.0, 1.0)
        weight = u * u * u * (10.0 + u * (6.0 * u - 15.0))
        return weight, 30.0 * (u * (1.0 - u)) ** 2 / span


@dataclass(frozen=True, eq=False)
class Lie:
    """How a foothold that will be stood on lies: the tilt of the sole, the bend of the toes."""

    blend: Blend
    tilt: Float[np.ndarray, "3"]
    toes: float


@dataclass(frozen=True, eq=False)
class LivePlan:
    """A contact plan of a few steps, the first of which is step ``first`` of the walk.

    ``lies`` are those of the footholds that the present swing was to end on, the first planned
    first.
    """

    contact: ContactPlan
    first: int
    lies: tuple[Lie, ...] = ()

    def toe_off(self, step: int) -> float:
        """Phase at which the swing foot leaves in ``step``."""
        return float(self.contact.toe_off[step - self.first])

    def poses(self, step: int, phases: Float[np.ndarray, "F"]) -> Poses:
        """Poses at ``phases`` of one ``step``."""
        # never the beginning of the next step: what bears changes there
        at = np.minimum(step - self.first + phases, np.nextafter(step - self.first + 1.0, 0.0))
        if self.contact.level:
            return self.contact.poses(at)
        alone = [self._lying(step, float(p)).poses(at[i : i + 1]) for i, p in enumerate(phases)]
        fields = alone[0].__dataclass_fields__
        return type(alone[0])(
            **{name: np.concatenate([getattr(p, name) for p in alone]) for name in fields}
        )

    def _lying(self, step: int, phase: float) -> ContactPlan:
        """The plan with the foothold that the foot is on its way to, as it counts by now."""
        if len(self.lies) < 2:
            return self.contact
        targets, row = self.contact.targets, step - self.first
        tilt, toes = self.lies[0].tilt, self.lies[0].toes
        for lie in self.lies[1:]:
            share = float(lie.blend.share(np.array([step + phase]))[0][0])
            tilt, toes = tilt + share * (lie.tilt - tilt), toes + share * (lie.toes - toes)
        tilts = np.array(targets.tilt)
        tilts[row] = tilt
        bent = None if targets.toes is None else np.array(targets.toes)
        if bent is not None:
            bent[row] = toes
        return replace(self.contact, targets=replace(targets, tilt=tilts, toes=bent))

    def become(
        self, new: ContactPlan, first: int, step: int, blend: Blend, changed: float = 0.0
    ) -> LivePlan:
        """The plan that is this one so far and becomes ``new`` in the course of ``step``.

        ``new`` begins with step ``first`` of the walk. Both say the same of everything that has
        been shown of ``step``: where its feet are and when the swinging one leaves. ``changed`` is
        how far the goal of that foot has moved, meters.
        """
        old, shift = self.contact, self.first - first
        row = step - first
        toe_off = np.array(new.toe_off)
        if old.toe_off[step - self.first] < 1.0:
            toe_off[row] = old.toe_off[step - self.first]
        low, high = float(row), blend.end - first
        theirs = new.at[new.at >= low - SAME]
        ours = old.at + shift
        ours = ours[(ours > low) & (ours < high)]
        marks = np.array([low, blend.begin - first, high, row + min(float(toe_off[row]), 1.0)])
        at = _merged(theirs, np.concatenate([marks, ours]))
        weight, rate = (v[:, None] for v in blend.share(at + first))
        a, da = _read(old, at - shift)
        b, db = _read(new, at)
        change = b - a
        table = np.where(weight >= 1.0, b, a + weight * change)
        slopes = np.where(weight >= 1.0, db, da + weight * (db - da) + rate * change)
        plan = replace(
            new,
            at=at,
            table=table,
            slopes=slopes,
            toe_off=toe_off,
            level=new.level and old.level,
        )
        if toe_off[row] < 1.0:
            _softened(plan, row, weight[:, 0], min(1.0, changed / MUCH))
        return LivePlan(plan, first, self._lies(new, row, step, blend))

    def _lies(self, new: ContactPlan, row: int, step: int, blend: Blend) -> tuple[Lie, ...]:
        toes = 0.0 if new.targets.toes is None else float(new.targets.toes[row])
        known = self.lies
        if not known or self.first + len(self.contact.stance) <= step:
            known = ()
        return (*known, Lie(blend, np.array(new.targets.tilt[row]), toes))

    def at_step(self, step: int) -> LivePlan:
        """The same as ``step`` begins: what is known of where it was to end."""
        row = step - self.first
        toes = self.contact.targets.toes
        bent = 0.0 if toes is None else float(toes[row])
        tilt = np.array(self.contact.targets.tilt[row])
        return replace(self, lies=(Lie(Blend(step, step + 1.0), tilt, bent),))


def _softened(plan: ContactPlan, row: int, weight: Float[np.ndarray, "n"], share: float) -> None:
    """Draw the swinging foot of step ``row`` near the hip where its leg gets straight.

    A leg that gets straight long before it lands, as when it reaches aside in a sharp turn, does
    so in no time at all otherwise. ``weight`` is 0 for what was shown.
    """
    body, at, off = plan.body, plan.at, row + float(plan.toe_off[row])
    node = np.flatnonzero((at > off) & (at < row + 1.0) & (weight > 0.0))
    if not len(node):
        return
    side = int(1 - plan.stance[row])
    rows = plan.table[node].T
    pelvis = turned_left(rows[ROWS["heading"]][0], exp(rows[ROWS["pelvis"]].T))
    half = (0.5, -0.5)[side] * body.hip_width
    hip = rows[ROWS["center"]].T + half * left_of(pelvis)
    columns = ROWS["ankle"].start + 3 * side + np.arange(3)
    line = plan.table[node[:, None], columns] - hip
    distance = np.sqrt((line * line).sum(-1))
    early = at[node] < row + EARLY
    reached = float(distance[early].max(initial=0.0)) / body.leg_length
    share = max(share, float(smoothstep((reached - STRAIGHT[0]) / (STRAIGHT[1] - STRAIGHT[0]))))
    if share < 0.01:
        return
    soft = share * SOFTER * body.leg_length
    over = (distance - SOFT_REACH * body.leg_length) / soft
    less = soft * np.log1p(np.exp(np.minimum(over, 30.0))) * np.minimum(weight[node], 1.0)
    less *= smoothstep((row + 1.0 - at[node]) / LANDS)
    moved = np.zeros((len(at), 3))
    moved[node] = -line * (less / distance)[:, None]
    around = np.arange(max(node[0] - 1, 0), min(node[-1] + 2, len(at)))
    plan.table[around[:, None], columns] += moved[around]
    plan.slopes[around[:, None], columns] += parabola_slopes(at[around], moved[around])


def _merged(fixed: Float[np.ndarray, "n"], more: Float[np.ndarray, "m"]) -> Float[np.ndarray, "k"]:
    """All nodes in order; of ``more`` those that are none of ``fixed``."""
    more = np.unique(more)
    more = more[np.insert(np.diff(more) > SAME, 0, values=True)]
    place = np.clip(np.searchsorted(fixed, more), 1, len(fixed) - 1)
    near = np.minimum(np.abs(fixed[place] - more), np.abs(fixed[place - 1] - more))
    return np.sort(np.concatenate([fixed, more[near > SAME]]))


def _read(
    plan: ContactPlan, at: Float[np.ndarray, "n"]
) -> tuple[Float[np.ndarray, "n C"], Float[np.ndarray, "n C"]]:
    """Curves and their slopes; what lies after the end of a plan is as the end is."""
    values = hermite(plan.at, plan.table, plan.slopes, at)
    slopes = hermite_slopes(plan.at, plan.table, plan.slopes, at)
    slopes[(at > plan.at[-1]) | (at < plan.at[0])] = 0.0
    return values, slopes


@dataclass(frozen=True)
class Run:
    """How the phase passes from ``begin`` (s) at phase ``low`` to ``high``: a cubic in time.

    ``rates``: phase per second at both ends.
    """

    begin: float
    duration: float
    low: float
    high: float
    rates: tuple[float, float]

    @staticmethod
    def of(begin: float, duration: float, low: float, rates: tuple[float, float]) -> Run:
        """From ``low`` to the end of the step, so quick that the phase never runs backwards."""
        most = STEEPEST_RATE * (1.0 - low) / max(*rates, 1e-9)
        return Run(begin, min(duration, most), low, 1.0, rates)

    @property
    def end(self) -> float:
        """Seconds."""
        return self.begin + self.duration

    def phase(self, time: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """At ``time``, seconds."""
        return self._eased(np.clip((time - self.begin) / self.duration, 0.0, 1.0))

    def phase_at(self, time: float) -> float:
        """At one ``time``, seconds: much quicker than an array of one."""
        return self._eased(min(max((time - self.begin) / self.duration, 0.0), 1.0))

    def _eased(self, u: Any) -> Any:
        v, way = 1.0 - u, self.high - self.low
        a, b = self.rates[0] * self.duration, self.rates[1] * self.duration
        return self.low + u * u * (3.0 - 2.0 * u) * way + u * v * (v * a - u * b)

    def rate(self, time: float) -> float:
        """Phase per second at ``time``."""
        u = float(np.clip((time - self.begin) / self.duration, 0.0, 1.0))
        a, b = self.rates
        v, mean = 1.0 - u, (self.high - self.low) / self.duration
        return 6.0 * u * v * mean + a * v * (1.0 - 3.0 * u) + b * u * (3.0 * u - 2.0)

    def time_of(self, phase: float) -> float:
        """When ``phase`` is passed."""
        low, high = self.begin, self.end
        for _ in range(60):
            middle = 0.5 * (low + high)
            if self.phase_at(middle) < phase:
                low = middle
            else:
                high = middle
        return high
