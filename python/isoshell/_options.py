"""Keywords of isoshell.remesh. Made by scripts/python_options.py from the option table of the command."""

from __future__ import annotations

import os
from typing import Callable, Literal, Optional, Sequence, TypedDict, Union

Path = Union[str, "os.PathLike[str]"]


class Options(TypedDict, total=False):
    """The options of the command vdb_isomesh, with underscores. None is as if a keyword were not there."""

    # Size of the result
    vertices: Optional[int]
    """Number of vertices of the result [10000]."""
    edge_length: Optional[float]
    """Target edge length in world units, instead of vertices."""
    sizing: Optional[Path]
    """Float grid of target edge lengths in world units; without vertices it also decides the number of vertices."""
    adaptivity: Optional[float]
    """Fraction of the vertices, 0 to 1, distributed by curvature instead of area [0]."""
    gradation: Optional[float]
    """Maximum ratio of neighbouring edge lengths, above 1 and at most 10 [1.2]."""

    # Grid
    resolution: Optional[int]
    """Voxels along the longest side, 8 to 8192 [cells are 4.5 to 5.5 voxels wide]."""
    voxel_size: Optional[float]
    """Voxel size in world units, instead of resolution."""
    band: Optional[int]
    """Thickness of the shell in voxels, 1 to 20 [2]."""
    close_gaps: Optional[Union[float, str]]
    """Maximum width of the gaps to bridge: W in world units, voxels as 4vox, 0, or auto [auto]."""
    outer_only: bool
    """Drop what lies inside of closed surfaces (default: keep hollows)."""

    # Relaxation
    method: Optional[Literal["sheet", "shell"]]
    """Sheet: exact clipped Voronoi cells on the closed sheet; shell: the paper's iteration on voxels of the shell
    [sheet]."""
    iterations: Optional[int]
    """Maximum number of relaxation passes on the finest level of seeds [the method's own]."""
    tolerance: Optional[float]
    """Stop when the energy falls by less than this fraction per pass [the method's own]."""
    step: Optional[float]
    """Maximum movement of a seed per pass, in voxels [the method's own]."""
    seed: Optional[int]
    """Seed of the random number generator [0]."""

    # Shape of the result
    fit: Optional[Literal["balanced", "surface"]]
    """Balanced: vertices where the mesh is closest to the surface; surface: vertices on the surface [balanced]."""
    features: Optional[Union[float, str]]
    """Sharp edges of the input that stay: auto: those of crisp parts; DEG: all whose faces turn by so many degrees or
    more; off: none; and the lines of FILE, OBJ (l) or PLY (edges), as auto,curves.obj [auto]."""
    boundary: Optional[Literal["close", "keep"]]
    """Borders of a surface that is not closed: close: the result is closed; keep: those wider than the gaps of close-
    gaps are borders of the result [close]."""
    attributes: Optional[Union[str, Sequence[str]]]
    """What a mesh has beside its positions and the result keeps: names separated by commas, such as color, uv, normal,
    material, group [all]."""
    color_features: bool
    """Colour faces by patch and vertices by curve and corner, and write the edges of curves; in PLY."""
    uniform_area: bool
    """Prefer triangles of equal area to triangles of the best shape."""

    # Files
    iso: Optional[float]
    """Isovalue of a volume; required for a fog volume [0 in a level set and in unsigned distances]."""
    input_format: Optional[str]
    """Format of INPUT: obj, ply, stl, off, xyz, pcd, vdb or nvdb [by its name]."""
    output_format: Optional[str]
    """Format of OUTPUT: ply, obj, stl, off or vdb [by its name]."""
    save_shell: Optional[Path]
    """Also write the shell, to resume from."""
    save_voronoi: Optional[Path]
    """Also write the Voronoi volume, to resume from."""
    stop_after: Optional[Literal["shell", "voronoi"]]
    """Stop after this stage; OUTPUT is its .vdb file."""
    stats: Optional[Union[bool, Path]]
    """Write all statistics as JSON; - writes to standard output."""
    force: bool
    """Overwrite existing files."""

    # Run
    require: Optional[Union[str, Sequence[str]]]
    """Exit with status 6 unless the result meets every requirement of this comma-separated list: closed, manifold, no-
    self-intersections, genus=G, components=N, boundary-loops=N, min-angle=DEG (smallest angle in degrees), max-
    deviation=W (distance between result and input in world units), normal-deviation=DEG (mean angle between normals of
    result and input), features (no curve of the input is lost)."""
    allow_intersections: bool
    """Exit with status 0, not 6, where the result intersects itself."""
    device: Optional[str]
    """Device to run on [auto]."""
    threads: Optional[int]
    """Number of CPU threads [all]."""
    max_memory: Optional[Union[int, str]]
    """Refuse a run that would need more memory than this (of the device, for a run there), as 512M or 8G [80 % of the
    free memory]."""
    progress: Optional[Union[Literal["auto", "always", "never", "json"], Callable[[str, float], object]]]
    """Report progress on standard error [no bar]."""
    verbose: bool
    """Print more messages."""
    quiet: bool
    """Print errors only."""
