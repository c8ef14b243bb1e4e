"""Volumes of labels by formula, the same on every machine: what regions are measured and tested on.

    volume, planes = grains(128)      # 64 Voronoi grains in a box, and the planes between them
    volume = random_labels(17)        # one of 200 small ones of every awkward kind

A volume is an array of int32 with axes (i, j, k); the centre of voxel (i, j, k) is at (i, j, k). Label 0 is background,
which everything outside of the array is too.

usage: region_volumes.py FOLDER      writes all of them as .npy files, grains at 128 voxels
"""
import sys
from pathlib import Path

import numpy as np
from scipy import ndimage, spatial

RANDOM_VOLUMES = 200


def grid(*size):
    """The three coordinates of all voxel centres, each of this shape."""
    return np.meshgrid(*[np.arange(n, dtype=np.float64) for n in size], indexing="ij")


def grain_seeds(n, count=64):
    """The points around which grains grow, in voxels."""
    return np.random.default_rng(count).uniform(-0.5, n - 0.5, (count, 3))


def grain_planes(seeds):
    """By pair of labels (a, b) with a < b, the plane between them: normal x, y, z from a to b, and offset d, where
    normal . point = d."""
    planes = {}
    for a in range(len(seeds)):
        for b in range(a + 1, len(seeds)):
            normal = (seeds[b] - seeds[a]) / np.linalg.norm(seeds[b] - seeds[a])
            planes[a + 1, b + 1] = np.array([*normal, normal @ (seeds[a] + seeds[b]) / 2])
    return planes


def grains(n, count=64):
    """Voronoi grains 1 to count that fill a box of n voxels a side, and the planes between them."""
    seeds = grain_seeds(n, count)
    tree = spatial.cKDTree(seeds)
    labels = np.empty((n, n, n), np.int32)
    j, k = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    for i in range(n):
        points = np.stack([np.full(n * n, i), j.ravel(), k.ravel()], axis=1)
        labels[i] = tree.query(points)[1].reshape(n, n) + 1
    return labels, grain_planes(seeds)


def folds(n, count=64):
    """A folded layer of two to three voxels in a box of n a side, with background on both sides, parted into regions 1
    to count: as maps of the cortex are. It is that around a gyroid with a period of 16 voxels."""
    layers, at = grains(n, count)[0], 2 * np.pi * np.arange(n) / 16
    sine, cosine = np.sin(at), np.cos(at)
    gyroid = (sine[:, None, None] * cosine[:, None] + sine[:, None] * cosine + sine * cosine[:, None, None])
    return np.where(abs(gyroid) < 0.6, layers, 0).astype(np.int32)


def touching_cubes(n=8, margin=2):
    """Two cubes of n voxels a side that share a face."""
    labels = np.zeros((2 * n + 2 * margin, n + 2 * margin, n + 2 * margin), np.int32)
    inside = slice(margin, margin + n)
    labels[margin:margin + n, inside, inside] = 1
    labels[margin + n:margin + 2 * n, inside, inside] = 2
    return labels


