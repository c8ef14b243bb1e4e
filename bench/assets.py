#!/usr/bin/env python3
"""What a result keeps of its input's sharp edges and borders, measured from the two files alone.

    bench/assets.py INPUT RESULT [--degrees 25] [--texels 1024] [--json]

Needs numpy, scipy and trimesh. Nothing of the library is used. Lengths are given in the result's mean edge length e.

- creases: the input's edges whose faces turn by at least --degrees, sampled every e / 10; for each sample the distance
  to the nearest edge of the result whose faces turn by at least half as much. `kept` is the part of the samples within
  .1 e.
- borders: loops of both, their length, that of the input's once it is resampled at every e of its arclength, and the
  distance of the result's border vertices from the input's border, also in percent of the input's diagonal.
- texels, where both files (PLY or OBJ) have texture coordinates: at points inside of every face of the result, the
  distance between its texture coordinates and the input's at the nearest point, in texels of an image of so many a side.
  A face straddles a seam when that is more than a tenth of the image at one of its points, or when the nearest points
  lie in different charts: sets of input faces across whose edges texture coordinates do not jump. Points within .2 e of
  an input edge where they jump do not count for that (`beside_pct` of all), since edges cut the corners of seams. And
  the part of the faces' points where a checkerboard of 8 fields a side has the wrong colour.
- color: the largest difference of the result's vertices from what the input's colour, if that is linear in position,
  is at their nearest points.
- names: the same points' materials, or other names of faces.
- sides: corners of the result whose normal is more than 60 degrees off the input's under their face's middle, of all and
  of those at vertices of several normals; and in how many of these a search from the corner itself would be.
"""
import argparse
import json

import numpy as np
import trimesh
from scipy import sparse
from scipy.sparse import csgraph  # noqa: F401
from scipy.spatial import cKDTree

KEPT = 0.1  # of an edge length
BESIDE = 0.2  # likewise


def face_files(path):
    """Positions, triangles, and what corners and faces have: (V, 3), (F, 3), {name: (F, 3, k) or (F,)}; colours are of vertices, (V, 3)."""
    return read_obj(path) if path.lower().endswith(".obj") else read_ply(path)


def read_obj(path):
    v, vt, vn, faces, uv, normal, names, now = [], [], [], [], [], [], [], ""
    with open(path) as lines:
        for line in lines:
            words = line.split()
            if not words:
                continue
            if words[0] == "v":
                v.append([float(x) for x in words[1:4]])
            elif words[0] == "vt":
                vt.append([float(x) for x in words[1:3]])
            elif words[0] == "vn":
                vn.append([float(x) for x in words[1:4]])
            elif words[0] == "usemtl":
                now = " ".join(words[1:])
            elif words[0] == "f":
                corners = [[int(i) if i else 0 for i in (w + "//").split("/")[:3]] for w in words[1:]]
                for i in range(1, len(corners) - 1):
                    three = [corners[0], corners[i], corners[i + 1]]
                    faces.append([c[0] - 1 for c in three])
                    uv.append([c[1] - 1 for c in three])
                    normal.append([c[2] - 1 for c in three])
                    names.append(now)
    found = {}
    if vt and np.min(uv) >= 0:
        found["uv"] = np.array(vt)[np.array(uv)]
    if vn and np.min(normal) >= 0:
        found["normal"] = np.array(vn)[np.array(normal)]
    if any(names):
        found["names"] = np.array(names)
    return np.array(v), np.array(faces), found


