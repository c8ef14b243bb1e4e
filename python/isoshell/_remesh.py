"""Runs."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable, Optional, Union

from . import _isoshell, _report
from ._context import Context, OnProgress, Progress
from ._errors import Error, note, warn
from ._exchange import format_of
from ._grids import grids_of
from ._inputs import Mesh
from ._level_set import LevelSet
from ._keywords import PLACE, READING, Keywords, keywords_of
from ._paths import path_text
from ._result import Result, checked
from ._sources import SourceLike, are_files, is_true_or_false, opened, sizing_of, source_of, with_faces
from ._usd import file_of, is_usd

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import Options

STAGE_FILES = ("save_shell", "save_voronoi", "save_level_set")
NOT_OF_LEVEL_SETS = ("save_shell", "save_voronoi", "save_level_set", "level_set_of", "level_set_half", "split_regions", "stop_after", "stats", "report", "grids",
                     "require", "output_format", "recenter", "color_features")
OF_OTHER_OUTPUTS = ("output_format", "stop_after", "color_features")


def remesh(source: SourceLike, *faces: Any, output: Optional[Union[str, os.PathLike[str]]] = None,
           context: Optional[Context] = None, **options: Unpack[Options]) -> Result:
    """Remesh a surface: an isotropic triangle mesh of it.

    Args:
        source: a path that the command can read, or a stage of USD, perhaps with a prim in it, as
            scene.usda:/World/Mesh (see isoshell.usd); a list of paths of level sets, which are regions, or with `union`
            one surface; (vertices, faces), arrays of (K, 3) numbers in world units and of
            (M, 3) whole numbers, or faces of more corners; anything with .vertices and .faces, such as a mesh of
            trimesh, or with .points and .faces as a PolyData of pyvista; isoshell.Mesh, which has attributes;
            isoshell.Points; isoshell.Volume; isoshell.Labels, whose result has regions. Meshes, scenes and clouds of
            trimesh, data sets of pyvista and VTK, meshes of meshio and PyMeshLab and images of nibabel bring what they
            have beside their positions; report["attributes"] says what was kept. Arrays are whatever numpy or
            DLPack can take, of the host, or of a CUDA device where the module was built with CUDA; they are copied
            once, those of a device to the host first.
        faces: remesh(V, F) is remesh((V, F)).
        output: also write the result there, as the command does, or as a stage of USD, which names the files of
            save_shell, save_voronoi and save_level_set as volumes.
        context: where to run; otherwise device, threads and max_memory say it.
        **options: the options of the command under their names, with underscores: see help(isoshell.Options). Beyond
            what these say, progress may be a function, called as progress(stage, fraction) with a Progress of the whole
            run, stats may be True, to measure everything without writing a file, save_level_set may be True, to have
            result.level_set without one, grids may be a dict of names and what is in memory: isoshell.Volume, also of
            three numbers a value, an array on the lattice of a source that is one, grids of OpenVDB's module, bytes of
            .vdb files, LevelSet; whole numbers are not interpolated. sizing may be an isoshell.Volume of
            edge lengths, or an array (K,) of one for each vertex of a mesh in memory, NaN where it says nothing: between
            them lengths are interpolated on the nearest triangle, which takes a search for each vertex of the sheet.

    Returns:
        The mesh. Warnings of the run are RunWarning; notes go to the logger "isoshell".

    Raises:
        Error: its code says why; the message names the argument. GATE_FAILED when the result does not meet `require`,
            or intersects itself without `allow_intersections`; the error has the result then.
        KeyboardInterrupt: within .3 s of the key; nothing half-written is left.
    """
    given: dict[str, Any] = dict(options)
    source = with_faces(source, faces)
    measure_all = takes_true(given, "stats")
    keep_level_set = takes_true(given, "save_level_set")
    sizing, grids = sizing_of(given), grids_of(given)
    place, progress = settle(context, given)
    target = "" if output is None else path_text(output)
    volumes = stage_files(given)
    is_ours = is_written_here(target, given)
    if is_ours:
        check_target(target, given, volumes, source, may_replace=True)
    if options.get("report"):
        _report.require_k3d()
    keywords_of(given)  # what cannot be is refused before anything is read
    source = opened(source, given)
    keywords = keywords_for(source, given)
    start = source_of(source, sizing, grids, place.max_bytes)
    made = _isoshell.remesh(place, start, keywords, "" if is_ours else target, measure_all, keep_level_set, progress,
                            listener(given))
    result = result_of(made, start, keywords, source, volumes)
    if is_ours:
        result.save(target, overwrite=given.get("force") is True, recenter=given.get("recenter"))
    page = options.get("report")
    if page:
        _report.write(result, source_of(source), page, given.get("force") is True)
    return checked(result)


def estimate(source: SourceLike, *faces: Any, context: Optional[Context] = None, **options: Unpack[Options]) -> dict[str, Any]:
    """What a run would take, as the command's --dry-run; arguments and errors are those of remesh().

    Returns:
        resolution, voxel_size (world units), vertices, sites, active_voxels, sheet_vertices and memory_bytes, all of
        them rather high than low.
    """
    given: dict[str, Any] = dict(options)
    place, _, start, keywords = begun(source, faces, context, given)
    return _isoshell.estimate(place, start, keywords, listener(given))


def level_set(source: SourceLike, *faces: Any, context: Optional[Context] = None, **options: Unpack[Options]) -> LevelSet:
    """Signed distances around the solid that a surface bounds: of any surface that remesh() takes, also with holes.

        distances = isoshell.level_set("scan.ply", resolution=512, level_set_band=3)
        distances.coordinates, distances.values
        distances.save("scan.vdb")

    The grid is that of the options resolution, voxel_size or vertices, and no mesh is made. Arguments and errors are
    those of remesh(), without output and what concerns meshes that are written.

    Raises:
        Error: of code USAGE, too, for a source with regions.
    """
    given: dict[str, Any] = dict(options)
    refused = [name for name in NOT_OF_LEVEL_SETS if given.get(name)]
    if refused:
        raise Error(f"{', '.join(refused)}: not of a level set; leave it out", stage="options")
    place, progress, start, keywords = begun(source, faces, context, given)
    return LevelSet(_isoshell.level_set(place, start, keywords, progress, listener(given)))


def takes_true(options: dict[str, Any], name: str) -> bool:
    """Whether an option that names a file is True, which is no name of one, for what needs none; False is no name, too."""
    if not isinstance(options.get(name), bool):
        return False
    return bool(options.pop(name))


def stage_files(options: dict[str, Any]) -> list[str]:
    """The stage files that a run is to save."""
    return [path_text(options[name]) for name in STAGE_FILES if options.get(name)]


def result_of(made: _isoshell.RunResult, start: _isoshell.Source, keywords: Keywords, source: Any,
              volumes: list[str]) -> Result:
    """What a run made of a source, with what a report would need of it."""
    return Result(made, start if start.is_file else None, [word for word in keywords if word[0] in READING],
                  source.origin if isinstance(source, Mesh) else None, volumes, getattr(source, "material", None))


def is_written_here(target: str, options: dict[str, Any]) -> bool:
    """Whether not the library writes such a file: a stage of USD, or by another package."""
    return is_usd(target) or (format_of(target) is not None and not options.get("output_format")
                              and not options.get("stop_after"))


def check_target(target: str, options: dict[str, Any], volumes: list[str], source: Any = None,
                 may_replace: bool = False) -> None:
    """Before a run whose output is such a file: whether it can be, and is not the file of the source, unless it may
    replace that: a stage of USD is read as long as it is open, and a report reads the source again."""
    refused = [name for name in OF_OTHER_OUTPUTS if options.get(name)]
    if not is_usd(target) and options.get("recenter") is not None:
        refused.append("recenter")
    if refused:
        raise Error(f"{', '.join(refused)}: not where output is {target}", stage="options")
    others = [(f"--{name.replace('_', '-')}", path_text(options[name])) for name in ("stats", "report", *STAGE_FILES)
              if options.get(name)]
    files = [source] if isinstance(source, (str, os.PathLike)) else source if are_files(source) else []
    inputs = [("INPUT", file_of(file)) for file in files]
    if not is_usd(target):
        from ._exchange import _files

        replaces = "INPUT" if may_replace and not options.get("report") else ""
        return _files.check_target(target, options.get("force") is True, others, inputs, replaces)
    from ._usd import _write

    _write.check_target(target, options.get("force") is True, volumes, others, inputs)


def begun(source: SourceLike, faces: tuple[Any, ...], context: Optional[Context],
          given: dict[str, Any]) -> tuple[Any, Any, _isoshell.Source, Keywords]:
    """The place of a run without files, its progress, what it starts from and its keywords; takes what is no keyword
    out of what was given."""
    sizing, grids = sizing_of(given), grids_of(given)
    place, progress = settle(context, given)
    source = opened(with_faces(source, faces), given)
    keywords = keywords_for(source, given)
    return place, progress, source_of(source, sizing, grids, place.max_bytes), keywords


def settle(context: Optional[Context], options: dict[str, Any]) -> tuple[Any, Any]:
    """Where to run and who hears of progress, taken out of the options."""
    named = {name: options.pop(name) for name in PLACE if options.get(name) is not None}
    if context is None:
        context = Context(**named)
    elif named:
        raise Error(f"{', '.join(named)}: the context says it already; leave it out", stage="options")
    progress = context.progress
    if callable(options.get("progress")):
        progress = options.pop("progress")
    return context._place, None if progress is None else teller(progress)


def teller(progress: OnProgress) -> Callable[[str, float, float, float], None]:
    """What the module calls."""
    def tell(stage: str, *numbers: float) -> None:
        progress(stage, Progress(*numbers))

    return tell


def keywords_for(source: Any, options: dict[str, Any]) -> Keywords:
    """The options as the parser takes them, with the isovalue that a source has by itself."""
    has_own = is_true_or_false(source) and options.get("iso") is None
    return keywords_of({**options, "iso": 0.5} if has_own else options)


def listener(options: dict[str, Any], source: str = "") -> Callable[[bool, str], None]:
    """What hears the messages of a run: warnings, unless it is to be quiet, and notes. Where there are many runs, of a
    source that has a name."""
    quiet = options.get("quiet") is True

    def tell(is_warning: bool, text: str) -> None:
        if source and not text.startswith(source):
            text = f"{source}: {text}"
        if is_warning and not quiet:
            warn(text)
        else:
            note(text)

    return tell
