"""Make the pictures of styles: docs/pictures/style-*.png.

A contact sheet of each built-in style, walked by the 1.75 m body; the paper's figure 6 (weights
0.5, 1 and 1.5) and figure 7 (legs with given and with found weights), of styles by rule.
"""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import gaitsmith
from gaitsmith.gait.neutral import subject
from gaitsmith.geometry.rotations import sign_continuous
from gaitsmith.style.composition import composition
from gaitsmith.style.examples import examples_of
from gaitsmith.style.restyle import restyled
from gaitsmith.style.rules import RULES, Rule
from gaitsmith.style.weights import Mix, PartMix
from gaitsmith.viz import palette
from gaitsmith.viz.canvas import Area, Canvas
from gaitsmith.viz.figures import figure_row
from gaitsmith.viz.tracks import stride_frames, tracks_of
from gaitsmith.walks.learned import gait_of_cycle

if TYPE_CHECKING:
    from gaitsmith.gait.cycle import Cycle

TARGET = Path(__file__).parent.parent / "docs/pictures"
WIDTH, SIDE, FRONT, EDGE, LINE, FIGURES = 1100, 180, 145, 20, 26, 8


def sheet(rows: list[tuple[str, gaitsmith.Motion, str]], path: Path) -> None:
    """Rows of figures, each with a caption: from the ``"right"`` or from the ``"front"``."""
    heights = [SIDE if view == "right" else FRONT for _, _, view in rows]
    canvas = Canvas(WIDTH, sum(heights) + (LINE + 8) * len(rows) + EDGE, fine=2)
    top = float(EDGE)
    for (caption, motion, view), height in zip(rows, heights, strict=True):
        tracks = tracks_of(motion)
        frames, _ = stride_frames(motion, FIGURES)
        canvas.text(EDGE, top + 12, caption, color=palette.INK)
        area = Area(EDGE, top + LINE, WIDTH - EDGE, top + LINE + height)
        figure_row(canvas, tracks, area, frames, view)
        top += LINE + 8 + height
    canvas.save(path)


def still(cycle: Cycle, strides: float = 1.0, rate: int = 60) -> gaitsmith.Motion:
    """A stride as it is in the cycle, before any contact stage."""
    count = round(strides * cycle.duration * rate) + 1
    phase = np.arange(count) / (rate * cycle.duration)
    center, turned = cycle.at(phase)
    center = center + phase[:, None] * np.array([0.0, 0.0, cycle.stride_length])
    return gaitsmith.Motion(cycle.skeleton, center, sign_continuous(turned), float(rate))


def main(names: list[str]) -> None:
    """Write the pictures of ``names``, or all."""
    warnings.simplefilter("ignore", gaitsmith.GaitsmithWarning)
    for name in names or sorted(RULES):
        if name in RULES:
            motion = gaitsmith.walk(distance=7.0, gait=name, fps=60)
            about = f"{name}: {RULES[name].about} (made by rule)"
            rows = [(about, motion, "right"), ("from ahead", motion, "front")]
            sheet(rows, TARGET / f"style-{name}.png")
    if names and "mixes" not in names:
        return
    examples = examples_of(
        {n: restyled(RULES.get(n, Rule())) for n in ("neutral", *RULES)}, subject()
    )
    rows = []
    for weight in (0.5, 1.0, 1.5):
        cycle = composition(examples, Mix({"sad": weight})).cycle
        gait = gait_of_cycle(cycle, subject(), name=f"{weight}")
        motion = gaitsmith.walk(distance=7.0, gait=gait, body=subject(), fps=60)
        step, cadence = 0.5 * cycle.stride_length, 120.0 / cycle.duration
        caption = f"sad, weight {weight}: steps of {step:.2f} m, {cadence:.0f} a minute"
        rows.append((caption, motion, "right"))
    sheet(rows, TARGET / "style-weights.png")
    rows = []
    for how in ("given", "optimized"):
        mix = Mix({"elderly": 1.0}, parts={"legs": PartMix({"happy": 1.0})}, legs=how, speed=0.9)
        cycle = composition(examples, mix).cycle
        caption = f"elderly with the legs of happy, weights {how}"
        rows.append(
            (f"{caption}: steps of {0.5 * cycle.stride_length:.2f} m", still(cycle), "right")
        )
    sheet(rows, TARGET / "style-legs.png")


if __name__ == "__main__":
    main(sys.argv[1:])
