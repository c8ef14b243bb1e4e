"""A child process that meshes, as its worker sees it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from typing import IO, Any, Callable, Dict, Optional

from . import _places as places

LOOK_SECONDS = 0.1
SLACK_BYTES = 768 << 20  # what a process has beside its runs: the interpreter, libraries, a device's driver
SLACK_PART = 0.25


class Lost(Exception):
    """A process has ended, or had to be ended, while it had work."""

    def __init__(self, reason: str, message: str, is_own_fault: bool = True) -> None:
        super().__init__(message)
        self.reason = reason  # CRASHED, TIME_LIMIT, OUT_OF_MEMORY or STOPPED
        self.is_own_fault = is_own_fault  # otherwise another asset in the same process may have been the cause


class Watch:
    """Ends a process that takes too long or too much memory."""

    def __init__(self, process: subprocess.Popen[Any], time_limit: Optional[float]) -> None:
        self._process = process
        self._limit = time_limit
        self._start = time.monotonic()
        self._memory = places.package("psutil").Process(process.pid)

    def look(self, most_bytes: float) -> None:
        """Raises Lost when it has ended the process."""
        seconds = time.monotonic() - self._start
        if self._limit is not None and seconds > self._limit:
            self._process.kill()
            raise Lost("TIME_LIMIT", f"not done after {self._limit:g} s, the time limit of an asset; --time-limit "
                       "raises it")
        taken = self.taken()
        if taken > most_bytes:
            self._process.kill()
            raise Lost("OUT_OF_MEMORY", f"took {taken >> 20} MB of memory, more than the {int(most_bytes) >> 20} MB "
                       "that it may have; --asset-memory raises it")

    def taken(self) -> int:
        """Bytes of memory, 0 of a process that is gone."""
        try:
            return int(self._memory.memory_info().rss)
        except places.package("psutil").Error:
            return 0


class Pending:
    """A job that a child has."""

    def __init__(self, share_bytes: int) -> None:
        self.share_bytes = share_bytes
        self.answer: Optional[Dict[str, Any]] = None
        self.lost: Optional[Lost] = None
        self.done = threading.Event()


class Child:
    """Does several jobs at a time. When one of them ends the process, all are lost."""

    def __init__(self, contexts: int, environment: Dict[str, str]) -> None:
        self._errors = tempfile.TemporaryFile()
        self._process = subprocess.Popen(
            [sys.executable, "-m", f"{__package__}._child", str(contexts)], stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=self._errors, env=environment_with(environment), start_new_session=True)
        self._lock = threading.Lock()
        self._pending: Dict[int, Pending] = {}
        self._count = 0
        self.is_spent = False  # takes no more jobs
        threading.Thread(target=self._listen, daemon=True).start()

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def is_idle(self) -> bool:
        return not self._pending

    def do(self, job: Dict[str, Any], share_bytes: int, time_limit: Optional[float]) -> Dict[str, Any]:
        """The answer to a job. Raises Lost."""
        pending = Pending(share_bytes)
        with self._lock:
            if self.is_spent:
                raise Lost("STOPPED", "its process has ended", False)
            self._count += 1
            number = self._count
            self._pending[number] = pending
        watch = Watch(self._process, time_limit)
        try:
            self._send({**job, "id": number})
            while not pending.done.wait(LOOK_SECONDS):
                self._look(watch)
        except Lost as lost:
            self._end(lost, number)
            raise
        finally:
            with self._lock:
                self._pending.pop(number, None)
        if pending.lost is not None:
            raise pending.lost
        assert pending.answer is not None
        return pending.answer

    def stop(self) -> None:
        """End the process, with what it is doing."""
        self._end(Lost("STOPPED", "stopped"), None)
        self._process.kill()
        self._process.wait()

    def _look(self, watch: Watch) -> None:
        with self._lock:
            share = sum(pending.share_bytes for pending in self._pending.values())
        watch.look(share * (1 + SLACK_PART) + SLACK_BYTES)

    def _send(self, job: Dict[str, Any]) -> None:
        assert self._process.stdin is not None
        line = json.dumps(job).encode() + b"\n"
        try:
            with self._lock:
                self._process.stdin.write(line)
                self._process.stdin.flush()
        except OSError:
            pass  # it has ended, which the listener tells

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            answer = json.loads(line)
            with self._lock:
                pending = self._pending.get(answer.pop("id"))
            if pending is not None:
                pending.answer = answer
                pending.done.set()
        status = self._process.wait()
        self._end(Lost("CRASHED", how_it_ended(status, self._errors), len(self._pending) == 1), None)

    def _end(self, lost: Lost, culprit: Optional[int]) -> None:
        """All other jobs are lost with the process, by no fault of theirs where the culprit is known."""
        with self._lock:
            self.is_spent = True
            for number, pending in self._pending.items():
                if number != culprit and not pending.done.is_set():
                    pending.lost = lost if culprit is None else Lost("STOPPED", "another asset was ended", False)
                    pending.done.set()


def environment_with(own: Dict[str, str]) -> Dict[str, str]:
    """This process's environment with variables of a child's own, and without the threshold that Dask sets for its
    workers: by it malloc would give memory back to the system after each step of a run and fetch it again for the next,
    which takes a third of the meshes a second that a device makes and a thirtieth of a CPU's."""
    inherited = {name: value for name, value in os.environ.items() if name != "MALLOC_TRIM_THRESHOLD_"}
    return {**inherited, **own}


def how_it_ended(status: int, errors: IO[bytes]) -> str:
    """In words, with the last line that the process wrote."""
    import signal

    errors.seek(max(0, errors.seek(0, os.SEEK_END) - 2000))
    lines = errors.read().decode(errors="replace").strip().splitlines()
    how = f"signal {-status} ({signal.Signals(-status).name})" if status < 0 else f"exit status {status}"
    return f"its process ended by {how}" + (f": {lines[-1].strip()}" if lines else "")


def run_command(words: list[str], share_bytes: int, time_limit: Optional[float], environment: Dict[str, str],
                is_stopped: Callable[[], bool]) -> tuple[int, str]:
    """Run the command isoshell in a process of its own. Returns its exit status and its last line of errors. Raises
    Lost."""
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen([sys.executable, "-m", "isoshell", *words], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=errors, env=environment_with(environment),
                                   start_new_session=True)
        watch = Watch(process, time_limit)
        try:
            while True:
                try:
                    status = process.wait(LOOK_SECONDS)
                    break
                except subprocess.TimeoutExpired:
                    watch.look(share_bytes * (1 + SLACK_PART) + SLACK_BYTES)
                    if is_stopped():
                        raise Lost("STOPPED", "stopped") from None
        finally:
            process.kill()
            process.wait()
        if status < 0:
            raise Lost("CRASHED", how_it_ended(status, errors))
        errors.seek(0)
        said = [line for line in errors.read().decode(errors="replace").splitlines() if "error:" in line]
        return status, said[-1].partition("error:")[2].strip() if said else ""