def sheets_in_t(n=24, thick=3, margin=2):
    """A lying sheet, 1, and one that stands on it, 2: walls end on background along straight lines."""
    labels = np.zeros((n, n, n), np.int32)
    inside, middle = slice(margin, n - margin), n // 2
    labels[inside, inside, margin:margin + thick] = 1
    labels[middle - thick // 2:middle - thick // 2 + thick, inside, margin + thick:n - margin] = 2
    return labels


def ball_in_shell(n=32):
    """A ball, 2, in a shell, 1."""
    centre = (n - 1) / 2
    distance = np.sqrt(sum((x - centre) ** 2 for x in grid(n, n, n)))
    return np.where(distance < 0.22 * n, 2, np.where(distance < 0.4 * n, 1, 0)).astype(np.int32)


def noise(random, size):
    """Every voxel a label by chance, few or many of them, background among them."""
    return random.integers(0, random.choice([2, 3, 5, 40, 1000]), size)


def lines(random, size):
    """Straight lines of one voxel along the axes, which cross, in background or in one label."""
    labels = np.full(size, random.integers(0, 2))
    for label in range(2, 2 + random.integers(1, 12)):
        at = [slice(int(x), int(x) + 1) for x in random.integers(0, size)]
        axis = random.integers(0, 3)
        at[axis] = slice(int(random.integers(0, size[axis])), size[axis])
        labels[tuple(at)] = label
    return labels


def islands(random, size):
    """Single voxels and boxes of up to three, in background or in one label."""
    labels = np.full(size, random.integers(0, 2))
    for _ in range(random.integers(1, 30)):
        low = random.integers(0, size)
        high = low + random.integers(1, 4, 3)
        labels[tuple(slice(*ends) for ends in zip(low, high))] = random.integers(0, 9)
    return labels


def checkerboard(random, size):
    """Blocks whose labels alternate, with background as one of them or not."""
    block, colours = random.integers(1, 4), random.integers(2, 5)
    return sum(x // block for x in np.indices(size)) % colours + random.integers(0, 2)


def edge_contacts(random, size):
    """Blocks of own or common labels that touch in edges and points only."""
    block = random.integers(1, 4)
    i, j, k = [x // block for x in np.indices(size)]
    evens = (i + j + k) % 2 == 0 if random.integers(0, 2) else (i % 2 == j % 2) & (j % 2 == k % 2)
    own = 1 + (i * 7 + j * 3 + k) % random.choice([1, 2, 50])
    return np.where(evens, own, 0)


def layers(random, size):
    """Layers of one or a few voxels, flat, oblique or curved."""
    i, j, k = grid(*size)
    normal = np.eye(3)[random.integers(0, 3)] if random.integers(0, 2) else random.normal(size=3)
    height = (normal[0] * i + normal[1] * j + normal[2] * k) / np.linalg.norm(normal)
    if random.integers(0, 2):
        height = height + 2 * np.sin(i / random.uniform(2, 6)) + 2 * np.cos(j / random.uniform(2, 6))
    return np.floor((height - height.min()) / random.uniform(1, 3)) % random.integers(2, 9)


def blobs(random, size):
    """Smooth regions: at each voxel the label whose smoothed noise is the greatest."""
    count, width = random.integers(2, 12), random.uniform(0.7, 3)
    return np.argmax([ndimage.gaussian_filter(random.normal(size=size), width) for _ in range(count)], axis=0)


def balls(random, size):
    """Balls that overlap, the later over the earlier, as a drawing has them."""
    labels = np.zeros(size, np.int32)
    coordinates = grid(*size)
    for label in range(1, 2 + random.integers(1, 15)):
        centre, radius = random.uniform(0, size), random.uniform(0.6, 0.4 * max(size))
        labels[sum((x - c) ** 2 for x, c in zip(coordinates, centre)) < radius ** 2] = label
    return labels


KINDS = [noise, lines, islands, checkerboard, edge_contacts, layers, blobs, balls]


def random_labels(i):
    """Small volume i of RANDOM_VOLUMES, of the kind KINDS[i % len(KINDS)]: 4 to 40 voxels a side. Every other round of
    kinds is framed by background, so that no region touches the box."""
    random = np.random.default_rng([2026, i])
    most = 13 if i % len(KINDS) == 0 else 41  # noise has a wall at every voxel
    size = tuple(int(n) for n in random.integers(4, most, 3))
    framed = (i // len(KINDS)) % 2 == 1
    labels = KINDS[i % len(KINDS)](random, size).astype(np.int32)
    if framed:
        for axis in range(3):
            np.moveaxis(labels, axis, 0)[[0, -1]] = 0
    if not labels.any():
        labels[tuple(n // 2 for n in size)] = 1
    return labels


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    named = {"grains128": grains(128)[0], "cubes": touching_cubes(), "sheets": sheets_in_t(), "shell": ball_in_shell()}
    named.update((f"random{i:03}", random_labels(i)) for i in range(RANDOM_VOLUMES))
    for name, labels in named.items():
        np.save(folder / f"{name}.npy", labels)
    print(f"{len(named)} volumes in {folder}")


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    main()
