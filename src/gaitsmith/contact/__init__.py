"""Feet on the ground, for every walker.

Walkers propose poses; this stage owns the feet. It works in two halves: :func:`plan_contact`
once per walk finds foot locks, the lowering of the hips and the clearance of the swing on a
grid of phases, across steps; :class:`ContactPlan` applies them at any array of phases by
look-up.
"""

from gaitsmith.contact.apply import ContactPlan, Poses
from gaitsmith.contact.plan import plan_contact
from gaitsmith.contact.reference import ReferenceStep
from gaitsmith.contact.step_curves import StepCurves

__all__ = ["ContactPlan", "Poses", "ReferenceStep", "StepCurves", "plan_contact"]
