"""Speed as ratios within one run: `make bench`.

Absolute times differ from machine to machine and from minute to minute; what is measured here
is always divided by something measured in the same run. Medians of CPU time (processes: user
plus system time), the two sides of each ratio taken in turn.
"""

from __future__ import annotations

import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import gaitsmith
from gaitsmith.ground import HeightField
from gaitsmith.io.bvh import write_bvh
from gaitsmith.motion.kinematics import forward_kinematics
from gaitsmith.walks import winter
from gaitsmith.walks.generalize import generalize

REPEATS = 9
#: Distance that makes a clip of about 20,000 frames at 120 frames per second.
LONG = 224.0
BYTECODE = tempfile.TemporaryDirectory()


def cpu(run) -> float:
    start = time.process_time()
    run()
    return time.process_time() - start


def ratio(run, yardstick, repeats: int = REPEATS) -> tuple[float, float, float]:
    """Median of ``run``, of ``yardstick``, and of their ratios pair by pair."""
    run(), yardstick()
    pairs = [(cpu(run), cpu(yardstick)) for _ in range(repeats)]
    return (
        statistics.median(a for a, _ in pairs),
        statistics.median(b for _, b in pairs),
        statistics.median(a / b for a, b in pairs),
    )


def process(*command: str) -> None:
    # as when installed: bytecode is there from the second run on, whatever the environment says
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = BYTECODE.name
    nothing = subprocess.DEVNULL
    subprocess.run(command, check=True, stdout=nothing, stderr=nothing, env=environment)


def children(run) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def process_ratio(command: list[str], yardstick: list[str]) -> float:
    process(*command), process(*yardstick)
    pairs = [
        (children(lambda: process(*command)), children(lambda: process(*yardstick)))
        for _ in range(REPEATS)
    ]
    return statistics.median(a / b for a, b in pairs)


def hilly() -> HeightField:
    """Relief of 0.2 m over 10 m, 60 m by 60 m."""
    x = np.arange(-15.0, 60.0, 0.1)
    height = 0.1 * np.sin(0.6 * x)[:, None] * np.cos(0.6 * x)[None]
    return HeightField(height, 0.1, (-15.0, -15.0))


def row(what: str, value: float, bar: float | None, note: str = "") -> None:
    limit = "" if bar is None else f"bar {bar:g}"
    mark = "" if bar is None or value <= bar else "  ABOVE"
    print(f"{what:58s} {value:8.2f}   {limit:10s}{mark} {note}")


def main() -> None:
    print(f"Python {platform.python_version()}, NumPy {np.__version__}, {os.cpu_count()} cores")
    motion = gaitsmith.walk(distance=LONG, fps=120)
    frames = len(motion)

    def kinematics() -> None:
        forward_kinematics(motion.skeleton, motion.root_position, motion.rotations)

    own, yard, times = ratio(lambda: gaitsmith.walk(distance=LONG, fps=120), kinematics)
    row(
        f"walk, {frames} frames / forward kinematics of the clip",
        times,
        7.0,
        f"{1e6 * own / frames:.1f} us against {1e6 * yard / frames:.1f} us a frame",
    )

    turns = np.linspace(0.0, 28.0, 60)
    curve = np.stack(
        [
            6.0 * np.sin(turns) * (1.0 + 0.3 * np.sin(3.0 * turns)),
            6.0 * np.cos(turns) + 3.0 * turns,
        ],
        axis=-1,
    )
    bent = gaitsmith.walk(path=curve, fps=120)

    def bent_kinematics() -> None:
        forward_kinematics(bent.skeleton, bent.root_position, bent.rotations)

    own, yard, times = ratio(lambda: gaitsmith.walk(path=curve, fps=120), bent_kinematics)
    row(
        f"curved walk, {len(bent)} frames / forward kinematics of the clip",
        times,
        7.0,
        f"{1e6 * own / len(bent):.1f} us against {1e6 * yard / len(bent):.1f} us a frame",
    )

    hills = hilly()
    for what, walker, bar in (
        ("curved walk on a height field", "kinematic", 13.0),
        ("elevation walker on it", "elevation", 170.0),
    ):

        def uneven(walker: str = walker) -> gaitsmith.Motion:
            return gaitsmith.walk(path=curve[:30], ground=hills, walker=walker, fps=120)

        up = uneven()

        def its_kinematics(clip: gaitsmith.Motion = up) -> None:
            forward_kinematics(clip.skeleton, clip.root_position, clip.rotations)

        own, yard, times = ratio(uneven, its_kinematics, repeats=3)
        row(
            f"{what}, {len(up)} frames / forward kinematics of the clip",
            times,
            bar,
            f"{1e6 * own / len(up):.1f} us against {1e6 * yard / len(up):.1f} us a frame",
        )

    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "a.bvh"
        table = np.concatenate(
            [motion.root_position, motion.rotations[..., :3].reshape(frames, -1)], axis=1
        )
        own, yard, times = ratio(
            lambda: write_bvh(motion, target),
            lambda: np.savetxt(Path(folder) / "b.txt", table, fmt="%.6f"),
            repeats=5,
        )
        row("write BVH / numpy.savetxt of as many numbers", times, 0.9)

    walk = winter()
    body = gaitsmith.body_from(1.6)
    data, _ = walk.prototypes[0]
    own, _, times = ratio(
        lambda: [generalize(data, body, 0.6, 0.65) for _ in range(200)], kinematics
    )
    row("one step generalized, us", 1e6 * own / 200, None)

    recipe = {
        "styles": {"a": "sad", "b": "happy"},
        "root": {"weights": {"a": 0.5, "b": 0.5}},
    }
    own, yard, times = ratio(lambda: gaitsmith.compose(recipe), kinematics)
    row(
        f"compose two styles again / forward kinematics, {frames} frames",
        times,
        2.7,  # 20 ms where a frame takes 0.37 us
        f"{1e3 * own:.1f} ms against {1e3 * yard:.1f} ms",
    )

    numpy = [sys.executable, "-c", "import numpy"]
    command = [str(Path(sys.executable).with_name("gaitsmith"))]
    row("--help / python -c 'import numpy'", process_ratio([*command, "--help"], numpy), 0.7)
    row(
        "import gaitsmith / import numpy",
        process_ratio([sys.executable, "-c", "import gaitsmith"], numpy),
        1.3,
    )
    with tempfile.TemporaryDirectory() as folder:
        ten_seconds = [*command, "walk", "--distance", "12.3", "-o", f"{folder}/walk.bvh"]
        row("10 s walk to BVH / python -c 'import numpy'", process_ratio(ten_seconds, numpy), 4.0)


if __name__ == "__main__":
    main()
