"""Where a farm runs: Dask's own clusters."""

from __future__ import annotations

import logging
import os
import tempfile
import warnings
from contextlib import ExitStack, contextmanager
from typing import Any, Dict, Iterator, NamedTuple, Optional

from .._errors import Error
from .._isoshell import ErrorCode
from . import _places as places
from ._admission import memory_of_node
from ._progress import tell

DEATHS_OF_WORKERS = 10  # that an asset may see before it is given up
OPEN = ("tcp://", "ws://")  # addresses that ask nobody for a certificate
THIS_MACHINE = "127.0.0.1:0"


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
def cluster_of(scheduler: str, workers: Optional[int], slots: int, memory: Optional[int],
               dashboard: bool) -> Iterator[Cluster]:
    """local, slurm, the address of a scheduler, or the file that it wrote."""
    distributed = places.package("distributed")
    settings: Dict[str, Any] = {
        "distributed.scheduler.allowed-failures": DEATHS_OF_WORKERS,
        "distributed.worker.profile.enabled": False,  # its threads only wait for processes
    }
    if dashboard:
        places.package("bokeh")
    else:
        settings["distributed.scheduler.http.routes"] = []
    for name in ("distributed", "asyncio", "tornado"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what goes wrong is said by the farm, in a line
    with ExitStack() as stack:
        stack.enter_context(places.package("dask").config.set(settings))
        if scheduler == "local":
            stack.enter_context(warnings.catch_warnings())
            warnings.filterwarnings("ignore", "Couldn't detect a suitable IP address")  # which no port needs
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="isoshell-farm-",
                                                                     ignore_cleanup_errors=True))
            cluster = stack.enter_context(local_cluster(distributed, slots, folder, dashboard))
            client = stack.enter_context(distributed.Client(cluster, set_as_default=False))
            yield Cluster(client, "local", memory or memory_of_node(), dashboard, folder)
        elif scheduler == "slurm":
            cluster = stack.enter_context(slurm_cluster(dashboard))
            cluster.scale(jobs=workers or 1)
            client = stack.enter_context(distributed.Client(cluster, set_as_default=False))
            yield Cluster(client, "slurm", memory, dashboard, "")
        else:
            client = stack.enter_context(connected(distributed, scheduler))
            yield Cluster(client, scheduler, memory, True, "")


def local_cluster(distributed: Any, slots: int, folder: str, dashboard: bool) -> Any:
    """A scheduler and a worker in this process, which listen at no port: whoever reaches one may run code as its user.
    The dashboard, which only shows, has one where it is asked for."""

    class Mute:
        def start_http_server(self, *_: Any, **__: Any) -> None:
            """Pages of Dask's that nobody has asked for."""

    own: Dict[str, Any] = {"protocol": "inproc://"}
    scheduler = distributed.Scheduler if dashboard else type("Scheduler", (Mute, distributed.Scheduler), {})
    worker = type("Worker", (Mute, distributed.Worker), {})
    return distributed.SpecCluster(
        scheduler={"cls": scheduler, "options": {**own, "dashboard": dashboard, "dashboard_address": THIS_MACHINE}},
        workers={0: {"cls": worker, "options": {**own, "nthreads": slots, "memory_limit": 0, "dashboard": False,
                                                "local_directory": folder}}},
        silence_logs=logging.CRITICAL)


def connected(distributed: Any, scheduler: str) -> Any:
    """A client of a scheduler that somebody else started."""
    is_address = "://" in scheduler
    if not is_address and not os.path.exists(scheduler):
        raise Error(f"--scheduler {scheduler}: no such file; give local, slurm, an address such as tcp://host:8786, or "
                    "the file of dask scheduler --scheduler-file", stage="scheduler")
    given = {"address": scheduler} if is_address else {"scheduler_file": scheduler}
    try:
        client = distributed.Client(**given, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:  # a time that is over is an OSError
        raise Error(f"--scheduler {scheduler}: no scheduler answers there: {error}", ErrorCode.NO_DEVICE,
                    "scheduler") from error
    if client.scheduler.address.startswith(OPEN):
        tell(f"warning: the scheduler at {client.scheduler.address} asks for no certificate: whoever reaches its port, "
             "or a worker's, can run code as the users of its workers; start it with TLS, as "
             "https://distributed.dask.org/en/stable/tls.html says")
    return client


def slurm_cluster(dashboard: bool) -> Any:
    """Of Slurm jobs as ~/.config/dask/jobqueue.yaml says; nothing is submitted yet. Certificates made for this farm
    alone are what its jobs and nobody else connect with: files that only their user can read, in the home folder unless
    shared-temp-directory says otherwise."""
    jobqueue, config = places.package("dask_jobqueue"), places.package("dask").config
    places.package("cryptography")
    options = {"dashboard": dashboard, "dashboard_address": THIS_MACHINE,
               **(config.get("jobqueue.slurm.scheduler-options", None) or {})}
    try:
        return jobqueue.SLURMCluster(
            n_workers=0, security=True, scheduler_options=options,
            worker_extra_args=[*(config.get("jobqueue.slurm.worker-extra-args", None) or []), "--no-dashboard"],
            shared_temp_directory=config.get("jobqueue.slurm.shared-temp-directory", None) or os.path.expanduser("~"))
    except (ValueError, TypeError) as error:
        raise Error(f"--scheduler slurm: {error} Say what a job is in ~/.config/dask/jobqueue.yaml, under "
                    "jobqueue: slurm: (cores, memory, queue, account, walltime)", stage="scheduler") from error
