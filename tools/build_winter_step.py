"""Build src/gaitsmith/data/winter_step.json from the marker table of Winter's book.

    python tools/build_winter_step.py TABLE.csv

TABLE.csv: the raw coordinates of Table A.1 (frame, time_s, then x, y in meters of rib_cage,
hip, knee, fibula, ankle, heel, mt5, toe). It is not part of the project; what ships are the
six timed sequences derived from it, see data/SOURCES.md.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from gaitsmith.body.presets import KB92B_SUBJECT
from gaitsmith.walks.extract import extract, read_winter_table
from gaitsmith.walks.files import write_walk_data

TARGET = Path(__file__).parent.parent / "src/gaitsmith/data/winter_step.json"
SOURCE = (
    "Derived from the marker coordinates of Table A.1 in D. A. Winter, Biomechanics and Motor "
    "Control of Human Movement, 4th ed., Wiley 2009 (subject WM, natural cadence), by "
    "gaitsmith.walks.extract; legs of the measured subject of [KB92b] section 6."
)


def main() -> None:
    """Read the table, write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    options = parser.parse_args()
    found = extract(read_winter_table(options.table), KB92B_SUBJECT)
    write_walk_data(found.walk, options.output, source=SOURCE, step_time=found.step_time)
    print(f"wrote {options.output.name}: step {found.walk.length:.4f} m in {found.step_time:.4f} s")


if __name__ == "__main__":
    main()
