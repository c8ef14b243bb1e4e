"""Whatever holds numbers as an array of numpy, without a copy where that is possible."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._errors import Error

if TYPE_CHECKING:  # imported where it is used: that takes longer than the rest of this package
    import numpy as np

HOST = 1  # of DLPack's kinds of device


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


def _gives_dlpack_only(value: Any) -> bool:
    import numpy as np

    return hasattr(value, "__dlpack__") and not isinstance(value, np.ndarray)


def _from_dlpack(argument: str, value: Any) -> np.ndarray[Any, Any]:
    import numpy as np

    if value.__dlpack_device__()[0] != HOST:
        raise Error(f"{argument} lies in the memory of a device, and only arrays of the host are read yet: bring it to "
                    'the host (tensor.cpu(), cupy.asnumpy(array)); device="cuda" still runs the stages there')
    try:
        return np.from_dlpack(value)
    except Exception as error:  # whatever the other library raises
        raise Error(f"{argument} gives no array: {error}") from error


def _from_any(argument: str, value: Any) -> np.ndarray[Any, Any]:
    import numpy as np

    try:
        return np.asarray(value)
    except Exception as error:
        raise Error(f"{argument} cannot be made an array: {error}") from error
