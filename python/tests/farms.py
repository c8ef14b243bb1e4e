"""What the tests of the farm share: farms, their rows, and assets that end their readers."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import make_ball, write_obj

psutil = pytest.importorskip("psutil")
pytest.importorskip("distributed")

FARM = [sys.executable, "-m", "isoshell", "farm"]
SMALL = ["--vertices", "150", "--resolution", "40", "--workers", "2"]


def farm(*words, timeout=60):
    return subprocess.run([*FARM, *map(str, words)], capture_output=True, text=True, timeout=timeout)


def rows_of(out):
    """The last row of each asset, by the name of its output."""
    rows = [json.loads(line) for file in (out / "manifest").glob("*.jsonl") for line in file.read_text().splitlines()]
    return {row["output"]: row for row in sorted(rows, key=lambda row: row["time"]) if "output" in row}


def digests_of(out):
    return {name: (row["digest"], row["output_sha256"]) for name, row in rows_of(out).items() if row["state"] == "done"}


def files_of(out):
    """What is in OUT beside the manifest; names of its folders too."""
    return {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file() and "manifest" not in path.parts}


def make_assets(folder, count):
    folder.mkdir(parents=True, exist_ok=True)
    vertices, faces = make_ball()
    for i in range(count):
        write_obj(folder / f"ball{i}.obj", vertices * np.array([1, 1 + 0.1 * i, 1]), faces)
    return folder


def assert_is_serial(out, serial):
    made = {name: (row["digest"], (out / name).read_bytes()) for name, row in rows_of(out).items()
            if row["state"] == "done"}
    assert made == serial


class Crasher(threading.Thread):
    """Ends whoever reads this asset, as a reader that crashes would."""

    def __init__(self, path):
        super().__init__(daemon=True)
        os.mkfifo(path)
        self.path, self.crashes = path, 0

    def run(self):
        while True:
            with open(self.path, "wb"):  # waits for a reader
                wait_for(self.end_readers)
                self.crashes += 1
                wait_for(lambda: not self.end_readers())

    def end_readers(self):
        readers = [pid for pid in map(int, filter(str.isdigit, os.listdir("/proc"))) if self.is_read_by(pid)]
        for pid in readers:
            os.kill(pid, signal.SIGSEGV)
        return readers

    def is_read_by(self, pid):
        try:
            return pid != os.getpid() and any(os.path.realpath(file) == str(self.path)
                                              for file in Path(f"/proc/{pid}/fd").iterdir())
        except OSError:
            return False


def wait_for(condition, seconds=20):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "this did not happen"
        time.sleep(0.02)


def processes_of(farm_process, name):
    """Its descendants whose command line has this in it."""
    found = []
    for process in psutil.Process(farm_process.pid).children(recursive=True):
        try:
            if name in " ".join(process.cmdline()):
                found.append(process)
        except psutil.Error:
            pass
    return found


def start_farm(*words):
    return subprocess.Popen([*FARM, *map(str, words)], stderr=subprocess.PIPE, text=True, start_new_session=True)
