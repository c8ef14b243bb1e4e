"""Where a farm runs: Dask's own clusters."""

from __future__ import annotations

import importlib.util
import logging
import os
import tempfile
from contextlib import ExitStack, contextmanager
from typing import Any, Dict, Iterator, NamedTuple, Optional

from .._errors import Error
from .._isoshell import ErrorCode
from . import _places as places
from ._admission import memory_of_node

SECONDS_TO_CONNECT = 20
DEATHS_OF_WORKERS = 10  # that an asset may see before it is given up


class Cluster(NamedTuple):
    """A scheduler that is there."""

    client: Any
    name: str
    memory: Optional[int]  # bytes for the assets of a worker; None: each worker knows its own
    has_pages: bool        # Dask's dashboard
    folder: str            # of a local scheduler, its own files

    @property
    def may_be_left(self) -> bool:
        """Whether nothing has to be closed but processes of this machine: jobs in a queue would stay there."""
        return self.name != "slurm"


@contextmanager
def cluster_of(scheduler: str, workers: Optional[int], slots: int, memory: Optional[int]) -> Iterator[Cluster]:
    """local, slurm, the address of a scheduler, or the file that it wrote."""
    distributed = places.package("distributed")
    settings: Dict[str, Any] = {
        "distributed.scheduler.allowed-failures": DEATHS_OF_WORKERS,
        "distributed.worker.profile.enabled": False,  # its threads only wait for processes
    }
    for name in ("distributed", "asyncio", "tornado"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what goes wrong is said by the farm, in a line
    with ExitStack() as stack:
        stack.enter_context(places.package("dask").config.set(settings))
        if scheduler == "local":
            start_tracker()
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="isoshell-farm-",
                                                                     ignore_cleanup_errors=True))
            cluster = stack.enter_context(distributed.LocalCluster(
                n_workers=1, threads_per_worker=slots, processes=True, memory_limit=0, host="127.0.0.1",
                dashboard_address="127.0.0.1:0" if has_dashboard() else None, local_directory=folder,
                silence_logs=logging.CRITICAL))
            client = stack.enter_context(distributed.Client(cluster, set_as_default=False))
            yield Cluster(client, "local", memory or memory_of_node(), has_dashboard(), folder)
        elif scheduler == "slurm":
            cluster = stack.enter_context(slurm_cluster())
            cluster.scale(jobs=workers or 1)
            client = stack.enter_context(distributed.Client(cluster, set_as_default=False))
            yield Cluster(client, "slurm", memory, has_dashboard(), "")
        else:
            client = stack.enter_context(connected(distributed, scheduler))
            yield Cluster(client, scheduler, memory, True, "")


def start_tracker() -> None:
    """Python's own process that removes semaphores, without a voice: after an interruption it would warn of them."""
    from multiprocessing import resource_tracker

    said, silence = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(silence, 2)
        resource_tracker.ensure_running()
    finally:
        os.dup2(said, 2)
        os.close(said)
        os.close(silence)


def connected(distributed: Any, scheduler: str) -> Any:
    """A client of a scheduler that somebody else started."""
    is_address = "://" in scheduler
    if not is_address and not os.path.exists(scheduler):
        raise Error(f"--scheduler {scheduler}: no such file; give local, slurm, an address such as tcp://host:8786, or "
                    "the file of dask scheduler --scheduler-file", stage="scheduler")
    given = {"address": scheduler} if is_address else {"scheduler_file": scheduler}
    try:
        return distributed.Client(**given, timeout=SECONDS_TO_CONNECT, set_as_default=False)
    except (OSError, ValueError) as error:  # a time that is over is an OSError
        raise Error(f"--scheduler {scheduler}: no scheduler answers there: {error}", ErrorCode.NO_DEVICE,
                    "scheduler") from error


def slurm_cluster() -> Any:
    """Of Slurm jobs as ~/.config/dask/jobqueue.yaml says; nothing is submitted yet."""
    jobqueue = places.package("dask_jobqueue")
    try:
        return jobqueue.SLURMCluster(n_workers=0)
    except (ValueError, TypeError) as error:
        raise Error(f"--scheduler slurm: {error} Say what a job is in ~/.config/dask/jobqueue.yaml, under "
                    "jobqueue: slurm: (cores, memory, queue, account, walltime)", stage="scheduler") from error


def has_dashboard() -> bool:
    """Dask's pages need bokeh."""
    return importlib.util.find_spec("bokeh") is not None
