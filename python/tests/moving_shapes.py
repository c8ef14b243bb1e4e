"""What the tests of sequences share: a shape that moves, and how a result does."""

import numpy as np
from conftest import make_ball

MOTION = {"born", "vx", "vy", "vz"}  # the attributes of a frame that follows another


def twisted(frame, rings=16):
    """A long ball, more twisted from frame to frame."""
    vertices, faces = make_ball(rings)
    x, y, z = (vertices * [1, 0.7, 2]).T
    angle = 0.08 * frame * z
    return np.column_stack([np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y, z]), faces


def spin_between(first, second):
    """By how much most vertices turn about z."""
    a, b = first.vertices, second.vertices
    kept = (second.attributes["born"] == 0) & (np.hypot(a[:, 0], a[:, 1]) > 0.6)
    turn = np.arctan2(b[:, 1], b[:, 0]) - np.arctan2(a[:, 1], a[:, 0])
    return np.median(np.angle(np.exp(1j * turn))[kept])
