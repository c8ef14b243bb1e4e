# SPDX-License-Identifier: Apache-2.0
"""Weights of vertices as a field of edge lengths."""

import numpy as np

CELLS = 128  # along the longest side
GOLDEN = 0.6180339887498949


def even_length(vertices, triangles, count):
    """The edge length that `count` vertices spread evenly have: equilateral triangles, two for each vertex."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return np.sqrt(area / count * 2 / np.sqrt(3))


def lengths(vertices, triangles, weights, base, ratio):
    """isoshell.Volume: `base` where the weight is 0, and `ratio` times shorter where it is 1."""
    import isoshell

    low, extent = vertices.min(0), np.ptp(vertices, axis=0).max()
    spacing = extent / CELLS
    at, weight = _samples(vertices, triangles, np.clip(weights, 0, 1), spacing / 2)
    shape = tuple((np.ptp(vertices, axis=0) / spacing).astype(int) + 8)  # and three cells around
    origin = low - 3.5 * spacing
    cell = np.ravel_multi_index(np.rint((at - origin) / spacing).astype(int).T, shape)
    hits = np.bincount(cell, minlength=np.prod(shape))
    mean = np.bincount(cell, weight, np.prod(shape)) / np.where(hits, hits, np.nan)
    mean = _grown(_grown(mean, shape), shape)
    return isoshell.Volume(base * ratio ** -mean.reshape(shape), spacing=spacing, origin=origin)


def _samples(vertices, triangles, weights, distance):
    """Points on every triangle, about so far from each other, and the weight there."""
    corners = vertices[triangles]
    sides = corners - corners[:, [1, 2, 0]]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    longest = np.linalg.norm(sides, axis=2).max(1)
    count = np.ceil(np.maximum(area / distance**2, longest / distance)).astype(int) + 1
    face = np.repeat(np.arange(len(triangles)), count)
    i = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count)
    root = np.sqrt((i + 0.5) / count[face])
    t = (i * GOLDEN) % 1
    share = np.stack([1 - root, root * (1 - t), root * t], axis=1)
    return np.einsum("nk,nkj->nj", share, corners[face]), np.einsum("nk,nk->n", share, weights[triangles[face]])


def _grown(values, shape):
    """Cells that say nothing take the mean of their neighbours that do; the outermost ones say nothing."""
    known = np.flatnonzero(~np.isnan(values))
    total, count = np.zeros(values.size), np.zeros(values.size)
    for stride in (shape[1] * shape[2], shape[2], 1):
        for beside in (known + stride, known - stride):
            total += np.bincount(beside, values[known], values.size)
            count += np.bincount(beside, minlength=values.size)
    return np.where(np.isnan(values) & (count > 0), total / np.maximum(count, 1), values)
