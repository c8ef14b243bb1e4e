"""What the triangles of regions are joined to: edges, fans and shells of every region's boundary, walls, adjacency."""
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


@dataclass
class RegionMesh:
    """Triangles between regions. Labels of a face: the region behind it, which its normal points away from, and the one
    in front. Background is never first; of two other labels the smaller one is. `owner`: where a program makes a mesh per
    label, the label that the face was made for; a wall is then there twice. None: each face is made for both its regions."""
    vertices: np.ndarray
    triangles: np.ndarray
    regions: np.ndarray
    owner: np.ndarray | None = None
    background: int = 0


def sides(mesh):
    """Every region's boundary: the labels, the corners of its faces, turned so that all normals point out of the region,
    and which faces they are."""
    bounds = [mesh.regions[:, i] != mesh.background for i in (0, 1)]
    if mesh.owner is not None:
        bounds = [bounds[i] & (mesh.regions[:, i] == mesh.owner) for i in (0, 1)]
    labels = np.concatenate([mesh.regions[bounds[0], 0], mesh.regions[bounds[1], 1]])
    corners = np.concatenate([mesh.triangles[bounds[0]], mesh.triangles[bounds[1]][:, ::-1]])
    return labels, corners, np.concatenate([np.flatnonzero(bounds[0]), np.flatnonzero(bounds[1])])


def weld(mesh, places=6):
    """The same mesh with vertices joined that agree to so many decimals of a voxel."""
    _, first, whole = np.unique(np.round(mesh.vertices, places), axis=0, return_index=True, return_inverse=True)
    return RegionMesh(mesh.vertices[first], whole.reshape(-1)[mesh.triangles], mesh.regions, mesh.owner, mesh.background)


def walls(mesh):
    """Of the faces between two regions that are not background, on a welded mesh: their count, how many exist once for
    both regions, and how many do or have a twin with the same three points, made for the other region."""
    inner = (mesh.regions != mesh.background).all(axis=1)
    _, group, count = np.unique(np.sort(mesh.triangles[inner], axis=1), axis=0, return_inverse=True, return_counts=True)
    count = count[group.reshape(-1)]
    shared = count == 1 if mesh.owner is None else np.zeros(len(count), bool)
    matching = shared if mesh.owner is None else count == 2
    return int(inner.sum()), int(shared.sum()), int(matching.sum())


