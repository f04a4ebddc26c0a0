"""Pictures of a motion with NumPy and Pillow alone: a contact sheet, an animated GIF."""

from __future__ import annotations

from gaitsmith.viz.animation import gif
from gaitsmith.viz.sheet import contact_sheet

__all__ = ["contact_sheet", "gif"]
