"""A program that uses the package as its users do: mypy --strict has nothing to say about it."""

from pathlib import Path
from typing import Any

import isoshell
import numpy as np


def remeshed(vertices: "np.ndarray[Any, Any]", faces: "np.ndarray[Any, Any]") -> isoshell.Result:
    with isoshell.Context(device="cpu", threads=2, max_memory="1G", progress=lambda stage, fraction: None) as context:
        return isoshell.remesh((vertices, faces), vertices=100, features="auto", close_gaps=0.1, context=context)


def of_each_kind(array: "np.ndarray[Any, Any]") -> float:
    sources = [isoshell.remesh(Path("a.ply")), isoshell.remesh(isoshell.Points(array, normals=array)),
               isoshell.remesh(isoshell.Volume(array, spacing=(0.5, 0.5, 0.7), origin=(0, 0, 0)), iso=300)]
    again = isoshell.remesh(sources[0], require=["closed", "genus=0"], attributes="none", stats=True)
    estimated: dict[str, Any] = isoshell.estimate("a.ply", edge_length=0.5)
    return float(again.vertices.mean()) + float(again.faces.max()) + float(estimated["memory_bytes"])


def of_a_level_set(array: "np.ndarray[Any, Any]") -> int:
    distances = isoshell.level_set("scan.ply", resolution=64, level_set_band=2.5)
    distances.save(Path("a.vdb"), half=True, overwrite=True)
    result = isoshell.remesh(isoshell.Volume(distances.values, coordinates=distances.coordinates, background=1,
                                             affine=distances.transform), save_level_set=True)
    isoshell.remesh(Path("pieces.vdb:*"), reference=Path("scan.ply"))
    isoshell.remesh(isoshell.Volume(distances)), isoshell.remesh(isoshell.Volume(b"bytes"))
    return len(result.level_set or distances) + int(distances.to_array("1G").size)


def of_a_stage(path: str) -> float:
    mesh = isoshell.usd.read(path, "/World/Mesh", time=24)
    result = isoshell.remesh(mesh, vertices=100)
    isoshell.usd.write("out.usda", result, volumes=["out.shell.vdb"], up_axis="Z")
    return result.origin.meters_per_unit if result.origin else 1.0


def of_a_sequence(array: "np.ndarray[Any, Any]") -> int:
    with isoshell.remesh_sequence([(array, array), "a.ply"], frames=range(1, 3), keep_going=True, vertices=9) as frames:
        for result in frames:
            print(result.frame, result.attributes["born"])
    files = isoshell.remesh_sequence("in.####.vdb", frames="1-9", output=Path("out.####.ply"), velocity="v")
    return len(frames.errors) + len(next(files).vertices)


def of_many(arrays: "list[np.ndarray[Any, Any]]") -> int:
    made = isoshell.remesh_many(["a.ply", *zip(arrays, arrays)], workers=2, vertices=100, device="cpu")
    first: isoshell.Result = next(made)
    made.close()
    kept = isoshell.remesh_many(iter([Path("a.ply")]), on_error="return")
    return len(first.faces) + sum(len(one.vertices) if isinstance(one, isoshell.Result) else one.code for one in kept)


def of_two_arrays(vertices: "np.ndarray[Any, Any]", faces: "np.ndarray[Any, Any]") -> isoshell.Result:
    made = isoshell.remesh(vertices, faces, sizing=vertices[:, 0])
    made.export("out.vtu", overwrite=True)
    print(made.to_trimesh(), made.region(3).to_pyvista(), made.to_meshio())
    return made


def code_of_failure(path: str) -> int:
    try:
        isoshell.remesh(path, output="out.ply", force=True).save("other.obj", overwrite=True)
    except isoshell.Error as error:
        code: isoshell.ErrorCode = error.code
        stage: str = error.stage
        return int(code) if stage and code is not isoshell.ErrorCode.USAGE else len(str(error))
    return 0


def of_a_certificate(path: str, vertices: "np.ndarray[Any, Any]", faces: "np.ndarray[Any, Any]") -> int:
    try:
        info: dict[str, Any] = isoshell.mesh_info((vertices, faces), ref=Path(path), require=["closed", "genus=0"])
        return int(info["topology"]["edges"])
    except isoshell.Error as error:
        return len(error.info["missed_gates"]) if error.info else -1
