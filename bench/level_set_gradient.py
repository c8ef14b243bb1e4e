#!/usr/bin/env python3
"""Measures the gradient of the level set of a mesh with holes, where there is no surface left.

    python3 bench/level_set_gradient.py MESH [--resolution 256] [--missing 0.05] [--seed 1]

Faces go in round patches until so many are missing. A voxel is in a hole if the nearest vertex of the whole mesh, of those
in the band, is one whose faces are all gone. The gradient is by central differences, where all six neighbours are in the
band, in terms of voxels: of distances it has length 1, but where two parts of a surface are equally near.
Needs numpy, scipy, trimesh and isoshell.
"""

import argparse

import numpy as np
import trimesh
from scipy.spatial import cKDTree

import isoshell


def with_holes(vertices: np.ndarray, faces: np.ndarray, missing: float, seed: int) -> np.ndarray:
    """(M,) bool: the faces that stay. Patches are of 200 faces around random ones."""
    centres = vertices[faces].mean(axis=1)
    tree = cKDTree(centres)
    chosen = np.random.default_rng(seed).permutation(len(faces))
    stays = np.ones(len(faces), bool)
    for face in chosen:
        if np.count_nonzero(~stays) >= missing * len(faces):
            return stays
        stays[tree.query(centres[face], k=200)[1]] = False
    return stays


def gradient_lengths(level_set: isoshell.LevelSet) -> tuple[np.ndarray, np.ndarray]:
    """(K, 3) coordinates that have all neighbours in the band, and (K,) lengths of gradients there."""
    coordinates, values = level_set.coordinates.astype(np.int64), level_set.values / level_set.voxel_size
    low = coordinates.min(axis=0) - 1
    size = coordinates.max(axis=0) + 2 - low
    grid = np.full(size, np.nan, np.float32)
    grid[tuple((coordinates - low).T)] = values
    square = np.zeros(len(coordinates))
    for axis in range(3):
        step = np.zeros(3, np.int64)
        step[axis] = 1
        there, back = coordinates - low + step, coordinates - low - step
        square += ((grid[tuple(there.T)] - grid[tuple(back.T)]) / 2) ** 2
    is_inside = ~np.isnan(square)
    return coordinates[is_inside], np.sqrt(square[is_inside])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh")
    parser.add_argument("--resolution", type=int, default=256)
    parser.add_argument("--missing", type=float, default=0.05)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    mesh = trimesh.load(given.mesh, process=False)
    vertices, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
    stays = with_holes(vertices, faces, given.missing, given.seed)
    level_set = isoshell.level_set((vertices, faces[stays]), resolution=given.resolution)
    coordinates, lengths = gradient_lengths(level_set)
    centres = coordinates * level_set.voxel_size + level_set.transform[:3, 3]
    is_left = np.zeros(len(vertices), bool)
    is_left[faces[stays]] = True
    is_in_hole = ~is_left[cKDTree(vertices).query(centres)[1]]
    for name, chosen in (("beside the surface", ~is_in_hole), ("in holes", is_in_hole)):
        off = np.abs(lengths[chosen] - 1)
        print(f"{name}: {np.count_nonzero(chosen)} voxels, {100 * np.mean(off <= 0.1):.2f} % within .1, "
              f"median off by {np.median(off):.4f}, ninety-nine of a hundred by {np.quantile(off, 0.99):.3f} or less")


if __name__ == "__main__":
    main()
