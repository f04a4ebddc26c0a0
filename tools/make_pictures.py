"""Make the pictures of the docs and the README: docs/pictures/*.

Contact sheets of two bodies at three step lengths, an animated walk, and joint curves. They
are committed, so that the docs build without running anything; run this after a change that
moves a body, and look at them.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import gaitsmith
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.viz import contact_sheet, gif
from gaitsmith.viz.canvas import Area, Canvas
from gaitsmith.viz.figures import figure_row
from gaitsmith.viz.tracks import stride_frames, tracks_of

TARGET = Path(__file__).parent.parent / "docs/pictures"
BODIES = {"adult": 1.75, "child": 1.2}
RATIOS = {"short": 0.5, "usual": 0.85, "long": 1.0}

#: Heights and speeds (m/s, of the middle one; the others at the same Froude number).
PEOPLE = (1.2, 1.75, 2.05)
SPEEDS = {"slow": 0.75, "usual": 1.3, "fast": 1.75}


def montage(path: Path, view: str) -> None:
    """`neutral` on three bodies (rows) at three speeds (columns), a stride each."""
    wide, high, figures = 500, 178, 6
    canvas = Canvas(3 * wide + 40, 3 * high + 40, fine=2)
    for row, height in enumerate(PEOPLE):
        leg = gaitsmith.body_from(height).leg_length
        share = np.sqrt(leg / gaitsmith.body_from(PEOPLE[1]).leg_length)
        for column, (word, speed) in enumerate(SPEEDS.items()):
            motion = gaitsmith.walk(distance=8 * leg, body=height, speed=speed * share)
            tracks = tracks_of(motion)
            frames, _ = stride_frames(motion, figures)
            x, y = 20 + column * wide, 34 + row * high
            figure_row(canvas, tracks, Area(x, y, x + wide - 20, y + high - 12), frames, view)
            canvas.text(x, y - 6, f"{height:g} m, {word}, {speed * share:.2f} m/s", size=12)
    canvas.save(path)


def ends(path: Path) -> None:
    """The first and the last two seconds of `neutral`, from the right and from ahead."""
    motion = gaitsmith.walk(distance=5.0)
    tracks, count = tracks_of(motion), len(motion)
    steps = np.arange(0, 100, 11)
    canvas = Canvas(1200, 900, fine=2)
    for row, frames in enumerate((steps, count - 1 - steps[::-1])):
        for line, view in enumerate(("right", "front")):
            top = 20 + (2 * row + line) * 220
            figure_row(canvas, tracks, Area(20, top, 1180, top + 205), frames, view)
    canvas.save(path)


def knee_and_hip(motion: gaitsmith.Motion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stride share (%), thigh elevation and knee flexion (deg) of the left leg, middle stride."""
    positions, index = joint_positions(motion), motion.skeleton.index
    hip, knee, ankle = (
        positions[:, index(f"left{part}")] for part in ("UpperLeg", "LowerLeg", "Foot")
    )

    def forward(v: np.ndarray) -> np.ndarray:
        return np.degrees(np.arctan2(v[:, 2], -v[:, 1]))

    thigh, shin = forward(knee - hip), forward(ankle - knee)
    labels = motion.labels
    assert labels is not None
    lefts = np.flatnonzero(labels.footstep_side == 0)
    middle = lefts[len(lefts) // 2]
    start, end = labels.footstep_time[middle], labels.footstep_time[middle + 2]
    share = np.linspace(0.0, 100.0, 101)
    at = start + (end - start) * share / 100.0
    return (
        share,
        np.interp(at, motion.times, thigh),
        np.interp(at, motion.times, thigh - shin),
    )


def joint_curves(path: Path) -> None:
    """Thigh elevation and knee flexion over the stride, step lengths beside each other."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 2, figsize=(10, 6), sharex=True, sharey="row")
    for column, (name, height) in enumerate(BODIES.items()):
        leg = gaitsmith.body_from(height).leg_length
        for word, ratio in RATIOS.items():
            motion = gaitsmith.walk(
                distance=12 * leg, body=height, step_length=ratio * leg, fps=120
            )
            share, thigh, knee = knee_and_hip(motion)
            label = f"{word}: {ratio:g} leg lengths"
            axes[0, column].plot(share, thigh, label=label)
            axes[1, column].plot(share, knee, label=label)
        axes[0, column].set_title(f"{name}, {height:g} m")
        axes[1, column].set_xlabel("% of the stride, from left heel strike")
    axes[0, 0].set_ylabel("thigh elevation (deg)")
    axes[1, 0].set_ylabel("knee flexion (deg)")
    axes[0, 0].legend(frameon=False, fontsize=8)
    for ax in axes.flat:
        ax.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, dpi=80, metadata={"Software": None})


def main() -> None:
    """Make them all."""
    TARGET.mkdir(parents=True, exist_ok=True)
    for name, height in BODIES.items():
        leg = gaitsmith.body_from(height).leg_length
        for word, ratio in RATIOS.items():
            motion = gaitsmith.walk(
                distance=round(6.5 * leg, 1), body=height, step_length=ratio * leg
            )
            contact_sheet(motion, TARGET / f"walk-{name}-{word}.png", width=1100)
    contact_sheet(gaitsmith.walk(distance=5.0), TARGET / "walk.png", width=1100)
    gif(gaitsmith.walk(distance=4.0), TARGET / "walk.gif", width=360, fps=12.5)
    montage(TARGET / "neutral-side.png", "right")
    montage(TARGET / "neutral-front.png", "front")
    ends(TARGET / "neutral-ends.png")
    joint_curves(TARGET / "joint-curves.png")


if __name__ == "__main__":
    main()
