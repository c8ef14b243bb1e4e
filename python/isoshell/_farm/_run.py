"""isoshell farm run: gives the assets to the workers, largest first, and says how it goes."""

from __future__ import annotations

import asyncio
import os
import shlex
import shutil
import sys
import time
from concurrent.futures import wait
from itertools import islice
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any, Dict, List, NoReturn, Optional, Tuple

import isoshell

from .._errors import Error
from .._isoshell import ErrorCode
from . import _manifest as manifest
from . import _places as places
from . import _worker as worker
from ._assets import Asset
from ._clusters import Cluster, cluster_of
from ._lock import locked
from ._plan import Plan, job_of, plan_of
from ._progress import Progress, tell
from ._status import tell_damaged

SOME_FAILED = 9
ENGINE_LOST = 10
DEATHS = 3  # of workers, by Dask's count, after which an asset is given up
LOOK_SECONDS = 0.5
SECONDS_TO_STOP = 0.5
SECONDS_TO_RECONNECT = 5.0
FOR_CLUSTERS = ("scheduler", "workers", "slots", "memory", "dashboard")


class EngineLost(Exception):
    """The scheduler does not answer any more."""


ENDS = (KeyboardInterrupt, worker.Unwritable, EngineLost)


def run(assets: List[Asset], out: str, settings: Dict[str, Any], words: List[str]) -> int:
    """Returns the exit status."""
    with locked(out):
        return run_alone(assets, out, settings, "isoshell farm run " + shlex.join(words))


def run_alone(assets: List[Asset], out: str, settings: Dict[str, Any], again: str) -> int:
    """While no other run is at work on OUT."""
    try:
        before = manifest.read(out)
        plan = plan_of(assets, before.rows, out, settings["retry_failed"])
        writer = manifest.Writer(out, before.newest)
        number = worker.new_run()
        if plan.wanted:
            writer.append({"began": number, "assets": len(assets), "done": plan.done, "failed": plan.failed,
                           "command": again, "version": isoshell.__version__})
    except OSError as error:
        raise Error(f"{error.filename or out}: {error.strerror or error}", ErrorCode.UNWRITABLE_OUTPUT,
                    "farm") from error
    tell_damaged(before, "what they were of is made again")
    if plan.done or plan.failed:
        tell(f"{plan.done} of {len(assets)} assets are done already" + (
            f", and {plan.failed} failed before: --retry-failed tries them again" if plan.failed else ""))
    failed = plan.failed
    progress = Progress(len(plan.wanted))
    try:
        if plan.wanted:
            common = {name: settings[name] for name in ("contexts", "asset_memory", "time_limit", "place")}
            with cluster_of(*(settings[name] for name in FOR_CLUSTERS)) as cluster:
                common.update(out=out, run=number, newest=before.newest, memory=cluster.memory)
                announce(cluster, len(plan.wanted))
                try:
                    failed += over(cluster, plan, common, writer, progress)
                except ENDS as error:
                    if cluster.may_be_left:
                        leave(cluster, ended(error, out, again, progress))
                    raise
                cluster.client.run(worker.stop, number, on_error="ignore")
    except ENDS as error:
        return ended(error, out, again, progress)
    finally:
        writer.close()
    progress.end()
    done = len(assets) - failed
    tell(f"{done} of {len(assets)} assets are done" + (
        f", {failed} failed: isoshell farm report {shlex.quote(out)} says why" if failed else ""))
    return SOME_FAILED if failed else 0


def ended(error: BaseException, out: str, again: str, progress: Progress) -> int:
    """Says why the farm stops and how it goes on. Returns the exit status."""
    progress.end()
    kept = "What is done is kept"
    if isinstance(error, KeyboardInterrupt):
        tell(f"interrupted. {kept}. To go on: {again}")
        return int(ErrorCode.INTERRUPTED)
    if isinstance(error, worker.Unwritable):
        tell(f"error: {error}: {out} takes no more files, so the farm has stopped. {kept}; make room, and go on with: "
             f"{again}")
        return int(ErrorCode.UNWRITABLE_OUTPUT)
    tell(f"error: {error}. {kept}. To go on: {again}")
    return ENGINE_LOST


def announce(cluster: Cluster, count: int) -> None:
    threads = sum(cluster.client.nthreads().values())
    place = f", {threads} at a time" if threads else ", when workers are there"
    tell(f"{count} assets{place}" + (f"; dashboard: {cluster.client.dashboard_link}" if cluster.has_pages else ""))


def over(cluster: Cluster, plan: Plan, common: Dict[str, Any], writer: manifest.Writer, progress: Progress) -> int:
    """Hands out the assets, as many at a time as keep all workers busy. Returns how many failed."""
    left = iter(plan.wanted)
    under_way: Dict[Any, Tuple[Dict[str, Any], int]] = {}
    answers: SimpleQueue[Any] = SimpleQueue()
    counted: List[Any] = []  # the pages count what somebody wants to have
    failed, rank = 0, 0
    try:
        while True:
            for asset, known in islice(left, None if cluster.has_pages else max(0, room(cluster) - len(under_way))):
                rank += 1
                submit(cluster, job_of(asset, known, common), rank, 0, under_way).add_done_callback(answers.put)
            if not under_way and rank == len(plan.wanted):
                return failed
            for future in finished(cluster, answers):
                job, deaths = under_way.pop(future)
                row = row_of(cluster, future, job, deaths, writer)
                if row is None:
                    submit(cluster, job, 0, deaths + 1, under_way).add_done_callback(answers.put)
                    continue
                if cluster.has_pages:
                    counted.append(future)
                failed += row["state"] == "failed"
                progress.count(row)
            progress.show()
    except BaseException:
        stop(cluster, common["run"])
        raise


