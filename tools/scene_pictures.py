"""Make the pictures of scenes: docs/pictures/scene.*, of the scene in the tutorial."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import gaitsmith
from gaitsmith.viz import scene_gif

DOCS = Path(__file__).parent.parent / "docs"
WIDTH, FPS = 560, 12.5


def main() -> None:
    """Read the tutorial's scene and write its pictures."""
    page = (DOCS / "tutorials/scenes.md").read_text(encoding="utf-8")
    block = re.search(r'```toml title="meeting.toml"\n(.*?)```', page, re.DOTALL)
    assert block is not None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "meeting.toml"
        path.write_text(block[1], encoding="utf-8")
        performance = gaitsmith.perform(path, fps=50.0)
    scene_gif(performance, DOCS / "pictures/scene.gif", width=WIDTH, fps=FPS)
    gaitsmith.save(performance, DOCS / "pictures/scene.png")


if __name__ == "__main__":
    main()
