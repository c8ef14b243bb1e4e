"""Volumes of labels as people have them, by formula: what the bars of regions are measured on (bars.py).

    labels, spacing = VOLUMES["nuclei"]()

An array of int32 with axes (i, j, k) and label 0 as background, and the lengths of a voxel along them.
"""
import numpy as np
from region_volumes import folds, grain_seeds, grains, grid
from scipy import ndimage, spatial


def nuclei():
    """28 ellipsoids in a thin stack, which touch and cut one another."""
    rng, labels = np.random.default_rng(28), np.zeros((96, 96, 24), np.int32)
    best = np.full(labels.shape, 1.)
    at = np.stack(grid(*labels.shape), axis=-1)
    for label in range(1, 29):
        middle, radii = rng.uniform((8, 8, 6), (88, 88, 18)), rng.uniform((8, 8, 5), (14, 14, 9))
        away = np.linalg.norm((at - middle) / radii, axis=-1)
        labels[away < best] = label
        best = np.minimum(best, away)
    return labels, (1, 1, 1)


def lamellae():
    """Twins: 12 grains, half of them parted into layers of two to four voxels, oblique to the axes."""
    labels = grains(64, 12)[0]
    rng = np.random.default_rng(12)
    at = np.stack(grid(64, 64, 64), axis=-1)
    for label in range(1, 7):
        normal = rng.normal(size=3)
        layer = np.floor(at @ (normal / np.linalg.norm(normal)) / rng.uniform(2, 4)).astype(np.int32)
        labels[(labels == label) & (layer % 2 == 1)] = 12 + label
    return labels, (1, 1, 1)


def lesions():
    """A ball of three shells with 24 ellipsoids of 10 to 200 voxels in it."""
    rng = np.random.default_rng(5)
    at = np.stack(grid(96, 96, 96), axis=-1) - 48
    radius = np.linalg.norm(at / (40, 34, 36), axis=-1)
    labels = (radius < 1).astype(np.int32) + (radius < .8) + (radius < .3)
    for label in range(4, 28):
        way = rng.normal(size=3)
        middle = way / np.linalg.norm(way) * rng.uniform(8, 36)
        labels[(np.linalg.norm((at - middle) / rng.uniform(1.3, 3.5, 3), axis=-1) < 1) & (labels > 0)] = label
    return labels, (1, 1, 1)


def atlas():
    """A brain of 724 labels: Voronoi regions of an ellipsoid of 120 x 150 x 110 voxels with a wavy skin."""
    size = np.array([120, 150, 110])
    at = np.stack(grid(*size), axis=-1)
    away = np.linalg.norm((at - size / 2) / (size / 2 - 4), axis=-1)
    skin = .93 + .05 * np.sin(at[..., 0] / 5) * np.sin(at[..., 1] / 6) * np.sin(at[..., 2] / 5)
    seeds = grain_seeds(1, 1900) + .5
    seeds = (seeds * size)[np.linalg.norm((seeds - .5) * 2, axis=1) < .93][:724]
    nearest = spatial.cKDTree(seeds).query(at.reshape(-1, 3))[1].reshape(size)
    return np.where(away < skin, nearest + 1, 0).astype(np.int32), (1, 1, 1)


def thick_anatomy():
    """A trunk in slices of 5 mm with pixels of 1 mm: skin, liver, a vertebra, two kidneys and a vessel, oblique to the slices."""
    spacing = np.array([1., 1., 5.])
    at = np.stack(grid(120, 90, 28), axis=-1) * spacing
    labels = np.zeros(at.shape[:3], np.int32)

    def put(label, middle, radii, lean=0.):
        moved = at - middle
        moved[..., 0] += lean * moved[..., 2]
        labels[np.linalg.norm(moved / radii, axis=-1) < 1] = label

    put(1, (60, 45, 70), (55, 41, 200))
    put(2, (40, 40, 75), (30, 28, 40), .3)
    put(3, (60, 72, 70), (11, 10, 200))
    put(4, (34, 66, 55), (9, 8, 22), .2)
    put(5, (86, 66, 60), (9, 8, 22), -.2)
    put(6, (64, 56, 70), (4, 4, 200), .15)
    return labels, spacing


def neurites():
    """A crop of 96^3 of dense tissue: 90 processes around random walks, and cells between them."""
    rng = np.random.default_rng(90)
    points, owners = [], []
    for label in range(1, 91):
        steps = ndimage.gaussian_filter1d(rng.normal(size=(160, 3)), 6, axis=0)
        walk = rng.uniform(0, 96, 3) + np.cumsum(steps / np.linalg.norm(steps, axis=1)[:, None], axis=0)
        points.append(walk)
        owners.append(np.full(len(walk), label))
    at = np.stack(grid(96, 96, 96), axis=-1)
    away, nearest = spatial.cKDTree(np.concatenate(points)).query(at.reshape(-1, 3))
    labels = np.where(away < 9, np.concatenate(owners)[nearest], 0)
    return labels.reshape(at.shape[:3]).astype(np.int32), (1, 1, 1)


def head():
    """Scalp, skull, fluid, grey and white matter around one another; the two last are folded."""
    at = np.stack(grid(80, 80, 80), axis=-1)
    way = at - 39.5
    radius = np.linalg.norm(way / (36, 38, 34), axis=-1)
    fold = .05 * np.sin(at[..., 0] / 2.5) * np.sin(at[..., 1] / 2.5) * np.sin(at[..., 2] / 2.5)
    shells = [(1., 0), (.9, 0), (.78, 0), (.72, 1), (.6, 1)]
    return sum((radius + folded * fold < end).astype(np.int32) for end, folded in shells), (1, 1, 1)


VOLUMES = {
    "nuclei": nuclei, "lamellae": lamellae, "lesions": lesions, "atlas of 724": atlas, "thick anatomy": thick_anatomy,
    "neurites": neurites, "head": head, "folded cortex": lambda: (folds(96, 32), (1, 1, 1)),
    "grains": lambda: (grains(96, 64)[0], (1, 1, 1)),
}
