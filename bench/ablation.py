#!/usr/bin/env python3
"""Draws what bench_ablation measures: curves of energy, Q and I a pass as SVG, final meshes as a Markdown table.

usage: ablation.py --bench bench_ablation --out DIR [--vertices 10000] MESH...

Curves are means over the meshes; energies are divided by the last energy of the variant that has everything.
"""
import argparse
import json
import pathlib
import subprocess

from paper_curves import write_svg


def mean(values):
    values = list(values)
    return sum(values) / len(values)


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("--bench", required=True)
    p.add_argument("--out", required=True)
    p.add_argument("--vertices", type=int, default=10000)
    p.add_argument("meshes", nargs="+")
    a = p.parse_args()
    runs = [json.loads(subprocess.check_output([a.bench, mesh, "--vertices", str(a.vertices)])) for mesh in a.meshes]
    out = pathlib.Path(a.out)
    names = [pathlib.Path(mesh).stem for mesh in a.meshes]
    title = f"{', '.join(names)}: {a.vertices} vertices"

    variants = runs[0]["curves"]
    for key, label in (("q_avg", "Qavg"), ("irregular", "irregular vertices I")):
        curves = {v: [(row["passes"], mean(r["curves"][v]["after"][i][key] for r in runs))
                      for i, row in enumerate(runs[0]["curves"][v]["after"])] for v in variants}
        write_svg(out / f"ablation_{key}.svg", title + ", dual only", "passes on the finest level", label, curves)
    shortest = {v: min(len(r["curves"][v]["energy"]) for r in runs) for v in variants}
    energies = {v: [(i + 1, mean(r["curves"][v]["energy"][i] / r["curves"]["all"]["energy"][-1] for r in runs))
                    for i in range(shortest[v])] for v in variants}
    write_svg(out / "ablation_energy.svg", title, "passes on the finest level", "energy", energies)

    columns = ("q_avg", "q_min", "theta_avg", "theta_min", "irregular")
    print("| variant | mean Q | least Q | mean smallest angle | least angle | I | intersecting pairs |")
    print("| --- |" + " --- |" * 6)
    for i, row in enumerate(runs[0]["final"]):
        worst = {"q_min", "theta_min"}
        cells = [(min if c in worst else mean)(r["final"][i][c] for r in runs) for c in columns]
        hits = [r["final"][i].get("self_intersections") for r in runs]
        print(f"| {row['variant']} | " + " | ".join(f"{c:.3f}" if c < 2 else f"{c:.1f}" for c in cells) +
              f" | {'not looked for' if None in hits else sum(hits)} |")


if __name__ == "__main__":
    main()
