#!/usr/bin/env python3
"""What it takes to start from a level set that is in memory, sparse or as an array, against one in a file.

bench/memory_grids.py [RESOLUTION ...]

A ball with waves, whose level set isoshell makes, is read in each way by a process of its own; the surface is the same, and
no mesh is made. Needs the module isoshell.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import isoshell
import numpy as np

WAYS = ("file", "bytes", "sparse", "array")


def wavy_ball(steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of a closed surface."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, steps, endpoint=False), np.linspace(0, np.pi, steps // 2)[1:-1], indexing="ij")
    radius = 1 + 0.1 * np.sin(5 * u) * np.sin(7 * v) * np.sin(v) ** 2
    ring = (radius[..., None] * np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], -1)).reshape(-1, 3)
    n = v.shape[1]
    vertices = np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]])
    top, bottom = len(ring), len(ring) + 1
    faces = []
    for i in range(steps):
        a, b = i * n, (i + 1) % steps * n
        faces += [(top, a, b), (bottom, b + n - 1, a + n - 1)]
        faces += [f for j in range(n - 1) for f in ((a + j, a + j + 1, b + j + 1), (a + j, b + j + 1, b + j))]
    return vertices, np.array(faces)


def volume_of(way: str, folder: Path) -> object:
    if way == "file":
        return folder / "set.vdb"
    if way == "bytes":
        return isoshell.Volume((folder / "set.vdb").read_bytes())
    held = np.load(folder / f"{way}.npz")
    if way == "sparse":
        return isoshell.Volume(held["values"], coordinates=held["coordinates"], affine=held["affine"])
    return isoshell.Volume(held["values"], affine=held["affine"])


def peak_mib() -> int:
    """Of this process; what getrusage says is at least what the one before it in its place had."""
    status = Path("/proc/self/status").read_text()
    return int(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM"))) >> 10


def measure(way: str, folder: Path) -> None:
    source = volume_of(way, folder)
    isoshell.Context(device="cpu")
    before = peak_mib()
    start = time.process_time()
    found = isoshell.estimate(source, vertices=4000, features="off", device="cpu")
    print(json.dumps({"seconds": time.process_time() - start, "mib_before": before, "sites": found["sites"],
                      "mib": peak_mib()}))


def main() -> None:
    if len(sys.argv) > 1 and sys.argv[1] in WAYS:
        return measure(sys.argv[1], Path(sys.argv[2]))
    print("| resolution | voxels | way | CPU seconds | MiB before | MiB at most |\n| --- | --- | --- | --- | --- | --- |")
    for resolution in map(int, sys.argv[1:] or ("256", "512")):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            distances = isoshell.level_set(wavy_ball(400), resolution=resolution, features="off", device="cpu")
            distances.save(folder / "set.vdb")
            np.savez(folder / "sparse.npz", values=distances.values, coordinates=distances.coordinates,
                     affine=distances.transform)
            corner = distances.transform.copy()
            corner[:3, 3] += distances.coordinates.min(axis=0) * distances.voxel_size
            np.savez(folder / "array.npz", values=distances.to_array(), affine=corner)
            for way in WAYS:
                runs = [json.loads(subprocess.run([sys.executable, __file__, way, name], check=True, capture_output=True,
                                                  text=True).stdout) for _ in range(3)]
                best = min(runs, key=lambda run: run["seconds"])
                print(f"| {resolution} | {len(distances):,} | {way} | {best['seconds']:.2f} | {best['mib_before']} | "
                      f"{best['mib']} |", flush=True)


if __name__ == "__main__":
    main()
