#!/usr/bin/env python3
"""A drop that falls into a pool: level sets with velocities, whose parts join and part, in FOLDER/splash.####.vdb.

    /usr/bin/python3 bench/splash.py FOLDER [FRAMES=48] [VOXELS=160]

A drop joins the pool, a ring rises around it, droplets part from the ring, fly and fall back, a jet rises in the middle
and lets a bead go. Grids "surface" (a level set of half-width 3) and "v" (world units a frame, around the surface).
Frames do not depend on one another: each is a smooth union of the shapes as they are then, with velocities that are
blended as the shapes are.

Needs numpy and, for the files, OpenVDB's Python module (Debian: python3-openvdb).
"""
import pathlib
import sys

import numpy as np

HALF_WIDTH = 3
BLEND = 0.05 / 3  # of the smooth union, in world units; the pool is 2 wide
GRAVITY = 0.0022  # a frame a frame
DROPLETS = 12
IMPACT = 8  # the frame in which the drop meets the pool
RISE = 0.3  # by how much the ring's height is nearer to the one it tends to, a frame


def sphere(at, center, radius, velocity):
    return np.linalg.norm(at - np.asarray(center, np.float32), axis=-1) - radius, np.asarray(velocity, np.float32)


def thrown(start, velocity, frames):
    """Where something is that flies, and how fast."""
    fall = np.array([0, 0, -GRAVITY])
    return start + np.multiply(velocity, frames) + fall * frames ** 2 / 2, velocity + fall * frames


def ring_height(frame):
    """Of the ring that goes outward: it rises quickly and sinks slowly."""
    time = max(0.0, frame - IMPACT)
    return 0.3 * (1 - np.exp(-RISE * time)) * np.exp(-0.09 * time)


def pool_top(radius, frame):
    """The height of the pool's surface, a crater with a ring around it."""
    time = max(0.0, frame - IMPACT)
    ring = 0.3 + 0.012 * time
    crater = -0.22 * (1 - np.exp(-RISE * time)) * np.exp(-0.12 * time)
    return (ring_height(frame) * np.exp(-((radius - ring) / 0.05) ** 2)
            + crater * np.exp(-(radius / (0.8 * ring)) ** 2))


def pool(at, frame):
    """A round basin 2 wide and .5 deep."""
    radius = np.hypot(at[..., 0], at[..., 1])
    top, later = pool_top(radius, frame), pool_top(radius, frame + 1)
    inside = np.maximum(np.maximum(radius - 0.95, at[..., 2] - top), -0.5 - at[..., 2])
    velocity = np.zeros_like(at)
    velocity[..., 2] = (later - top) * np.clip(1 + at[..., 2] / 0.5, 0, 1)
    return inside, velocity


def shapes(at, frame):
    """Distance and velocity of each shape that there is in a frame."""
    yield pool(at, frame)
    fall = frame - IMPACT
    place, velocity = thrown(np.array([0, 0, 0.2]), np.array([0, 0, -0.05]), fall)
    if place[2] > -0.3:
        yield sphere(at, place, 0.18, velocity)
    for i in range(DROPLETS):
        turn, since = 2 * np.pi * i / DROPLETS, frame - IMPACT - 4 - i % 3
        outward = np.array([np.cos(turn), np.sin(turn), 0])
        place, velocity = thrown(outward * 0.34 + [0, 0, 0.05],
                                 outward * (0.009 + 0.002 * (i % 2)) + [0, 0, 0.036 + 0.004 * (i % 4)], since)
        if since >= 0 and place[2] > -0.2:
            yield sphere(at, place, 0.045 + 0.006 * (i % 3), velocity)
    since = frame - IMPACT - 14
    place, velocity = thrown(np.array([0, 0, -0.15]), np.array([0, 0, 0.045]), since)
    if since >= 0 and place[2] > -0.3:
        yield sphere(at, place, 0.075, velocity)
        for part in np.linspace(0.2, 0.8, 4):  # the jet below the bead
            yield sphere(at, place * part + np.array([0, 0, -0.15]) * (1 - part), 0.075 * (1 - part), velocity * part)


def frame_of(frame, voxels):
    """Distances and velocities on the lattice of a frame, and where its corner is."""
    size = 2 / voxels
    low = np.array([-1, -1, -0.55]) - 4 * size
    counts = np.ceil((np.array([1, 1, 0.85]) + 4 * size - low) / size).astype(int)
    at = np.stack(np.meshgrid(*[low[i] + size * np.arange(n) for i, n in enumerate(counts)], indexing="ij"),
                  axis=-1).astype(np.float32)
    velocity, weights = np.zeros_like(at), np.zeros(counts, np.float32)
    for distance, of_shape in shapes(at, frame):  # a smooth union: -BLEND log(sum(exp(-distance / BLEND)))
        weight = np.exp(-np.clip(distance, -1, 1) / BLEND)
        weights += weight
        velocity += weight[..., None] * of_shape
    inside = -BLEND * np.log(weights)
    slope = np.linalg.norm(np.stack(np.gradient(inside, size), -1), axis=-1)
    return inside / np.maximum(slope, 0.5), velocity / weights[..., None], low, size


def write_frame(path, frame, voxels):
    try:
        import pyopenvdb as openvdb
    except ImportError:
        import openvdb

    distance, velocity, low, size = frame_of(frame, voxels)
    most = np.float32(HALF_WIDTH * size)
    transform = openvdb.createLinearTransform(voxelSize=size)
    transform.translate(tuple(low))
    surface = openvdb.FloatGrid(most)
    surface.copyFromArray(np.clip(distance, -most, most), tolerance=0)
    surface.name, surface.gridClass, surface.transform = "surface", openvdb.GridClass.LEVEL_SET, transform
    surface.signedFloodFill()
    velocities = openvdb.Vec3SGrid()
    near = np.abs(distance) < 2 * most
    velocities.copyFromArray(np.where(near[..., None], velocity, 0).astype(np.float32), tolerance=(0, 0, 0))
    velocities.name, velocities.transform = "v", transform
    openvdb.write(str(path), grids=[surface, velocities])


def main():
    folder = pathlib.Path(sys.argv[1])
    frames, voxels = (int(sys.argv[2]) if len(sys.argv) > 2 else 48), (int(sys.argv[3]) if len(sys.argv) > 3 else 160)
    folder.mkdir(parents=True, exist_ok=True)
    for frame in range(frames):
        write_frame(folder / f"splash.{frame:04}.vdb", frame, voxels)


if __name__ == "__main__":
    main()
