"""Motion to numbers."""

from gaitsmith.measure.promises import promises

__all__ = ["promises"]
