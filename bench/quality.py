#!/usr/bin/env python3
"""Remeshes every mesh of a folder and lets an independent judge measure the results: a Markdown table and JSON.

usage: quality.py --command vdb_isomesh --gauge PROGRAM --meshes DIR --out FILE.json [--vertices 4000] [-- OPTIONS...]
The judge prints "name value" lines for `PROGRAM --ref INPUT OUTPUT`.
"""
import argparse
import json
import pathlib
import resource
import subprocess
import tempfile

COLUMNS = [("V", "V", "{:.0f}"), ("components", "components", "{:.0f}"), ("total_genus_of_closed_components", "genus", "{:.0f}"),
           ("closed_2manifold", "closed", "{}"), ("orientation", "side", "{}"), ("self_intersecting_pairs", "SI", "{:.0f}"),
           ("Qmin", "Qmin", "{:.3f}"), ("Qavg", "Qavg", "{:.4f}"), ("theta_min", "θmin", "{:.1f}"),
           ("theta_avg", "θavg", "{:.2f}"), ("singularity_ratio", "I", "{:.3f}"), ("edge_cv", "edge CV", "{:.3f}"),
           ("area_cv", "area CV", "{:.3f}")]


def gauge(program, *arguments):
    done = subprocess.run([program, *arguments], check=True, capture_output=True, text=True)
    values = {}
    for line in done.stdout.splitlines():
        name, _, value = line.partition(" ")
        value = value.strip().strip('"')
        try:
            values[name] = float(value)
        except ValueError:
            values[name] = value
    return values


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("--command", required=True)
    p.add_argument("--gauge", required=True)
    p.add_argument("--meshes", required=True)
    p.add_argument("--out", required=True)
    p.add_argument("--vertices", default="4000")
    p.add_argument("--keep", help="folder for the results")
    p.add_argument("options", nargs="*", help="more options of the command, after --")
    a = p.parse_args()
    rows = []
    heads = ["mesh", "input comps/genus", "res"] + [h for _, h, _ in COLUMNS] + ["mean %", "Hausdorff %", "CPU s"]
    print("| " + " | ".join(heads) + " |\n|" + " --- |" * len(heads), flush=True)
    for mesh in sorted(pathlib.Path(a.meshes).iterdir()):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(a.keep or scratch)
            folder.mkdir(parents=True, exist_ok=True)
            out, stats = folder / f"{mesh.stem}.ply", folder / f"{mesh.stem}.json"
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([a.command, str(mesh), str(out), "--force", "--vertices", a.vertices, "--stats", str(stats), "-q",
                            *a.options], check=False)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            if not out.exists():
                print(f"| {mesh.name} | failed |", flush=True)
                continue
            source, result, s = gauge(a.gauge, "--no-si", str(mesh)), gauge(a.gauge, "--ref", str(mesh), str(out)), json.load(open(stats))
            row = {"mesh": mesh.name, "input_components": source["components"],
                   "input_genus": source["total_genus_of_closed_components"], "cpu_s": cpu, "stats": s, "gauge": result}
            rows.append(row)
            cells = [mesh.name, f"{source['components']:.0f}/{source['total_genus_of_closed_components']:.0f}",
                     str(s["grid"]["resolution"])]
            cells += [f.format(result[k]) for k, _, f in COLUMNS]
            cells += [f"{result['dist_mesh_to_ref_mean_pct']:.4f}", f"{result['hausdorff_pct']:.3f}", f"{cpu:.2f}"]
            print("| " + " | ".join(cells) + " |", flush=True)
    json.dump(rows, open(a.out, "w"), indent=1)


if __name__ == "__main__":
    main()
