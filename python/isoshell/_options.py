"""Keywords of isoshell.remesh. Made by scripts/python_options.py from the option table of the command."""

from __future__ import annotations

from typing import Any, Callable, Literal, Mapping, Optional, Sequence, TypedDict, Union

from ._context import Progress
from ._paths import Path


class Options(TypedDict, total=False):
    """The options of the command vdb_isomesh, with underscores. None is as if a keyword were not there; what holds then
    is in brackets.

    Size of the result:
        vertices: number of vertices of the result [10000].
        edge_length: target edge length in world units, instead of vertices.
        sizing: target edge lengths in world units: a float grid, or the attribute of the input's vertices of that name;
            without vertices it also decides the number of vertices.
        region_edge_length: edge length in world units on the walls of a region, a label or a name; may be given for
            each region; without vertices it also decides the number of vertices.
        adaptivity: fraction of the vertices, 0 to 1, distributed by curvature instead of area [0].
        gradation: maximum ratio of neighbouring edge lengths, above 1 and at most 10 [1.2].

    Grid:
        resolution: voxels along the longest side, 8 to 8192 [cells are 4.5 to 5.5 voxels wide].
        voxel_size: voxel size in world units, instead of resolution; voxels have their centres at multiples of it.
        band: thickness of the shell in voxels, 1 to 20 [2].
        close_gaps: maximum width of the gaps to bridge: W in world units, voxels as 4vox, 0, or auto [auto].
        outer_only: drop what lies inside of closed surfaces (default: keep hollows).

    Relaxation:
        method: sheet: exact clipped Voronoi cells on the closed sheet; shell: the paper's iteration on voxels of the
            shell [sheet].
        iterations: maximum number of relaxation passes on the finest level of seeds [the method's own].
        tolerance: stop when the energy falls by less than this fraction per pass [the method's own].
        step: maximum movement of a seed per pass, in voxels [the method's own].
        seed: seed of the random number generator [0].

    Shape of the result:
        fit: balanced: vertices where the mesh is closest to the surface; surface: vertices on the surface [balanced].
        features: sharp edges of the input that stay: auto: those of crisp parts; DEG: all whose faces turn by so many
            degrees or more; off: none; and the lines of FILE, OBJ (l) or PLY (edges), as auto,curves.obj [auto].
        boundary: borders of a surface that is not closed: close: the result is closed; keep: those wider than the gaps
            of close_gaps are borders of the result [close].
        regions: one mesh of all regions of a mesh, with shared walls: its connected components, its groups or objects,
            whatever its faces enclose, or what has the same value of an attribute of faces.
        snap: of regions: faces nearer than that, in world units, are one wall; at least two steps of the grid, at most
            a 20th of the longest side [two steps of the grid].
        attributes: what a mesh has beside its positions and the result keeps: names separated by commas, such as color,
            uv, normal, material, group [all].
        uv_seams: places where texture coordinates jump: keep: they are edges of the result; ignore: triangles lie
            across them, each with the texture coordinates of one chart [keep].
        color_features: colour faces by patch and vertices by curve and corner, and write the edges of curves; in PLY.
        uniform_area: prefer triangles of equal area to triangles of the best shape.

    Files:
        iso: isovalue of a volume; required for a fog volume [0 in a level set and in unsigned distances].
        background: of a volume of labels: the label of what is no region [that around the labels, mostly 0].
        smallest_island: of a volume of labels: islands of fewer voxels get the label around them, but the largest one
            of each region; 0: none do [8].
        smoothing: of a volume of labels: how far, in voxels, walls may leave the faces of their voxels to be smooth; at
            0 they are these faces, flat, with creases where they turn [0.5].
        periodic: of a volume of labels: axes of its array, as x,y,z, along which it goes on with its first layer: walls
            of one period, from the centres of that layer to those of its repetition, with the same triangles on
            opposite sides [none].
        grids: give vertices the values of these grids of INPUT's .vdb file, as v,Cd,temperature, or of others, as
            FILE.vdb:NAME; all: all numbers and vectors beside the grid that is meshed [none].
        union: of several level sets: one surface around all of them, not a region of each.
        reference: of several level sets: the mesh or level set that they were cut from; faces of the result that lie on
            it are of the material exterior, others of the material inner [none].
        input_format: format of INPUT: ply, obj, stl, off, glb, gltf, xyz, pcd, vdb or nvdb [by its name].
        output_format: format of OUTPUT: ply, obj, stl, off, glb, gltf or vdb [by its name].
        save_shell: also write the shell, to resume from.
        save_voronoi: also write the Voronoi volume, to resume from.
        save_level_set: also write signed distances around the closed surface, on the grid of resolution or voxel_size.
        level_set_band: how far, in voxels, a level set reaches on both sides [3].
        level_set_of: what a level set has the distances to: the surface of INPUT, with its holes closed, or the
            resulting mesh [input].
        level_set_half: write level sets with values of 16 bits, of half the size.
        split_regions: also write each region of the result as a closed mesh of its own, DIR/NAME or DIR/LABEL, in the
            format of OUTPUT.
        recenter: write meshes with this place at the origin, auto: round numbers near the middle of the result; for
            formats whose numbers are too coarse far from the origin, as STL.
        stop_after: stop after this stage; OUTPUT is its .vdb file.
        stats: write all statistics as JSON; - writes to standard output.
        report: also write a page that shows the result beside the input, with all that was measured; by the Python
            module alone: pip install isoshell[report].
        force: overwrite existing files.

    Run:
        require: exit with status 6 unless the result meets every requirement of this comma-separated list: closed,
            manifold, no-self-intersections, genus=G, components=N, boundary-loops=N, regions (each is closed, walls are
            shared, no triangles intersect), adjacency (regions that touch in the input share a wall, and no others do),
            region-volume=PERCENT (by which the volume of a region may differ from the input's), min-angle=DEG (smallest
            angle in degrees), min-dihedral=DEG (smallest angle between triangles with a common edge), max-deviation=W
            (distance between result and input in world units), normal-deviation=DEG (mean angle between normals of
            result and input), count (as many vertices as were asked for, to a tenth), features (no curve of the input
            is lost), kept-edges=PERCENT (of a frame that follows another: edges that it keeps, at least), born=N (of a
            frame that follows another: vertices that are new, at most).
        allow_intersections: exit with status 0, not 6, where the result intersects itself.
        device: device to run on [auto].
        threads: number of CPU threads [all].
        max_memory: refuse a run that would need more memory than this (of the device, for a run there), as 512M or 8G
            [80 % of the free memory].
        progress: report progress on standard error [no bar].
        verbose: print more messages.
        quiet: print errors only.
    """

    vertices: Optional[int]
    edge_length: Optional[float]
    sizing: Any
    region_edge_length: Optional[Mapping[Union[int, str], float]]
    adaptivity: Optional[float]
    gradation: Optional[float]
    resolution: Optional[int]
    voxel_size: Optional[float]
    band: Optional[int]
    close_gaps: Optional[Union[float, str]]
    outer_only: bool
    method: Optional[Literal["sheet", "shell"]]
    iterations: Optional[int]
    tolerance: Optional[float]
    step: Optional[float]
    seed: Optional[int]
    fit: Optional[Literal["balanced", "surface"]]
    features: Optional[Union[float, str]]
    boundary: Optional[Literal["close", "keep"]]
    regions: Optional[str]
    snap: Optional[float]
    attributes: Optional[Union[str, Sequence[str]]]
    uv_seams: Optional[Literal["keep", "ignore"]]
    color_features: bool
    uniform_area: bool
    iso: Optional[float]
    background: Optional[int]
    smallest_island: Optional[int]
    smoothing: Optional[float]
    periodic: Optional[str]
    grids: Optional[Union[str, Sequence[str], Mapping[str, Any]]]
    union: bool
    reference: Optional[Path]
    input_format: Optional[str]
    output_format: Optional[str]
    save_shell: Optional[Path]
    save_voronoi: Optional[Path]
    save_level_set: Optional[Union[bool, Path]]
    level_set_band: Optional[float]
    level_set_of: Optional[Literal["input", "result"]]
    level_set_half: bool
    split_regions: Optional[Path]
    recenter: Optional[Union[str, Sequence[float]]]
    stop_after: Optional[Literal["shell", "voronoi", "level-set"]]
    stats: Optional[Union[bool, Path]]
    report: Optional[Path]
    force: bool
    require: Optional[Union[str, Sequence[str]]]
    allow_intersections: bool
    device: Optional[str]
    threads: Optional[int]
    max_memory: Optional[Union[int, str]]
    progress: Optional[Union[Literal["auto", "always", "never", "json"], Callable[[str, Progress], object]]]
    verbose: bool
    quiet: bool
