"""Build src/gaitsmith/data/neutral_step.json: the legs of `neutral` as walk data.

    python tools/build_neutral_step.py

The stride of data/neutral.json with planted feet (gaitsmith.walks.planting), one step of
it, for the stride is symmetric. Made once, because the fit takes longer than a walk; run this after
a change of the fit or of the stride.
"""

from __future__ import annotations

from pathlib import Path

from gaitsmith.gait.neutral import neutral_cycle
from gaitsmith.synthesis.gaits import neutral_step
from gaitsmith.walks.files import write_walk_data

TARGET = Path(__file__).parent.parent / "src/gaitsmith/data/neutral_step.json"


def main() -> None:
    """Fit and write."""
    cycle = neutral_cycle()
    write_walk_data(
        neutral_step(),
        TARGET,
        source=f"{cycle.source} Its legs, with planted feet. {cycle.license}",
        step_time=0.5 * cycle.duration,
    )


if __name__ == "__main__":
    main()