def read_ply(path):
    types = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
             "double": "f8", "int8": "i1", "uint8": "u1", "int32": "i4", "uint32": "u4", "float32": "f4"}
    elements, labels = [], {}
    with open(path, "rb") as file:
        while True:
            words = file.readline().decode("latin-1").split()
            if words[:1] == ["format"]:
                text = words[1] == "ascii"
            elif words[:2] == ["comment", "label"]:
                labels.setdefault(words[2], []).append(" ".join(words[4:]))
            elif words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:1] == ["property"]:
                elements[-1][2].append((words[-1], [types[t] for t in words[1:-1] if t in types]))
            elif words[:1] == ["end_header"]:
                break
        data = file.read()
    at, tokens = 0, data.split() if text else None

    def take(kind, count=1):
        nonlocal at
        if text:
            got = [float(t) for t in tokens[at:at + count]]
            at += count
            return got
        got = np.frombuffer(data, "<" + kind, count, at)
        at += got.nbytes
        return got

    rows = {}
    for name, count, properties in elements:
        kept = {p: [] for p, _ in properties}
        for _ in range(count):
            for p, kind in properties:
                kept[p].append(take(kind[-1], int(take(kind[0])[0])) if len(kind) == 2 else take(kind[0])[0])
        rows[name] = kept
    vertex, face = rows["vertex"], rows["face"]
    v = np.column_stack([vertex[a] for a in "xyz"]).astype(float)
    lists = face.get("vertex_indices", face.get("vertex_index"))
    which = [(i, k) for i, l in enumerate(lists) for k in range(1, len(l) - 1)]
    faces = np.array([[lists[i][0], lists[i][k], lists[i][k + 1]] for i, k in which], dtype=int)
    found = {}

    def corners(name, size):
        full = [np.reshape(face[name][i], (-1, size))[[0, k, k + 1]] for i, k in which]
        return np.array(full, dtype=float)

    if "texcoord" in face:
        found["uv"] = corners("texcoord", 2)
    elif "s" in vertex:
        found["uv"] = np.column_stack([vertex["s"], vertex["t"]])[faces]
    if "red" in vertex:
        found["color"] = np.column_stack([vertex["red"], vertex["green"], vertex["blue"]]).astype(float)
    if "normals" in face:
        found["normal"] = corners("normals", 3)
    elif "nx" in vertex:
        found["normal"] = np.column_stack([vertex["nx"], vertex["ny"], vertex["nz"]])[faces]
    for name in ("material", "texnumber"):
        if name in face and "names" not in found:
            numbers = np.array(face[name], dtype=int)[[i for i, _ in which]]
            found["names"] = np.array(labels[name])[numbers] if name in labels else numbers.astype(str)
    return v, faces, found


def charts_of(v, faces, uv):
    """Per face the number of its chart; and the edges where texture coordinates jump, as pairs of points."""
    _, first_at, welded = np.unique(v, axis=0, return_index=True, return_inverse=True)
    at, uses = {}, {}
    pairs = []
    for f, t in enumerate(welded.reshape(-1)[faces]):
        for i in range(3):
            a, b = (t[i], uv[f, i]), (t[(i + 1) % 3], uv[f, (i + 1) % 3])
            (a, ua), (b, ub) = (a, b) if a[0] < b[0] else (b, a)
            uses.setdefault((a, b), set()).add((tuple(ua), tuple(ub)))
            other = at.setdefault((a, b, tuple(ua), tuple(ub)), f)
            if other != f:
                pairs.append((other, f))
    jumps = [v[first_at[[a, b]]] for a, b in {k[:2] for k in at} if len(uses[a, b]) > 1]
    graph = sparse.coo_matrix((np.ones(len(pairs)), np.array(pairs).reshape(-1, 2).T), shape=(len(faces),) * 2)
    return sparse.csgraph.connected_components(graph, directed=False)[1], np.reshape(jumps, (-1, 2, 3))


