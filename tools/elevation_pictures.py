"""Make the picture of the exact elevation walker: docs/pictures/elevation-walker.png.

One data set walks three figures, as in [SM01] section 7; uphill and downhill; where steps of
the five sets lie, and the preferred steps of Figure 13.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
import matplotlib.pyplot as plt

from gaitsmith.body.presets import body_from
from gaitsmith.ground import Slope
from gaitsmith.plan.slope_steps import preferred_step
from gaitsmith.synthesis.elevation_exact import ExactWalker
from gaitsmith.walks.elevation_sets import built_in_sets
from gaitsmith.walks.interpolate import ElevInterp

TARGET = Path(__file__).parent.parent / "docs/pictures/elevation-walker.png"
COLORS = ("#3567a8", "#b5543c")
PANELS = (
    ("adult, 1.75 m", 1.75, 0.0),
    ("child, 1.2 m", 1.2, 0.0),
    ("tall, 2.1 m", 2.1, 0.0),
    ("adult, 8 deg up", 1.75, 8.0),
    ("adult, 8 deg down", 1.75, -8.0),
)


def sticks(ax, height: float, degrees: float) -> None:
    """Two steps from aside, an instant every sixth of a step."""
    body, ground = body_from(height), Slope(degrees)
    walker = ExactWalker(built_in_sets(), body, ground=ground)
    length = 0.8 * body.leg_length if degrees == 0.0 else 0.7 * body.leg_length
    steps = walker.walk(4, lambda t: 0.0 * t, length=length, frames=24)[2:]
    for legs in steps:
        corners = legs.sole.shape[2] // 2
        for frame in range(0, 25, 4):
            for side in (1, 0):
                chain = [legs.top[frame], legs.hip[frame, side], legs.knee[frame, side]]
                chain = np.array([*chain, legs.ankle[frame, side]])
                ax.plot(chain[:, 2], chain[:, 1], color=COLORS[side], lw=0.9)
                sole = np.concatenate([legs.sole[frame, side, :corners], chain[-1:]])
                ax.plot(sole[:, 2], sole[:, 1], color=COLORS[side], lw=0.9)
    z = np.array(ax.get_xlim())
    ax.fill_between(z, ground.height(0.0 * z, z), ax.get_ylim()[0] - 1.0, color="0.92", zorder=0)
    ax.set_ylim(*(float(ground.height(0.0, z.mean())) + np.array([-0.25, 1.35]) * body.leg_length))
    ax.set(aspect="equal", xticks=[], yticks=[])
    ax.spines[:].set_visible(False)


def steps_of_sets(ax) -> None:
    """Length and height of the sets' steps, and those that people prefer."""
    body = body_from(1.75)
    plan = ElevInterp(built_in_sets(), body)
    for dataset, (length, height) in zip(plan.sets, plan.steps, strict=True):
        ax.plot(length, height, "o", color=COLORS[bool(dataset.constructed)])
        ax.annotate(f" {dataset.name}", (length, height), fontsize=8)
    length, height = preferred_step(np.radians(np.linspace(-14.0, 14.0, 57)), body)
    ax.plot(length, height, color="0.4", lw=1.2, label="preferred, Eqs. 11-12")
    ax.set(xlabel="step length (m)", ylabel="step height (m)")
    ax.legend(fontsize=8, loc="lower right")


def main() -> None:
    """Write the picture."""
    figure, axes = plt.subplots(2, 3, figsize=(13.0, 7.2), dpi=110)
    for ax, (title, height, degrees) in zip(axes.flat, PANELS, strict=False):
        sticks(ax, height, degrees)
        ax.set_title(title, fontsize=10)
    steps_of_sets(axes[1, 2])
    axes[1, 2].set_title("adult: steps of the five sets (red: constructed)", fontsize=10)
    figure.tight_layout()
    figure.savefig(TARGET)


if __name__ == "__main__":
    main()
