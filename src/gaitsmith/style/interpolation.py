"""Key frames joined to a loop: cubic or by slerp, periodic."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.rotations import slerp

if TYPE_CHECKING:
    from jaxtyping import Float


def periodic_cubic(
    knots: Float[np.ndarray, "N"], period: float, at: Float[np.ndarray, "K"]
) -> Float[np.ndarray, "K N"]:
    """Matrix that turns values at ``knots`` into those of the periodic C2 cubic at ``at``.

    ``knots`` rise and span less than ``period``.
    """
    count = len(knots)
    h = np.diff(np.append(knots, knots[0] + period))
    before = np.roll(h, 1)
    rows = np.arange(count)
    left, right = np.roll(rows, 1), np.roll(rows, -1)
    system, source = np.zeros((count, count)), np.zeros((count, count))
    np.add.at(system, (rows, left), before / 6.0)
    np.add.at(system, (rows, rows), (before + h) / 3.0)
    np.add.at(system, (rows, right), h / 6.0)
    np.add.at(source, (rows, right), 1.0 / h)
    np.add.at(source, (rows, rows), -1.0 / h - 1.0 / before)
    np.add.at(source, (rows, left), 1.0 / before)
    second = np.linalg.solve(system, source)
    i, u = _interval(knots, period, at)
    size = h[i]
    v = 1.0 - u
    eye = np.eye(count)
    curved = (v**3 - v)[:, None] * second[i] + (u**3 - u)[:, None] * second[right[i]]
    straight = v[:, None] * eye[i] + u[:, None] * eye[right[i]]
    return straight + (size**2 / 6.0)[:, None] * curved


def periodic_slerp(
    keys: Float[np.ndarray, "N J 4"],
    knots: Float[np.ndarray, "N"],
    period: float,
    at: Float[np.ndarray, "K"],
) -> Float[np.ndarray, "K J 4"]:
    """Rotations the shorter way from key to key, at even pace between two."""
    i, u = _interval(knots, period, at)
    return slerp(keys[i], keys[(i + 1) % len(keys)], u[:, None])


def periodic_linear(
    knots: Float[np.ndarray, "N"], period: float, at: Float[np.ndarray, "K"]
) -> Float[np.ndarray, "K N"]:
    """Matrix of straight lines from knot to knot."""
    i, u = _interval(knots, period, at)
    eye = np.eye(len(knots))
    return (1.0 - u)[:, None] * eye[i] + u[:, None] * eye[(i + 1) % len(knots)]


def _interval(
    knots: Float[np.ndarray, "N"], period: float, at: Float[np.ndarray, "K"]
) -> tuple[np.ndarray, Float[np.ndarray, "K"]]:
    """Knot before each instant, and how far on to the next."""
    inside = (at - knots[0]) % period + knots[0]
    i = np.clip(np.searchsorted(knots, inside, side="right") - 1, 0, len(knots) - 1)
    ends = np.append(knots, knots[0] + period)
    return i, (inside - ends[i]) / (ends[i + 1] - ends[i])
