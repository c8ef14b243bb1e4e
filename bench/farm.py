#!/usr/bin/env python3
"""Farms beside plain loops, and farms in trouble.

    bench/farm.py make MESHES ASSETS [--count 100]    scaled and damaged copies of a folder of meshes, 5 % poisoned
    bench/farm.py beside ASSETS WORK [--repeats 3]    a farm of two assets at a time and two loops, in turn
    bench/farm.py chaos ASSETS WORK                   processes killed, the disk full; then resumed
    bench/farm.py rows WORK [--count 100000]          time to read a manifest and to find that nothing is left to do

Poisoned are: a named pipe that never ends, a named pipe whose reader this program ends by SIGSEGV, a row of the table
that asks for a grid 100 times too large, and a file that is cut off. `chaos` needs root, for a small disk of its own.
"""
import argparse
import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np

import isoshell
from isoshell import _isoshell
from isoshell._farm import _assets, _manifest, _plan, _rows

VERTICES = 2000
TIME_LIMIT = 8
KILL_SECONDS = 20
FARM = [sys.executable, "-m", "isoshell", "farm"]
KINDS = ("endless", "crash", "huge", "malformed")


def make(meshes, folder, count):
    """The same files for the same meshes and count."""
    folder.mkdir(parents=True)
    chance = random.Random(7)
    sources = sorted(path for path in meshes.rglob("*") if path.suffix in (".off", ".obj", ".ply"))
    loaded = {path: surface_of(path) for path in sources}
    table = [("path", "resolution")]
    for i in range(count):
        if i % 20 == 19:
            name, resolution = poison(folder, i, KINDS[i // 20 % len(KINDS)], loaded[sources[0]])
        else:
            name, resolution = f"asset{i:05d}.off", ""
            vertices, faces = loaded[sources[i % len(sources)]]
            scale = np.array([chance.uniform(0.5, 2) for _ in range(3)])
            kept = np.ones(len(faces), bool)
            for _ in range(chance.randrange(4)):  # holes
                at = chance.randrange(len(faces))
                kept[at:at + len(faces) // 200] = False
            write_off(folder / name, vertices * scale, faces[kept])
        table.append((name, resolution))
    with open(folder / "assets.csv", "w", newline="") as file:
        csv.writer(file).writerows(table)


def surface_of(path):
    place = isoshell.Context()._place
    return _isoshell.read_surface(place, _isoshell.Source.file(str(path)), [], lambda *_: None)


def write_off(path, vertices, faces):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        np.savetxt(file, vertices, "%.7g")
        np.savetxt(file, np.column_stack([np.full(len(faces), 3), faces]), "%d")


def poison(folder, number, kind, surface):
    path = folder / f"{kind}{number:05d}.off"
    if kind in ("endless", "crash"):
        os.mkfifo(path)
    else:
        write_off(path, *surface)
    if kind == "malformed":
        os.truncate(path, path.stat().st_size // 2)
    return path.name, 8000 if kind == "huge" else ""


def is_poisoned(name):
    return name.startswith(KINDS)


class Crasher(threading.Thread):
    """Ends whoever reads one of these pipes."""

    def __init__(self, path):
        super().__init__(daemon=True)
        self.path = path

    def run(self):
        while True:
            with open(self.path, "wb"):
                while not self.end_readers():
                    time.sleep(0.01)
                while self.end_readers():
                    time.sleep(0.01)

    def end_readers(self):
        found = False
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                names = [os.readlink(file) for file in Path(f"/proc/{pid}/fd").iterdir()]
            except OSError:
                continue
            if int(pid) != os.getpid() and str(self.path) in names:
                os.kill(int(pid), signal.SIGSEGV)
                found = True
        return found


def start_crashers(folder):
    for path in sorted(folder.glob("crash*")):
        Crasher(path.resolve()).start()


def rows_of(out):
    return {row["output"]: row for row in _manifest.read(str(out)).rows.values()}


def good_assets(folder):
    return sorted(path for path in folder.glob("asset*.off"))


def loop(words):
    """A plain loop over the module: what a person writes who has no farm. Every second asset, from `first`."""
    folder, out, first = Path(words[0]), Path(words[1]), int(words[2])
    context = isoshell.Context(threads=1)
    for path in good_assets(folder)[first::2]:
        target = out / f"{path.stem}.ply"
        isoshell.remesh(path, vertices=VERTICES, context=context, output=target, stats=target.with_suffix(".json"),
                        quiet=True)


def time_loops(folder, out):
    out.mkdir()
    start = time.perf_counter()
    halves = [subprocess.Popen([sys.executable, "-W", "ignore", __file__, "loop", folder, out, str(i)]) for i in (0, 1)]
    assert all(half.wait() == 0 for half in halves)
    return time.perf_counter() - start


def time_farm(folder, out):
    start = time.perf_counter()
    subprocess.run(farm_words(f"{folder}/asset*.off", out), check=True, stderr=subprocess.DEVNULL)
    return time.perf_counter() - start


def farm_words(assets, out):
    return [*FARM, "run", str(assets), str(out), "--vertices", str(VERTICES), "--workers", "2", "--threads", "1",
            "--time-limit", str(TIME_LIMIT)]


def beside(folder, work, repeats):
    work.mkdir(parents=True, exist_ok=True)
    times = {"farm": [], "loops": []}
    for i in range(repeats):
        for name, measure in (("loops", time_loops), ("farm", time_farm)):
            out = work / f"{name}{i}"
            shutil.rmtree(out, ignore_errors=True)
            times[name].append(measure(folder, out))
    names = [f"{path.stem}.ply" for path in good_assets(folder)]
    same = sum((work / "farm0" / name).read_bytes() == (work / "loops0" / name).read_bytes() for name in names)
    farm, loops = (float(np.median(times[name])) for name in ("farm", "loops"))
    print(json.dumps({"assets": len(names), "same_bytes": same, "seconds": times, "ratio": farm / loops}, indent=1))


def chaos(folder, work):
    disk = work / "disk"
    disk.mkdir(parents=True)
    start_crashers(folder)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256m", "tmpfs", str(disk)], check=True)
    try:
        ends = []
        for how in ("farm killed", "disk full", "processes killed only", "resumed"):
            ends.append({"run": how, **run_in_trouble(folder, disk, how)})
            print(json.dumps(ends[-1]), flush=True)
        print(json.dumps(verdict(folder, disk / "out", work / "serial"), indent=1))
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def run_in_trouble(folder, disk, how):
    """Every 20 seconds a process that meshes is killed; after 30 the farm itself is, or no room is left."""
    filler = disk / "filler"
    farm = subprocess.Popen(farm_words(folder / "assets.csv", disk / "out"), stderr=subprocess.PIPE, text=True)
    start, killed = time.monotonic(), 0
    while farm.poll() is None:
        time.sleep(0.5)
        seconds = time.monotonic() - start
        if how != "resumed" and seconds > KILL_SECONDS * (killed + 1):
            killed += kill_one_that_meshes(farm.pid)
        if how == "farm killed" and seconds > 30:
            farm.kill()
        if how == "disk full" and seconds > 30 and not filler.exists():
            fill(filler)
    said = farm.stderr.read().strip().splitlines()
    filler.unlink(missing_ok=True)
    rows = rows_of(disk / "out").values()
    return {"status": farm.returncode, "seconds": round(time.monotonic() - start, 1), "killed": killed,
            "done": sum(row["state"] == "done" for row in rows), "said": said[-1] if said else ""}


def kill_one_that_meshes(pid):
    for line in subprocess.run(["ps", "-eo", "pid,ppid,args"], capture_output=True, text=True).stdout.splitlines():
        words = line.split(None, 2)
        if len(words) == 3 and words[1] == str(pid) and "isoshell._farm._child" in words[2]:
            os.kill(int(words[0]), signal.SIGKILL)
            return 1
    return 0


def fill(path):
    with open(path, "wb", buffering=0) as file:
        try:
            while True:
                file.write(bytes(1 << 16))
        except OSError:
            pass


def verdict(folder, out, serial):
    """Whether all others are done with the digests of a loop, and each poisoned one is a row with its reason."""
    rows = rows_of(out)
    if not serial.exists():
        time_loops(folder, serial)
    good = [path.stem for path in good_assets(folder)]
    same = [name for name in good if rows.get(f"{name}.ply", {}).get("state") == "done"
            and (out / f"{name}.ply").read_bytes() == (serial / f"{name}.ply").read_bytes()
            and rows[f"{name}.ply"]["digest"] == json.loads((serial / f"{name}.json").read_text())["digests"]["mesh"]]
    reasons = {}
    for name, row in rows.items():
        if is_poisoned(name):
            kind = next(kind for kind in KINDS if name.startswith(kind))
            reasons.setdefault(f"{kind}: {row.get('code', 'done')}", []).append(row["attempts"])
    left = sorted(str(path.relative_to(out)) for path in out.rglob("*")
                  if path.is_file() and path.suffix not in (".ply", ".json", ".jsonl"))
    return {"good": len(good), "same_as_serial": len(same), "poisoned": reasons, "other_files_left": left}


def rows(work, count):
    """Rows as long as real ones, of assets and outputs that are there, empty."""
    folder, out = work / "assets", work / "out"
    shutil.rmtree(work, ignore_errors=True)
    folder.mkdir(parents=True)
    out.mkdir()
    for i in range(count):
        (folder / f"{i:06d}.off").touch()
        (out / f"{i:06d}.ply").touch()
        (out / f"{i:06d}.json").touch()
    assets = _assets.assets_of(str(folder), {"vertices": "2000"}, ".ply", str(out))
    (out / "manifest").mkdir()
    with open(out / "manifest/rows.jsonl", "wb") as file:
        file.write(_rows.line_of({"began": "0", "time": 0, "assets": count, "done": 0, "failed": 0, "command": "",
                                  "version": isoshell.__version__}))
        for asset in assets:
            file.write(_rows.line_of({
                "output": asset.output, "asset": asset.path, "options": asset.options, "version": isoshell.__version__,
                "run": "0", "input_size": 0, "input_changed": asset.changed, "gates": {"required": [], "missed": []},
                "worker": "host:1", "input_sha256": "0" * 64, "digest": "0" * 16, "peak_memory": 1, "device": "cpu",
                "device_memory": None, "vertices": 2000, "triangles": 3996, "min_angle": 40.0, "quality": 0.96,
                "deviation_pct": 0.9, "output_sha256": "0" * 64, "output_size": 0, "attempts": 1, "state": "done",
                "seconds": 1.0, "time": 1.0}))
    start = time.perf_counter()
    found = _manifest.read(str(out))
    read = time.perf_counter()
    plan = _plan.plan_of(assets, found.rows, str(out), False)
    planned = time.perf_counter()
    subprocess.run([*FARM, "run", folder, out, "--vertices", "2000"], check=True, stderr=subprocess.DEVNULL)
    print(json.dumps({"rows": len(found.rows), "read_s": read - start, "plan_s": planned - read, "done": plan.done,
                      "whole_command_s": time.perf_counter() - planned}, indent=1))


def main():
    if sys.argv[1:2] == ["loop"]:
        return loop(sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="what", required=True)
    for name, words in (("make", ("meshes", "assets")), ("beside", ("assets", "work")), ("chaos", ("assets", "work")),
                        ("rows", ("work",))):
        command = commands.add_parser(name)
        for word in words:
            command.add_argument(word, type=Path)
        command.add_argument("--count", type=int, default=100000 if name == "rows" else 100)
        command.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    if given.what == "make":
        make(given.meshes, given.assets, given.count)
    elif given.what == "beside":
        beside(given.assets.resolve(), given.work.resolve(), given.repeats)
    elif given.what == "chaos":
        chaos(given.assets.resolve(), given.work.resolve())
    else:
        rows(given.work.resolve(), given.count)


if __name__ == "__main__":
    main()
