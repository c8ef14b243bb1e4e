"""Whatever holds numbers as an array of numpy, without a copy where that is possible."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

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
    array, mask = masked_array_of(argument, value)
    if mask is not None:
        raise Error(f"{argument}{first_place(mask)} is masked, and has no value; leave it out, or fill it: array.filled(value)")
    return array


def masked_array_of(argument: str, value: Any) -> tuple[np.ndarray[Any, Any], Optional[np.ndarray[Any, Any]]]:
    """The same, and where it has no value; None: it has one everywhere."""
    import numpy as np

    array = _from_dlpack(argument, value) if _gives_dlpack_only(value) else _from_any(argument, value)
    mask = np.ma.getmaskarray(array) if np.ma.is_masked(array) else None
    return _plain(argument, np.ma.getdata(array)), mask


def floats_or_nan(argument: str, value: Any) -> np.ndarray[Any, Any]:
    """An array of single precision, NaN where it has no value."""
    import numpy as np

    array, mask = masked_array_of(argument, value)
    with np.errstate(over="ignore"):  # what is beyond single precision becomes infinite, and is refused as that
        floats = array.astype(np.float32, copy=False)
    return floats if mask is None else np.where(mask, np.float32(np.nan), floats)


def nan_where_masked(argument: str, value: Any) -> np.ndarray[Any, Any]:
    """An array, NaN where it has no value; whole numbers must have one everywhere."""
    import numpy as np

    array, mask = masked_array_of(argument, value)
    if mask is None:
        return array
    if array.dtype.kind != "f":
        raise Error(f"{argument} is masked at {first_place(mask)}, and whole numbers have none that means nothing; "
                    "fill it: array.filled(value)")
    return np.where(mask, np.nan, array).astype(array.dtype)


def shape_of(value: Any) -> tuple[int, ...]:
    """The shape that its array has, without a copy of what a device holds."""
    import numpy as np

    shape = getattr(value, "shape", None)
    return tuple(np.shape(value) if shape is None else shape)


def first_place(mask: np.ndarray[Any, Any]) -> str:
    """The indices of the first that is true, as they are written in Python."""
    return str([int(i[0]) for i in mask.nonzero()])


def _plain(argument: str, array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    import numpy as np

    if array.dtype.kind not in "biuf":
        raise Error(f"{argument} must be an array of numbers, and is one of {array.dtype}")
    if array.dtype.kind == "f" and array.dtype.itemsize not in (4, 8):
        return array.astype(np.float64)
    if not array.dtype.isnative:
        return array.astype(array.dtype.newbyteorder("="))
    return array


def axes_of(argument: str, value: Any) -> list[bool]:
    """Whether the axes x, y and z are among those named."""
    names = set(filter(None, value.split(","))) if isinstance(value, str) else None
    if names is None or not names <= {"x", "y", "z"}:
        raise Error(f'{argument} is {value!r}; give axes, "x", "y" or "z", as in "x,y"')
    return [axis in names for axis in "xyz"]


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
        if isinstance(value, (list, tuple)) and any(isinstance(part, np.ma.MaskedArray) for part in value):
            return np.ma.stack(value)
        return np.asanyarray(value) if isinstance(value, np.ma.MaskedArray) else np.asarray(value)
    except Exception as error:
        raise Error(f"{argument} cannot be made an array: {error}") from error
