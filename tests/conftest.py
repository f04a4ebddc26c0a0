"""Fixtures and settings that every test may use."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from gaitsmith.cli.main import main

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).resolve().parents[1]
GOLDEN = Path(__file__).parent / "golden"
NO_DATA = "measured data absent: set GAITSMITH_DATA to their folder"

# Load spikes of a shared machine are no failure, and CI tries the same examples every time.
_always = {
    "deadline": None,
    "print_blob": True,
    "suppress_health_check": [HealthCheck.too_slow],
}
settings.register_profile("ci", derandomize=True, **_always)
settings.register_profile("night", max_examples=2000, **_always)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="rewrite the golden files")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Compare named columns with ``tests/golden/<name>.csv``."""

    def check(name: str, *, atol: float, **columns: np.ndarray) -> None:
        path, header = GOLDEN / f"{name}.csv", ",".join(columns)
        table = np.column_stack(list(columns.values()))
        if request.config.getoption("--update-golden"):
            GOLDEN.mkdir(exist_ok=True)
            np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.6f")
            pytest.skip(f"rewrote {path.name}; look at its diff before you commit it")
        if not path.exists():
            pytest.fail(f"there is no golden file {path.name}; pytest --update-golden writes it")
        assert path.read_text().splitlines()[0] == header, f"{path.name} has other columns"
        expected = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
        np.testing.assert_allclose(table, expected, rtol=0, atol=atol, err_msg=path.name)

    return check


@pytest.fixture(scope="session")
def measured_data() -> Path:
    """Folder of the measured data, which are no part of the project; skips without it."""
    folder = Path(os.environ.get("GAITSMITH_DATA") or ROOT.parent / "shared" / "data")
    if not folder.is_dir():
        pytest.skip(NO_DATA)
    return folder


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many tests did not run for want of measured data."""
    skipped = terminalreporter.getreports("skipped")
    count = sum(NO_DATA in str(report.longrepr) for report in skipped)
    if count:
        terminalreporter.write_line(f"{count} tests skipped: {NO_DATA}", yellow=True)


@pytest.fixture
def run(monkeypatch, capsys, tmp_path):
    """Run the command line in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def command(*args):
        monkeypatch.setattr(sys, "argv", ["gaitsmith", *map(str, args)])
        code = 0
        try:
            main()
        except SystemExit as stop:
            code = stop.code or 0
        out, err = capsys.readouterr()
        return code, out, err

    return command
