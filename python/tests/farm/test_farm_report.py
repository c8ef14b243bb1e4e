"""isoshell farm report: what is amiss with its places is told before any work, and in one line."""

import os
import subprocess
import sys

import pytest
from farms import FARM, files_of, row_of

import isoshell
from isoshell._farm import _manifest as manifest


@pytest.fixture
def out(tmp_path):
    """What a farm has left: a manifest."""
    place = tmp_path / "out"
    writer = manifest.Writer(str(place), 0.0)
    writer.append({"began": "0", "assets": 2, "done": 0, "failed": 0, "command": "isoshell farm run a out",
                   "version": isoshell.__version__})
    writer.append(row_of("a"))
    writer.append(row_of(os.fsdecode(b"\xff"), state="failed", code="INTERNAL", message="it is bad"))
    writer.close()
    return place


def report(out, *words, hidden=None):
    paths = os.pathsep.join(map(str, filter(None, [hidden, *sys.path[1:]])))
    return subprocess.run([*FARM, "report", out, *words], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": paths})


def without(package, folder, says):
    """A folder in which it is as if the package were not there, or did not work."""
    folder.mkdir()
    (folder / f"{package}.py").write_text(f"raise {says}\n")
    return folder


@pytest.mark.parametrize("says", ["ModuleNotFoundError(\"No module named 'pyarrow'\", name='pyarrow')",
                                  "ImportError('libarrow.so: cannot open')"])
def test_a_table_without_its_package_is_refused_before_a_page_is_written(out, tmp_path, says):
    done = report(out, "--parquet", tmp_path / "a.parquet", hidden=without("pyarrow", tmp_path / "hidden", says))
    assert done.returncode == 2 and "needs pyarrow" in done.stderr and "pip install pyarrow" in done.stderr
    assert "Traceback" not in done.stderr and files_of(out) == set()


@pytest.mark.parametrize("option", ["--parquet", "--output"])
def test_a_place_that_takes_no_file_is_refused_before_the_manifest_is_read(out, tmp_path, option):
    (out / "manifest/damaged.jsonl").write_text("{}\n")  # which reading would tell
    for place, says in ((tmp_path / "none" / "a", "none"), (tmp_path, "is a folder")):
        done = report(out, option, place)
        assert done.returncode == 4 and says in done.stderr and "Traceback" not in done.stderr, done.stderr
        (line,) = done.stderr.splitlines()
        assert str(place) in line and files_of(out) == set()
    same = report(out, "--parquet", out / "report.html")
    assert same.returncode == 2 and "are one file" in same.stderr and files_of(out) == set()


def test_the_page_and_the_table_are_written(out, tmp_path):
    parquet, table = pytest.importorskip("pyarrow.parquet"), tmp_path / "a.parquet"
    for _ in range(2):  # what is there is replaced
        done = report(out, "--parquet", table)
        assert done.returncode == 0, done.stderr
        assert parquet.read_table(table).num_rows == 2
    assert files_of(out) == {"report.html"} and "\\udcff" in (out / "report.html").read_text(encoding="utf-8")
    assert {path.name for path in tmp_path.iterdir()} == {"out", "a.parquet"}


def test_a_page_without_a_farm_is_refused_with_the_place(tmp_path):
    done = report(tmp_path / "nowhere")
    assert done.returncode == 3 and "no manifest there" in done.stderr
