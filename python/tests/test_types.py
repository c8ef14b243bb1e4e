"""The package is typed for its users."""

import subprocess
import sys
from pathlib import Path

import isoshell
import pytest

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def mypy(tmp_path_factory):
    """Runs mypy --strict over the package and these files; what it found of numpy is kept from run to run."""
    pytest.importorskip("mypy")
    words = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--cache-dir", tmp_path_factory.mktemp("mypy")]
    package = str(Path(isoshell.__file__).parent.parent)

    def run(*arguments):
        return subprocess.run([*map(str, words), *map(str, arguments)], env={"MYPYPATH": package, "PATH": ""}, cwd=HERE,
                              capture_output=True, text=True)

    return run


def test_a_user_of_the_package_is_checked_strictly(mypy):
    done = mypy("user_of_types.py")
    assert done.returncode == 0, done.stdout


def test_a_mistyped_keyword_and_a_wrong_type_are_found(mypy, tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text('import isoshell\nisoshell.remesh("a.ply", verticse=7)\nisoshell.remesh("a.ply", vertices="x")\n'
                     'isoshell.remesh(7)\nisoshell.remesh("a.ply").no_such_thing\n')
    found = mypy(wrong).stdout
    assert found.count("error:") == 4, found


def test_the_package_itself_is_checked_strictly(mypy):
    done = mypy("-p", "isoshell")
    assert done.returncode == 0, done.stdout


def test_everything_public_says_what_it_does():
    for name in isoshell.__all__:
        thing = getattr(isoshell, name)
        assert name == "__version__" or thing.__doc__, name
        for member in vars(thing) if isinstance(thing, type) else ():
            if not member.startswith("_") and name not in ("ErrorCode", "Options"):
                assert getattr(thing, member).__doc__, f"{name}.{member}"
