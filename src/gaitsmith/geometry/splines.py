"""Plane curves in pieces: natural cubic splines, Hermite pieces, Bezier curves.

All of them know their arc length; the last two are batches, one curve a row, so that every
step of a walk is read at once. NumPy only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float, Int

#: Gauss-Legendre of four points on [0, 1]: abscissas and weights.
_OUTER, _INNER = np.sqrt(3.0 / 7.0 + np.array([2.0, -2.0]) / 7.0 * np.sqrt(1.2))
_AT = 0.5 + 0.5 * np.array([-_OUTER, -_INNER, _INNER, _OUTER])
_WEIGHT = (18.0 + np.array([-1.0, 1.0, 1.0, -1.0]) * np.sqrt(30.0)) / 72.0
#: Cells of the table that turns arc lengths to parameters.
CELLS = 16


@dataclass(frozen=True, eq=False)
class Spline:
    """A cubic spline by knots: values and second derivatives."""

    knots: Float[np.ndarray, "n"]
    values: Float[np.ndarray, "n 2"]
    second: Float[np.ndarray, "n 2"]

    def _cell(
        self, u: Float[np.ndarray, "m"]
    ) -> tuple[Float[np.ndarray, "m"], tuple[Float[np.ndarray, "4 2 m"], ...]]:
        """How far beyond the knot before, and the cubic there: four coefficients, x and z apart."""
        i = np.clip(np.searchsorted(self.knots, u, side="right") - 1, 0, len(self.knots) - 2)
        h = np.diff(self.knots)
        y, m = self.values.T, self.second.T
        slope = np.diff(y) / h - h * (2.0 * m[:, :-1] + m[:, 1:]) / 6.0
        cubic = np.stack([y[:, :-1], slope, 0.5 * m[:, :-1], np.diff(m) / (6.0 * h)])
        return u - self.knots[i], tuple(np.take(cubic, i, axis=2))

    def at(self, u: Float[np.ndarray, "m"]) -> Float[np.ndarray, "m 2"]:
        """Points."""
        x, (a, b, c, d) = self._cell(u)
        return (a + x * (b + x * (c + x * d))).T

    def derivative(self, u: Float[np.ndarray, "m"]) -> Float[np.ndarray, "m 2"]:
        """First derivative."""
        x, (_, b, c, d) = self._cell(u)
        return (b + x * (2.0 * c + x * (3.0 * d))).T

    def curvature(self, u: Float[np.ndarray, "m"]) -> Float[np.ndarray, "m"]:
        """Change of heading per length, positive from +Z to +X."""
        x, (_, b, c, d) = self._cell(u)
        first, second = b + x * (2.0 * c + x * (3.0 * d)), 2.0 * c + 6.0 * x * d
        cross = first[1] * second[0] - first[0] * second[1]
        return cross / np.maximum(first[0] ** 2 + first[1] ** 2, 1e-18) ** 1.5

    def arc_length(self, u: Float[np.ndarray, "m"]) -> Float[np.ndarray, "m"]:
        """Arc length at rising parameters from the first of them, by Gauss in each gap."""
        gap = np.diff(u)
        inner = u[:-1, None] + gap[:, None] * _AT
        slope = self.derivative(inner.ravel())
        speed = np.sqrt(slope[:, 0] ** 2 + slope[:, 1] ** 2).reshape(inner.shape)
        return np.concatenate([[0.0], np.cumsum(gap * (speed @ _WEIGHT))])


def natural_spline(points: Float[np.ndarray, "n 2"]) -> Spline:
    """Natural cubic spline through ``points``, its parameter the length of the chords."""
    h = np.linalg.norm(np.diff(points, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(h)])
    second = np.zeros_like(points)
    count = len(points) - 2
    if count > 0:  # the tridiagonal system of the second derivatives, by elimination
        slope = np.diff(points, axis=0) / h[:, None]
        right = 6.0 * np.diff(slope, axis=0)
        main = 2.0 * (h[:-1] + h[1:])
        for i in range(1, count):
            share = h[i] / main[i - 1]
            main[i] -= share * h[i]
            right[i] -= share * right[i - 1]
        second[count] = right[-1] / main[-1]
        for i in range(count - 2, -1, -1):
            second[i + 1] = (right[i] - h[i + 1] * second[i + 2]) / main[i]
    return Spline(knots, points, second)


@dataclass(frozen=True, eq=False)
class PlaneCurves:
    """S plane curves on [0, 1], polynomials with ``(degree + 1, S, 2)`` coefficients."""

    coefficients: Float[np.ndarray, "degree+1 S 2"]

    @staticmethod
    def hermite(
        start: Float[np.ndarray, "S 2"],
        end: Float[np.ndarray, "S 2"],
        leaving: Float[np.ndarray, "S 2"],
        arriving: Float[np.ndarray, "S 2"],
    ) -> PlaneCurves:
        """Cubics between two points with end derivatives."""
        chord = end - start
        return PlaneCurves(
            np.stack(
                [
                    start,
                    leaving,
                    3.0 * chord - 2.0 * leaving - arriving,
                    leaving + arriving - 2.0 * chord,
                ]
            )
        )

    @staticmethod
    def quintic(
        start: Float[np.ndarray, "S 2"],
        end: Float[np.ndarray, "S 2"],
        leaving: Float[np.ndarray, "S 2"],
        arriving: Float[np.ndarray, "S 2"],
        second: tuple[Float[np.ndarray, "S 2"], Float[np.ndarray, "S 2"]],
    ) -> PlaneCurves:
        """Between two points with first and ``second`` derivatives at both ends."""
        chord = end - start
        one, two = second
        # what is left of the end conditions after 0, 1 and 2, by the powers 3 to 5
        place = chord - leaving - 0.5 * one
        speed = arriving - leaving - one
        bend = two - one
        return PlaneCurves(
            np.stack(
                [
                    start,
                    leaving,
                    0.5 * one,
                    10.0 * place - 4.0 * speed + 0.5 * bend,
                    -15.0 * place + 7.0 * speed - bend,
                    6.0 * place - 3.0 * speed + 0.5 * bend,
                ]
            )
        )

    @staticmethod
    def bezier(
        start: Float[np.ndarray, "S 2"],
        control: Float[np.ndarray, "S 2"],
        end: Float[np.ndarray, "S 2"],
    ) -> PlaneCurves:
        """De Casteljau's curve of second degree."""
        return PlaneCurves(np.stack([start, 2.0 * (control - start), start - 2.0 * control + end]))

    def __len__(self) -> int:
        """Number of curves."""
        return self.coefficients.shape[1]

    def rows(self, index: Int[np.ndarray, "m"]) -> PlaneCurves:
        """The curves at ``index``."""
        apart = np.ascontiguousarray(self.coefficients.transpose(0, 2, 1))
        return PlaneCurves(np.take(apart, index, axis=2).transpose(0, 2, 1))

    @cached_property
    def _slope(self) -> PlaneCurves:
        """The first derivative, a curve itself."""
        powers = np.arange(1.0, len(self.coefficients))[:, None, None]
        apart = self.coefficients[1:].transpose(0, 2, 1)
        return PlaneCurves((powers * apart).transpose(0, 2, 1))

    def at(self, u: Float[np.ndarray, "S"]) -> Float[np.ndarray, "S 2"]:
        """Each curve at its own parameter."""
        out = np.empty((2, len(u)))
        for axis, value in enumerate(out):  # each alone: rows of two are slow to work on
            value[:] = self.coefficients[-1, :, axis]
            for c in self.coefficients[-2::-1, :, axis]:
                value *= u
                value += c
        return out.T

    def derivative(self, u: Float[np.ndarray, "S"]) -> Float[np.ndarray, "S 2"]:
        """First derivative of each at its own parameter."""
        return self._slope.at(u)

    def speed(self, u: Float[np.ndarray, "S"]) -> Float[np.ndarray, "S"]:
        """Length of the first derivative."""
        slope = self.derivative(u)
        return np.sqrt(slope[:, 0] ** 2 + slope[:, 1] ** 2)

    def length(self) -> Float[np.ndarray, "S"]:
        """Arc length of each."""
        return self._arcs[:, -1]

    @cached_property
    def _arcs(self) -> Float[np.ndarray, "S cells+1"]:
        """Arc lengths at the ends of equal cells of the parameter, by Gauss in each."""
        cells = np.arange(CELLS) / CELLS
        total = np.zeros((len(self), CELLS))
        for at, weight in zip(_AT, _WEIGHT, strict=True):
            speed = self._speeds(cells + at / CELLS)
            total += (weight / CELLS) * speed
        return np.concatenate([np.zeros((len(self), 1)), np.cumsum(total, axis=1)], axis=1)

    def _speeds(self, u: Float[np.ndarray, "k"]) -> Float[np.ndarray, "S k"]:
        """Length of the derivative of every curve at every ``u``."""
        degree = len(self.coefficients) - 1
        powers = np.arange(1, degree + 1)[:, None] * u ** np.arange(degree)[:, None]
        slope = np.einsum("dsc,dk->csk", self.coefficients[1:], powers)
        return np.sqrt(slope[0] ** 2 + slope[1] ** 2)

    def parameter(
        self, row: Int[np.ndarray, "m"], along: Float[np.ndarray, "m"]
    ) -> Float[np.ndarray, "m"]:
        """Parameter at arc length ``along`` of the curve ``row``; within [0, 1].

        Read off a table by cubics, then one step of Newton: right to about 1e-11.
        """
        return self.located(row, along)[1]

    def located(
        self, row: Int[np.ndarray, "m"], along: Float[np.ndarray, "m"]
    ) -> tuple[PlaneCurves, Float[np.ndarray, "m"]]:
        """The curves ``row``, and the :meth:`parameter` on each."""
        arcs = self._arcs
        whole = np.maximum(arcs[:, -1:], 1e-12)
        share = arcs / whole
        aim = np.clip(along / whole[row, 0], 0.0, 1.0)
        count = CELLS + 1
        ends = (share[:, :-1] + np.arange(len(self))[:, None]).ravel()
        cell = np.searchsorted(ends, aim + row, side="right") - 1
        cell = np.clip(cell - row * CELLS, 0, CELLS - 1)
        edges = np.arange(count) / CELLS
        slope = whole / np.maximum(self._speeds(edges), 0.02 * whole)
        at = row * count + cell
        first, last = share.ravel()[at], share.ravel()[at + 1]
        gap = np.maximum(last - first, 1e-15)
        v = np.clip((aim - first) / gap, 0.0, 1.0)
        w = 1.0 - v
        begins, ends_ = gap * slope.ravel()[at], gap * slope.ravel()[at + 1]
        rise = v * v * (3.0 - 2.0 * v) / CELLS + v * w * (w * begins - v * ends_)
        # one step of Newton from there
        curve, gone = self.rows(row), np.zeros(len(row))
        for node, weight in zip(_AT, _WEIGHT, strict=True):
            gone += weight * curve.speed(edges[cell] + node * rise)
        miss = gone * rise - (aim - first) * whole[row, 0]
        size = np.maximum(curve.speed(edges[cell] + rise), 0.02 * whole[row, 0])
        return curve, np.clip(edges[cell] + rise - miss / size, 0.0, 1.0)
