#!/usr/bin/env python3
"""Judges a mesh of regions, with numpy and scipy alone and no code of the library: is every region closed, is each wall
there once, do neighbours and voxels stay what they were, how good are the triangles, do any cross.

    from region_judge import RegionMesh, judge, line
    found = judge(RegionMesh(vertices, triangles, regions), volume, origin, spacing)

usage: region_judge.py MESH.npz [VOLUME.npy] [--origin X Y Z] [--spacing X Y Z] [--background N] [--grains COUNT]
MESH.npz holds `vertices`, `triangles` and `regions`. The volume has axes (i, j, k); the centre of voxel (i, j, k) is at
origin + (i, j, k) * spacing. Prints every figure as JSON and then the main ones as a row of a table.
"""
import argparse
import json

import numpy as np
from scipy import ndimage

import region_geometry as geometry
import region_topology as topology
from region_topology import RegionMesh

MOST_CENTRES = 20_000
MOST_FACES_CROSSED = 1_000_000  # of more, crossings are not searched for

COLUMNS = [("vertices", "vertices", "{:d}"), ("welded_vertices", "joined", "{:d}"), ("closed_regions", "closed regions", "{}"),
           ("manifold_regions", "manifold regions", "{}"), ("shared_wall_pct", "walls shared %", "{:.1f}"),
           ("matching_wall_pct", "walls that match %", "{:.1f}"), ("lost_added_pairs", "pairs lost, added", "{}"),
           ("same_topology_regions", "topology of voxels", "{}"), ("volume_error_pct", "volume error %", "{:.2f}"),
           ("kept_voxels_pct", "voxels kept %", "{:.2f}"), ("q", "Q", "{:.3f}"), ("least_angle", "least angle", "{:.1f}"),
           ("below_30_pct", "below 30 %", "{:.2f}"), ("below_25_pct", "below 25 %", "{:.2f}"),
           ("crossings", "crossings", "{:d}"), ("plane_rms_vox", "rms to planes", "{:.3f}"),
           ("normal_deg", "normals, degrees", "{:.2f}"), ("line_rms_vox", "rms to lines", "{:.3f}")]


def in_voxels(mesh, origin, spacing):
    vertices = (np.asarray(mesh.vertices, np.float64) - origin) / spacing
    regions = np.asarray(mesh.regions, np.int64).reshape(-1, 2)
    return RegionMesh(vertices, np.asarray(mesh.triangles, np.int64).reshape(-1, 3), regions, mesh.owner, mesh.background)


def judge_arrays(mesh):
    """Whether the arrays are what they are said to be: counts of faults, all 0 in a sound mesh."""
    a, b = mesh.regions.T
    corners = mesh.triangles
    order = (a == mesh.background) | ((b != mesh.background) & (a >= b))
    return {"vertices": len(mesh.vertices), "faces": len(corners), "not_finite": int((~np.isfinite(mesh.vertices)).sum()),
            "bad_order": int(order.sum()),
            "degenerate": int((np.sort(corners, axis=1)[:, 1:] == np.sort(corners, axis=1)[:, :-1]).any(axis=1).sum()),
            "unused_vertices": len(mesh.vertices) - len(np.unique(corners))}


