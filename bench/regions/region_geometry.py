"""Where the triangles of regions are: their shape, whether they cross, which voxels they enclose, planes between grains."""
import numpy as np
from scipy.sparse import coo_array

from region_topology import sides

CHUNK = 200_000


def shape(vertices, triangles):
    """Mean quality Q, the least angle in degrees, and the share of triangles with an angle below 30 and below 25, in %."""
    corners = vertices[triangles]
    ends = corners[:, [1, 2, 0]] - corners
    length = np.linalg.norm(ends, axis=2)
    area = np.linalg.norm(np.cross(ends[:, 0], ends[:, 1]), axis=1) / 2
    inradius = 2 * area / np.maximum(length.sum(axis=1), 1e-300)
    q = 6 / np.sqrt(3) * inradius / np.maximum(length.max(axis=1), 1e-300)
    before = -ends[:, [2, 0, 1]]
    cosine = (ends * before).sum(axis=2) / np.maximum(length * length[:, [2, 0, 1]], 1e-300)
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1))).min(axis=1)
    return {"q": q.mean(), "least_angle": angle.min(), "below_30_pct": 100 * (angle < 30).mean(),
            "below_25_pct": 100 * (angle < 25).mean()}


def spread(low, high):
    """Every whole-numbered cell from low to high, both included, of every row: rows and cells."""
    size = high - low + 1
    count = size.prod(axis=1)
    row = np.repeat(np.arange(len(low)), count)
    rest = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    cells = np.empty((len(row), low.shape[1]), np.int64)
    for axis in range(low.shape[1]):
        cells[:, axis] = low[row, axis] + rest % size[row, axis]
        rest //= size[row, axis]
    return row, cells


def labels_at(mesh, points):
    """The label of the region around each point, by the sum of the crossings of a ray with each region's boundary;
    background where it is in none, and -1 where it is in several or in one more than once. In voxels. The rays are a
    little oblique, so that they meet no edge of a lattice."""
    slope = np.array([0.00271828, 0.00141421])
    labels, corners, _ = sides(mesh)
    names, label_of = np.unique(labels, return_inverse=True)
    flat, flat_points = (p[:, :2] - p[:, 2:] * slope for p in (mesh.vertices, points))
    origin = np.floor(flat_points.min(axis=0))
    size = (np.floor(flat_points.max(axis=0)) - origin).astype(np.int64) + 1
    cell = np.floor(flat_points - origin).astype(np.int64) @ [size[1], 1]
    order = np.argsort(cell, kind="stable")
    ends = np.searchsorted(cell[order], np.arange(size.prod() + 1))
    winding = np.zeros((len(points), len(names)), np.int32)
    for first in range(0, len(corners), CHUNK):
        part = slice(first, first + CHUNK)
        triangle = flat[corners[part]]
        low = np.clip(np.floor(triangle.min(axis=1) - origin).astype(np.int64), 0, size)
        high = np.clip(np.floor(triangle.max(axis=1) - origin).astype(np.int64), -1, size - 1)
        some = np.flatnonzero((low <= high).all(axis=1))
        row, cells = spread(low[some], high[some])
        row, cells = some[row], cells @ [size[1], 1]
        count = ends[cells + 1] - ends[cells]
        at = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(ends[cells], count)
        row, point = np.repeat(row, count), order[at]
        sign = crossings(triangle[row], mesh.vertices[corners[part][row], 2], flat_points[point], points[point, 2])
        np.add.at(winding, (point, label_of[part][row]), sign)
    inside = winding == 1
    found = np.where(inside.any(axis=1), names[np.argmax(inside, axis=1)] if len(names) else 0, mesh.background)
    return np.where((np.abs(winding).sum(axis=1) > 1) | (winding < 0).any(axis=1), -1, found)


