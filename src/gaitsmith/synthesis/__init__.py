"""A plan, a body and a walk become poses. Seam 2 is in ``step.py``."""
