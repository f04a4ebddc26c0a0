"""Make the pictures of local steps and turns: docs/pictures/step-*.

The paper's figures 10 to 13, snapshots of a forward, backward and lateral step and of a turn;
footprints from above; and, where the measured data are at hand (GAITSMITH_DATA), a measured
side step, turn on the spot, start and stop beside ours.
"""

from __future__ import annotations

import os
import warnings
from pathlib import Path

import numpy as np

import gaitsmith
from gaitsmith.viz.canvas import Canvas
from gaitsmith.viz.render import camera, draw_figure
from gaitsmith.viz.tracks import Tracks, tracks_of

TARGET = Path(__file__).parent.parent / "docs/pictures"
DATA = Path(os.environ.get("GAITSMITH_DATA", "../shared/data")) / "permissive/accad"
ROWS = (
    ("step forward 0.55", "Forward step", "right", (0.0, 0.42, 0.66, 0.86, 1.16, 1.45, 1.75)),
    ("step back 0.4", "Backward step", "right", (0.0, 0.42, 0.66, 0.86, 1.16, 1.45, 1.75)),
    ("step left 0.6", "Lateral step", "front", (0.0, 0.30, 0.55, 0.80, 0.98, 1.25, 1.60)),
    (
        "turn left 90",
        "Turnaround, 90 deg",
        "three-quarter",
        (0.0, 0.45, 0.80, 1.20, 1.65, 2.10, 2.80),
    ),
)
COLORS = ("#3567a8", "#b5543c")


def snapshots(path: Path) -> None:
    """Each step in a row, seen from one place, the person where the motion has them."""
    width, height = 1500, 350
    canvas = Canvas(width, height * len(ROWS) + 40, fine=2)
    for row, (script, title, view, times) in enumerate(ROWS):
        tracks = tracks_of(gaitsmith.walk(do=script, fps=120))
        level = height * (row + 1) - 14.0
        canvas.box(20.0, level - 6.0, width - 20.0, level + 14.0, "#e8e6e0")
        for k, second in enumerate(times):
            frame = min(round(second * 120), len(tracks.motion) - 1)
            middle = 120.0 + k * (width - 340.0) / (len(times) - 1)
            seen = camera(
                view,
                heading=0.0,
                target=np.zeros(3),
                center=(middle * canvas.fine, level * canvas.fine),
                scale=150.0 * canvas.fine,
            )
            draw_figure(
                canvas.image, tracks.figure, tracks.positions[frame], tracks.world[frame], seen
            )
            canvas.text(middle - 20.0, level + 30.0, f"{second:.2f} s")
        canvas.text(24.0, level - height + 60.0, f"{title}: {script}")
    canvas.save(path)