def submit(cluster: Cluster, job: Dict[str, Any], rank: int, deaths: int,
           under_way: Dict[Any, Tuple[Dict[str, Any], int]]) -> Any:
    key = f"mesh-{job['run']}-{deaths}-{ascii(job['output'])}"  # Dask has its own idea of text
    future = cluster.client.submit(worker.mesh, job, key=key, pure=False, priority=-rank)
    under_way[future] = job, deaths
    return future


def room(cluster: Cluster) -> int:
    """One asset waits behind each that a worker has."""
    return max(2, 2 * sum(threads_of(cluster).values()))


def threads_of(cluster: Cluster) -> Dict[str, int]:
    workers = cluster.client.scheduler_info(n_workers=-1)["workers"]
    return {name: info["nthreads"] for name, info in workers.items()}


def finished(cluster: Cluster, answers: SimpleQueue[Any]) -> List[Any]:
    """The futures that are, after a while at most. Raises EngineLost."""
    found = []
    try:
        found.append(answers.get(timeout=LOOK_SECONDS))
        while True:
            found.append(answers.get_nowait())
    except Empty:
        pass
    require_scheduler(cluster)
    return found


def require_scheduler(cluster: Cluster) -> None:
    """Waits for one that is lost, for a while at most. Raises EngineLost."""
    end = time.monotonic() + SECONDS_TO_RECONNECT
    while cluster.client.status != "running":
        if time.monotonic() > end:
            raise no_answer(cluster)
        time.sleep(LOOK_SECONDS)


def result_of(cluster: Cluster, future: Any) -> manifest.Row:
    """What a finished task returned. Future.result would wait for a scheduler that is lost meanwhile as long as a
    connection may take. Raises EngineLost."""
    fetched = asyncio.run_coroutine_threadsafe(cluster.client.gather(future, asynchronous=True),
                                               cluster.client.loop.asyncio_loop)
    try:
        while not wait([fetched], timeout=LOOK_SECONDS).done:
            require_scheduler(cluster)
    except EngineLost:
        fetched.cancel()
        raise
    try:
        row: manifest.Row = fetched.result()
    except Exception as lost:  # the asset is done, so what fails is the way to its row, through the scheduler
        raise no_answer(cluster) from lost
    return row


def no_answer(cluster: Cluster) -> EngineLost:
    return EngineLost(f"the scheduler ({cluster.name}) does not answer any more")


def row_of(cluster: Cluster, future: Any, job: Dict[str, Any], deaths: int,
           writer: manifest.Writer) -> Optional[manifest.Row]:
    """The row of a finished asset; None of one that has to be tried again, as its workers ended."""
    error = future.exception() if future.status == "error" else None
    if future.status == "cancelled":
        raise EngineLost("the scheduler has dropped its work")
    if error is None:
        return result_of(cluster, future)
    if isinstance(error, worker.Unwritable):
        raise error
    if isinstance(error, worker.Stopped):
        return None
    if type(error).__name__ == "KilledWorker" and deaths < DEATHS:
        return None
    row = {**manifest.row_of_job(job, ""), "state": "failed",
           "code": "WORKER_LOST" if type(error).__name__ == "KilledWorker" else "INTERNAL",
           "message": f"{type(error).__name__}: {error}", "attempts": deaths + 1, "transient": True, "seconds": 0.0}
    try:
        writer.append(row)
    except OSError as full:
        raise worker.Unwritable(f"{job['out']}: {full.strerror}") from full
    return row


def stop(cluster: Cluster, run: str) -> None:
    """End what is under way, on the workers of others without waiting for its end."""
    def ask() -> None:
        try:
            cluster.client.run(worker.stop_soon, run, wait=False, on_error="ignore")
        except Exception:
            pass  # it is going anyhow

    worker.stop(run)
    if cluster.name == "local" or cluster.client.status != "running":
        return
    asking = Thread(target=ask, daemon=True)
    asking.start()
    asking.join(SECONDS_TO_RECONNECT)  # the scheduler may be lost meanwhile


def leave(cluster: Cluster, status: int) -> NoReturn:
    """End at once, with all processes of a local worker: what they have not finished is made again."""
    if cluster.folder:
        psutil = places.package("psutil")
        own = psutil.Process().children(recursive=True)
        for process in own:
            try:
                process.kill()
            except psutil.Error:
                pass
        psutil.wait_procs(own, timeout=SECONDS_TO_STOP)
        shutil.rmtree(cluster.folder, ignore_errors=True)
    sys.stderr.flush()
    os._exit(status)
