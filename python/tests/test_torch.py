"""Results as tensors of torch, and tensors as sources."""

import isoshell
import numpy as np
import pytest

torch = pytest.importorskip("torch")
SMALL = {"vertices": 60, "resolution": 24}


def test_a_result_becomes_tensors_of_torch(ball):
    result = isoshell.remesh(ball, **SMALL)
    vertices, faces = result.to_torch()
    assert vertices.dtype == torch.float64 and faces.dtype == torch.int64
    assert vertices.device.type == result.report["device"]
    assert np.array_equal(vertices.cpu().numpy(), result.vertices) and np.array_equal(faces.cpu().numpy(), result.faces)
    vertices += 1  # it is the caller's own
    assert isoshell.remesh((vertices, faces), **SMALL).vertices.shape == (60, 3)
