#!/usr/bin/env python3
"""Programs that mesh volumes of labels, side by side on one volume in one run, judged by region_judge: a Markdown table.

usage: compare_regions.py grains:128 | grains:128:320 | folds:160:80 | cubes | sheets | shell | FILE.npy | FILE.nii.gz   [--only NAME...] [--repeats 3]
                          [--vertices 50000] [--json FILE] [--most-faces 1000000]

Runs those of vtk (vtkSurfaceNets3D), serra-mesh, zmesh and isoshell that are installed. Seconds are the best of
the repeats, by the clock and of the processor, from the array of labels to the arrays of the mesh; a program that makes
a mesh per label is timed for all of them. nibabel reads .nii.gz. All programs get a frame of background of one voxel, in which walls to the
outside lie; it is taken off again.
"""
import argparse
import importlib.metadata
import importlib.util
import json
import time
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import region_volumes
from region_judge import RegionMesh, heads, judge, line
from region_topology import components


def from_pairs(vertices, triangles, pairs):
    """A mesh whose faces know both labels, in the order of a mesh's regions: a face turns with its pair."""
    pairs, triangles = pairs.astype(np.int64), triangles.astype(np.int64)
    swap = (pairs[:, 0] == 0) | ((pairs[:, 1] != 0) & (pairs[:, 0] > pairs[:, 1]))
    triangles[swap], pairs[swap] = triangles[swap][:, ::-1], pairs[swap][:, ::-1]
    return RegionMesh(vertices.astype(np.float64), triangles, pairs)


