#!/usr/bin/env python3
"""The bars of regions: count, shape, volumes, angles between walls, and whether TetGen and Gmsh fill them.

    python3 bench/regions/bars.py [--only WORD] [--vertices N ...] [LABELS.npz|LABELS.nii.gz|LABELS.vdb|ASSEMBLY[:REGIONS] ...]

Prints a row for every volume of field_volumes.py, every pin in a plate of fillable.py and every file, at 6000 and 20,000
vertices. A file of labels is an array `labels` (with `affine` where it has one), an image or a volume; of an assembly the parts are
its components, or what REGIONS says. CPU seconds are of one thread. "Filled" is per cent of the regions' volumes in tetrahedra. Large
regions have more than 30 voxels, or a millionth of all where there are none; "named" says that a warning tells of it.
"""
import argparse
import pathlib
import time
import warnings

import isoshell
import numpy as np
from field_volumes import VOLUMES
from fillable import LARGE_VOXELS, pin_in_plate

GAPS = (0, 5e-6, 2e-5, 1e-4, 1e-3)
HEADS = ("input", "asked", "made", "CPU s", "least angle", "Q", "below 30 degrees", "closed", "large regions off by more than 2 %",
         "between walls", "TetGen %", "Gmsh %", "missed")


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def of_labels(labels, affine=None, spacing=(1, 1, 1)):
    affine = np.diag([*spacing, 1]) if affine is None else affine
    return isoshell.Labels(labels, affine=affine), {}, abs(np.linalg.det(affine[:3, :3]))


def read(given):
    """Of a file the source, options, and the volume of a voxel, or None."""
    path, _, regions = given.partition(":")
    if path.endswith(".npz"):
        arrays = np.load(path)
        return of_labels(arrays["labels"], arrays.get("affine"))
    if path.endswith((".nii", ".nii.gz")):
        import nibabel
        image = nibabel.load(path)
        return of_labels(np.asanyarray(image.dataobj).astype(np.int32), image.affine)
    return path, {} if path.endswith(".vdb") else {"regions": regions or "components"}, None


def sources(paths):
    for name, make in VOLUMES.items():
        labels, spacing = make()
        yield name, of_labels(labels, spacing=spacing)
    for gap in GAPS:
        yield f"pin in plate, gap {gap:g}", (pin_in_plate(gap), {"regions": "part"}, None)
    for path in paths:
        yield pathlib.Path(path).name, read(path)


def filled_pct(made, mesher):
    """How much of each region's volume is tetrahedra, the least of all, or the first words of why there are none."""
    volumes = {region["label"]: region["volume"] for region in made.report["regions"]["regions"]}
    try:
        filled = made.fill(mesher)
    except isoshell.Error as error:
        return 0, f"refused: {str(error)[:90]}"
    least = min(100 * filled.volume(label) / volume for label, volume in volumes.items() if volume > 0)
    return least, f"{least:.2f}"


def shifted(made, voxel_world):
    """The large regions whose volume changes by more than 2 per cent, and whether a warning tells of it."""
    regions = made.report["regions"]["regions"]
    large = LARGE_VOXELS * voxel_world if voxel_world else 1e-6 * sum(region["volume"] for region in regions)
    changes = [100 * abs(r["volume"] / r["volume_before"] - 1) for r in regions if r["volume_before"] > large]
    off = [change for change in changes if change > 2]
    is_told = not off or any("volume" in text for text in made.report["warnings"])
    return f"{len(off)}, up to {max(off):.0f} %" if off else f"none ({max(changes, default=0):.2f} %)", is_told


def judged(made, asked, seconds, voxel_world):
    quality, topology = made.report["quality"], made.report["regions"]
    told = " ".join(made.report["warnings"])
    closed = [region["closed"] for region in topology["regions"]]
    off, is_told = shifted(made, voxel_world)
    fills = [filled_pct(made, mesher) for mesher in ("tetgen", "gmsh")]
    missed = [name for name, is_missed in {
        "count": len(made.vertices) != asked and "vertices" not in told, "seconds": asked == 20_000 and seconds > 20,
        "closed": not all(closed), "volumes": not is_told,
        "walls": quality["dihedral_min_deg"] < 5 and "meet at" not in told,
        "TetGen": fills[0][0] < 99.9, "Gmsh": fills[1][0] < 99.9}.items() if is_missed]
    row_of = (asked, len(made.vertices), f"{seconds:.1f}", f"{quality['theta_min_deg']:.1f}", f"{quality['q_avg']:.3f}",
              quality["below_30_deg"], f"{sum(closed)} of {len(closed)}", off, f"{quality['dihedral_min_deg']:.1f}",
              fills[0][1], fills[1][1], ", ".join(missed) or "-")
    return row_of


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("files", nargs="*")
    parser.add_argument("--only", default="", help="inputs whose names have this word")
    parser.add_argument("--vertices", type=int, nargs="+", default=[6000, 20_000])
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    row(*HEADS)
    row(*["---"] * len(HEADS))
    for name, (source, options, voxel_world) in sources(given.files):
        if given.only not in name:
            continue
        for vertices in given.vertices:
            start = time.process_time()
            try:
                made = isoshell.remesh(source, vertices=vertices, threads=1, **options)
            except isoshell.Error as error:
                row(name, vertices, f"refused: {error}", *[""] * (len(HEADS) - 3))
                continue
            row(name, *judged(made, vertices, time.process_time() - start, voxel_world))


if __name__ == "__main__":
    main()
