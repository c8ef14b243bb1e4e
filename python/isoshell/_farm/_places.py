"""Files here and in object storage, by fsspec where a place has a protocol."""

from __future__ import annotations

import hashlib
import importlib
import os
from typing import Any, Dict, Iterator, List, NamedTuple, Tuple

from .._errors import Error
from .._isoshell import ErrorCode

REMEDY = "pip install 'isoshell[farm]'"
MEBIBYTE = 1 << 20


class File(NamedTuple):
    """What tells a changed file without reading it."""

    size: int
    changed: float  # seconds since 1970; 0 where the place does not say


def package(name: str) -> Any:
    """A package that the farm needs and isoshell itself does not."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        top = name.split(".")[0]
        extra = {"pyarrow": "pip install pyarrow", "bokeh": "pip install bokeh",
                 **dict.fromkeys(("dask_jobqueue", "cryptography"), "pip install dask-jobqueue cryptography")}
        raise Error(f"this needs {top}, which cannot be imported ({error}): {extra.get(top, REMEDY)}",
                    stage="farm") from error


def is_remote(place: str) -> bool:
    return "://" in place


def local(place: str) -> str:
    """The path that a place here has."""
    return os.path.abspath(os.path.expanduser(place))


def join(place: str, *names: str) -> str:
    return "/".join([place.rstrip("/") if len(place) > 1 else place, *names]) if names else place


def file_system(place: str) -> Tuple[Any, str]:
    """The file system of a remote place, and the place's path in it."""
    try:
        system, path = package("fsspec").core.url_to_fs(place)
    except (ImportError, ValueError) as error:
        raise Error(f"{place}: {error}", ErrorCode.UNREADABLE_INPUT, "farm") from error
    return system, str(path)


def files_below(place: str) -> Iterator[Tuple[str, File]]:
    """Every file of a folder and of the folders in it, by its relative path; no order. A folder that cannot be listed
    raises OSError. Nothing where there is no such folder."""
    if is_remote(place):
        system, root = file_system(place)
        system.invalidate_cache()
        for path, info in system.find(root, detail=True).items():
            yield os.path.relpath(path, root), _file_of(info)
        return
    folders = [""] if os.path.isdir(place) else []
    while folders:
        folder = folders.pop()
        with os.scandir(os.path.join(place, folder)) as entries:
            for entry in entries:
                name = f"{folder}/{entry.name}" if folder else entry.name
                if entry.is_dir():
                    if not entry.is_symlink():  # a link could lead back here
                        folders.append(name)
                else:
                    try:
                        status = entry.stat()
                    except FileNotFoundError:
                        continue  # a link to nothing, or a file that has just been renamed
                    yield name, File(status.st_size, status.st_mtime)


def matches_of(pattern: str) -> Dict[str, File]:
    """The files that a pattern with * means, by their places."""
    if is_remote(pattern):
        system, path = file_system(pattern)
        found = system.glob(path, detail=True)
        return {system.unstrip_protocol(name): _file_of(info) for name, info in found.items()
                if info.get("type") == "file"}
    import glob

    return {path: file_at(path) for path in glob.glob(local(pattern), recursive=True) if not os.path.isdir(path)}


def file_at(place: str) -> File:
    """Raises OSError where there is none."""
    if is_remote(place):
        system, path = file_system(place)
        return _file_of(system.info(path))
    status = os.stat(place)
    return File(status.st_size, status.st_mtime)


def is_folder(place: str) -> bool:
    if is_remote(place):
        system, path = file_system(place)
        return bool(system.isdir(path))
    return os.path.isdir(place)


def read_bytes(place: str) -> bytes:
    if is_remote(place):
        system, path = file_system(place)
        return bytes(system.cat_file(path))
    with open(place, "rb") as file:
        return file.read()


def fetch(place: str, target: str) -> None:
    """Copy a remote file to a path here."""
    system, path = file_system(place)
    system.get_file(path, target)


def publish(finished: str, place: str) -> None:
    """Put a finished file of this machine where it belongs, whole or not at all; it is no longer here then."""
    if is_remote(place):
        system, path = file_system(place)
        system.makedirs(system._parent(path), exist_ok=True)
        system.put_file(finished, path)
        os.unlink(finished)
        return
    os.makedirs(os.path.dirname(place), exist_ok=True)
    os.replace(finished, place)


def sha256_of(paths: List[str]) -> str:
    """Of one file its SHA-256; of several the SHA-256 of theirs, in order."""
    digests = [_sha256(path) for path in paths]
    return digests[0] if len(digests) == 1 else hashlib.sha256("".join(digests).encode()).hexdigest()


def to_disk(path: str) -> None:
    """Wait until a file has reached the disk: where that is full or away, some systems only say so now."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _sha256(path: str) -> str:
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(MEBIBYTE):
            digest.update(block)
    return digest.hexdigest()


def _file_of(info: Dict[str, Any]) -> File:
    changed = next((info[name] for name in ("mtime", "LastModified", "last_modified", "updated", "created")
                    if info.get(name)), 0)
    if hasattr(changed, "timestamp"):
        changed = changed.timestamp()
    return File(int(info.get("size") or 0), float(changed) if isinstance(changed, (int, float)) else 0.0)
