"""Frames, units and array axes. Every other module assumes this page.

========== ==================================================================
Units      meters, seconds, kilograms, radians. Degrees appear only at the
           edges: file formats, the command line, plot labels.
World      right-handed; +Y up, heading 0 faces +Z, +X is the walker's left.
Heading    psi, a rotation about +Y: the walker faces
           ``(sin psi, 0, cos psi)``; positive psi turns left.
Sagittal   2-D vectors are ``(forward, up)`` in the plane at heading psi.
Rotations  unit quaternions ``(x, y, z, w)``, joint frame to parent frame,
           sign-continuous in time.
Axes       ``(..., frame, joint, component)``, in that order.
Sides      0 is left, 1 is right, wherever an axis counts legs.
Sole       [heel, ball, toe tip], wherever an axis counts points of a sole.
Phase      normalized time of a STEP in [0, 1]: 0 at the heel strike that
           starts it (HSM-), 1 at the next heel strike, of the other foot
           (HSM+). A Cycle's ``stride_phase`` is that of the STRIDE, from
           one left heel strike to the next.
Legs       *stance* or *swing* as [KB93] section 2 names them: a leg is the
           stance leg from its own heel strike to the other's.
N          the floor point under the ankle of the flat foot. A footstep's
           position is N, its heading the foot's.
Rest pose  T-pose, identity local rotations, soles at y = 0.
========== ==================================================================

World and quaternions are those of glTF and VRM. Conversions to another convention
(BVH's Euler degrees and centimeters, MuJoCo's Z-up and wxyz, a paper's x-forward)
live in :mod:`gaitsmith.io`, or in the one module that codes the paper's formula.

Papers are cited by these keys:

* [KB92a] Ko & Badler, *Curved Path Walking*, MS-CIS-92-02, 1992
* [KB92b] Ko & Badler, *Straight Line Walking Animation Based on Kinematic Generalization
  that Preserves the Original Characteristics*, MS-CIS-92-79, 1992
* [KB93] Ko & Badler, *Intermittent Non-Rhythmic Human Stepping and Locomotion*,
  MS-CIS-93-55, 1993
* [SM01] Sun & Metaxas, *Automating Gait Generation*, SIGGRAPH 2001
* [KN12] Kim & Neff, *Component-based Locomotion Composition*, SCA 2012
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float

#: Steps of a walk: from standing feet, mid-walk, closing to standing; local steps ([KB93]), and
#: a while of standing, in which no foot moves.
StepKind = Literal["start", "walk", "stop", "forward", "backward", "lateral", "turn", "stand"]
#: The kinds that are no part of a walk.
LOCAL_KINDS = ("forward", "backward", "lateral", "turn", "stand")
#: Ways to lean into a curve: feet outside as people do, trunk inside as [KB92a], not at all.
BANKINGS = ("body", "trunk", "none")
LEFT, RIGHT = 0, 1
SIDES = ("left", "right")
#: +1 where +X is, -1 on the other side: multiplies lateral offsets.
SIDE_SIGN = np.array([1.0, -1.0])
SIDE_SIGN.flags.writeable = False
HEEL, BALL, TOE = 0, 1, 2
#: m/s^2, the standard value.
GRAVITY = 9.80665

UP = np.array([0.0, 1.0, 0.0])
UP.flags.writeable = False


def ahead(heading: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n 3"]:
    """Horizontal unit vector(s) the walker faces at ``heading`` radians.

    >>> ahead(0.0).tolist()
    [0.0, 0.0, 1.0]
    """
    if isinstance(heading, float):  # one footstep: much quicker than arrays of one
        return np.array([math.sin(heading), 0.0, math.cos(heading)])
    return _level_vectors(np.sin(heading), np.cos(heading))


def leftward(heading: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n 3"]:
    """Horizontal unit vector(s) to the walker's left at ``heading`` radians.

    >>> leftward(0.0).tolist()
    [1.0, 0.0, -0.0]
    """
    if isinstance(heading, float):
        return np.array([math.cos(heading), 0.0, -math.sin(heading)])
    return _level_vectors(np.cos(heading), -np.sin(heading))


def _level_vectors(
    x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
) -> Float[np.ndarray, "*n 3"]:
    """Stacked, each component contiguous: quick to compute with."""
    x = np.asarray(x)
    out = np.zeros((3, *x.shape))
    out[0], out[2] = x, z
    return out.transpose(*range(1, out.ndim), 0)
