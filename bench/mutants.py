#!/usr/bin/env python3
"""Damages files and meshes them: what a hostile or broken file does to the command.

    bench/mutants.py FOLDER... [--count N] [--seed S] [--command PATH] [--meshinfo PATH] [--keep DIR]

Takes every file of the folders that the command reads, changes bytes, numbers, lines or the length of copies of them, and
runs the command on each under limits of time and memory. Prints how many runs ended with which status, and every run
that ended by a signal, with a status that the command does not document, after more CPU seconds than allowed, or with a
mesh that `vdb_meshinfo --require closed,manifold,no-self-intersections` refuses though the status was 0. --keep stores
these files. The same seed makes the same files.
"""

import argparse
import collections
import concurrent.futures
import os
import random
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ENDINGS = {".obj", ".ply", ".stl", ".off", ".glb", ".gltf", ".xyz", ".pcd", ".vdb", ".nvdb"}
TEXTS = {".obj", ".off", ".xyz", ".gltf"}
MOST_CPU_S = 20
MOST_MEMORY = "500M"
LARGEST_FILE = 400_000
STATUSES = {0, 2, 3, 4, 5, 6, 7}
NUMBERS = ["nan", "inf", "-inf", "0", "-0", "-1", "1e300", "-1e300", "1e-300", "1e15", "4294967295", "4294967296",
           "9223372036854775807", "-9223372036854775808", "99999999999999999999", "1e", "", "0x10", "1,5", "1.#IND"]


def flip_bits(data, rng):
    for _ in range(rng.choice([1, 1, 2, 8, 64])):
        at = rng.randrange(len(data))
        data[at] ^= 1 << rng.randrange(8)


def set_words(data, rng):
    for _ in range(rng.choice([1, 1, 4])):
        at = rng.randrange(len(data))
        word = rng.choice([b"\0\0\0\0", b"\xff\xff\xff\xff", b"\0\0\x80\x7f", b"\0\0\xc0\x7f", b"\xff\xff\xff\x7f", b"\0\0\0\x80"])
        data[at:at + 4] = word[:len(data) - at]


def cut_end(data, rng):
    del data[rng.randrange(len(data)):]


def cut_piece(data, rng):
    at = rng.randrange(len(data))
    del data[at:at + rng.choice([1, 4, 16, 1000])]


def repeat_piece(data, rng):
    at, size = rng.randrange(len(data)), rng.choice([1, 4, 16, 1000, 10000])
    data[at:at] = data[at:at + size]


def put_noise(data, rng):
    data[(at := rng.randrange(len(data))):at] = rng.randbytes(rng.choice([1, 4, 100]))


def change_numbers(data, rng):
    found = list(re.finditer(rb"-?\d[\d.eE+-]*", bytes(data[:200_000])))
    for match in sorted(rng.sample(found, min(len(found), rng.choice([1, 1, 3, 20]))), key=lambda m: -m.start()):
        data[match.start():match.end()] = rng.choice(NUMBERS).encode()


def shuffle_lines(data, rng):
    lines = bytes(data).split(b"\n")
    for _ in range(rng.choice([1, 5, 50])):
        i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
        lines[i], lines[j] = lines[j], lines[i]
    data[:] = b"\n".join(lines)


CHANGES = [flip_bits, set_words, cut_end, cut_piece, repeat_piece, put_noise, change_numbers]


def mutant(path, rng):
    data = bytearray(path.read_bytes())
    changes = CHANGES + [change_numbers, change_numbers, shuffle_lines] if path.suffix.lower() in TEXTS else CHANGES
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        if data:
            rng.choice(changes)(data, rng)
    return bytes(data)


def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (3 * MOST_CPU_S, 3 * MOST_CPU_S))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run(args, number, path, folder):
    rng = random.Random(f"{args.seed} {number}")
    source = folder / f"{number}{path.suffix}"
    source.write_bytes(mutant(path, rng))
    output = folder / f"{number}.out.ply"
    options = rng.choice([[], [], [], ["--features", "off"], ["--boundary", "keep"], ["--regions", "components"], ["--outer-only"],
                          ["--adaptivity", "0.5"], ["--attributes", "none"]])
    command = [args.command, source, output, "--vertices", str(rng.choice([50, 300, 1000])), "--threads", "1",
               "--max-memory", MOST_MEMORY, *options]
    process = subprocess.Popen(command, preexec_fn=limit, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
    said = process.stderr.read().decode(errors="replace")
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    fault = fault_of(args, process.returncode, used, output, options)
    if fault:
        print(f"{path.name} {number} {' '.join(options)}: {fault}; {said.strip()[-200:]}", flush=True)
        if args.keep:
            (args.keep / source.name).write_bytes(source.read_bytes())
    for file in (source, output):
        file.unlink(missing_ok=True)
    return process.returncode, bool(fault)


def fault_of(args, status, used, output, options):
    if status not in STATUSES:
        return f"status {status}"
    if used.ru_utime + used.ru_stime > MOST_CPU_S:
        return f"{used.ru_utime + used.ru_stime:.0f} CPU s"
    if used.ru_maxrss > 900_000:
        return f"{used.ru_maxrss // 1000} MB"
    if status != 0:
        return output.exists() and status != 6 and "an output in spite of the status"
    gates = "no-self-intersections"
    if "--regions" in options:
        gates += ",regions"
    elif "keep" not in options:
        gates += ",closed,manifold"
    judged = subprocess.run([args.meshinfo, output, "--require", gates], capture_output=True, text=True)
    return judged.returncode != 0 and f"refused: {judged.stderr.strip()[-200:]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--count", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--command", default="build/cpu/vdb_isomesh")
    parser.add_argument("--meshinfo", default="build/cpu/vdb_meshinfo")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()
    if args.keep:
        args.keep.mkdir(parents=True, exist_ok=True)
    files = sorted(p for folder in args.folders for p in folder.rglob("*")
                   if p.suffix.lower() in ENDINGS and 0 < p.stat().st_size <= LARGEST_FILE)
    statuses, faults = collections.Counter(), 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        jobs = [pool.submit(run, args, n, files[n % len(files)], Path(folder)) for n in range(args.count)]
        for job in jobs:
            status, is_fault = job.result()
            statuses[status] += 1
            faults += is_fault
    print(f"{args.count} of {len(files)} files, seed {args.seed}: "
          + ", ".join(f"status {s}: {n}" for s, n in sorted(statuses.items())) + f"; {faults} faults")
    return faults > 0


if __name__ == "__main__":
    sys.exit(main())
