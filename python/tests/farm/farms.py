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
from conftest import FOREVER, make_ball, write_obj

import isoshell

psutil = pytest.importorskip("psutil")
pytest.importorskip("distributed")

FARM = [sys.executable, "-m", "isoshell", "farm"]
ENDLESS = ["--time-limit", "0"]
SMALL = ["--vertices", "150", "--resolution", "40", "--workers", "2"]


def farm(*words):
    return subprocess.run([*FARM, *map(os.fspath, map(named, words))], capture_output=True, text=True, timeout=FOREVER,
                          errors="backslashreplace", env=patient())


def patient():
    """The environment, with connections that wait for whoever is slow."""
    return {**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": f"{FOREVER}s"}


def named(word):
    return word if isinstance(word, (str, os.PathLike)) else str(word)


def rows_of(out):
    """The last row of each asset, by the name of its output."""
    rows = [json.loads(line) for file in (out / "manifest").glob("*.jsonl") for line in file.read_text().splitlines()]
    return {row["output"]: row for row in sorted(rows, key=lambda row: row["time"]) if "output" in row}


def digests_of(out):
    return {name: (row["digest"], row["output_sha256"]) for name, row in rows_of(out).items() if row["state"] == "done"}


def files_of(out):
    """What is in OUT beside the manifest; names of its folders too."""
    return {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file() and "manifest" not in path.parts}


def row_of(output, **others):
    """A row of the manifest, as of an asset that is done."""
    return {"output": output, "asset": f"/{output}.obj", "options": {}, "version": isoshell.__version__, "run": "0",
            "state": "done", "input_size": 1, "input_changed": 1.5, "gates": {}, "seconds": 1.0, "attempts": 1,
            "output_sha256": "0" * 64, "output_size": 1, **others}


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


def connect(address, **security):
    """Connects to a scheduler, and leaves it."""
    import distributed

    distributed.Client(address, timeout=f"{FOREVER}s", set_as_default=False, **security).close()


def assert_is_refused(address, why="", **security):
    """It closes the connection: a scheduler that is not there, or slow, is another error."""
    from distributed.comm.core import CommClosedError

    with pytest.raises(CommClosedError, match=why):
        connect(address, **security)


class Crasher(threading.Thread):
    """Ends whoever reads this asset, as a reader that crashes would, until it is left."""

    def __init__(self, path):
        super().__init__(daemon=True)
        os.mkfifo(path)
        self._handle = os.open(path, os.O_RDWR)  # so that a reader waits, and never comes to an end
        self._path, self._left = path, threading.Event()
        self.ended = set()  # processes

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self._left.set()
        self.join()
        os.close(self._handle)

    def run(self):
        while not self._left.wait(0.02):
            for pid in map(int, filter(str.isdigit, os.listdir("/proc"))):
                if self.is_read_by(pid):
                    self.ended.add(pid)
                    end_if_there(pid, signal.SIGSEGV)

    def is_read_by(self, pid):
        """A process that meshes; others have it open while they start one."""
        try:
            return b"isoshell._farm._child" in Path(f"/proc/{pid}/cmdline").read_bytes() and any(
                os.path.realpath(file) == str(self._path) for file in Path(f"/proc/{pid}/fd").iterdir())
        except OSError:
            return False


def end_if_there(pid, how):
    try:
        os.kill(pid, how)
    except ProcessLookupError:
        pass  # it has ended meanwhile


def wait_for(condition):
    """However slow the machine is: what does not happen at all ends here."""
    end = time.monotonic() + FOREVER
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
    return subprocess.Popen([*FARM, *map(str, words)], stderr=subprocess.PIPE, text=True, start_new_session=True,
                            env=patient())


def end(process, how=signal.SIGKILL):
    """What it has said."""
    process.send_signal(how)
    _, said = process.communicate(timeout=FOREVER)
    return said


def wait_for_rows(out, count):
    wait_for(lambda: (out / "manifest").exists() and len(rows_of(out)) >= count)


def link_assets(assets, folder):
    """The assets in a folder that takes others beside them."""
    folder.mkdir()
    for path in assets.glob("*.obj"):
        (folder / path.name).symlink_to(path)
    return folder


@pytest.fixture
def held(assets, tmp_path):
    """The assets, and one beside them that holds whoever reads it."""
    mixed = link_assets(assets, tmp_path / "mixed")
    os.mkfifo(mixed / "held.obj")
    return mixed


@pytest.fixture
def engine(tmp_path):
    """A scheduler of Dask's and a worker, as somebody else would start them: the file of the one, and both processes."""
    yield from engine_with(tmp_path)


def engine_with(folder, *words):
    address, program = folder / "scheduler.json", [sys.executable, "-m"]
    of_scheduler = ["distributed.cli.dask_scheduler", "--scheduler-file", address, "--host", "127.0.0.1", "--port", "0",
                    "--dashboard-address", "127.0.0.1:0", *words]
    scheduler = subprocess.Popen([*program, *map(str, of_scheduler)], stderr=subprocess.DEVNULL, env=patient())
    wait_for(address.exists)
    of_worker = ["distributed.cli.dask_worker", "--scheduler-file", address, "--nthreads", "2", "--no-dashboard",
                 "--host", "127.0.0.1", "--local-directory", folder, "--death-timeout", FOREVER, *words]
    worker = subprocess.Popen([*program, *map(str, of_worker)], stderr=subprocess.DEVNULL, env=patient())
    yield address, scheduler, worker
    for process in (scheduler, *psutil.Process(worker.pid).children(recursive=True), worker):
        end_if_there(process.pid, signal.SIGKILL)
    scheduler.wait(FOREVER)
    worker.wait(FOREVER)
