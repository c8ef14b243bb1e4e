#!/usr/bin/env python3
"""Remeshes files by two or more builds of the command, many at a time: a row a file, and what each build has in all.

    python3 bench/compare_parts.py COMMAND,COMMAND... FILE... [--vertices 4000] [--jobs N] [--limit 150]

Seconds are CPU seconds of whole processes of one thread. Beside many others they are longer than alone, so only those
of one run compare.
"""
import argparse
import concurrent.futures
import json
import os
import subprocess
import tempfile
from pathlib import Path


def remesh(number, command, part, folder, options, limit):
    """CPU seconds, and the statistics; none where there are none."""
    out = folder / f"{number}.ply"
    stats = out.with_suffix(".json")
    process = subprocess.Popen(
        ["timeout", str(limit), command, part, out, "--threads", "1", "--quiet", "--stats", stats, *options],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)  # with what `timeout` waited for
    process.returncode = os.waitstatus_to_exitcode(status)
    return used.ru_utime + used.ru_stime, json.loads(stats.read_text()) if stats.exists() else None


def kept(stats):
    features = stats["features"]
    return features["kept_length"] / features["length"] if features["length"] else 1


def found(stats):
    """Of the length of what looks like a crease, the part that `auto` takes for one."""
    features = stats["features"]
    candidates = features["length"] + features["passed_over"]
    return features["length"] / candidates if candidates else 1


def is_lost(stats):
    return bool(stats["features"]["on_sheet"] or stats["features"]["given_up"])


def cell(seconds, stats):
    if not stats:
        return f"{seconds:.1f} s, no mesh"
    quality = stats["quality"]
    return (f"{seconds:.1f} s, {stats['counts']['vertices']}, Q {quality['q_avg']:.3f}, "
            f"{quality['theta_min_deg']:.1f}, {100 * kept(stats):.0f} %{' lost' if is_lost(stats) else ''}")


def total(made):
    seconds, stats = sorted(s for s, _ in made), [read for _, read in made if read]

    def mean(values):
        return sum(values) / max(1, len(stats))

    return (f"{sum(seconds):.1f} s, median {seconds[len(seconds) // 2]:.2f}, most {seconds[-1]:.1f}; "
            f"{len(made) - len(stats)} without a mesh; creases lost or on the sheet: {sum(map(is_lost, stats))}; "
            f"found {mean(map(found, stats)):.3f}, 95 % of it in {sum(found(s) >= .95 for s in stats)}; "
            f"kept {mean(map(kept, stats)):.3f}; all angles from 30 degrees on: "
            f"{sum(s['quality']['theta_min_deg'] >= 30 for s in stats)}; "
            f"Q {mean(s['quality']['q_avg'] for s in stats):.4f}")


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("commands", type=lambda text: text.split(","))
    p.add_argument("files", nargs="+", type=Path)
    p.add_argument("--vertices", default="4000")
    p.add_argument("--jobs", type=int, default=os.cpu_count())
    p.add_argument("--limit", type=float, default=150, help="seconds a run")
    a = p.parse_args()
    runs = [(command, part) for part in sorted(a.files) for command in a.commands]
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        made = list(pool.map(lambda n: remesh(n, *runs[n], Path(folder), ["--vertices", a.vertices], a.limit),
                             range(len(runs))))
    print("| file | " + " | ".join(a.commands) + " |\n|" + " --- |" * (1 + len(a.commands)))
    for i in range(0, len(runs), len(a.commands)):
        print(f"| {runs[i][1].name} | " + " | ".join(cell(*run) for run in made[i:i + len(a.commands)]) + " |")
    for c, command in enumerate(a.commands):
        print(f"{command}: {total(made[c::len(a.commands)])}")


if __name__ == "__main__":
    main()
