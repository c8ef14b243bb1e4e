#!/usr/bin/env python3
"""A farm over the devices of one machine: assets a second with one, two, ... of them.

    bench/farm_devices.py make SOURCES ASSETS [--count 2000]    copies of the files of a folder, in turn
    bench/farm_devices.py run ASSETS WORK [--devices 1,2,4] [--contexts 16] [--kill] [--cpu]

Copies of meshes are scaled along the axes, and PLY; those of clouds (.xyz, .pcd) and volumes (.vdb) are as they are. Of
twenty copies one is cut off in the middle where there are clouds or volumes.

The rate is that between the tenth and the last asset, so that it leaves out how processes start; the whole time stands
beside it. With --kill a last run has all devices, and the process that meshes on one of them is killed every
twenty seconds. With --cpu the same assets are meshed on the processor. All runs must give the same digests.
"""
import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import isoshell
from isoshell import _isoshell
from isoshell._farm import _manifest

FARM = [sys.executable, "-m", "isoshell", "farm", "run"]
VERTICES = 4000
KILL_SECONDS = 20
MESHES = (".off", ".obj", ".ply")
OTHERS = (".xyz", ".pcd", ".vdb")


def make(sources, folder, count):
    """The same files for the same sources and count."""
    folder.mkdir(parents=True)
    chance = random.Random(11)
    place = isoshell.Context(device="cpu")._place
    scans = {path: _isoshell.read_surface(place, _isoshell.Source.file(str(path)), [], lambda *_: None)
             for path in sources.iterdir() if path.suffix in MESHES}
    paths = sorted([*scans, *(path for path in sources.iterdir() if path.suffix in OTHERS)])
    for i in range(count):
        path = paths[i % len(paths)]
        copy = folder / f"asset{i:05d}{path.suffix if path.suffix in OTHERS else '.ply'}"
        if path in scans:
            vertices, faces = scans[path]
            scale = np.array([chance.uniform(0.5, 2) for _ in range(3)])
            write_ply(copy, (vertices * scale).astype("<f4"), faces.astype("<i4"))
        else:
            shutil.copyfile(path, copy)
        if len(paths) > len(scans) and i % 20 == 19:
            os.truncate(copy, copy.stat().st_size // 2)


def write_ply(path, vertices, faces):
    rows = np.empty(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, faces
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(head.encode() + vertices.tobytes() + rows.tobytes())


def children_of(pid):
    """(number, words) of all processes below."""
    all_of = {}
    for line in subprocess.run(["ps", "-eo", "pid,ppid,args"], capture_output=True, text=True).stdout.splitlines()[1:]:
        number, parent, words = line.split(None, 2)
        all_of.setdefault(int(parent), []).append((int(number), words))
    found, looked_at = [], [pid]
    while looked_at:
        below = all_of.get(looked_at.pop(), [])
        found += below
        looked_at += [number for number, _ in below]
    return found


def kill_one_that_meshes(pid):
    meshing = [number for number, words in children_of(pid) if "_child" in words]
    if meshing:
        os.kill(meshing[0], signal.SIGKILL)
    return len(meshing[:1])


def run(assets, out, words, devices=None, kill=False):
    shutil.rmtree(out, ignore_errors=True)
    environment = dict(os.environ)
    if devices is not None:
        environment["CUDA_VISIBLE_DEVICES"] = ",".join(map(str, range(devices)))
    start, killed = time.monotonic(), 0
    farm = subprocess.Popen([*FARM, assets, out, "--vertices", str(VERTICES), *words], env=environment,
                            stderr=subprocess.PIPE, text=True)
    while kill and farm.poll() is None:
        time.sleep(0.2)
        if time.monotonic() - start > KILL_SECONDS * (killed + 1):
            killed += kill_one_that_meshes(farm.pid)
    said = farm.communicate()[1].strip().splitlines()
    seconds = time.monotonic() - start
    rows = _manifest.read(str(out)).rows.values()
    done = sorted(row["time"] for row in rows if row["state"] == "done")
    rate = (len(done) - 10) / (done[-1] - done[9]) if len(done) > 10 else None
    print(json.dumps({"out": out.name, "status": farm.returncode, "done": len(done), "seconds": round(seconds, 1),
                      "assets_a_second": rate and round(rate, 1), "killed": killed,
                      "tried_again": sum(row["attempts"] > 1 for row in rows), "said": said[-1:]}), flush=True)
    return {row["output"]: row.get("digest") for row in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="what", required=True)
    made = commands.add_parser("make")
    made.add_argument("sources", type=Path)
    made.add_argument("assets", type=Path)
    made.add_argument("--count", type=int, default=2000)
    runs = commands.add_parser("run")
    runs.add_argument("assets", type=Path)
    runs.add_argument("work", type=Path)
    runs.add_argument("--devices", default="1,2,4")
    runs.add_argument("--contexts", default="16")
    runs.add_argument("--kill", action="store_true")
    runs.add_argument("--cpu", action="store_true")
    given = parser.parse_args()
    if given.what == "make":
        return make(given.sources, given.assets, given.count)
    counts = [int(number) for number in given.devices.split(",")]
    words = ["--device", "cuda", "--contexts", given.contexts]
    digests = {f"devices-{n}": run(given.assets, given.work / f"devices-{n}", words, n) for n in counts}
    if given.kill:
        digests["killed"] = run(given.assets, given.work / "killed", words, counts[-1], kill=True)
    if given.cpu:
        digests["cpu"] = run(given.assets, given.work / "cpu", ["--device", "cpu"])
    first = digests[f"devices-{counts[0]}"]
    same = {name: sum(first[output] is not None and found.get(output) == first[output] for output in first)
            for name, found in digests.items()}
    print(json.dumps({"assets": len(first), "same_digests": same}))


if __name__ == "__main__":
    main()
