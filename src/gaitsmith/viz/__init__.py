"""Pictures of a motion with NumPy and Pillow alone: a contact sheet, an animated GIF."""

from __future__ import annotations

from gaitsmith.viz.animation import gif
from gaitsmith.viz.scene_sheet import scene_sheet
from gaitsmith.viz.sheet import contact_sheet
from gaitsmith.viz.stage import scene_gif

__all__ = ["contact_sheet", "gif", "scene_gif", "scene_sheet"]
