"""The canonical motion: one skeleton, sampled. Every part of the package speaks it."""
