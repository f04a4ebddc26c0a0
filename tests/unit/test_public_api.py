"""The public surface: what it names, what it documents, what it loads."""

from __future__ import annotations

import inspect
import subprocess
import sys

import pytest

import gaitsmith

PUBLIC = list(getattr(gaitsmith, "__all__", ()))
#: What a walk must not load: imported late, by those who need them.
LATE = ("jaxtyping", "matplotlib", "pydantic", "rich", "scipy", "shapely", "sklearn", "starlette")


def loaded_by(code: str, names: tuple[str, ...]) -> list[str]:
    """Which of ``names`` a fresh interpreter has loaded after ``code``."""
    report = f"print(*sorted(set({names!r}) & set(sys.modules)), file=sys.stderr)"
    run = subprocess.run(
        [sys.executable, "-c", f"import sys\n{code}\n{report}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stderr.split()


def test_there_is_a_public_surface():
    assert PUBLIC


def test_all_is_sorted_and_real():
    assert sorted(PUBLIC, key=str.casefold) == PUBLIC
    assert len(set(PUBLIC)) == len(PUBLIC)
    assert not [name for name in PUBLIC if not hasattr(gaitsmith, name)]


def test_dir_shows_the_public_names():
    """They load late, and completion in a notebook must still find them."""
    assert set(PUBLIC) <= set(dir(gaitsmith))


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="wakl"):
        _ = gaitsmith.wakl


@pytest.mark.parametrize("name", PUBLIC)
def test_public_names_are_documented(name):
    public = getattr(gaitsmith, name)
    if isinstance(public, str):  # __version__ and the like speak for themselves
        return
    assert inspect.getdoc(public), f"gaitsmith.{name} has no docstring"


def test_importing_the_package_loads_nothing_heavy():
    assert loaded_by("import gaitsmith", (*LATE, "numpy", "PIL")) == []


def test_a_walk_loads_no_late_dependency():
    code = "import gaitsmith, gaitsmith.pipeline\ngaitsmith.walk(distance=2)"
    assert loaded_by(code, LATE) == []


def test_help_loads_no_numpy():
    code = (
        "import gaitsmith.cli.main as cli\n"
        "sys.argv = ['gaitsmith', '--help']\n"
        "try:\n    cli.main()\n"
        "except SystemExit as done:\n    assert not done.code, done.code"
    )
    assert loaded_by(code, (*LATE, "numpy", "PIL")) == []