def from_labels(meshes, volume):
    """One mesh of meshes by label, whose faces know theirs alone. The label in front is that of the face of another label
    with the same three points; where there is none, that of the nearest voxel that is not the own one, half a voxel or
    more before the middle of the face; background where there is none either."""
    vertices, triangles, owner, start = [], [], [], 0
    for label, (points, faces) in meshes.items():
        vertices.append(points)
        triangles.append(faces.astype(np.int64) + start)
        owner.append(np.full(len(faces), label, np.int64))
        start += len(points)
    vertices, triangles, owner = (np.concatenate(x) for x in (vertices, triangles, owner))
    corners = vertices.astype(np.float64)[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    front, padded = twins(vertices, triangles, owner), np.pad(volume, 1)
    for reach in (0.5, 0.75, 1.0, 1.5):
        own = front == owner
        at = np.rint(corners[own].mean(axis=1) + reach * normal[own]).astype(np.int64) + 1
        front[own] = padded[tuple(np.clip(at, 0, np.array(padded.shape) - 1).T)]
    front[front == owner] = 0
    mesh = from_pairs(vertices, triangles, np.stack([owner, front], axis=1))
    mesh.owner = owner
    return mesh


def twins(vertices, triangles, owner):
    """The label of the other face with the same three points, or the own one."""
    same = np.unique(np.round(vertices, 6), axis=0, return_inverse=True)[1].reshape(-1)
    group, count = np.unique(np.sort(same[triangles], axis=1), axis=0, return_inverse=True, return_counts=True)[1:]
    group, front = group.reshape(-1), owner.copy()
    two = np.flatnonzero(count[group] == 2)
    two = two[np.argsort(group[two], kind="stable")]
    front[two] = owner[two.reshape(-1, 2)[:, ::-1].ravel()]
    return front


def run_vtk(volume, smoothing=True):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

    framed = np.pad(volume, 1)
    image = vtk.vtkImageData()
    image.SetDimensions(*framed.shape)
    image.SetOrigin(-1, -1, -1)
    image.GetPointData().SetScalars(numpy_to_vtk(framed.ravel(order="F")))
    nets = vtk.vtkSurfaceNets3D()
    nets.SetInputData(image)
    labels = np.unique(volume)
    for i, label in enumerate(labels[labels != 0].tolist()):
        nets.SetValue(i, label)
    nets.SetSmoothing(smoothing)
    nets.SetOutputMeshTypeToTriangles()
    nets.Update()
    made = nets.GetOutput()
    triangles = vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    pairs = vtk_to_numpy(made.GetCellData().GetArray("BoundaryLabels"))
    return vtk_to_numpy(made.GetPoints().GetData()), triangles, pairs


def run_vtk_fewer(volume, vertices):
    """vtkDecimatePro without splits leaves vertices of edges with more than two faces where they are, but forgets which
    labels a face parts: the mesh of before goes along, to find them again."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

    points, triangles, pairs = run_vtk(volume)
    mesh, coordinates, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    coordinates.SetData(numpy_to_vtk(points))
    cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(triangles.ravel(), np.int64), deep=True))
    mesh.SetPoints(coordinates)
    mesh.SetPolys(cells)
    fewer = vtk.vtkDecimatePro()
    fewer.SetInputData(mesh)
    fewer.PreserveTopologyOn()
    fewer.SplittingOff()
    fewer.SetTargetReduction(max(0.0, 1 - vertices / len(points)))
    fewer.Update()
    made = fewer.GetOutput()
    fewer_triangles = vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(made.GetPoints().GetData()), fewer_triangles, (points, triangles, pairs)


def with_labels_of(points, triangles, before):
    """Gives each patch of faces, that edges with two faces join, the labels that most of the nearest faces of before have."""
    old_points, old_triangles, old_pairs = before
    nearest = cKDTree(old_points[old_triangles].mean(axis=1)).query(points[triangles].mean(axis=1))[1]
    names, of = np.unique(old_pairs, axis=0, return_inverse=True)
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, edge, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    order = np.argsort(edge, kind="stable")
    joined = (order[count[edge[order]] == 2] // 3).reshape(-1, 2)
    patches, patch = components(len(triangles), *joined.T)
    votes = np.zeros((patches, len(names)), np.int32)
    np.add.at(votes, (patch, of.reshape(-1)[nearest]), 1)
    return from_pairs(points, triangles, names[np.argmax(votes, axis=1)][patch])


def run_serra(volume, reduction=0, **settings):
    import serra_mesh

    mesher = serra_mesh.Mesher(voxel_resolution=[1, 1, 1], **settings)
    mesher.mesh(volume.astype(np.uint32), close=True)
    return {label: got(mesher.get(label, reduction_factor=reduction)) for label in mesher.ids()}


def run_zmesh(volume, reduction=0):
    import zmesh

    mesher = zmesh.Mesher((1, 1, 1))
    mesher.mesh(volume.astype(np.uint32), close=True)
    return {label: got(mesher.get(label, reduction_factor=reduction), 1) for label in mesher.ids()}


def got(mesh, shift=0):  # zmesh closes regions by a frame of its own, which moves them by a voxel
    return np.asarray(mesh.vertices) - np.float32(shift), np.asarray(mesh.faces)


def run_isoshell(volume, vertices):
    import isoshell

    made = isoshell.remesh(isoshell.Labels(volume), vertices=vertices)
    return made.vertices, made.faces, made.regions["labels"]


def faces_in(meshes):
    return sum(len(faces) for _, faces in meshes.values())


def programs(volume, vertices):
    """Name, module, what prepares the call that is timed, and what normalises its result. Where walls are there twice,
    `fewer` asks for four faces a vertex: about as many vertices as asked, once those in the same place are joined."""
    both = lambda made: from_pairs(*made)  # noqa: E731
    each = lambda made: from_labels(made, volume)  # noqa: E731
    taubin = {"fairing": 20, "fairing_taubin": True}

    def fewer(run, **settings):
        factor = max(1, faces_in(run(volume, **settings)) / (4 * vertices))
        return lambda: run(volume, reduction=factor, **settings)

    return [("vtk", "vtk", lambda: lambda: run_vtk(volume), both),
            ("vtk, not smoothed", "vtk", lambda: lambda: run_vtk(volume, False), both),
            ("vtk, fewer", "vtk", lambda: lambda: run_vtk_fewer(volume, vertices), lambda made: with_labels_of(*made)),
            ("serra-mesh", "serra_mesh", lambda: lambda: run_serra(volume, **taubin), each),
            ("serra-mesh, fewer", "serra_mesh", lambda: fewer(run_serra, **taubin), each),
            ("zmesh", "zmesh", lambda: lambda: run_zmesh(volume), each),
            ("zmesh, fewer", "zmesh", lambda: fewer(run_zmesh), each),
            ("isoshell", "isoshell", lambda: lambda: run_isoshell(volume, vertices), both)]


def is_there(module):
    if importlib.util.find_spec(module) is None:
        return False
    return module != "isoshell" or hasattr(__import__("isoshell"), "Labels")


def timed(call, repeats):
    """The least seconds by the clock and of the processor, all threads together, and what the last call made."""
    best, made = [np.inf, np.inf], None
    for _ in range(repeats):
        start = time.perf_counter(), time.process_time()
        made = call()
        best = np.minimum(best, [time.perf_counter() - start[0], time.process_time() - start[1]])
    return *best.tolist(), made


def read_volume(name):
    """The volume of that name, and the planes between its grains, if it has any."""
    if name.startswith("grains:"):
        return region_volumes.grains(*map(int, name.split(":")[1:]))
    if name.startswith("folds:"):
        return region_volumes.folds(*map(int, name.split(":")[1:])), None
    if name.endswith((".nii", ".nii.gz")):
        import nibabel
        data = np.asarray(nibabel.load(name).dataobj)
        return np.ascontiguousarray(np.rint(data).astype(np.int32)), None
    if name.endswith(".npy"):
        return np.load(name).astype(np.int32), None
    made = {"cubes": region_volumes.touching_cubes, "sheets": region_volumes.sheets_in_t,
            "shell": region_volumes.ball_in_shell}
    return made[name](), None


def version(module):
    names = importlib.metadata.packages_distributions().get(module, [module])
    try:
        return importlib.metadata.version(names[0])
    except importlib.metadata.PackageNotFoundError:
        return "?"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("volume")
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--vertices", type=int, default=50_000)
    parser.add_argument("--most-faces", type=int, default=1_000_000, help="of more, crossings are not searched for")
    parser.add_argument("--json")
    given = parser.parse_args()
    volume, planes = read_volume(given.volume)
    print(f"{Path(given.volume).name}: {' x '.join(map(str, volume.shape))} voxels, {len(np.unique(volume[volume != 0]))} labels\n")
    print(heads("program", "seconds", "CPU s"), flush=True)
    rows, missing = {}, []
    for name, module, prepare, normal in programs(volume, given.vertices):
        if given.only and name not in given.only:
            continue
        if not is_there(module):
            missing.append(name)
            continue
        seconds, processor, made = timed(prepare(), given.repeats)
        found = judge(normal(made), volume, planes=planes, most_faces=given.most_faces)
        rows[name] = {"seconds": seconds, "cpu_seconds": processor, "version": version(module), **found}
        print(line(found, f"{name} {version(module)}", f"{seconds:.2f}", f"{processor:.2f}"), flush=True)
    if missing:
        print(f"\nNot there: {', '.join(missing)}.")
    if given.json:
        Path(given.json).write_text(json.dumps(rows, indent=1, default=lambda value: value.item()))


if __name__ == "__main__":
    main()
