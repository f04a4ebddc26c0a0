"""Hips and soles that show measured joint angles best while bearing feet stay where they are.

A least-squares problem in a few splines; what is measured comes from
:mod:`gaitsmith.walks.planting`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.sole import rolled_ankle
from gaitsmith.conventions import SIDE_SIGN
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.threads import on_one_thread

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Body

#: Samples of the stride, splines a stride, iterations.
SAMPLES, SPLINES, ITERATIONS = 240, 30, 12
#: A step of the fit (radians, meters) after which it is done, and one that ends it if it leads up.
_CLOSE, _BENT = 1e-7, 1e-5
#: How far toes bend down against the sole at most, radians.
CURL = 0.1
#: Least knee flexion that a bearing leg is asked to show, radians.
_STRAIGHTEST = 0.105
#: Part of a stride over which a heel begins to rise.
ONSET = 0.05
#: Weights of the splines' own size and of their second differences, against radians of angle:
#: hips forward, hips up, then the pitch and the meta angle of both feet. Weaker on the hips, joints
#: are nearer to what was measured (1.4 instead of 1.9 deg, rms) and hips lurch at heel strikes.
_SIZE = (0.0, 0.0, 0.35, 0.35, 0.15, 0.15)
_BEND = (8.0, 12.0, 0.6, 0.6, 0.3, 0.3)


@dataclass(eq=False)
class Measured:
    """What the stride shows, ``(N, ...)``; sides [left, right]."""

    phase: Float[np.ndarray, "N"]
    center: Float[np.ndarray, "N 3"]  # lateral, up, forward with travel
    hip: Float[np.ndarray, "N 2 3"]  # from the center
    leg: Float[np.ndarray, "N 2 3"]  # hip to ankle
    thigh: Float[np.ndarray, "N 2"]
    knee: Float[np.ndarray, "N 2"]
    pitch: Float[np.ndarray, "N 2"]
    toes: Float[np.ndarray, "N 2"]
    own: Float[np.ndarray, "N 2"]


def _splines() -> Float[np.ndarray, "N S"]:
    """Uniform periodic cubic B-splines at the samples."""
    at = np.arange(SAMPLES)[:, None] * (SPLINES / SAMPLES) - np.arange(SPLINES)
    d = np.abs((at + 0.5 * SPLINES) % SPLINES - 0.5 * SPLINES)
    near = 2.0 / 3.0 - d * d + 0.5 * d**3
    return np.where(d < 1.0, near, np.where(d < 2.0, (2.0 - d) ** 3 / 6.0, 0.0))


_BASIS = _splines()


class Fit:
    """Hips and soles that show the measured angles: damped Gauss-Newton over splines."""

    def __init__(
        self,
        seen: Measured,
        body: Body,
        stride: float,
        place: Float[np.ndarray, "2"],
        marks: Float[np.ndarray, "2 5"],
        width: float,
        pitch: Float[np.ndarray, "N 2"],
        meta: Float[np.ndarray, "N 2"],
    ) -> None:
        self.seen, self.body, self.stride, self.place = seen, body, stride, place
        self.pitch, self.meta = pitch, meta
        flat, heel_off, meta_off, toe_off, strike = marks.T
        own = seen.own
        self.down: Bool[np.ndarray, "N 2"] = own <= toe_off
        across = 0.5 * width * SIDE_SIGN - (seen.center[:, :1] + seen.hip[..., 0])
        # a foot that struck before this stride began stands one stride behind
        late = seen.phase[:, None] < strike
        self.stands = place - stride * late
        rising = smoothstep((own - heel_off) / ONSET)
        self.free_pitch = np.where(own < flat, 1.0 - smoothstep(own / flat), rising) * self.down
        on_toes = self.pitch[np.abs(own - flat).argmin(axis=0), [0, 1]] < -0.01
        self.free_pitch = np.where(on_toes & self.down, 1.0, self.free_pitch)
        self.free_meta = smoothstep((own - meta_off) / ONSET) * self.down
        self.basis = _BASIS
        self.start = seen.center[:, [2, 1]]
        # samples and sides of bearing legs, and what they should show
        self.at = np.nonzero(self.down)
        self.hip, self.aside = seen.hip[self.at][:, [2, 1]], across[self.at] ** 2
        ankle = seen.pitch - (seen.thigh - seen.knee)
        angles = np.stack([seen.thigh, np.maximum(seen.knee, _STRAIGHTEST), ankle], axis=-1)
        self.target = angles[self.at]

    def ankles(
        self, pitch: Float[np.ndarray, "N 2"], meta: Float[np.ndarray, "N 2"]
    ) -> Float[np.ndarray, "N 2 2"]:
        """Where the ankles of bearing feet are."""
        out = rolled_ankle(self.body.foot, pitch, meta)
        out[..., 0] += self.stands
        return out

    @on_one_thread
    def solved(
        self,
    ) -> tuple[Float[np.ndarray, "N 2"], Float[np.ndarray, "N 2"], Float[np.ndarray, "N 2"]]:
        """Center, pitch and meta of the best fit."""
        x, damping = np.zeros((6, SPLINES)), 1e-3
        away = self._away(x)
        value, slope, normal = self._system(x, away)
        for _ in range(ITERATIONS):
            damped = np.array(normal)
            np.fill_diagonal(damped, normal.diagonal() * (1.0 + damping))
            step = np.linalg.solve(damped, -slope).reshape(6, SPLINES)
            far = np.abs(step).max()
            away = self._away(x + step)
            tried = self._value(x + step, away)
            if tried < value:
                x, damping = x + step, 0.3 * damping
                if far < _CLOSE:
                    break
                value, slope, normal = self._system(x, away)
            elif far < _BENT:  # at a kink, where no step gets farther
                break
            else:
                damping *= 8.0
        return self._pose(x)

    def _pose(
        self, x: Float[np.ndarray, "6 S"]
    ) -> tuple[Float[np.ndarray, "N 2"], Float[np.ndarray, "N 2"], Float[np.ndarray, "N 2"]]:
        change = (self.basis @ x.T).reshape(SAMPLES, 3, 2)
        center = self.start + change[:, 0]
        raised = self.pitch + self.free_pitch * change[:, 1]
        heel = self.down & (self.pitch > 0.0)
        pitch = np.where(heel, np.maximum(raised, 0.0), raised)
        pitch = np.where(self.down & ~heel, np.minimum(pitch, 0.0), pitch)
        meta = np.maximum(self.meta + self.free_meta * change[:, 2], 0.0)
        meta = np.minimum(meta, np.maximum(-pitch, 0.0) + CURL)
        return center, pitch, meta

    def _angles(
        self,
        center: Float[np.ndarray, "*t M 2"],
        ankle: Float[np.ndarray, "*t M 2"],
        pitch: Float[np.ndarray, "*t M"],
    ) -> Float[np.ndarray, "*t M 3"]:
        """Thigh against the vertical, knee, and foot against the shin, of the bearing legs."""
        thigh, shin = self.body.thigh, self.body.shin
        forward = ankle[..., 0] - (center[..., 0] + self.hip[:, 0])
        up = ankle[..., 1] - (center[..., 1] + self.hip[:, 1])
        square = forward**2 + up**2 + self.aside
        cosine = (square - thigh**2 - shin**2) / (2.0 * thigh * shin)
        # beyond reach the angle goes on linearly, so that the way back is seen
        inside = np.minimum(cosine, np.cos(0.05))
        knee = np.arccos(np.maximum(inside, -1.0)) - (cosine - inside) / np.sin(0.05)
        lead = np.arctan2(shin * np.sin(knee), thigh + shin * np.cos(np.maximum(knee, 0.0)))
        turned = np.arctan2(forward, -up) + lead
        return np.stack([turned, knee, pitch - (turned - knee)], axis=-1)

    def _bearing(
        self, pitch: Float[np.ndarray, "*t M"], meta: Float[np.ndarray, "*t M"]
    ) -> Float[np.ndarray, "*t M 2"]:
        """Ankles of the feet that bear."""
        out = rolled_ankle(self.body.foot, pitch, meta)
        out[..., 0] += self.stands[self.at]
        return out

    def _away(self, x: Float[np.ndarray, "6 S"]) -> Float[np.ndarray, "N 2 3"]:
        """Angles of bearing legs less the measured ones."""
        center, pitch, meta = self._pose(x)
        pitch, meta = pitch[self.at], meta[self.at]
        out = np.zeros((SAMPLES, 2, 3))
        angles = self._angles(center[self.at[0]], self._bearing(pitch, meta), pitch)
        out[self.at] = angles - self.target
        return out

    def _value(self, x: Float[np.ndarray, "6 S"], away: Float[np.ndarray, "N 2 3"]) -> float:
        """What is to be least: squares of the angles, and of the splines' size and bend."""
        return float((away**2).sum() + (x[:, None] @ _SMOOTH @ x[..., None]).sum())

    def _system(
        self, x: Float[np.ndarray, "6 S"], away: Float[np.ndarray, "N 2 3"]
    ) -> tuple[float, Float[np.ndarray, "6S"], Float[np.ndarray, "6S 6S"]]:
        """The value, half its slope, and the Gauss-Newton matrix, spline by spline."""
        slopes = self._slopes(x)
        slope = (slopes * away.reshape(SAMPLES, 6, 1)).sum(1).T @ self.basis
        slope += (_SMOOTH @ x[..., None])[..., 0]
        normal = _over_splines(slopes.transpose(0, 2, 1) @ slopes).reshape(6 * SPLINES, -1)
        for row in range(6):
            own = slice(row * SPLINES, (row + 1) * SPLINES)
            normal[own, own] += _SMOOTH[row]
        return self._value(x, away), slope.ravel(), normal

    def _slopes(self, x: Float[np.ndarray, "6 S"]) -> Float[np.ndarray, "N 6 6"]:
        """How the angles of [left, right] bearing legs go with the six splines' values."""
        center, pitch, meta = self._pose(x)
        center, pitch, meta = center[self.at[0]], pitch[self.at], meta[self.at]
        tiny = 1e-6
        tipped = pitch - tiny * self.free_pitch[self.at]
        ankles = self._bearing(
            np.stack([pitch, tipped, pitch]),
            np.stack([meta, meta, meta + tiny * self.free_meta[self.at]]),
        )
        # all at once: the pose, the hips a little forward and up, soles and toes turned a little
        now, forward, up, down, bent = self._angles(
            np.stack([center, *(center + tiny * axis for axis in np.eye(2)), center, center]),
            ankles[[0, 0, 0, 1, 2]],
            np.stack([pitch, pitch, pitch, tipped, pitch]),
        )
        out = np.zeros((SAMPLES, 2, 3, 6))
        rows, sides = self.at
        for column, slope in ((0, forward - now), (1, up - now)):
            out[rows, sides, :, column] = slope / tiny
        for column, slope in ((2, now - down), (4, bent - now)):
            out[rows, sides, :, column + sides] = slope / tiny
        return out.reshape(SAMPLES, 6, 6)