def top_views(path: Path) -> None:
    """Footprints, hips and swinging ankles from above."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    from curve_pictures import top_view

    scripts = (
        "step forward 0.55",
        "step back 0.4",
        "step left 0.6",
        "turn left 90; stand 0.5",
        "turn right 90; walk to -2,0",
        "walk to 0,2; turn left 90; step back 0.3; walk to 2,3",
    )
    figure, axes = plt.subplots(2, 3, figsize=(11, 7))
    for ax, script in zip(axes.flat, scripts, strict=True):
        top_view(ax, gaitsmith.walk(do=script, fps=120), script)
    figure.tight_layout()
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)


class Person:
    """Curves of one person: hips, ankles, yaw of pelvis and head, from a clip or ours."""

    def __init__(self, motion: gaitsmith.Motion) -> None:
        tracks: Tracks = tracks_of(motion)
        at = tracks.motion.skeleton.index
        self.fps, self.time = tracks.motion.fps, np.arange(len(tracks.motion)) / tracks.motion.fps
        points = tracks.positions
        self.hips = points[:, at("hips")]
        feet = np.stack([points[:, at(f"{s}Foot")] for s in ("left", "right")], axis=1)
        self.lift = feet[..., 1] - np.percentile(feet[..., 1], 5, axis=0)
        step = max(1, round(self.fps / 20))
        speed = np.linalg.norm(np.gradient(feet, axis=0), axis=-1) * self.fps
        kernel = np.ones(step) / step
        moving = np.stack([np.convolve(v, kernel, "same") for v in speed.T], axis=-1) > 0.25
        self.swings = [self._runs(moving[:, s]) for s in (0, 1)]
        ways = points[:, at("leftUpperLeg")] - points[:, at("rightUpperLeg")]
        self.pelvis = np.degrees(np.unwrap(np.arctan2(-ways[:, 2], ways[:, 0])))
        from gaitsmith.geometry.rotations import rotate

        face = rotate(tracks.world[:, at("head")], np.array([0.0, 0.0, 1.0]))
        self.head = np.degrees(np.unwrap(np.arctan2(face[:, 0], face[:, 2])))
        self.across = ways[0, [0, 2]] / np.linalg.norm(ways[0, [0, 2]])
        self.ankles = feet

    def _runs(self, moving: np.ndarray) -> list[tuple[float, float]]:
        edges = np.flatnonzero(np.diff(np.concatenate([[0], moving.astype(int), [0]])))
        return [(a / self.fps, b / self.fps) for a, b in edges.reshape(-1, 2) if b - a > 3]


def measured(path: Path) -> None:
    """A man's side step, turn, start and stop beside ours; prints what is compared."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    def man(name: str) -> Person:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return Person(gaitsmith.load(DATA / name))

    pairs = {
        "side step": (man("Male2_B22_SideStepLeft.bvh"), "step left 0.62"),
        "turn on the spot": (man("Male2_E2_TurnAroundLeft.bvh"), "turn left 360"),
        "stand to walk": (man("Male2_B1_StandToWalk.bvh"), "walk to 0,6"),
        "walk to stand": (man("Male2_B2_WalkToStand.bvh"), "walk to 0,6"),
    }
    figure, axes = plt.subplots(2, 3, figsize=(12, 6.5))
    for name, (his, script) in pairs.items():
        ours = Person(gaitsmith.walk(do=script, body=1.83, fps=120))
        for who, p, color in (("man", his, "k"), ("ours", ours, "#2a7")):
            swings = sorted((b - a, s) for s in (0, 1) for a, b in p.swings[s])
            drop = 100.0 * (np.percentile(p.hips[:, 1], 98) - p.hips[:, 1].min())
            lengths = [round(v, 2) for v, _ in swings]
            print(
                f"{name}, {who}: swings {lengths} s, lift {100 * p.lift.max():.1f} cm, "
                f"drop {drop:.1f} cm, pelvis {np.ptp(p.pelvis):.0f} deg, "
                f"{p.time[-1]:.1f} s"
            )
            begin = min(a for s in (0, 1) for a, _ in p.swings[s])
            end = max(b for s in (0, 1) for _, b in p.swings[s])
            t = p.time - begin
            if name == "side step":
                way = (p.hips[:, [0, 2]] - p.hips[0, [0, 2]]) @ p.across
                axes[0, 0].plot(t, way, color=color, label=who)
                axes[0, 1].plot(t, 100.0 * (p.hips[:, 1] - p.hips[0, 1]), color=color)
                for side in (0, 1):
                    axes[0, 2].plot(t, 100.0 * p.lift[:, side], color=color, ls="-:"[side])
            elif name == "turn on the spot":
                axes[1, 0].plot(t, p.pelvis - p.pelvis[0], color=color)
                axes[1, 1].plot(t, p.head - p.pelvis - (p.head - p.pelvis)[0], color=color, lw=0.8)
            elif name == "stand to walk":
                speed = np.linalg.norm(np.gradient(p.hips[:, [0, 2]], axis=0), axis=-1) * p.fps
                axes[1, 2].plot(t[t < 2.6], speed[t < 2.6], color=color)
            else:
                speed = np.linalg.norm(np.gradient(p.hips[:, [0, 2]], axis=0), axis=-1) * p.fps
                near = (p.time - end > -1.8) & (p.time - end < 0.8)
                axes[1, 2].plot((p.time - end)[near] + 5.0, speed[near], color=color, ls="--")
    titles = (
        "side step: hips aside (m)",
        "side step: hips' height (cm)",
        "side step: ankles' lift (cm)",
        "turn on the spot: pelvis (deg)",
        "turn on the spot: head against pelvis (deg)",
        "speed (m/s): start, and stop (dashed)",
    )
    for ax, title in zip(axes.flat, titles, strict=True):
        ax.set_title(title, fontsize=9)
        ax.set_xlabel("s", fontsize=7)
        ax.tick_params(labelsize=7)
    axes[0, 0].legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)


def main() -> None:
    """Make them all."""
    TARGET.mkdir(parents=True, exist_ok=True)
    snapshots(TARGET / "step-snapshots.png")
    top_views(TARGET / "step-above.png")
    if DATA.exists():
        measured(TARGET / "step-measured.png")
    else:
        print(f"no {DATA}: the measured person is left out")


if __name__ == "__main__":
    main()
