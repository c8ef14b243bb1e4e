"""Arrays in the memory of a CUDA device give the mesh of the same arrays of the host. Skipped where there is none."""

import isoshell
import numpy as np
import pytest
from device_tensor import LEGACY, DeviceTensor, Driver
from isoshell import _isoshell

SMALL = {"vertices": 60, "resolution": 24}


@pytest.fixture(scope="module")
def driver():
    if why := _isoshell.why_not_readable(0):
        pytest.skip(f"no device: {why}")
    return Driver()


def test_a_mesh_on_a_device_is_the_mesh_of_the_host(driver, ball):
    vertices, faces = DeviceTensor(driver, ball[0].astype(np.float32)), DeviceTensor(driver, ball[1].astype(np.int32))
    expected = isoshell.remesh((vertices.values, faces.values), **SMALL).digest
    assert isoshell.remesh((vertices, faces), **SMALL).digest == expected
    assert vertices.streams == [LEGACY] and not vertices.alive, "it is taken once, and let go of"


def test_what_is_still_being_written_is_waited_for(driver, ball):
    late = DeviceTensor(driver, ball[0].copy(), late=True)
    assert isoshell.remesh((late, ball[1]), **SMALL).digest == isoshell.remesh(ball, **SMALL).digest


@pytest.mark.parametrize("view", [
    lambda a: a[::2], lambda a: a[::-1], lambda a: a.T, lambda a: a[5:, 1:], lambda a: a[:0], lambda a: a[3:4]])
@pytest.mark.parametrize("kind", ["f8", "f4", "i8", "u1", "?"])
def test_any_strides_and_types_have_their_values(driver, kind, view):
    values = view(np.arange(60).reshape(12, 5).astype(kind))
    found = _isoshell.copied_from_device(DeviceTensor(driver, values).__dlpack__(stream=LEGACY))
    assert found.dtype == values.dtype and np.array_equal(found, values)


def test_volumes_points_and_attributes_may_lie_on_a_device(driver, ball):
    axis = np.arange(-12, 13) / 10
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    distance = (np.sqrt(x * x + y * y + z * z) - 1).astype(np.float32)
    for values in (distance, distance < 0):
        on_host = isoshell.remesh(isoshell.Volume(values, spacing=.1), **SMALL)
        given = DeviceTensor(driver, values)
        given.dtype = values.dtype
        assert isoshell.remesh(isoshell.Volume(given, spacing=.1), **SMALL).digest == on_host.digest
        assert len(given.streams) == 1
    normals = ball[0].copy()
    on_device = isoshell.Points(DeviceTensor(driver, ball[0].copy()), normals=DeviceTensor(driver, normals))
    assert isoshell.remesh(on_device, **SMALL).digest == isoshell.remesh(
        isoshell.Points(ball[0], normals=normals), **SMALL).digest
    heat = ball[0][:, 2].copy()
    mesh = isoshell.Mesh(*ball, of_vertices={"heat": DeviceTensor(driver, heat)})
    assert np.isfinite(isoshell.remesh(mesh, **SMALL).attributes["heat"]).all()


def test_the_device_of_the_calling_thread_stays_what_it_was(driver, ball):
    import ctypes

    before, after = ctypes.c_void_p(), ctypes.c_void_p()
    driver.call("cuCtxSetCurrent", None)
    driver.call("cuCtxGetCurrent", ctypes.byref(before))
    try:
        _isoshell.why_not_readable(0)
        driver.call("cuCtxGetCurrent", ctypes.byref(after))
    finally:
        driver.call("cuCtxSetCurrent", driver.context)
    assert before.value == after.value
