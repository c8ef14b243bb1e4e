"""Tensors in the memory of a CUDA device, made with the driver alone: what torch and cupy give, where neither is."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_char_p, c_int, c_int32, c_int64, c_size_t, c_uint8, c_uint16, c_uint64, c_void_p

import numpy as np

CUDA = 2  # DLPack's kinds of device
LEGACY = 1  # the legacy default stream, for DLPack and the driver


class Device(ctypes.Structure):
    _fields_ = [("kind", c_int32), ("number", c_int32)]


class Type(ctypes.Structure):
    _fields_ = [("code", c_uint8), ("bits", c_uint8), ("lanes", c_uint16)]


class DLTensor(ctypes.Structure):
    _fields_ = [("data", c_void_p), ("device", Device), ("ndim", c_int32), ("type", Type), ("shape", POINTER(c_int64)),
                ("strides", POINTER(c_int64)), ("byte_offset", c_uint64)]


class Managed(ctypes.Structure):
    pass


Deleter = ctypes.CFUNCTYPE(None, POINTER(Managed))
Managed._fields_ = [("tensor", DLTensor), ("context", c_void_p), ("deleter", Deleter)]
CODES = {"i": 0, "u": 1, "f": 2, "b": 6}

capsule_of = ctypes.pythonapi.PyCapsule_New
capsule_of.argtypes, capsule_of.restype = [c_void_p, c_char_p, c_void_p], ctypes.py_object


class Driver:
    """The device 0 of this process. Raises OSError where there is no driver or device."""

    def __init__(self) -> None:
        self.functions = ctypes.CDLL("libcuda.so.1")
        self.call("cuInit", 0)
        device = c_int()
        self.call("cuDeviceGet", byref(device), 0)
        self.context = c_void_p()
        self.call("cuDevicePrimaryCtxRetain", byref(self.context), device)
        self.call("cuCtxSetCurrent", self.context)
        self.stream = c_void_p()
        self.call("cuStreamCreate", byref(self.stream), 1)  # waits for no other, and the default ones not for it

    def call(self, name: str, *arguments: object) -> None:
        status = getattr(self.functions, name)(*arguments)
        if status:
            raise OSError(f"{name} failed with {status}")


class DeviceTensor:
    """Values that are written by a stream of its own, late: who reads them without waiting finds others."""

    def __init__(self, driver: Driver, values: np.ndarray, late: bool = False) -> None:
        self.driver, self.values = driver, values
        base = values if values.base is None else values.base
        self.base = np.ascontiguousarray(base)
        assert self.base is base, "a view must be one of a whole array"
        self.offset = values.__array_interface__["data"][0] - base.__array_interface__["data"][0]
        self.streams: list[object] = []
        self.alive: dict[int, object] = {}
        self.data = c_void_p()
        driver.call("cuMemAlloc_v2", byref(self.data), c_size_t(max(1, base.nbytes)))
        if late:
            self._keep_busy()
        driver.call("cuMemcpyHtoDAsync_v2", self.data, base.ctypes.data_as(c_void_p), c_size_t(base.nbytes),
                    driver.stream)

    def _keep_busy(self) -> None:
        scratch, size = c_void_p(), 1 << 30
        self.driver.call("cuMemAlloc_v2", byref(scratch), c_size_t(size))
        for turn in range(100):
            self.driver.call("cuMemsetD8Async", scratch, c_uint8(turn), c_size_t(size), self.driver.stream)

    def __dlpack_device__(self) -> tuple[int, int]:
        return CUDA, 0

    def __dlpack__(self, *, stream: object = None, **_: object) -> object:
        self.streams.append(stream)
        event = c_void_p()
        self.driver.call("cuEventCreate", byref(event), 2)
        self.driver.call("cuEventRecord", event, self.driver.stream)
        self.driver.call("cuStreamWaitEvent", c_void_p(int(stream)) if stream else None, event, 0)
        v, managed = self.values, Managed()
        shape = (c_int64 * v.ndim)(*v.shape)
        strides = (c_int64 * v.ndim)(*(step // v.itemsize for step in v.strides))
        managed.tensor = DLTensor(self.data, Device(CUDA, 0), v.ndim, Type(CODES[v.dtype.kind], 8 * v.itemsize, 1), shape,
                                  strides, self.offset)
        managed.deleter = Deleter(lambda _: self.alive.clear())
        self.alive[0] = managed, shape, strides
        return capsule_of(ctypes.addressof(managed), b"dltensor", None)
