"""Motion to numbers."""

from gaitsmith.measures.promises import promises

__all__ = ["promises"]
