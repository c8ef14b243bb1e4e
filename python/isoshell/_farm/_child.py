"""The process that meshes: a child of a worker, which hands it one asset after the other and may end it at any time.

Jobs come as lines of JSON on standard input, answers go as such to standard output. Several jobs may be under way, each
on a context of its own; these share the process, and with it a device.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import tempfile
import threading
import warnings
from typing import Any, Dict, List, Optional

import isoshell
from isoshell import Error, ErrorCode, Result
from isoshell._farm import _places as places
from isoshell._farm._assets import file_of, files_of

Answer = Dict[str, Any]


def main() -> None:
    """Until standard input ends: with the worker, however that ends, this process ends too."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # what a library prints is no answer
    lock = threading.Lock()
    jobs: queue.SimpleQueue[Dict[str, Any]] = queue.SimpleQueue()

    def work() -> None:
        contexts: Dict[Any, isoshell.Context] = {}
        while True:
            job = jobs.get()
            answer = done(job, contexts)
            with lock:
                answers.write(json.dumps({"id": job["id"], **answer}) + "\n")

    warnings.simplefilter("ignore")  # they are in the statistics
    for _ in range(int(sys.argv[1])):
        threading.Thread(target=work, daemon=True).start()
    for line in sys.stdin:
        jobs.put(json.loads(line))
    os._exit(0)


def done(job: Dict[str, Any], contexts: Dict[Any, isoshell.Context]) -> Answer:
    """Do a job. Whatever goes wrong is part of the answer."""
    answer: Answer = {}
    try:
        with tempfile.TemporaryDirectory(prefix="fetched-", dir=job["scratch"]) as fetched:
            mesh_asset(job, contexts, fetched, answer)
    except Error as error:
        answer.update(code=error.code.name, message=str(error))
    except MemoryError:
        answer.update(code=ErrorCode.OUT_OF_MEMORY.name, message="out of memory")
    except OSError as error:
        answer.update(code=ErrorCode.UNREADABLE_INPUT.name, message=f"{error.filename or job['path']}: "
                      f"{error.strerror or error}", transient=True)
    except Exception as error:
        answer.update(code=ErrorCode.INTERNAL.name, message=f"{type(error).__name__}: {error}")
    return answer


def mesh_asset(job: Dict[str, Any], contexts: Dict[Any, isoshell.Context], fetched: str, answer: Answer) -> None:
    """From the input to a finished mesh and its statistics in the scratch folder."""
    path, inputs = brought_here(job["path"], job["options"], fetched)
    answer["input_sha256"] = places.sha256_of(inputs)
    if answer["input_sha256"] == job["known_sha256"]:
        answer["unchanged"] = True
        return
    if job["estimate"]:
        answer["estimate"] = isoshell.estimate(path, **job["options"])["memory_bytes"]
        return
    if job["frames"]:
        answer["path"] = path  # the worker starts the command, which knows sequences
        return
    key = tuple(sorted(job["place"].items()))
    if key not in contexts:
        for context in contexts.values():
            context.close()
        contexts.clear()
        contexts[key] = isoshell.Context(**job["place"])
    forget_peak()
    try:
        result = isoshell.remesh(path, context=contexts[key], output=job["mesh"], stats=True, force=True, quiet=True,
                                 **job["options"])
    except Error as error:
        if error.result is not None:
            write_statistics(error.result, job)
            answer.update(measures_of(error.result), **finished(job))
        raise
    write_statistics(result, job)
    answer.update(measures_of(result), **finished(job))


def forget_peak() -> None:
    """The largest memory of a process is that of its run, although it has had others."""
    try:
        with open("/proc/self/clear_refs", "w") as file:
            file.write("5")
    except OSError:
        pass  # not everywhere; the figure is then that of the largest run


def write_statistics(result: Result, job: Dict[str, Any]) -> None:
    """As --stats has them, with the names that files have for good."""
    report = result.report
    report["input"]["path"], report["output"]["path"] = job["path"], job["output"]
    try:
        with open(job["stats"], "w", encoding="utf-8", errors="backslashreplace") as file:
            json.dump(report, file, indent=2, ensure_ascii=False)
    except OSError as error:
        raise Error(f"{job['stats']}: {error.strerror}", ErrorCode.UNWRITABLE_OUTPUT, "write") from error


def finished(job: Dict[str, Any]) -> Answer:
    """What is known of the files, which have reached the disk then."""
    for file in (job["mesh"], job["stats"]):
        try:
            places.to_disk(file)
        except OSError as error:
            raise Error(f"{file}: {error.strerror}", ErrorCode.UNWRITABLE_OUTPUT, "write") from error
    return {"output_sha256": places.sha256_of([job["mesh"]]), "output_size": os.path.getsize(job["mesh"])}


def brought_here(path: str, options: Dict[str, Any], fetched: str) -> tuple[str, List[str]]:
    """The path that is read, and the files that it means: of remote ones copies."""
    files = [*files_of(path, options)]
    if not places.is_remote(path):
        return path, files
    copies = [os.path.join(fetched, os.path.basename(file)) for file in files]
    for file, copy in zip(files, copies):
        try:
            places.fetch(file, copy)
        except Exception as error:  # each file system has its own
            raise OSError(f"{file}: {type(error).__name__}: {error}") from error
    pattern = os.path.join(fetched, os.path.basename(file_of(path)))
    return pattern + path[len(file_of(path)):], copies


def measures_of(result: Result) -> Answer:
    """What the manifest has of a result."""
    report = result.report
    memory, quality, distance = report["memory_bytes"], report["quality"], report.get("distance")
    missed = list(result._made.missed_gates)
    return {"digest": result.digest, "gates": {"required": list(result._made.gates), "missed": missed},
            "peak_memory": memory["host_peak"], "device_memory": memory["device_peak"], "device": report["device"],
            "vertices": len(result.vertices), "triangles": len(result.faces), "min_angle": quality["theta_min_deg"],
            "quality": quality["q_avg"], "deviation_pct": deviation_of(distance)}


def deviation_of(distance: Optional[Dict[str, Any]]) -> Optional[float]:
    return distance["pct_of_diagonal"]["hausdorff"] if distance else None


if __name__ == "__main__":
    main()
