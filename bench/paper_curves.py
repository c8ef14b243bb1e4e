#!/usr/bin/env python3
"""Reproduces the paper's Table 3 rows and Fig. 5 curves with --method shell, as CSV and SVG.

usage: paper_curves.py --command vdb_isomesh --meshes DIR --out DIR [--resolution 512] [--gauge PROGRAM]

Table 3: Armadillo 4k, Pegaso 8k, Helix 4k at d = 2. Fig. 5: quality and singularity ratio against d for 1k and 4k
seeds, energy against pass. `--gauge` names an independent judge that prints "name value" lines; without it the
command's own stats are used.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import tempfile

TABLE_3 = [("armadillo.off", 4000, dict(I=.26, Qmin=.613, Qavg=.902, tmin=30.3, tavg=51.9, passes=200)),
           ("pegaso.off", 8000, dict(I=.26, Qmin=.600, Qavg=.894, tmin=31.5, tavg=51.3, passes=150)),
           ("helix.off", 4000, dict(I=.29, Qmin=.589, Qavg=.889, tmin=33.4, tavg=50.9, passes=100))]
BANDS = [1, 2, 3, 4, 6, 9]


def run(a, mesh, vertices, band, passes):
    with tempfile.TemporaryDirectory() as folder:
        out, stats = f"{folder}/out.ply", f"{folder}/stats.json"
        subprocess.run([a.command, str(pathlib.Path(a.meshes) / mesh), out, "--method", "shell", "--vertices", str(vertices),
                        "--band", str(band), "--resolution", str(a.resolution), "--iterations", str(passes),
                        "--tolerance", "0", "--stats", stats, "-q"], check=True)
        s = json.load(open(stats))
        q = s["quality"]
        row = dict(mesh=mesh, vertices=vertices, band=band, passes=len(s["energy"]), sites=s["counts"]["sites"],
                   I=q["irregular_ratio"], Qmin=q["q_min"], Qavg=q["q_avg"], theta_min=q["theta_min_deg"],
                   theta_avg=q["theta_avg_deg"], shell_s=s["timings_ms"]["shell"] / 1000,
                   pass_s=s["timings_ms"]["relax"] / 1000 / max(1, len(s["energy"])), total_s=s["timings_ms"]["total"] / 1000)
        if a.gauge:
            lines = subprocess.run([a.gauge, out], check=True, capture_output=True, text=True).stdout.splitlines()
            g = {l.split()[0]: l.split()[1] for l in lines if len(l.split()) >= 2}
            row.update(I=float(g["singularity_ratio"]), Qmin=float(g["Qmin"]), Qavg=float(g["Qavg"]),
                       theta_min=float(g["theta_min"]), theta_avg=float(g["theta_avg"]))
        return row, s["energy"]


def write_csv(path, rows):
    with open(path, "w", newline="") as f:
        w = csv.DictWriter(f, rows[0].keys())
        w.writeheader()
        w.writerows(rows)


def write_svg(path, title, x_label, y_label, curves):
    """curves: {name: [(x, y), ...]}"""
    width, height, left, bottom = 640, 400, 70, 50
    xs = [x for c in curves.values() for x, _ in c]
    ys = [y for c in curves.values() for _, y in c]
    x0, x1, y0, y1 = min(xs), max(xs), min(ys), max(ys)
    y0, y1 = y0 - .05 * (y1 - y0 or 1), y1 + .05 * (y1 - y0 or 1)
    px = lambda x: left + (x - x0) / ((x1 - x0) or 1) * (width - left - 20)
    py = lambda y: height - bottom - (y - y0) / (y1 - y0) * (height - bottom - 40)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="12">',
           '<rect width="100%" height="100%" fill="white"/>',
           f'<text x="{width / 2}" y="20" text-anchor="middle" font-size="14">{title}</text>',
           f'<text x="{width / 2}" y="{height - 10}" text-anchor="middle">{x_label}</text>',
           f'<text x="14" y="{height / 2}" text-anchor="middle" transform="rotate(-90 14 {height / 2})">{y_label}</text>']
    for i in range(6):
        x, y = x0 + (x1 - x0) * i / 5, y0 + (y1 - y0) * i / 5
        out.append(f'<line x1="{left}" y1="{py(y):.1f}" x2="{width - 20}" y2="{py(y):.1f}" stroke="#ddd"/>'
                   f'<text x="{left - 6}" y="{py(y) + 4:.1f}" text-anchor="end">{y:.4g}</text>'
                   f'<text x="{px(x):.1f}" y="{height - bottom + 18}" text-anchor="middle">{x:.4g}</text>')
    for i, (name, curve) in enumerate(curves.items()):
        colour = ["#1f5fa8", "#c2452d", "#2f8f4e", "#8a55b5"][i % 4]
        points = " ".join(f"{px(x):.1f},{py(y):.1f}" for x, y in curve)
        out.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
                   f'<text x="{width - 24}" y="{44 + 16 * i}" text-anchor="end" fill="{colour}">{name}</text>')
    pathlib.Path(path).write_text("\n".join(out) + "\n</svg>\n")


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("--command", required=True)
    p.add_argument("--meshes", required=True)
    p.add_argument("--out", required=True)
    p.add_argument("--gauge")
    p.add_argument("--resolution", type=int, default=512)
    p.add_argument("--curve-passes", type=int, default=100)
    a = p.parse_args()
    out = pathlib.Path(a.out)
    out.mkdir(parents=True, exist_ok=True)

    rows = []
    for mesh, vertices, paper in TABLE_3:
        row, _ = run(a, mesh, vertices, 2, paper["passes"])
        row.update({f"paper_{k}": v for k, v in paper.items() if k != "passes"})
        rows.append(row)
        print(row, flush=True)
    write_csv(out / "paper_table3.csv", rows)

    rows, energies = [], {}
    for vertices in (1000, 4000):
        for band in BANDS:
            row, energy = run(a, "armadillo.off", vertices, band, a.curve_passes)
            rows.append(row)
            if vertices == 4000 and band in (1, 2, 4, 9):
                energies[f"d = {band}"] = [(i, e / energy[-1]) for i, e in enumerate(energy)]
            print(row, flush=True)
    write_csv(out / "paper_fig5_quality.csv", rows)
    for name, label in (("Qavg", "Qavg"), ("I", "singularity ratio I")):
        write_svg(out / f"paper_fig5_{name}.svg", f"Armadillo, resolution {a.resolution}", "shell thickness d (voxels)", label,
                  {f"{k} seeds": [(r["band"], r[name]) for r in rows if r["vertices"] == k] for k in (1000, 4000)})
    write_csv(out / "paper_fig5_energy.csv",
              [dict(band=name, step=i, energy_over_last=e) for name, curve in energies.items() for i, e in curve])
    write_svg(out / "paper_fig5_energy.svg", "Armadillo, 4000 seeds", "pass", "energy / last energy", energies)


if __name__ == "__main__":
    main()
