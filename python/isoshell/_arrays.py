"""Whatever holds numbers as an array of numpy, without a copy where that is possible."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _isoshell
from ._errors import Error

if TYPE_CHECKING:  # imported where it is used: that takes longer than the rest of this package
    import numpy as np

# DLPack's kinds of device.
HOST, CUDA, CUDA_PINNED, CUDA_MANAGED = 1, 2, 3, 13
LEGACY_DEFAULT_STREAM = 1  # DLPack's name of it
BRING = "bring it to the host (tensor.cpu(), cupy.asnumpy(array))"


def array_of(argument: str, value: Any) -> np.ndarray[Any, Any]:
    """An array of numbers in the host's memory and byte order; `argument` is what errors call it."""
    import numpy as np

    array = _from_dlpack(argument, value) if _gives_dlpack_only(value) else _from_any(argument, value)
    if array.dtype.kind not in "biuf":
        raise Error(f"{argument} must be an array of numbers, and is one of {array.dtype}")
    if array.dtype.kind == "f" and array.dtype.itemsize not in (4, 8):
        return array.astype(np.float64)
    if not array.dtype.isnative:
        return array.astype(array.dtype.newbyteorder("="))
    return array


def triple_of(argument: str, value: Any) -> tuple[float, float, float]:
    """One number for all axes, or three."""
    import numpy as np

    numbers = array_of(argument, value).astype(np.float64)
    if numbers.shape not in ((), (3,)):
        raise Error(f"{argument} must be one number or three, and has the shape {numbers.shape}")
    x, y, z = np.broadcast_to(numbers, 3).tolist()
    return x, y, z


def _gives_dlpack_only(value: Any) -> bool:
    import numpy as np

    return hasattr(value, "__dlpack__") and not isinstance(value, np.ndarray)


def _from_dlpack(argument: str, value: Any) -> np.ndarray[Any, Any]:
    import numpy as np

    kind, number = value.__dlpack_device__()
    on_cuda = kind in (CUDA, CUDA_MANAGED)
    if on_cuda and (why := _isoshell.why_not_readable(number)):
        raise Error(f"{argument} lies in the memory of a device, which cannot be read: {why}; {BRING}")
    if not on_cuda and kind not in (HOST, CUDA_PINNED):
        raise Error(f"{argument} lies in the memory of a device of kind {kind} of DLPack, and only those of CUDA are "
                    f"read: {BRING}")
    try:
        if on_cuda:  # the producer has that stream wait for its own
            array: np.ndarray[Any, Any] = _isoshell.copied_from_device(value.__dlpack__(stream=LEGACY_DEFAULT_STREAM))
            return array
        return np.from_dlpack(value)
    except Error:
        raise
    except Exception as error:  # whatever the other library raises
        raise Error(f"{argument} gives no array: {error}") from error


def _from_any(argument: str, value: Any) -> np.ndarray[Any, Any]:
    import numpy as np

    try:
        return np.asarray(value)
    except Exception as error:
        raise Error(f"{argument} cannot be made an array: {error}") from error
