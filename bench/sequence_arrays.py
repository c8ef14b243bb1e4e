#!/usr/bin/env python3
"""A sequence by the command from files, and by the Python module from arrays: the same bytes, and CPU time a frame.

    PYTHONPATH=build/cpu/python bench/sequence_arrays.py build/cpu/vdb_isomesh 'frame.####.off' 0-23 --vertices 4000

Frames are OFF files of triangles. Each runs in a process of its own, with one thread, in turns; the least of the
rounds counts. Reading the arrays is not counted, and given by itself.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROUNDS = 3


def arrays_of(path):
    words = Path(path).read_text().split()
    vertices, faces = int(words[1]), int(words[2])
    at = 4 + 3 * vertices
    return (np.array(words[4:at], float).reshape(-1, 3),
            np.array(words[at:at + 4 * faces], int).reshape(-1, 4)[:, 1:])


def by_module(arguments):
    """In a process of its own: what it took, and the digests."""
    import isoshell

    options = {"vertices": arguments.vertices, "features": "off", "threads": 1, "quiet": True}
    first, last = map(int, arguments.frames.split("-"))
    reading, digests = 0.0, []

    def sources():
        nonlocal reading
        for frame in range(first, last + 1):
            start = time.process_time()
            arrays = arrays_of(isoshell._isoshell.path_of_frame(arguments.pattern, frame))
            reading += time.process_time() - start
            yield arrays

    for result in isoshell.remesh_sequence(sources(), frames=arguments.frames, output=arguments.output, **options):
        digests.append(result.digest)
    print(json.dumps({"cpu_s": time.process_time() - reading, "reading_s": reading, "digests": digests,
                      "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}))


def measured(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([*map(str, words)], check=True, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command")
    parser.add_argument("pattern")
    parser.add_argument("frames")
    parser.add_argument("--vertices", type=int, default=4000)
    parser.add_argument("--output", help=argparse.SUPPRESS)  # of the process with the module
    arguments = parser.parse_args()
    if arguments.output:
        return by_module(arguments)
    command_s, module_s = [], []
    for _ in range(ROUNDS):
        with tempfile.TemporaryDirectory() as folder:
            ours, theirs = Path(folder) / "ours.####.ply", Path(folder) / "theirs.####.ply"
            command_s.append(measured([arguments.command, arguments.pattern, theirs, "--frames", arguments.frames,
                                       "--vertices", arguments.vertices, "--features", "off", "--threads", 1,
                                       "--quiet"])[0])
            said = json.loads(measured([sys.executable, __file__, *sys.argv[1:], "--output", ours])[1])
            module_s.append(said["cpu_s"])
            pairs = [(path, Path(str(path).replace("ours", "theirs"))) for path in sorted(Path(folder).glob("ours*"))]
            same = sum(a.read_bytes() == b.read_bytes() for a, b in pairs)
    count = len(said["digests"])
    print(f"{same} of {count} files have the command's bytes; digest of the last {said['digests'][-1]}")
    print(f"CPU time a frame: command {min(command_s) / count:.3f} s, module {min(module_s) / count:.3f} s "
          f"({min(module_s) / min(command_s):.3f} of it); reading the arrays {said['reading_s'] / count:.3f} s besides; "
          f"peak of the module {said['peak_mb']:.0f} MB")


if __name__ == "__main__":
    sys.exit(main())
