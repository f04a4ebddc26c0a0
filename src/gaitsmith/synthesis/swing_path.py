"""The swing foot seen from above, [KB92a] section 5.3, and kept clear of the stance foot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.planar import feet_apart
from gaitsmith.geometry.splines import PlaneCurves

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.synthesis.bent import Bent, Flat2D

#: Meters between the axes of the feet in passing, at least, in turns; narrower footsteps keep
#: their own distance.
APART = 0.085
#: The push is sought in such parts (m), so many times.
PUSH, MOST_PUSHES = 0.015, 13
#: Meters that the feet must come farther apart per meter of push, at least.
ODD = 0.2
#: Turn (radians) and change of width (m) of a step from which it is fully kept so.
TURNS, SHIFTS = 0.10, 0.02


@dataclass(frozen=True, eq=False)
class SwingPath:
    """S swings seen from above: where they go by themselves, and how far aside they are pushed.

    Attributes
    ----------
    push, away
        ``(S,)`` meters in the middle of the swing, ``(S, 2)`` to where.
    plan
        ``(M, 2)``, ``(M,)`` ankle and heading of the swing foot at every sample, not pushed.
    """

    push: Float[np.ndarray, "S"]
    away: Float[np.ndarray, "S 2"]
    plan: tuple[Float[np.ndarray, "M 2"], Float[np.ndarray, "M"]]

    @staticmethod
    def of(body: Body, bent: Bent, flat: Flat2D) -> SwingPath:
        """D1 at toe-off, D3 at heel strike, D2 the stance ankle mirrored in the line beside it."""
        way = np.stack([np.sin(bent.direction), np.cos(bent.direction)], axis=-1)
        ankle = flat.ankle[:, 1, 0]
        # asked lengths are rounded: the ends are measured from their own footholds
        leaving = ankle[flat.off] + flat.asked[:, 0]
        landing = ankle[flat.last] - flat.asked[:, 1]
        start = bent.place[:, 0] + leaving[:, None] * way[:, 0]
        end = bent.place[:, 2] + landing[:, None] * way[:, 2]
        mirrored = 2.0 * bent.middle[:, 1] - bent.place[:, 1]
        chord = end - start
        size = np.maximum((chord * chord).sum(-1), 1e-12)
        share = ((mirrored - start) * chord).sum(-1) / size
        # beside its own chord, or the curve would run back
        control = mirrored + ((np.clip(share, 0.25, 0.75) - share)[:, None]) * chord
        curve = PlaneCurves.bezier(start, control, end)
        left = np.stack([np.cos(bent.direction[:, 1]), -np.sin(bent.direction[:, 1])], axis=-1)
        away = -bent.sign[:, None] * left
        whole = curve.length()
        plan = _planned(curve, whole, bent, flat)
        path = SwingPath(np.zeros(len(size)), away, plan)
        return path.kept_apart(body, bent, flat)

    def kept_apart(self, body: Body, bent: Bent, flat: Flat2D) -> SwingPath:
        """Pushed away from the stance leg where the feet would come too near."""
        turn = np.abs(bent.direction[:, 2] - bent.direction[:, 0])
        turn = turn + np.abs(
            bent.direction[:, 1] - 0.5 * (bent.direction[:, 0] + bent.direction[:, 2])
        )
        aside = ((bent.place - bent.middle) ** 2).sum(-1) ** 0.5
        off_line = np.abs(
            ((bent.middle[:, [0, 2]] - bent.middle[:, [1]]) * self.away[:, None]).sum(-1)
        ).max(-1)
        uneven = np.ptp(aside, axis=-1) + off_line
        turn, uneven = (np.where(v < 1e-9, 0.0, v) for v in (turn, uneven))
        weight = np.minimum(1.0, turn / TURNS + uneven / SHIFTS)
        if not weight.any():
            return self
        swinging = np.flatnonzero(
            (flat.swing > 0.04) & (flat.swing < 0.96) & (weight[flat.step] > 0)
        )
        if not len(swinging):
            return self
        i = flat.step[swinging]
        shape = push_shape(flat.swing[swinging])
        plain, heading = (values[swinging] for values in self.plan)
        foot = body.foot

        def apart(which: np.ndarray, ankle: np.ndarray, facing: np.ndarray) -> np.ndarray:
            return feet_apart(
                ankle,
                facing,
                bent.place[which, 1],
                bent.heading[which, 1],
                back=foot.heel,
                front=foot.ball + foot.toes,
            )

        # no farther than the feet stand apart before and after
        every = np.arange(len(self.push))
        ends = [apart(every, bent.place[:, k], bent.heading[:, k]) for k in (0, 2)]
        want = np.minimum(APART, np.minimum(*ends))
        push, missing = np.zeros(len(self.push)), np.zeros(len(self.push))
        best, least = np.zeros(len(push)), np.full(len(push), np.inf)
        search = np.ones(len(i), dtype=np.bool_)
        for k in range(MOST_PUSHES):
            j = i[search]
            ankle = plain[search] + (push[j] * shape[search])[:, None] * self.away[j]
            short = np.full(len(push), -np.inf)
            np.maximum.at(short, j, want[j] - apart(j, ankle, heading[search]))
            done = (short <= 0.0) & (short > -np.inf)
            if k:  # between the last two tries
                share = missing / np.maximum(missing - short, 1e-9)
                met = push - PUSH * (1.0 - share)
            else:
                met = push
            # a push that hardly helps would only look odd
            way = np.where(done, met, push)
            cost = np.where(short > -np.inf, np.maximum(short, 0.0) + ODD * way, np.inf)
            better = cost < least - 1e-4
            best, least = np.where(better, way, best), np.where(better, cost, least)
            search &= ~done[i]
            if not search.any():
                break
            missing = np.where(short > 0.0, short, missing)
            push = np.where(short > 0.0, push + PUSH, push)
        return SwingPath(weight * best, self.away, self.plan)

    def read(
        self,
        bent: Bent,
        flat: Flat2D,
        ankle: Float[np.ndarray, "M 2 3"],
        headings: Float[np.ndarray, "M 2"],
    ) -> None:
        """Write world ankles and headings of [left, right] to ``ankle`` and ``headings``.

        Where a foot bears, contact replaces them.
        """
        plan, heading = self.plan
        plan = plan + (flat.each(self.push) * push_shape(flat.swing))[:, None] * flat.each(
            self.away
        )
        place, stands = flat.each(bent.place[:, 1]), flat.each(bent.heading[:, 1])
        up = flat.ankle[..., 1]
        left = flat.each(bent.stance == LEFT)
        for side, bears in ((LEFT, left), (RIGHT, ~left)):
            ankle[:, side, 0] = np.where(bears, place[:, 0], plan[:, 0])
            ankle[:, side, 1] = np.where(bears, up[:, 0], up[:, 1])
            ankle[:, side, 2] = np.where(bears, place[:, 1], plan[:, 1])
            headings[:, side] = np.where(bears, stands, heading)


def _planned(
    curve: PlaneCurves, whole: Float[np.ndarray, "S"], bent: Bent, flat: Flat2D
) -> tuple[Float[np.ndarray, "M 2"], Float[np.ndarray, "M"]]:
    """Ankle and heading of the swing foot, not pushed."""
    ankle = flat.ankle[:, 1, 0]
    begin, end = flat.each(ankle[flat.off]), flat.each(ankle[flat.last])
    span = end - begin
    moved = np.abs(span) > 1e-6
    share = np.where(moved, (ankle - begin) / np.where(moved, span, 1.0), flat.swing)
    whole = flat.each(whole)
    along = share * whole
    own, u = curve.located(flat.step, along)
    tangent = own.derivative(u)
    # the share leaves [0, 1] where the foot draws back before it lands
    over = np.maximum(along - whole, 0.0) + np.minimum(along, 0.0)
    over /= np.maximum(np.sqrt(tangent[:, 0] ** 2 + tangent[:, 1] ** 2), 1e-12)
    turned = flat.each(bent.heading[:, 2] - bent.heading[:, 0])
    heading = flat.each(bent.heading[:, 0]) + smoothstep(flat.swing) * turned
    return own.at(u) + over[:, None] * tangent, heading


def push_shape(u: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
    """0 at toe-off and heel strike, 1 in the middle of the swing."""
    return smoothstep(u / 0.35) * smoothstep((1.0 - u) / 0.35)
