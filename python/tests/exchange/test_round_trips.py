"""What a mesh has beside its positions comes through other packages and formats, or its loss is named."""

import isoshell
import numpy as np
import pytest
from carriers import RUN, by_file, check_values, full_mesh, told

# Of each: what carries it, the package that it needs, and what is lost, which report or warning name.
OBJECTS = {
    "trimesh": (lambda result, _: result.to_trimesh(), "trimesh", set()),
    "pyvista": (lambda result, _: result.to_pyvista(), "pyvista", set()),
    "meshio": (lambda result, _: result.to_meshio(), "meshio", set()),
}
FILES = {
    "ply": (by_file("ply"), "numpy", set()),
    "glb": (by_file("glb"), "numpy", {"part", "regions"}),
    "usda": (by_file("usda"), "pxr", set()),
    "vtu": (by_file("vtu"), "meshio", {"names"}),
    "msh": (by_file("msh"), "meshio", set()),
    "xdmf": (by_file("xdmf"), "h5py", {"names"}),
    "med": (by_file("med"), "h5py", {"names"}),
    "vtp": (by_file("vtp"), "pyvista", set()),
    "vtk": (by_file("vtk"), "pyvista", set()),
    "inp": (by_file("inp"), "meshio", {"heat", "color", "uv", "normal", "part", "regions"}),
    "3mf": (by_file("3mf"), "lxml", {"heat", "color", "uv", "normal", "part", "regions"}),
}
NAMED = {"regions": "region", "names": "names of"}


@pytest.fixture(scope="module")
def made():
    return {regions: isoshell.remesh(full_mesh(regions), **RUN) for regions in (False, True)}


@pytest.mark.parametrize("regions", [False, True], ids=["solid", "regions"])
@pytest.mark.parametrize("carrier", [*OBJECTS, *FILES])
def test_everything_comes_through_or_its_loss_is_named(made, tmp_path, carrier, regions):
    carry, package, lost = {**OBJECTS, **FILES}[carrier]
    pytest.importorskip(package)
    check_values(made[regions], set(), regions)

    def twice():
        return isoshell.remesh(carry(made[regions], tmp_path), **RUN)

    again, warned = told(twice)
    check_values(again, lost, regions)
    dropped = {entry["name"] for entry in again.report["attributes"]["dropped"]}
    for name in lost - (set() if regions else {"regions", "names"}):
        assert name in dropped or NAMED.get(name, name) in warned, f"{name} is lost without a word: {warned}"


@pytest.mark.parametrize("carrier", OBJECTS)
def test_one_region_has_its_attributes(made, carrier):
    package = pytest.importorskip(carrier)
    region = made[True].region(1)
    there = OBJECTS[carrier][0](region, None)
    again = isoshell.remesh(there, **RUN)
    check_values(again, set(), False)
    assert isinstance(there, {"trimesh": "Trimesh", "pyvista": "PolyData", "meshio": "Mesh"}[carrier]
                      and getattr(package, {"trimesh": "Trimesh", "pyvista": "PolyData", "meshio": "Mesh"}[carrier]))


@pytest.mark.parametrize("carrier", OBJECTS)
def test_a_result_of_labels_has_the_regions_of_its_faces(carrier):
    pytest.importorskip(carrier)
    labels = np.zeros((12, 8, 8), np.uint8)
    labels[2:6, 2:6, 2:6], labels[6:10, 2:6, 2:6] = 3, 7
    result = isoshell.remesh(isoshell.Labels(labels, names={3: "tibia", 7: "femur"}), vertices=200)
    again = isoshell.remesh(OBJECTS[carrier][0](result, None), vertices=200)
    assert again.region_names == {3: "tibia", 7: "femur"}
    assert {*again.regions["labels"].ravel().tolist()} == {0, 3, 7}
