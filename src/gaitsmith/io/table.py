"""CSV for spreadsheets and plotting: a header line, then one row a frame.

Columns, in this order; meters with six decimals, world frame, +Y up:

* ``time_s``, ``frame``: seconds from the first frame, frame index from 0
* ``<joint>_x``, ``<joint>_y``, ``<joint>_z`` of every joint, named as in the skeleton
* ``sole_left_heel_x`` ... ``sole_right_toe_z``: sole points, where the skeleton has soles
* ``contact_left_heel`` ... ``contact_right_toe``: 1 while the point is on the ground and does
  not move, else 0; where contacts are known
* ``phase``, ``step``: time since the last landing over the step's duration, and the index of
  the footstep that lands next; where the motion has labels

This is a table to look at, not a motion to load again: it holds no rotations.
(The module is not called ``csv`` lest it be taken for Python's.)
"""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.io._text import number_rows
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float

    from gaitsmith.motion.motion import Motion

_SOLE = ("heel", "ball", "toe")
_DECIMALS = 6


def write_csv(motion: Motion, path: Path) -> None:
    """Write ``motion`` to ``path`` as CSV; see the top of this module for the columns.

    Raises
    ------
    InvalidInputError
        If there is no frame, or a position is beyond what six decimals hold.
    """
    if len(motion) == 0:
        raise InvalidInputError("a CSV needs at least one frame, this motion has none")
    columns = _columns(motion)
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(columns)
    whole = np.array([n in ("frame", "step") or n.startswith("contact_") for n in columns])
    values = np.stack(list(columns.values()), axis=-1)
    with path.open("wb") as file:
        file.write(line.getvalue().encode("utf-8"))
        for rows in number_rows(values, decimals=_DECIMALS, separator=",", whole=whole):
            file.write(rows)


def _columns(motion: Motion) -> dict[str, Float[np.ndarray, "frames"]]:
    """Values of each column by its name, in order."""
    skeleton = motion.skeleton
    positions, world = motion_kinematics(motion)
    columns = {"time_s": motion.times, "frame": np.arange(len(motion), dtype=np.float64)}
    for joint, name in enumerate(skeleton.names):
        columns |= _points(name, positions[:, joint])
    points = [(s, p, f"{SIDES[s]}_{_SOLE[p]}") for s in range(2) for p in range(3)]
    if skeleton.soles is not None:
        soles = sole_positions(skeleton, positions, world)
        for side, point, name in points:
            columns |= _points(f"sole_{name}", soles[:, side, point])
    if motion.contacts is not None:
        for side, point, name in points:
            columns[f"contact_{name}"] = motion.contacts[:, side, point].astype(np.float64)
    if motion.labels is not None:
        columns["phase"] = motion.labels.phase
        columns["step"] = motion.labels.step.astype(np.float64)
    return columns


def _points(
    name: str, positions: Float[np.ndarray, "frames 3"]
) -> dict[str, Float[np.ndarray, "frames"]]:
    return {f"{name}_{axis}": positions[:, i] for i, axis in enumerate("xyz")}
