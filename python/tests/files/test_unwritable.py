"""What fails while a file is written, and that there is one helper for it."""

import ast
import os
from collections import Counter

import isoshell
import pytest
from conftest import SOURCE
from isoshell import ErrorCode
from isoshell._paths import writing


@pytest.mark.parametrize("raised, words", [(OSError(28, "No space left on device"), "No space left"), (KeyError("x"), "'x'"),
                                           (RuntimeError(), "RuntimeError")])
def test_what_fails_while_a_file_is_written_is_an_error_that_names_it(raised, words):
    with pytest.raises(isoshell.Error, match=f"a.vtp: {words}") as caught, writing("a.vtp"):
        raise raised
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT and caught.value.stage == "write"


def test_an_error_of_ours_and_what_is_no_failure_of_the_package_stay_what_they_are():
    with pytest.raises(isoshell.Error, match="^mine$"), writing("a.vtp"):
        raise isoshell.Error("mine")
    with pytest.raises(KeyError), writing("a.usda", RuntimeError):
        raise KeyError("x")


def test_helpers_of_files_are_there_once():
    """Functions and names that several modules of the package would share have one definition."""
    defined = Counter()
    for folder, _, files in os.walk(SOURCE / "python/isoshell"):
        for file in (name for name in files if name.endswith(".py")):
            with open(os.path.join(folder, file), encoding="utf-8") as text:
                body = ast.parse(text.read()).body
            defined.update(node.name.lstrip("_") for node in body if isinstance(node, ast.FunctionDef))
            defined.update(target.id for node in body if isinstance(node, ast.Assign) for target in node.targets
                           if isinstance(target, ast.Name))
    assert {name: defined[name] for name in ("writing", "unwritable", "words_of", "path_text", "Path")} == {
        "writing": 1, "unwritable": 1, "words_of": 1, "path_text": 1, "Path": 1}
