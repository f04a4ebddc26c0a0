"""Make the pictures of [SM01]: docs/pictures/elevation-walker.png, elevation-figures.png.

The first: one data set walks three figures, as in section 7; uphill and downhill; where the
steps of the five sets lie, and the preferred ones. The second: Figures 13 and 15 to 17
anew, the measured man, the exact walker and the product's.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib as mpl
import numpy as np
from PIL import Image

mpl.use("Agg")
import matplotlib.pyplot as plt

import gaitsmith
from gaitsmith.body.presets import body_from
from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.ground import Slope
from gaitsmith.motion.kinematics import forward_kinematics, joint_positions
from gaitsmith.plan.slope_steps import preferred_step
from gaitsmith.synthesis.elevation_exact import ExactWalker
from gaitsmith.walks.elevation_sets import built_in_sets, neutral_legs
from gaitsmith.walks.interpolate import ElevInterp

#: Share of the height of a contact sheet that shows the figures.
FIGURES = (0.072, 0.28)
PICTURES = Path(__file__).parent.parent / "docs/pictures"
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


def even(values: np.ndarray) -> np.ndarray:
    """Centimeters ahead of a point that travels evenly; a whole stride, its end left out."""
    ahead = 100.0 * (values - values[0] - (values[-1] - values[0]) * np.linspace(0, 1, len(values)))
    return ahead[:-1] - ahead[:-1].mean()


def of_data() -> dict[str, np.ndarray]:
    """Left hip, knee, ankle and the hips' middle ahead, meters, of the measured man's stride."""
    cycle = neutral_cycle()
    phase = np.arange(len(cycle.center) + 1) / len(cycle.center)
    root, rotations = cycle.at(phase % 1.0)
    root = root + phase[:, None] * [0.0, 0.0, cycle.stride_length]
    places = forward_kinematics(cycle.skeleton, root, rotations)[0]
    names = cycle.skeleton
    out = {
        name: places[:, names.index(f"left{part}"), 2]
        for name, part in (("hip", "UpperLeg"), ("knee", "LowerLeg"), ("ankle", "Foot"))
    }
    other = places[:, names.index("rightUpperLeg"), 2]
    return {"phase": phase, **out, "middle": 0.5 * (out["hip"] + other)}


def of_exact() -> dict[str, np.ndarray]:
    """The same of the exact walker on the normal set."""
    walker = ExactWalker(built_in_sets()[:1], subject())
    steps = walker.walk(4, lambda t: 0.0 * t, frames=50)[2:]
    out = {"phase": np.linspace(0.0, 1.0, 101)}
    for name in ("hip", "knee", "ankle"):
        first, second = (getattr(legs, name)[:, 0, 2] for legs in steps)
        out[name] = np.concatenate([first[:-1], second])
    first, second = (legs.hip.mean(axis=1)[:, 2] for legs in steps)
    out["middle"] = np.concatenate([first[:-1], second])
    return out


def of_product() -> dict[str, np.ndarray]:
    """The same of ``walk --walker elevation``."""
    legs = neutral_legs()
    motion = gaitsmith.walk(
        distance=9.0, body=legs.body, walker="elevation", step_length=legs.length, fps=240
    )
    labels, names = motion.labels, motion.skeleton
    lands = [t for t, s in zip(labels.footstep_time, labels.footstep_side, strict=True) if s == 0]
    first, last = (round(t * motion.fps) for t in lands[3:5])
    places = joint_positions(motion)[first : last + 1, :, 2]
    out = {
        name: places[:, names.index(f"left{part}")]
        for name, part in (("hip", "UpperLeg"), ("knee", "LowerLeg"), ("ankle", "Foot"))
    }
    middle = 0.5 * (out["hip"] + places[:, names.index("rightUpperLeg")])
    return {"phase": np.linspace(0.0, 1.0, len(places)), **out, "middle": middle}


def figures() -> None:
    """Figures 13 and 15 to 17."""
    figure, axes = plt.subplots(1, 3, figsize=(13.0, 4.2), dpi=110)
    rho = np.radians(np.linspace(-14.0, 14.0, 141))
    length, height = preferred_step(rho, body_from(1.75))
    axes[0].plot(100.0 * height, 100.0 * length, color=COLORS[0])
    axes[0].set(xlabel="step height (cm)", ylabel="step length (cm)")
    axes[0].set_title("Fig. 13: preferred steps, 1.75 m", fontsize=10)
    walks = (
        ("product", of_product(), {"lw": 4.0, "alpha": 0.35}),
        ("measured", of_data(), {"lw": 1.3}),
        ("exact", of_exact(), {"lw": 1.3, "ls": "--"}),
    )
    for label, walk, line in walks:
        start = walk["ankle"][int(0.25 * (len(walk["phase"]) - 1))]
        for name, color in zip(("hip", "knee", "ankle"), ("0.35", *COLORS), strict=True):
            ahead, named = walk[name] - start, f"{name}, {label}"
            axes[1].plot(walk["phase"], ahead, color=color, label=named, **line)
        axes[2].plot(walk["phase"][:-1], even(walk["middle"]), label=label, **line)
    axes[1].set(xlabel="stride phase", ylabel="ahead of the stance ankle (m)")
    axes[1].set_title("Fig. 15: hip, knee, ankle", fontsize=10)
    axes[1].legend(fontsize=6)
    axes[2].set(xlabel="stride phase", ylabel="ahead of even travel (cm)")
    axes[2].set_title("Figs. 16, 17: the pelvis", fontsize=10)
    axes[2].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(PICTURES / "elevation-figures.png")


def people() -> None:
    """One data set walks three figures, and up and down a slope: the product's walker."""
    asked = ((1.75, "flat"), (1.2, "flat"), (2.1, "flat"), (1.75, "slope:10"), (1.75, "slope:-10"))
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for body, ground in asked:
            motion = gaitsmith.walk(distance=6.0, body=body, ground=ground, walker="elevation")
            sheet = Image.open(gaitsmith.save(motion, Path(folder) / "sheet.png")).convert("RGB")
            top, bottom = (int(share * sheet.height) for share in FIGURES)
            rows.append(sheet.crop((0, top, sheet.width, bottom)))
    out = Image.new("RGB", (rows[0].width, sum(row.height for row in rows)), "white")
    below = 0
    for row in rows:
        out.paste(row, (0, below))
        below += row.height
    out = out.resize((out.width * 5 // 8, out.height * 5 // 8), Image.Resampling.LANCZOS)
    out.quantize(96).save(PICTURES / "elevation-people.png", optimize=True)


def main() -> None:
    """Write the pictures."""
    figures()
    people()
    figure, axes = plt.subplots(2, 3, figsize=(13.0, 7.2), dpi=110)
    for ax, (title, height, degrees) in zip(axes.flat, PANELS, strict=False):
        sticks(ax, height, degrees)
        ax.set_title(title, fontsize=10)
    steps_of_sets(axes[1, 2])
    axes[1, 2].set_title("adult: steps of the five sets (red: constructed)", fontsize=10)
    figure.tight_layout()
    figure.savefig(PICTURES / "elevation-walker.png")


if __name__ == "__main__":
    main()