def crossings(triangle, height, point, above):
    """Per triangle and point in the plane: 1 where the ray upwards leaves by the triangle, -1 where it enters, else 0."""
    weights = []
    for i in range(3):
        a, b = triangle[:, i] - point, triangle[:, (i + 1) % 3] - point
        weights.append(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    weights = np.stack([weights[1], weights[2], weights[0]], axis=1)
    sign = np.where((weights > 0).all(axis=1), 1, np.where((weights < 0).all(axis=1), -1, 0))
    total = weights.sum(axis=1)
    meets = (weights * height).sum(axis=1) / np.where(total == 0, 1, total)
    return np.where(meets > above, sign, 0)


def candidates(low, high):
    """Pairs of boxes that overlap, in portions. Every box is put into the cells of a lattice that it reaches; a pair counts
    in the cell that holds the greater of its two lower corners."""
    cell_size = 1.5 * np.maximum((high - low).mean(), 1e-12)
    origin = low.min(axis=0)
    first, last = (np.floor((x - origin) / cell_size).astype(np.int64) for x in (low, high))
    extent = last.max(axis=0) + 1
    row, cells = spread(first, last)
    key = (cells[:, 0] * extent[1] + cells[:, 1]) * extent[2] + cells[:, 2]
    order = np.argsort(key, kind="stable")
    row, cells, key = row[order], cells[order], key[order]
    at, step = np.arange(len(row) - 1), 1
    while len(at):
        at = at[at + step < len(row)]
        at = at[key[at] == key[at + step]]
        a, b = row[at], row[at + step]
        fits = (np.maximum(first[a], first[b]) == cells[at]).all(axis=1)
        fits &= (low[a] <= high[b]).all(axis=1) & (low[b] <= high[a]).all(axis=1)
        a, b = a[fits], b[fits]
        for start in range(0, len(a), CHUNK):
            yield a[start:start + CHUNK], b[start:start + CHUNK]
        step += 1


def separates(axis, a, b, tolerance):
    """Whether the triangles lie on two sides of a plane with this normal, or touch it. No normal separates nothing."""
    length = np.linalg.norm(axis, axis=1)
    on_a, on_b = (np.einsum("nd,nkd->nk", axis, x) for x in (a, b))
    gap = np.maximum(on_a.min(axis=1) - on_b.max(axis=1), on_b.min(axis=1) - on_a.max(axis=1))
    return (gap >= -tolerance * length) & (length > 1e-9)


def crossing(a, b, tolerance):
    """Which pairs of triangles, (n, 3, 3) each, have inner points in common, and which of these lie in one plane. Two
    triangles have none if a plane separates them whose normal is that of one of them, or a product of an edge with an
    edge or with a normal; a vertex or an edge in common or a mere touch is therefore no crossing."""
    scale = np.maximum(np.ptp(a, axis=1).max(axis=1), np.ptp(b, axis=1).max(axis=1))[:, None, None]
    middle = a.mean(axis=1, keepdims=True)
    a, b, tolerance = (a - middle) / scale, (b - middle) / scale, tolerance
    edges = [[x[:, (i + 1) % 3] - x[:, i] for i in range(3)] for x in (a, b)]
    normals = [np.cross(e[0], e[1]) for e in edges]
    normals = [n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300) for n in normals]
    flat = (np.abs(np.einsum("nd,nkd->nk", normals[0], b - a[:, :1])).max(axis=1) < tolerance)
    flat &= (np.abs(np.einsum("nd,nkd->nk", normals[1], a - b[:, :1])).max(axis=1) < tolerance)
    axes = [np.cross(normals[i], e) for i in (0, 1) for e in edges[i]]
    left = np.arange(len(a))
    for axis in axes:
        left = left[~separates(axis[left], a[left], b[left], tolerance)]
    coplanar, left = left[flat[left]], left[~flat[left]]
    for axis in [*normals, *(np.cross(e, f) for e in edges[0] for f in edges[1])]:
        left = left[~separates(axis[left], a[left], b[left], tolerance)]
    return left, coplanar


