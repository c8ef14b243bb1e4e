"""What a worker does with an asset: admission, a child process, a second attempt alone, and a row of the manifest."""

from __future__ import annotations

import errno
import os
import shutil
import socket
import tempfile
import threading
import time
import uuid
from contextlib import contextmanager
from typing import Any, Dict, Iterator, List, Optional, Set

from isoshell import ErrorCode

from . import _places as places
from ._admission import Admission, memory_of_node
from ._assets import files_of
from ._manifest import Row, Writer, row_of_job
from ._process import Child, Lost, run_command

SCRATCH = ".farm"  # below OUT, so that a finished file needs only another name
REJECTED = "rejected"  # below OUT: meshes that miss a requirement
FULL = [os.strerror(number) for number in (errno.ENOSPC, errno.EDQUOT, errno.EROFS)]
TRANSIENT = ("UNWRITABLE_OUTPUT", "NO_DEVICE", "INTERRUPTED")
ABOVE_ESTIMATE = 1.1
CONTEXTS_OF_DEVICE = 16

Job = Dict[str, Any]


class Unwritable(Exception):
    """OUT takes no more files: the whole farm has to stop."""


class Stopped(Exception):
    """The farm was told to stop."""


def mesh(job: Job) -> Row:
    """Mesh one asset and keep its row: what a farm gives its workers to do. Raises Unwritable or Stopped."""
    return crew_of(job).mesh(job)


def stop(run: str) -> None:
    """End the assets of a run that are under way here, and begin none of it any more."""
    with _lock:
        _ended.add(run)
        crew = _crews.pop(run, None)
    if crew is not None:
        crew.stop()


async def stop_soon(run: str) -> None:
    """What Dask's workers can be told without waiting for it."""
    stop(run)


