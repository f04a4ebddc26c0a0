"""What a person's walk is: one closed stride of the whole body."""

from gaitsmith.gait.cycle import Cycle

__all__ = ["Cycle"]