def nearest_on(v, faces, points, normals, step):
    """Per point the nearest face that looks its way, and the point's barycentric coordinates there: exact among the
    faces whose samples are nearest."""
    corners = v[faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.clip(np.ceil(longest / step), 1, 64).astype(int)
    samples, owner = [], []
    for n in np.unique(parts):
        which = np.flatnonzero(parts == n)
        grid = np.array([(i, j) for i in range(n + 1) for j in range(n + 1 - i)]) / n
        weight = np.column_stack([1 - grid.sum(axis=1), grid])
        samples.append(np.einsum("wk,fkd->fwd", weight, corners[which]).reshape(-1, 3))
        owner.append(np.repeat(which, len(weight)))
    samples, owner = np.vstack(samples), np.concatenate(owner)
    face_normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    _, near = cKDTree(samples).query(points, k=min(48, len(samples)))
    best = np.full(len(points), np.inf)
    found, weights = np.zeros(len(points), dtype=int), np.zeros((len(points), 3))
    for column in np.atleast_2d(near.T):
        f = owner[column]
        foot = trimesh.triangles.closest_point(corners[f], points)
        d = np.linalg.norm(foot - points, axis=1)
        d[np.einsum("ij,ij->i", face_normal[f], normals) < 0] += 10 * step
        better = d < best
        best[better], found[better] = d[better], f[better]
        weights[better] = trimesh.triangles.points_to_barycentric(corners[f[better]], foot[better])
    return found, weights


# Points inside of a triangle: its middle, near its corners, near the middles of its edges.
INSIDE = np.array([[1, 1, 1], [10, 1, 1], [1, 10, 1], [1, 1, 10], [6, 6, 1], [1, 6, 6], [6, 1, 6]], dtype=float)
INSIDE /= INSIDE.sum(axis=1, keepdims=True)


def corners_and_faces(before, after, texels):
    """What corners and faces of the result have, against the input's at the nearest points."""
    (v, faces, had), (w, out, has) = before, after
    normals = np.cross(w[out[:, 1]] - w[out[:, 0]], w[out[:, 2]] - w[out[:, 0]])
    step = np.linalg.norm(w[out[:, 1]] - w[out[:, 0]], axis=1).mean() / 4
    points = np.einsum("pk,fkd->fpd", INSIDE, w[out])
    face, weight = nearest_on(v, faces, points.reshape(-1, 3), np.repeat(normals, len(INSIDE), axis=0), step)
    shape = (len(out), len(INSIDE))
    found = {}
    if "uv" in had and "uv" in has:
        expected = np.einsum("pk,pkd->pd", weight, had["uv"][face]).reshape(shape + (2,))
        got = np.einsum("pk,fkd->fpd", INSIDE, has["uv"])
        off = np.linalg.norm(got - expected, axis=2)
        chart_of_face, seams = charts_of(v, faces, had["uv"])
        chart = chart_of_face[face].reshape(shape)
        counts = (distances(points.reshape(-1, 3), seams, step / 2) > BESIDE * 4 * step).reshape(shape)
        straddles = ((off > .1) & counts).any(axis=1) | ((chart != chart[:, :1]) & counts & counts[:, :1]).any(axis=1)
        fields = [np.floor(8 * x).astype(int).sum(axis=2) % 2 for x in (got, expected)]
        found["texels"] = {"charts": int(chart.max()) + 1, "mean": float(off.mean() * texels),
                           "p99": float(np.percentile(off, 99) * texels), "max": float(off.max() * texels),
                           "straddling": int(straddles.sum()), "beside_pct": float(100 * np.mean(~counts)),
                           "checkers_wrong_pct": float(100 * np.mean(fields[0] != fields[1]))}
    if "color" in had and "color" in has:
        fit = np.linalg.lstsq(np.column_stack([v, np.ones(len(v))]), had["color"], rcond=None)[0]
        at = np.bincount(out.reshape(-1), minlength=len(w))
        vertex_normal = np.zeros_like(w)
        np.add.at(vertex_normal, out.reshape(-1), np.repeat(normals, 3, axis=0))
        face_at, weight_at = nearest_on(v, faces, w, vertex_normal, step)
        foot = np.einsum("vk,vkd->vd", weight_at, v[faces[face_at]])
        off = np.abs(has["color"] - (np.column_stack([foot, np.ones(len(w))]) @ fit))[at > 0].max(axis=1)
        found["color"] = {"mean_255": float(255 * off.mean()), "max_255": float(255 * off.max())}
    if "names" in had and "names" in has:
        same = had["names"][face].reshape(shape) == has["names"][:, None]
        found["names"] = {"wrong_points_pct": float(100 * np.mean(~same)), "mixed_faces": int((~same).any(axis=1).sum())}
    if "normal" in had and "normal" in has:
        inside = np.einsum("pk,pkd->pd", weight, had["normal"][face]).reshape(shape + (3,))[:, :1]
        corner_face, corner_weight = nearest_on(v, faces, w, np.zeros_like(w), step)
        naive = np.einsum("vk,vkd->vd", corner_weight, had["normal"][corner_face])[out]

        def wrong(normal):
            size = np.linalg.norm(inside, axis=2) * np.linalg.norm(normal, axis=2)
            return np.einsum("fkd,fkd->fk", normal, np.broadcast_to(inside, normal.shape)) < .5 * size

        pairs = np.unique(np.column_stack([out.reshape(-1), has["normal"].reshape(-1, 3)]), axis=0)[:, 0].astype(int)
        several = (np.bincount(pairs, minlength=len(w)) > 1)[out]
        found["sides"] = {"corners": int(several.size), "wrong": int(wrong(has["normal"]).sum()),
                          "several": int(several.sum()), "wrong_of_several": int((wrong(has["normal"]) & several).sum()),
                          "naive_of_several": int((wrong(naive) & several).sum())}
    return found


def load(path):
    if path.lower().endswith((".ply", ".obj")):
        v, faces, _ = face_files(path)
        mesh = trimesh.Trimesh(v, faces, process=False)
    else:
        mesh = trimesh.load(path, process=False, force="mesh")
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=None)
    return mesh


def sharp_edges(mesh, degrees):
    """Pairs of points: the ends of the edges of two faces that turn by at least so many degrees."""
    sharp = mesh.face_adjacency_angles >= np.radians(degrees)
    return mesh.vertices[mesh.face_adjacency_edges[sharp]]


def border_edges(mesh):
    edges = np.sort(mesh.edges, axis=1)
    found, count = np.unique(edges, axis=0, return_counts=True)
    return found[count == 1]


def loops_of(edges):
    """Connected components of border edges."""
    if len(edges) == 0:
        return 0
    return len(list(trimesh.graph.connected_components(edges)))


