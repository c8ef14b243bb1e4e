#!/usr/bin/env python3
"""Memory and time of a stage of USD with many samples: samples.py SOURCE OUTPUT.usdc SAMPLES [VERTICES=50000]

A result is made once, and every sample is that with other points and another order of faces, so that none is like another.
"""

import os
import sys
import time

import isoshell
import numpy as np
from isoshell._usd._samples import SampledStage


class Moved:
    """A result at another place, as far as a stage asks."""

    origin = None
    attributes: dict = {}
    domains: dict = {}
    labels: dict = {}

    def __init__(self, result, frame):
        self.frame = frame
        self.vertices = result.vertices + 0.01 * frame
        self.faces = np.roll(result.faces, frame, axis=0)

    def _named_attributes(self):
        return []


def own_mb():
    """Memory of the process that is not a file's."""
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) / 1024 for line in status if line.startswith("RssAnon"))


def main():
    source, target, samples = sys.argv[1], sys.argv[2], int(sys.argv[3])
    vertices = int(sys.argv[4]) if len(sys.argv) > 4 else 50_000
    result = isoshell.remesh(source, vertices=vertices, quiet=True)
    stage, start = SampledStage(target), time.perf_counter()
    print(f"before: {own_mb():.0f} MB")
    for frame in range(1, samples + 1):
        stage.add(Moved(result, frame))
        if frame % 100 == 0:
            print(f"{frame} samples: {own_mb():.0f} MB, {time.perf_counter() - start:.1f} s", flush=True)
    stage.finish()
    print(f"written: {own_mb():.0f} MB, {time.perf_counter() - start:.1f} s, {os.path.getsize(target) / 1e6:.0f} MB on disk")
    stage.discard()


if __name__ == "__main__":
    main()
