"""Formulas of [KB92a] as printed, to show what is wrong with them (errata D9 to D13)."""

from __future__ import annotations

import numpy as np


def way(a):
    return np.array([np.sin(a), np.cos(a)])


def hermite(a, b, da, db, n=2001):
    """Points of the cubic with chord-long end tangents."""
    u = np.linspace(0.0, 1.0, n)[:, None]
    size = np.linalg.norm(b - a)
    ta, tb = size * da, size * db
    return a + u * ta + u**2 * (3 * (b - a) - 2 * ta - tb) + u**3 * (ta + tb - 2 * (b - a))


def length(points):
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def printed_ends(radius, turn, steps, *, kappa, toe_off, offset=0.0, ratio=False):
    """Eq. 3: where the hips are at each heel strike, over the step behind the new foot.

    ``turn`` radians a step on a circle (0: straight, then ``radius`` is the step length).
    ``ratio``: C at toe-off is the 2D system's own ("eq3ratio"), else as far as in 2D from where
    the step began. ``offset``: meters that the first step begins too far back.
    """
    sl = radius * turn if turn else radius
    eta2d = toe_off * sl
    tau2d = sl - eta2d
    found = []

    def place(i):
        if not turn:
            return np.array([0.0, i * sl]), 0.0
        angle = i * turn
        return radius * np.array([1.0 - np.cos(angle), np.sin(angle)]), angle

    begins = -kappa * sl - offset
    for i in range(steps):
        here, d = place(i)
        new, d2 = place(i + 1)
        eta = eta2d
        off = here + way(d) * (begins + eta2d)
        if ratio:
            off = here + way(d) * (-kappa * sl + eta2d)
            eta = -kappa * sl + eta2d - begins
        wanted = eta * tau2d / eta2d

        def gap(x, new=new, d2=d2, off=off, d=d, wanted=wanted):
            return length(hermite(off, new + way(d2) * x, way(d), way(d2), 400)) - wanted

        low, high = -1.5 * sl, 0.5 * sl
        if gap(low) * gap(high) > 0.0:
            found.append(np.nan)
            break
        for _ in range(50):
            mid = 0.5 * (low + high)
            low, high = (mid, high) if gap(mid) < 0.0 else (low, mid)
        begins = 0.5 * (low + high)
        found.append(begins / sl)
    return np.array(found)