def chains_of(edges):
    """Border edges in a row, as lists of vertices: from one vertex with other than two of them to another, or rings."""
    around = {}
    for a, b in edges:
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    taken, chains = set(), []
    for start in sorted(around, key=lambda v: (len(around[v]) == 2, v)):  # ends first, so that only rings are left
        for second in around[start]:
            chain, a, b = [start], start, second
            while (min(a, b), max(a, b)) not in taken:
                taken.add((min(a, b), max(a, b)))
                chain.append(b)
                if len(around[b]) != 2:
                    break
                a, b = b, around[b][0] if around[b][0] != a else around[b][1]
            if len(chain) > 1:
                chains.append(chain)
    return chains


def resampled_length(points, edges, step):
    """Of border edges with a vertex at every step of arclength only, at least three in a ring."""
    total = 0.0
    for chain in chains_of(edges.tolist()):
        line = points[chain]
        at = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        parts = max(3 if chain[0] == chain[-1] else 1, round(at[-1] / step))
        places = np.linspace(0, at[-1], parts + 1)
        few = np.stack([np.interp(places, at, line[:, k]) for k in range(3)], axis=1)
        total += np.linalg.norm(np.diff(few, axis=0), axis=1).sum()
    return float(total)


def samples_along(segments, step):
    """Points along segments, no farther apart than a step, ends included."""
    if len(segments) == 0:
        return np.zeros((0, 3))
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    count = np.maximum(1, np.ceil(length / step).astype(int))
    which = np.repeat(np.arange(len(segments)), count + 1)
    start = np.concatenate([[0], np.cumsum(count + 1)[:-1]])
    along = (np.arange(len(which)) - start[which]) / count[which]
    return segments[which, 0] + (segments[which, 1] - segments[which, 0]) * along[:, None]


def distances(points, segments, step):
    """Of points to the nearest of the segments: exact among those whose samples are nearest."""
    if len(points) == 0:
        return np.zeros(0)
    if len(segments) == 0:
        return np.full(len(points), np.inf)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    count = np.maximum(1, np.ceil(length / step).astype(int))
    which = np.repeat(np.arange(len(segments)), count + 1)
    tree = cKDTree(samples_along(segments, step))
    _, near = tree.query(points, k=min(8, len(which)))
    best = np.full(len(points), np.inf)
    for column in np.atleast_2d(near.T):
        a, b = segments[which[column], 0], segments[which[column], 1]
        ab = b - a
        t = np.einsum("ij,ij->i", points - a, ab) / np.maximum(np.einsum("ij,ij->i", ab, ab), 1e-300)
        foot = a + ab * np.clip(t, 0, 1)[:, None]
        best = np.minimum(best, np.linalg.norm(points - foot, axis=1))
    return best


def summary(d, e):
    if len(d) == 0:
        return None
    return {"samples": len(d), "kept": float(np.mean(d <= KEPT * e)), "mean_e": float(d.mean() / e),
            "max_e": float(d.max() / e)}


def measure(before, after, degrees):
    e = float(after.edges_unique_length.mean())
    step = e / 10
    creases, kept = sharp_edges(before, degrees), sharp_edges(after, degrees / 2)
    rim_before, rim_after = border_edges(before), border_edges(after)
    segments_before, segments_after = before.vertices[rim_before], after.vertices[rim_after]
    off_border = distances(after.vertices[np.unique(rim_after)] if len(rim_after) else np.zeros((0, 3)),
                           segments_before, step)
    return {
        "e": e,
        "creases": summary(distances(samples_along(creases, step), kept, step), e),
        "false_creases": summary(distances(samples_along(sharp_edges(after, degrees), step),
                                           sharp_edges(before, degrees / 2), step), e),
        "border_loops": [loops_of(rim_before), loops_of(rim_after)],
        "border_length": [float(np.linalg.norm(s[:, 1] - s[:, 0], axis=1).sum()) if len(s) else 0.0
                          for s in (segments_before, segments_after)],
        "border_length_resampled": resampled_length(before.vertices, rim_before, e),
        "border": summary(off_border, e),
        "border_max_pct": float(100 * off_border.max() / before.scale) if len(off_border) else None,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("input")
    parser.add_argument("result")
    parser.add_argument("--degrees", type=float, default=25)
    parser.add_argument("--texels", type=int, default=1024)
    parser.add_argument("--json", action="store_true")
    a = parser.parse_args()
    found = measure(load(a.input), load(a.result), a.degrees)
    if all(path.lower().endswith((".ply", ".obj")) for path in (a.input, a.result)):
        found.update(corners_and_faces(face_files(a.input), face_files(a.result), a.texels))
    if a.json:
        print(json.dumps(found))
        return
    for name, value in found.items():
        print(f"{name:14} {value}")


if __name__ == "__main__":
    main()