def self_intersections(mesh, tolerance=1e-6):
    """Pairs of faces of a welded mesh that cross, and that overlap in one plane. A face that is there twice, once for each
    of its regions, counts once. Depths below the tolerance, in lengths of an edge, are no crossing."""
    triangles = mesh.triangles[np.unique(np.sort(mesh.triangles, axis=1), axis=0, return_index=True)[1]]
    corners = mesh.vertices[triangles]
    corners = corners[np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) > 1e-12]
    cross = overlap = 0
    for a, b in candidates(corners.min(axis=1), corners.max(axis=1)):
        left, coplanar = crossing(corners[a], corners[b], tolerance)
        cross, overlap = cross + len(left), overlap + len(coplanar)
    return cross, overlap


def labels_of_vertices(mesh):
    """A table of vertices and labels: how many faces with the label each vertex has; and the labels of its columns."""
    names, of = np.unique(mesh.regions, return_inverse=True)
    of = of.reshape(mesh.regions.shape)
    rows, columns = np.repeat(mesh.triangles.ravel(), 2), np.repeat(of, 3, axis=0).ravel()
    table = coo_array((np.ones(len(rows), np.int32), (rows, columns)), (len(mesh.vertices), len(names))).tocsr()
    table.sum_duplicates()
    return table, names


def against_planes(mesh, planes):
    """How far walls between grains are from the planes between their seeds, on a welded mesh in voxels: rms distance of
    vertices inside walls, mean angle between normals in degrees, weighted by area, and rms distance of the vertices where
    exactly three grains meet from the line where their planes do."""
    inner = (mesh.regions != mesh.background).all(axis=1)
    pairs, of = np.unique(mesh.regions[inner], axis=0, return_inverse=True)
    plane = np.array([planes[tuple(pair)] for pair in pairs.tolist()])[of.reshape(-1)]
    corners = mesh.vertices[mesh.triangles[inner]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    cosine = (normal * plane[:, :3]).sum(axis=1) / np.maximum(area, 1e-300)
    deviation = (np.degrees(np.arccos(np.clip(cosine, -1, 1))) * area).sum() / area.sum()
    table, names = labels_of_vertices(mesh)
    count = np.diff(table.indptr)
    at, row = np.unique(mesh.triangles[inner].ravel(), return_index=True)
    inside = count[at] == 2
    plane, at = plane[row[inside] // 3], at[inside]
    distance = (mesh.vertices[at] * plane[:, :3]).sum(axis=1) - plane[:, 3]
    return {"plane_rms_vox": rms(distance), "normal_deg": deviation,
            "line_rms_vox": rms(distances_to_lines(mesh, planes, table, names, count))}


def distances_to_lines(mesh, planes, table, names, count):
    """Of the vertices with exactly three labels, none of them background."""
    three = np.flatnonzero(count == 3)
    labels = np.sort(names[table.indices[table.indptr[three][:, None] + np.arange(3)]], axis=1)
    keep = (labels != mesh.background).all(axis=1)
    three, labels = three[keep], labels[keep]
    first, second = (np.array([planes[a, b] for a, b in labels[:, ends].tolist()]).reshape(-1, 4)
                     for ends in ([0, 1], [0, 2]))
    distances = []
    for plane in (first, second):
        distances.append((mesh.vertices[three] * plane[:, :3]).sum(axis=1) - plane[:, 3])
    along = (first[:, :3] * second[:, :3]).sum(axis=1)
    a, b = distances  # the nearest point of the line differs by x * first + y * second, both normals of length 1
    x, y = (a - along * b) / (1 - along ** 2), (b - along * a) / (1 - along ** 2)
    return np.sqrt(np.maximum(x * x + y * y + 2 * x * y * along, 0))


def rms(values):
    return float(np.sqrt(np.mean(values ** 2))) if len(values) else None
