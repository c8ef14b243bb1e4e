#!/usr/bin/env python3
"""What it costs to give remesh() a mesh in the memory of a CUDA device, beside the same mesh in the host's: needs a
device, the module built with CUDA, and numpy; neither torch nor cupy.
  PYTHONPATH=build/cuda/python python bench/device_tensors.py [N] [VERTICES]"""
import sys
import time
from pathlib import Path
from statistics import median

import isoshell
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python/tests"))
from device_tensor import DeviceTensor, Driver
from isoshell._arrays import array_of

REPEATS = 9


def torus(n):
    """A closed mesh of 4 n^2 triangles."""
    a, b = np.meshgrid(np.arange(2 * n) * np.pi / n, np.arange(n) * 2 * np.pi / n, indexing="ij")
    r = 2 + .7 * np.cos(b)
    i, j = np.meshgrid(np.arange(2 * n), np.arange(n), indexing="ij")
    corner = [((i + x) % (2 * n) * n + (j + y) % n).ravel() for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    faces = np.concatenate([np.stack([corner[0], *pair], 1) for pair in (corner[1:3], corner[2:4])])
    return np.stack([r * np.cos(a), r * np.sin(a), .7 * np.sin(b)], -1).reshape(-1, 3), faces


def milliseconds(*works):
    """Of each, done in turn."""
    def once(work):
        start = time.perf_counter()
        work()
        return 1e3 * (time.perf_counter() - start)

    rounds = [[once(work) for work in works] for _ in range(REPEATS + 1)][1:]
    return [median(column) for column in zip(*rounds)]


def main(n=500, vertices=100_000):
    mesh = torus(n)
    driver = Driver()
    on_device = [DeviceTensor(driver, np.array(values)) for values in mesh]
    driver.call("cuStreamSynchronize", driver.stream)
    megabytes = sum(values.nbytes for values in mesh) / 1e6
    [copy] = milliseconds(lambda: [array_of("values", tensor) for tensor in on_device])
    print(f"{len(mesh[1])} triangles, {megabytes:.1f} MB: {copy:.1f} ms to the host, {megabytes / copy:.1f} GB/s")
    with isoshell.Context(device="cuda") as context:
        def run(source):
            return isoshell.remesh(source, vertices=vertices, context=context)

        assert run(tuple(on_device)).digest == run(mesh).digest
        host, device = milliseconds(lambda: run(mesh), lambda: run(tuple(on_device)))
        print(f"remesh: {host:.0f} ms from the host, {device:.0f} ms from the device")
        try:
            result = run(tuple(on_device))
            print(f"to_torch: {milliseconds(result.to_torch)[0]:.1f} ms")
        except ImportError:
            print("to_torch: there is no torch here")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
