#!/usr/bin/env python3
"""Remeshes parts one after the other, each with a clock: a row a part, medians, and what was not as it should be.

    python3 bench/parts.py --command vdb_isomesh [--vertices 4000] [--threads 1] [--limit 60] FILE...

All figures but the seconds, which are those of the whole process, are the command's own (--stats).
"""
import argparse
import json
import statistics
import subprocess
import tempfile
import time
from pathlib import Path


def remesh(command, part, folder, options, limit):
    """The statistics and the seconds; a text where there are none."""
    out, stats = folder / f"{part.stem}.ply", folder / f"{part.stem}.json"
    start = time.monotonic()
    try:
        done = subprocess.run([command, str(part), str(out), "--force", "--quiet", "--stats", str(stats), *options],
                              capture_output=True, text=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        return f"more than {limit:g} s"
    seconds = time.monotonic() - start
    return (json.loads(stats.read_text()), seconds) if done.returncode == 0 else f"exit status {done.returncode}"


def row(part, stats, seconds):
    features, distance = stats["features"], stats["distance"]
    lost = features["lost_length"]
    kept = "all" if lost == 0 else f"{100 * (1 - lost / features['length']):.0f} %" if features["kept"] else "none"
    return (f"| {part.name} | {seconds:.2f} | {features['curves']} | {kept} | {stats['quality']['q_avg']:.3f} | "
            f"{stats['quality']['theta_min_deg']:.1f} | {stats['quality']['below_30_deg']} | "
            f"{distance['pct_of_diagonal']['hausdorff']:.3f} |")


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("--command", required=True)
    p.add_argument("--vertices", default="4000")
    p.add_argument("--threads", default="1")
    p.add_argument("--limit", type=float, default=60, help="seconds a part")
    p.add_argument("files", nargs="+", type=Path)
    a = p.parse_args()
    made, wrong = [], []
    print("| part | s | curves | kept, of their length | Q | smallest angle | angles below 30 | Hausdorff % |\n|" + " --- |" * 8)
    with tempfile.TemporaryDirectory() as folder:
        for part in a.files:
            found = remesh(a.command, part, Path(folder), ["--vertices", a.vertices, "--threads", a.threads], a.limit)
            if isinstance(found, str):
                wrong.append(f"{part.name}: {found}")
                continue
            made.append(found)
            print(row(part, *found), flush=True)
            topology = found[0]["topology"]
            if not topology["closed"] or not topology["manifold"] or topology["self_intersections"]:
                wrong.append(f"{part.name}: not closed, no manifold, or it intersects itself")
    seconds = [s for _, s in made]
    if made:
        good = sum(stats["quality"]["below_30_deg"] == 0 for stats, _ in made)
        print(f"\n{len(made)} parts: median {statistics.median(seconds):.2f} s, most {max(seconds):.2f} s; {good} with all "
              "angles from 30 degrees on")
    print("\n".join(wrong) if wrong else "all valid")


if __name__ == "__main__":
    main()