class Boundaries:
    """The edges of all regions' boundaries. `counts` and `balance` have one entry per region and edge: the number of the
    region's faces there, and how many more of them run one way than the other. 0 and 2 are right; 0 and 4 where the
    region touches itself in an edge."""

    def __init__(self, mesh):
        self.vertices = mesh.vertices
        side_labels, self.corners, self.faces = sides(mesh)
        self.labels, self.label_of = np.unique(side_labels, return_inverse=True)
        n = len(self.corners)
        start, end = self.corners.ravel(), self.corners[:, [1, 2, 0]].ravel()
        self.forward = start < end
        low, high = np.minimum(start, end).astype(np.int64), np.maximum(start, end).astype(np.int64)
        key = (np.repeat(self.label_of.astype(np.int64), 3) * len(mesh.vertices) + low) * len(mesh.vertices) + high
        self.order = np.argsort(key, kind="stable")
        first = np.flatnonzero(np.diff(key[self.order], prepend=-1)) if n else np.zeros(0, np.int64)
        self.first, self.counts = first, np.diff(first, append=3 * n)
        self.edge_label = self.label_of[self.order[first] // 3]
        self.balance = np.add.reduceat(np.where(self.forward[self.order], 1, -1), first) if n else first
        self._sort_around()

    def _sort_around(self):
        """Puts the faces at edges with more than two of them into the order in which they stand around it."""
        at = np.flatnonzero(np.repeat(self.counts > 2, self.counts))
        if len(at) == 0:
            return
        group = np.repeat(np.arange(len(self.counts)), self.counts)[at]
        half = self.order[at]
        side, slot = half // 3, half % 3
        a, b = self.corners[side, slot], self.corners[side, (slot + 1) % 3]
        low, high = self.vertices[np.minimum(a, b)], self.vertices[np.maximum(a, b)]
        along = high - low
        along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
        across = np.cross(along, np.eye(3)[np.argmin(np.abs(along), axis=1)])
        arm = self.vertices[self.corners[side, (slot + 2) % 3]] - low
        angle = np.arctan2((np.cross(along, across) * arm).sum(axis=1), (across * arm).sum(axis=1))
        self.order[at] = half[np.lexsort((angle, group))]

    def pairs(self):
        """Half-edges, 3 * side + slot, that bound one piece of their region at an edge: the one that runs downwards, and
        the next one around the edge, which has the region between them. Only of edges in balance."""
        group = np.repeat(np.arange(len(self.counts)), self.counts)
        following = np.arange(len(self.order)) + 1
        last = self.first + self.counts - 1
        following[last] = self.first
        starts = ~self.forward[self.order] & (self.balance[group] == 0)
        return self.order[starts], self.order[following[starts]]

    def shells(self):
        """Per region its number of closed surfaces, and their Euler number once fans are parted; and how often a vertex
        has a further fan of the same region."""
        a, b = self.pairs()
        count, of = components(len(self.corners), a // 3, b // 3)
        shells = per_label(self.label_of, of, count, len(self.labels))
        ends = [3 * (half // 3) + (half % 3 + 1) % 3 for half in (a, b)]  # a runs downwards, b mostly upwards
        same_way = self.forward[b] == self.forward[a]
        b_high, b_low = np.where(same_way, b, ends[1]), np.where(same_way, ends[1], b)
        corner_label = np.repeat(self.label_of, 3)
        count, of = components(3 * len(self.corners), np.concatenate([a, ends[0]]), np.concatenate([b_high, b_low]))
        fans = per_label(corner_label, of, count, len(self.labels))
        used = np.unique(corner_label.astype(np.int64) * len(self.vertices) + self.corners.ravel())
        points = np.bincount(used // max(len(self.vertices), 1), minlength=len(self.labels))
        edges = np.bincount(self.label_of[a // 3], minlength=len(self.labels))
        faces = np.bincount(self.label_of, minlength=len(self.labels))
        return shells, fans - edges + faces, int((fans - points).sum())

    def volumes(self):
        """Per region the volume that its boundary encloses."""
        middle = self.vertices.mean(axis=0)
        a, b, c = (self.vertices[self.corners[:, i]] - middle for i in range(3))
        return np.bincount(self.label_of, (np.cross(a, b) * c).sum(axis=1) / 6, len(self.labels))


def components(count, a, b):
    return connected_components(coo_array((np.ones(len(a), np.int8), (a, b)), (count, count)), directed=False)


def per_label(label_of, component_of, count, labels):
    """How many components each label has."""
    label = np.zeros(count, np.int64)
    label[component_of] = label_of
    return np.bincount(label, minlength=labels)


def pairs_of_voxels(volume, background=0):
    """The pairs of labels whose voxels share a face, as rows in the order of a mesh's regions."""
    padded = np.pad(volume.astype(np.int64), 1, constant_values=background)
    found = []
    for axis in range(3):
        a, b = (np.moveaxis(padded, axis, 0)[part] for part in (slice(None, -1), slice(1, None)))
        differ = a != b
        found.append(np.stack([a[differ], b[differ]], axis=1))
    return distinct_pairs(np.concatenate(found), background)


def distinct_pairs(rows, background=0):
    """The pairs, each once, in the order of a mesh's regions, as a set."""
    rows = np.sort(rows.astype(np.int64), axis=1)
    swap = rows[:, 0] == background
    rows[swap] = rows[swap][:, ::-1]
    return set(map(tuple, np.unique(rows, axis=0).tolist()))


def voxel_regions(volume, background=0):
    """By label: the number of its voxels, of the closed surfaces around them, and the Euler number of these. Voxels of a
    label are joined by faces alone, those around it by faces and edges, as fans that are parted have it."""
    labels, whole = np.unique(volume, return_inverse=True)
    boxes = ndimage.find_objects(whole.reshape(volume.shape) + 1)
    regions = {}
    for label, box in zip(labels.tolist(), boxes):
        if label == background:
            continue
        inside = np.pad(volume[box] == label, 1)
        pieces = ndimage.label(inside)[1]
        outsides = ndimage.label(~inside, ndimage.generate_binary_structure(3, 2))[1]
        regions[label] = int(inside.sum()), pieces + outsides - 1, 2 * euler_number(inside)
    return regions


def euler_number(inside):
    """Of voxels that are joined by faces: points, less edges, plus squares, less cubes of their centres. Six around a
    point, that lack two opposite ones, are joined in it, too, as the others are not."""
    total = joined_in_points(inside)
    for step in np.ndindex(2, 2, 2):
        cell = inside
        for axis in range(3):
            if step[axis]:
                parts = np.moveaxis(cell, axis, 0)
                cell = np.moveaxis(parts[:-1] & parts[1:], 0, axis)
        total += (-1) ** sum(step) * int(cell.sum())
    return total


def joined_in_points(inside):
    """How many points have two opposite voxels outside and the six others inside."""
    cells = np.stack([inside[i:i - 1 or None, j:j - 1 or None, k:k - 1 or None] for i, j, k in np.ndindex(2, 2, 2)])
    six = cells.sum(axis=0) == 6
    return sum(int((six & ~cells[i] & ~cells[7 - i]).sum()) for i in range(4))
