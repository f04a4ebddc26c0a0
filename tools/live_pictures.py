"""Make the pictures of live control: docs/pictures/live-*.

Somebody is steered through gates by a pilot who sees only the next gate, ten times a second; the
way from above, and the walk as a contact sheet.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
import matplotlib.pyplot as plt

import gaitsmith
from curve_pictures import top_view
from gaitsmith import Controls, LiveWalker
from gaitsmith.viz import contact_sheet

TARGET = Path(__file__).parent.parent / "docs/pictures"
#: Middles of the gates, x,z, meters, and half their width; speeds wished on the way to each.
GATES = ((0.0, 2.5), (1.3, 4.6), (-0.4, 6.6), (-2.4, 5.0), (-3.2, 2.2))
HALF, SPEEDS = 0.45, (1.3, 1.1, 1.5, 1.0, 1.3)
REACHED, EACH = 0.35, 0.1


def steered() -> tuple[gaitsmith.Motion, list[tuple[float, float]]]:
    """The walk through the gates, and where the hips were when the pilot spoke."""
    walker, told = LiveWalker(), []
    pose = walker.advance(0.3, Controls(stop=True))
    for gate, speed in zip(GATES, SPEEDS, strict=True):
        goal, ahead = np.array(gate), True
        while ahead:
            here = pose.root_position[[0, 2]]
            way = goal - here
            heading = float(np.arctan2(way[0], way[1]))
            told.append((float(here[0]), float(here[1])))
            pose = walker.advance(EACH, Controls(heading=heading, speed=speed))
            ahead = float(np.linalg.norm(goal - pose.root_position[[0, 2]])) > REACHED
    walker.advance(2.2, Controls(stop=True))
    return walker.motion(), told


def main() -> None:
    """Write the pictures."""
    motion, told = steered()
    contact_sheet(motion, TARGET / "live-sheet.png")
    figure, ax = plt.subplots(figsize=(7.0, 7.0), dpi=110)
    top_view(ax, motion, "Steered through gates: footprints, hips, swinging ankles")
    ax.plot(*np.array(told).T, ".", color="0.3", ms=3, label="told")
    before = np.zeros(2)
    for gate in map(np.array, GATES):
        way = (gate - before) / np.linalg.norm(gate - before)
        posts = gate + HALF * np.outer((-1.0, 1.0), (way[1], -way[0]))
        ax.plot(*posts.T, color="#2f7d4f", lw=1, ls=":")
        ax.plot(*posts.T, "o", color="#2f7d4f", ms=7)
        before = gate
    ax.legend(fontsize=8, loc="best")
    figure.tight_layout()
    figure.savefig(TARGET / "live-above.png")


if __name__ == "__main__":
    main()