def judge_boundaries(boundaries):
    """Of every region: closed, oriented, manifold once fans are parted, not inside out."""
    count = len(boundaries.labels)
    open_edges = np.bincount(boundaries.edge_label[boundaries.balance != 0], minlength=count)
    many_edges = np.bincount(boundaries.edge_label[boundaries.counts != 2], minlength=count)
    four = np.flatnonzero(boundaries.counts == 4)
    half = boundaries.order[boundaries.first[four[:100]]]
    ends = np.stack([boundaries.corners[half // 3, half % 3], boundaries.corners[half // 3, (half % 3 + 1) % 3]], axis=1)
    shells, euler, fans = boundaries.shells()
    return {"regions": count, "closed_regions": f"{int((open_edges == 0).sum())} of {count}",
            "manifold_regions": f"{int((many_edges == 0).sum())} of {count}",
            "inside_out": boundaries.labels[boundaries.volumes() <= 0].tolist()[:100],
            "not_closed": boundaries.labels[open_edges > 0].tolist()[:100],
            "edges_out_of_balance": int(open_edges.sum()), "edges_with_4": len(four),
            "edges_with_others": int(((boundaries.counts != 2) & (boundaries.counts != 4)).sum()),
            "edges_with_4_listed": np.sort(ends, axis=1).tolist(), "further_fans": fans,
            "shells": dict(zip(boundaries.labels.tolist(), shells.tolist())),
            "euler": dict(zip(boundaries.labels.tolist(), euler.tolist()))}


def judge_against_voxels(mesh, boundaries, found, volume):
    """Volumes, surfaces, neighbours and voxels of each region against those of the volume; mesh in voxels."""
    voxels = topology.voxel_regions(volume, mesh.background)
    measured = dict(zip(boundaries.labels.tolist(), boundaries.volumes()))
    errors = {label: measured.get(label, 0) - count for label, (count, _, _) in voxels.items()}
    total = sum(count for count, _, _ in voxels.values())
    relative = [100 * abs(errors[label]) / count for label, (count, _, _) in voxels.items()]
    same = sum(found["shells"].get(label) == shells and found["euler"].get(label) == euler
               for label, (_, shells, euler) in voxels.items())
    wanted = topology.pairs_of_voxels(volume, mesh.background)
    there = topology.distinct_pairs(mesh.regions, mesh.background)
    lost, added = sorted(wanted - there), sorted(there - wanted)
    return {"regions_of_voxels": len(voxels), "lost_regions": sorted(set(voxels) - set(measured))[:100],
            "volume_error_pct": 100 * sum(map(abs, errors.values())) / total, "worst_volume_error_pct": max(relative),
            "same_topology_regions": f"{same} of {len(voxels)}", "shells_of_voxels": {k: v[1] for k, v in voxels.items()},
            "pairs": len(wanted), "lost_added_pairs": f"{len(lost)}, {len(added)}", "lost_pairs": lost[:100],
            "added_pairs": added[:100], **kept_voxels(mesh, volume)}


def kept_voxels(mesh, volume, most=MOST_CENTRES):
    """Of the centres of voxels that are not background or beside such, up to so many by chance: the share whose label is
    that of the region around them."""
    beside = ndimage.binary_dilation(np.pad(volume != mesh.background, 1), np.ones((3, 3, 3)))
    centres = np.argwhere(beside) - 1
    if len(centres) > most:
        centres = centres[np.random.default_rng(1).choice(len(centres), most, replace=False)]
    labels = np.pad(volume, 1, constant_values=mesh.background)[tuple(centres.T + 1)]
    found = geometry.labels_at(mesh, centres.astype(np.float64))
    return {"centres": len(centres), "kept_voxels_pct": 100 * (found == labels).mean(),
            "torn_centres": int((found == -1).sum())}


def judge(mesh, volume=None, origin=(0, 0, 0), spacing=(1, 1, 1), planes=None, most_faces=MOST_FACES_CROSSED):
    """All figures of a mesh, by name. Shapes are judged in the units of the mesh, all else in voxels."""
    if len(mesh.triangles) == 0:
        raise ValueError("a mesh without faces cannot be judged")
    found = geometry.shape(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.triangles))
    mesh = in_voxels(mesh, np.asarray(origin, np.float64), np.asarray(spacing, np.float64))
    found |= judge_arrays(mesh)
    boundaries = topology.Boundaries(mesh)
    found |= judge_boundaries(boundaries)
    welded = topology.weld(mesh)
    count, shared, matching = topology.walls(welded)
    found |= {"welded_vertices": len(welded.vertices), "wall_faces": count,
              "shared_wall_pct": 100 * shared / max(count, 1), "matching_wall_pct": 100 * matching / max(count, 1)}
    if volume is not None:
        found |= judge_against_voxels(mesh, boundaries, found, np.asarray(volume))
    del boundaries
    if len(mesh.triangles) <= most_faces:
        found["crossings"], found["overlaps"] = geometry.self_intersections(welded)
    if planes is not None:
        found |= geometry.against_planes(welded, planes)
    return found


def heads(*before):
    names = [*before, *(head for _, head, _ in COLUMNS)]
    return "| " + " | ".join(names) + " |\n|" + " --- |" * len(names)


def line(found, *before):
    """The main figures as a row of a table; a dash where there is none."""
    cells = [form.format(found[name]) if found.get(name) is not None else "–" for name, _, form in COLUMNS]
    return "| " + " | ".join([*map(str, before), *cells]) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("mesh")
    parser.add_argument("volume", nargs="?")
    parser.add_argument("--origin", nargs=3, type=float, default=(0, 0, 0))
    parser.add_argument("--spacing", nargs=3, type=float, default=(1, 1, 1))
    parser.add_argument("--background", type=int, default=0)
    parser.add_argument("--grains", type=int, help="the volume is that of so many grains of region_volumes.py")
    given = parser.parse_args()
    arrays = np.load(given.mesh)
    mesh = RegionMesh(arrays["vertices"], arrays["triangles"], arrays["regions"], background=given.background)
    volume = np.load(given.volume) if given.volume else None
    planes = None
    if given.grains:
        from region_volumes import grain_planes, grain_seeds
        planes = grain_planes(grain_seeds(volume.shape[0], given.grains))
    found = judge(mesh, volume, given.origin, given.spacing, planes)
    print(json.dumps(found, indent=1, default=lambda value: value.item()))
    print(heads() + "\n" + line(found))


if __name__ == "__main__":
    main()