class Crew:
    """The child processes of a worker."""

    def __init__(self, job: Job) -> None:
        self.run = job["run"]
        self._out = job["out"]
        slots = _slots()
        self._devices = devices_of(job["place"].get("device"))
        self._contexts = job["contexts"] or (CONTEXTS_OF_DEVICE if self._devices else 1)
        self._most = job["memory"] or _memory_of_worker()
        self._admission = Admission(self._most)
        self._share = job["asset_memory"] or self._most // slots
        self._is_share_fixed = bool(job["asset_memory"])
        self._lock = threading.Lock()
        self._children: List[Optional[Child]] = [None] * -(-slots // self._contexts)
        self._busy = [0] * len(self._children)
        self._extra: List[Child] = []
        self.is_stopped = False
        self._writer = Writer(self._out, job["newest"])
        if places.is_remote(self._out):
            self._scratch = os.path.join(tempfile.mkdtemp(prefix="isoshell-farm-"), "work")
            os.mkdir(self._scratch)
        else:
            self._scratch = os.path.join(self._out, SCRATCH, f"{socket.gethostname()}-{self.run}-{os.getpid()}")
            os.makedirs(self._scratch, exist_ok=True)
            _remove_what_the_dead_left(os.path.join(self._out, SCRATCH))

    @property
    def is_idle(self) -> bool:
        return not self._extra and not any(self._busy)

    def stop(self) -> None:
        self.is_stopped = True
        with self._lock:
            children = [*self._children, *self._extra]
        for child in children:
            if child is not None:
                child.stop()
        self._writer.close()
        shutil.rmtree(self._scratch, ignore_errors=True)
        try:
            os.rmdir(os.path.dirname(self._scratch))
        except OSError:
            pass  # others are at work

    def mesh(self, job: Job) -> Row:
        start = time.perf_counter()
        row = row_of_job(job, f"{socket.gethostname()}:{os.getpid()}")
        folder = ""
        try:
            folder = tempfile.mkdtemp(dir=self._scratch)
            row.update(self._outcome(job, folder))
        except OSError as error:
            row.update(code="UNWRITABLE_OUTPUT", message=f"{error.filename or folder or self._out}: {error.strerror}")
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        row["state"] = "failed" if "code" in row else "done"
        row["seconds"] = round(time.perf_counter() - start, 3)
        if row.get("code") in TRANSIENT:
            row["transient"] = True
        if row.get("code") == "UNWRITABLE_OUTPUT" and any(text in row["message"] for text in FULL):
            raise Unwritable(row["message"])
        try:
            with self._lock:
                self._writer.append(row)
        except OSError as error:
            if self.is_stopped:
                raise Stopped() from error
            raise Unwritable(f"{self._out}: {error.strerror}") from error
        return row

    def _outcome(self, job: Job, folder: str) -> Row:
        """What becomes of an asset, in one attempt or two. Malformed input is tried once."""
        share, is_alone, attempts = self._share, False, 0
        while True:
            attempts += 1
            again = is_alone or attempts > 3
            try:
                answer = self._attempt(job, folder, share, is_alone)
            except Lost as lost:
                if self.is_stopped or lost.reason == "STOPPED" and lost.is_own_fault:
                    raise Stopped() from lost
                if lost.reason == "STOPPED":
                    attempts -= 1  # another asset's fault
                    continue
                if again:
                    return {"code": lost.reason, "message": str(lost), "attempts": attempts}
                is_alone = True
                if not self._is_share_fixed and (lost.reason == "OUT_OF_MEMORY" or "SIGKILL" in str(lost)):
                    share = self._most  # the kernel kills where memory is short
                continue
            code = answer.get("code")
            is_limit_fixed = self._is_share_fixed or job["place"].get("max_memory")
            if code == "OUT_OF_MEMORY" and not is_limit_fixed and share < self._most:
                # With all of the node's memory it is alone on the node, and shares say nothing of a device's memory.
                share = self._most if self._devices or share > self._share else self._wanted(job, folder)
                is_alone = False
                continue
            if code == "INTERNAL" and not again:
                is_alone = True
                continue
            return {**self._published(job, folder, answer), "attempts": attempts}

    def _wanted(self, job: Job, folder: str) -> int:
        """The memory that an asset needs by its estimate, at most all of it."""
        try:
            answer = self._attempt({**job, "estimate": True}, folder, self._most, False)
        except Lost:
            return self._most
        return min(self._most, max(self._share + 1, int(ABOVE_ESTIMATE * (answer.get("estimate") or self._most))))

    def _attempt(self, job: Job, folder: str, share: int, is_alone: bool) -> Row:
        place = {name: value for name, value in job["place"].items() if name != "max_memory"}
        if job["place"].get("max_memory"):
            place["max_memory"] = job["place"]["max_memory"]
        elif not self._devices:
            place["max_memory"] = share
        names = {"scratch": folder, "mesh": os.path.join(folder, "mesh" + os.path.splitext(job["output"])[1]),
                 "stats": os.path.join(folder, "mesh.json"), "place": place, "frames": job["options"].get("frames"),
                 "estimate": job.get("estimate", False)}
        with self._admission.share(share), self._child(is_alone) as child:
            if self.is_stopped:
                raise Stopped()
            answer = child.do({**job, **names}, share, job["time_limit"])
            if answer.get("code") == "INTERNAL":
                child.is_spent = True
            if "path" in answer:
                answer.update(self._sequence(job, names, share, answer.pop("path")))
        return answer

    @contextmanager
    def _child(self, is_alone: bool) -> Iterator[Child]:
        """A child with a free context: a new one, for nothing else, for an asset that is tried alone."""
        if is_alone:
            child = Child(1, self._environment(0))
            with self._lock:
                self._extra.append(child)
            try:
                yield child
            finally:
                with self._lock:
                    self._extra.remove(child)
                child.stop()
            return
        with self._lock:
            at = min(range(len(self._busy)), key=lambda i: self._busy[i])
            self._busy[at] += 1
            kept = self._children[at]
            if kept is None or kept.is_spent:
                kept = self._children[at] = Child(self._contexts, self._environment(at))
        try:
            yield kept
        finally:
            with self._lock:
                self._busy[at] -= 1
            if kept.is_spent and kept.is_idle:
                kept.stop()

    def _environment(self, at: int) -> Dict[str, str]:
        return {"CUDA_VISIBLE_DEVICES": self._devices[at % len(self._devices)]} if self._devices else {}

    def _sequence(self, job: Job, names: Dict[str, Any], share: int, path: str) -> Row:
        """The frames of a sequence, by the command. They stay in their folder until all are there."""
        frames = [*files_of(os.path.basename(job["output"]), job["options"])]
        folder = os.path.join(names["scratch"], "frames")
        is_again = os.path.isdir(folder)
        os.makedirs(folder, exist_ok=True)
        pattern = os.path.join(folder, os.path.basename(job["output"]))
        words = [path, pattern, "--stats", os.path.splitext(pattern)[0] + ".json", "--quiet"]
        if is_again:
            words.append("--resume" if pattern.endswith(".ply") else "--force")
        for name, value in {**job["options"], **names["place"]}.items():
            words += [f"--{name.replace('_', '-')}"] + ([] if value is True else [str(value)])
        status, message = run_command(words, share, job["time_limit"], self._environment(0), lambda: self.is_stopped)
        row: Row = {}
        if status:
            row = {"code": ErrorCode(status).name, "message": message}
        made = [os.path.join(folder, frame) for frame in frames if os.path.exists(os.path.join(folder, frame))]
        if made:
            for file in made:
                places.to_disk(file)
            row.update(output_sha256=places.sha256_of(made), output_size=sum(os.path.getsize(file) for file in made),
                       frames=len(made))
        return row

    def _published(self, job: Job, folder: str, answer: Row) -> Row:
        """The row of an answer, with the finished files where they belong. A mesh that misses a requirement goes
        aside, and frames of a sequence that is not whole go nowhere."""
        answer.pop("estimate", None)
        if answer.get("unchanged"):
            return {**job["known"], **answer}
        parts = os.path.join(folder, "frames")
        if "output_sha256" not in answer or os.path.isdir(parts) and "code" in answer:
            return answer
        root = places.join(self._out, REJECTED) if "code" in answer else self._out
        if os.path.isdir(parts):
            inside = os.path.dirname(job["output"])
            for name in sorted(os.listdir(parts), key=lambda name: (not name.endswith(".json"), name)):
                places.publish(os.path.join(parts, name), places.join(root, *filter(None, [inside, name])))
        else:
            stem = os.path.splitext(job["output"])[0]
            places.publish(os.path.join(folder, "mesh.json"), places.join(root, f"{stem}.json"))
            places.publish(os.path.join(folder, "mesh" + os.path.splitext(job["output"])[1]),
                           places.join(root, job["output"]))
        if "code" in answer:
            answer["rejected"] = f"{REJECTED}/{job['output']}"
        return answer


_crews: Dict[str, Crew] = {}
_ended: Set[str] = set()  # runs
_lock = threading.Lock()


def crew_of(job: Job) -> Crew:
    """The crew of a run. Crews of others that have nothing to do are sent home: their run may have died."""
    with _lock:
        if job["run"] in _ended:
            raise Stopped()
        if job["run"] not in _crews:
            for run in [run for run, crew in _crews.items() if crew.is_idle]:
                _crews.pop(run).stop()
            try:
                _crews[job["run"]] = Crew(job)
            except OSError as error:
                raise Unwritable(f"{error.filename}: {error.strerror}") from error
        return _crews[job["run"]]


def new_run() -> str:
    return uuid.uuid4().hex[:12]


def _remove_what_the_dead_left(folder: str) -> None:
    """Scratch folders of workers of this machine that were killed."""
    own = socket.gethostname()
    for name in os.listdir(folder):
        whole, _, pid = name.rpartition("-")
        if whole.rpartition("-")[0] == own and pid.isdigit() and not _is_alive(int(pid)):
            shutil.rmtree(os.path.join(folder, name), ignore_errors=True)


def _is_alive(pid: int) -> bool:
    psutil = places.package("psutil")
    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.Error:
        return False


def _slots() -> int:
    """Assets that this worker has at a time."""
    try:
        return int(places.package("distributed").get_worker().state.nthreads)
    except ValueError:
        return 1  # not in a worker


def _memory_of_worker() -> int:
    """What the worker was told that it may have; Dask gives a worker its threads' part of the node."""
    try:
        told = places.package("distributed").get_worker().memory_manager.memory_limit
    except ValueError:
        told = None
    return int(told) if told else memory_of_node()


def devices_of(device: Optional[str]) -> List[str]:
    """The CUDA devices that children take turns on; none where all is done by the CPU or on one named device."""
    if device not in (None, "auto", "cuda"):
        return []
    named = os.environ.get("CUDA_VISIBLE_DEVICES")
    if named is not None:
        return [name for name in named.split(",") if name]
    try:
        return [str(i) for i in range(len(os.listdir("/proc/driver/nvidia/gpus")))]
    except OSError:
        return []