def _smoothness() -> Float[np.ndarray, "6 S S"]:
    """Squares of the splines' size and bend, by weight."""
    one = np.eye(SPLINES)
    bend = one - 0.5 * np.roll(one, 1, 0) - 0.5 * np.roll(one, -1, 0)
    per = SAMPLES / SPLINES
    return np.stack(
        [
            per * (size**2 * one + weight**2 * bend.T @ bend)
            for size, weight in zip(_SIZE, _BEND, strict=True)
        ]
    )


_SMOOTH = _smoothness()


def _over_splines(products: Float[np.ndarray, "N 6 6"]) -> Float[np.ndarray, "6 S 6 S"]:
    """Sums over samples of ``products`` times the values there of each pair of splines.

    At a sample four splines are not 0, the same four from knot to knot.
    """
    every = SAMPLES // SPLINES
    near = _BASIS[:every, [-1, 0, 1, 2]]
    pairs = (near[:, :, None] * near[:, None, :]).reshape(every, 16)
    sums = (pairs.T @ products.reshape(SPLINES, every, 36)).reshape(SPLINES, 16, 6, 6)
    # one spline more before the first, which is the last, and two after it
    out = np.zeros((SPLINES + 3, SPLINES + 3, 6, 6))
    for first in range(4):
        for second in range(4):
            own = out[first : first + SPLINES, second : second + SPLINES]
            along = np.einsum("kkij->kij", own)  # a view
            along += sums[:, 4 * first + second]
    for rows in (out, out.transpose(1, 0, 2, 3)):
        rows[SPLINES] += rows[0]
        rows[1:3] += rows[SPLINES + 1 :]
    out = out[1 : SPLINES + 1, 1 : SPLINES + 1]
    return out.transpose(2, 0, 3, 1)
