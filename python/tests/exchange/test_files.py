"""Files that other packages read and write: as sources, as outputs, by the command, and without these packages."""

import os
import subprocess
import sys

import isoshell
import numpy as np
import pytest
from conftest import FOREVER, write_obj
from isoshell import ErrorCode
from isoshell._exchange import formats

SMALL = {"vertices": 100, "resolution": 32}
WRITTEN = [format.ending for format in formats() if format.writes]


def as_ball(result):
    return np.allclose(np.linalg.norm(result.vertices, axis=1), 1, atol=0.05) and result.report["topology"]["closed"]


def run_module(*words, **environment):
    return subprocess.run([sys.executable, "-m", "isoshell", *map(str, words)], capture_output=True, text=True, timeout=FOREVER,
                          env={**os.environ, **environment})


@pytest.mark.parametrize("ending", WRITTEN)
def test_what_is_written_is_read_by_every_call(tmp_path, ball, ending):
    for package in {"vtk": ["pyvista"], "vtp": ["pyvista"], "3mf": ["lxml"], "med": ["h5py"]}.get(ending, ["meshio", "h5py"]):
        pytest.importorskip(package)
    path = tmp_path / f"ball.{ending}"
    made = isoshell.remesh(ball, output=path, **SMALL)
    assert os.path.exists(path) and as_ball(isoshell.remesh(path, **SMALL))
    assert isoshell.estimate(path, **SMALL)["vertices"] == 100
    assert isoshell.mesh_info(path, require="closed") and isoshell.mesh_info(made, ref=path)["distance"]
    assert as_ball(next(isoshell.remesh_many([path], **SMALL)))
    assert as_ball(isoshell.Stages(path, **SMALL).triangulate())
    assert as_ball(next(isoshell.remesh_sequence([path], **SMALL)))
    with pytest.raises(isoshell.Error, match="exists") as caught:
        isoshell.remesh(ball, output=path, **SMALL)
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT
    made.export(path, overwrite=True)
    assert sorted(os.listdir(tmp_path))[0].startswith("ball.")


def test_the_command_takes_such_files_and_says_what_it_made(tmp_path, ball):
    pytest.importorskip("meshio")
    isoshell.remesh(ball, **SMALL).save(tmp_path / "in.vtu")
    done = run_module(tmp_path / "in.vtu", tmp_path / "out.msh", "--vertices", "80")
    assert done.returncode == 0 and "80 vertices" in done.stderr, done.stderr
    assert len(isoshell.remesh(tmp_path / "out.msh", **SMALL).vertices) == 100
    again = run_module(tmp_path / "in.vtu", tmp_path / "out.msh")
    assert again.returncode == ErrorCode.UNWRITABLE_OUTPUT and "exists" in again.stderr


def test_frames_are_written_as_such_files(tmp_path, ball):
    pytest.importorskip("meshio")
    frames = [(ball[0] * (1 + 0.1 * i), ball[1]) for i in range(2)]
    made = list(isoshell.remesh_sequence(frames, output=tmp_path / "out.##.vtu", **SMALL))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.01.vtu", "out.02.vtu"] and len(made) == 2
    read = list(isoshell.remesh_sequence(tmp_path / "out.##.vtu", frames="1-2", **SMALL))
    assert [result.frame for result in read] == [1, 2]


@pytest.mark.parametrize("ending", ["nii", "nii.gz"])
def test_labels_of_nifti_have_the_affine_of_their_file(tmp_path, ending):
    nibabel = pytest.importorskip("nibabel")
    labels = np.zeros((12, 9, 8), np.uint8)
    labels[2:6, 2:6, 2:6], labels[6:10, 2:6, 2:6] = 3, 7
    affine = np.array([[-0.75, 0.125, 0, 20], [0, 1.125, 0.25, -3], [0, 0, 2, 5], [0, 0, 0, 1]])  # single precision
    path = tmp_path / f"labels.{ending}"
    nibabel.save(nibabel.Nifti1Image(labels, affine), path)
    expected = isoshell.remesh(isoshell.Labels(labels, affine=affine), vertices=200)
    made = isoshell.remesh(path, vertices=200)
    assert made.digest == expected.digest
    assert {*made.regions["labels"].ravel().tolist()} == {0, 3, 7}
    other = isoshell.remesh(path, vertices=200, background=3, smallest_island=0)
    assert other.regions["background"] == 3
    done = run_module(path, tmp_path / "out.ply", "--vertices", "200", "--background", "3")
    assert done.returncode == 0, done.stderr
    with pytest.raises(isoshell.Error, match="no package writes"):
        made.save(path, overwrite=True)


def test_a_format_that_is_named_is_that_of_the_file_whatever_its_ending(tmp_path, ball):
    path = tmp_path / "ply.vtk"
    isoshell.remesh(ball, **SMALL).save(tmp_path / "a.ply")
    (tmp_path / "a.ply").rename(path)
    for made in (isoshell.remesh(path, input_format="ply", **SMALL),
                 next(isoshell.remesh_many([path], input_format="ply", **SMALL)),
                 next(isoshell.remesh_sequence([path], input_format="ply", **SMALL)),
                 isoshell.Stages(path, input_format="ply", **SMALL).triangulate()):
        assert as_ball(made)
    assert isoshell.estimate(path, input_format="ply", **SMALL)["vertices"] == 100
    assert isoshell.mesh_info(path, input_format="ply", ref=path, ref_format="ply")["distance"]


@pytest.mark.parametrize("ending, package", [("ply", "numpy"), ("vtp", "pyvista"), ("xdmf", "h5py"), ("usda", "pxr")])
def test_a_result_replaces_its_source_when_asked_to_and_where_that_is_not_read_again(tmp_path, ball, ending, package):
    pytest.importorskip(package)
    path = tmp_path / f"a.1.{ending}"
    isoshell.remesh(ball, **SMALL).save(path)
    kept = path.read_bytes()
    with pytest.raises(isoshell.Error, match="exists already.*force"):
        isoshell.remesh(path, output=path, **SMALL)
    if ending == "usda":
        refused = [{"source": path}, {"source": f"{path}:/World"}]
    else:
        pytest.importorskip("k3d")
        refused = [{"source": path, "report": tmp_path / "page.html"}]
    for words in refused:
        with pytest.raises(isoshell.Error, match="are one file") as caught:
            isoshell.remesh(output=path, force=True, **words, **SMALL)
        assert caught.value.code == ErrorCode.USAGE
    with pytest.raises(isoshell.Error, match="are one file"):
        pattern = tmp_path / f"a.#.{ending}"
        list(isoshell.remesh_sequence(pattern, frames="1-1", output=pattern, force=True, **SMALL))
    assert path.read_bytes() == kept
    if ending != "usda":
        assert len(isoshell.remesh(path, output=path, force=True, vertices=80, resolution=32).vertices) == 80
        assert len(isoshell.remesh(path, **SMALL).vertices) == 100 and path.read_bytes() != kept


def test_the_numbers_of_xdmf_are_a_file_that_is_checked_before_a_run(tmp_path, ball):
    pytest.importorskip("h5py")
    target, numbers = tmp_path / "o.xdmf", tmp_path / "o.h5"
    for words in ({"stats": numbers}, {"report": numbers}):
        with pytest.raises(isoshell.Error, match=r"o\.h5.* are one file"):
            isoshell.remesh(tmp_path / "absent.obj", output=target, **words)
    numbers.write_text("mine")
    with pytest.raises(isoshell.Error, match=r"o\.h5: exists already") as caught:
        isoshell.remesh(tmp_path / "absent.obj", output=target)
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT and os.listdir(tmp_path) == ["o.h5"]
    with pytest.raises(isoshell.Error, match=r"o\.h5: exists already"):
        isoshell.remesh(ball, **SMALL).save(target)
    assert numbers.read_text() == "mine" and os.listdir(tmp_path) == ["o.h5"]
    assert as_ball(isoshell.remesh(ball, output=target, force=True, **SMALL)) and as_ball(isoshell.remesh(target, **SMALL))


def test_recenter_is_refused_before_a_run_where_the_format_has_none(tmp_path):
    pytest.importorskip("pyvista")
    for place in ("auto", np.zeros(3)):
        with pytest.raises(isoshell.Error, match="recenter: not where output is .*o.vtp"):
            isoshell.remesh(tmp_path / "absent.obj", output=tmp_path / "o.vtp", recenter=place)


def test_vtk_reads_files_of_other_programs(tmp_path, ball):
    pyvista = pytest.importorskip("pyvista")
    rows = np.column_stack([np.full(len(ball[1]), 3), ball[1]])
    mesh = pyvista.PolyData(ball[0], rows.ravel()).compute_normals()
    mesh.save(tmp_path / "poly.vtk")
    mesh.cast_to_unstructured_grid().save(tmp_path / "grid.vtk")
    for name in ("poly.vtk", "grid.vtk"):
        made = isoshell.remesh(tmp_path / name, **SMALL)
        assert as_ball(made) and "normal" in made.attributes


@pytest.mark.parametrize("ending", [format.ending for format in formats() if format.reads])
def test_a_damaged_file_and_one_that_is_not_there_are_errors(tmp_path, ending):
    pytest.importorskip({"vtk": "pyvista", "vtp": "pyvista", "vti": "pyvista", "3mf": "lxml", "nii": "nibabel",
                         "nii.gz": "nibabel"}.get(ending, "h5py"))
    path = tmp_path / f"bad.{ending}"
    with pytest.raises(isoshell.Error, match="bad.*no such file") as caught:
        isoshell.remesh(path)
    assert caught.value.code == ErrorCode.UNREADABLE_INPUT
    path.write_bytes(b"this is nothing\n" * 40)
    with pytest.raises(isoshell.Error, match="bad") as caught:
        isoshell.remesh(path)
    assert caught.value.code in (ErrorCode.UNREADABLE_INPUT, ErrorCode.USAGE, ErrorCode.NOTHING_TO_MESH)


@pytest.mark.parametrize("ending, package", [("vtu", "meshio"), ("vtp", "pyvista"), ("nii", "nibabel"), ("3mf", "trimesh")])
def test_without_its_package_a_file_is_refused_with_what_to_install(tmp_path, ball, ending, package):
    code = f"import sys; sys.modules[{package!r}] = None; import runpy; runpy.run_module('isoshell', run_name='__main__')"
    (tmp_path / f"in.{ending}").write_text("")
    source = write_obj(tmp_path / "ball.obj", *ball)
    for words in ([tmp_path / f"in.{ending}", "o.ply"], [source, tmp_path / f"out.{ending}"]):
        if ending == "nii" and words[0] == source:
            continue
        done = subprocess.run([sys.executable, "-c", code, *map(str, words)], capture_output=True, text=True, timeout=FOREVER)
        assert done.returncode == ErrorCode.USAGE, done.stderr
        assert f"pip install 'isoshell[{package}]'" in done.stderr and "Traceback" not in done.stderr


def test_the_command_in_cpp_names_the_module_that_reads_such_files(command, tmp_path, ball):
    if "VDB_ISOMESH" not in os.environ:
        pytest.skip("VDB_ISOMESH names no command")
    (tmp_path / "in.vtu").write_text("")
    source = write_obj(tmp_path / "ball.obj", *ball)
    for words, verb in (([tmp_path / "in.vtu", tmp_path / "o.ply"], "reads"), ([source, tmp_path / "o.msh"], "writes")):
        done = command(*words)
        assert done.returncode in (ErrorCode.USAGE, ErrorCode.UNREADABLE_INPUT)
        assert f"the Python module {verb}" in done.stderr and "python -m isoshell" in done.stderr
        assert "pip install 'isoshell[meshio]'" in done.stderr
    done = command(source, tmp_path / "o.nii")
    assert "python -m isoshell" not in done.stderr  # it is not written there either


def test_what_meshio_prints_is_not_caught(tmp_path, ball, monkeypatch, capsys):
    """Streams are of the process, and other threads write to them, too."""
    meshio = pytest.importorskip("meshio")
    isoshell.remesh(ball, **SMALL).save(tmp_path / "in.vtu")
    read = meshio.vtu.read
    monkeypatch.setattr(meshio.vtu, "read", lambda path: print("another thread's words") or read(path))
    assert as_ball(isoshell.remesh(tmp_path / "in.vtu", **SMALL)) and capsys.readouterr().out == "another thread's words\n"


@pytest.mark.parametrize("ending", WRITTEN)
def test_a_disk_that_is_full_is_told_with_the_name_of_the_file(tmp_path, ball, ending):
    for package in {"vtk": ["pyvista"], "vtp": ["pyvista"], "3mf": ["lxml"]}.get(ending, ["meshio", "h5py"]):
        pytest.importorskip(package)
    source, target = write_obj(tmp_path / "ball.obj", *ball), tmp_path / f"o.{ending}"
    code = """if True:
        import resource, sys, isoshell
        result = isoshell.remesh(sys.argv[1], vertices=1000, resolution=32)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, resource.RLIM_INFINITY))
        try:
            result.save(sys.argv[2])
        except isoshell.Error as error:
            print(error.code.name, error)"""
    done = subprocess.run([sys.executable, "-c", code, source, target], capture_output=True, text=True, timeout=FOREVER)
    assert done.returncode == 0 and done.stdout.startswith(f"UNWRITABLE_OUTPUT {target}: "), done.stdout + done.stderr
    assert "Success" not in done.stdout and "Traceback" not in done.stderr, done.stderr
    assert os.listdir(tmp_path) == ["ball.obj"]


def test_saving_says_what_a_format_does_not_hold(tmp_path, ball):
    pytest.importorskip("meshio")
    mesh = isoshell.Mesh(*ball, of_vertices={"heat": ball[0][:, 2]}, of_faces={"part": np.arange(len(ball[1])) % 2})
    result = isoshell.remesh(mesh, **SMALL)
    for ending, lost in (("stl", "heat"), ("off", "part"), ("glb", "part"), ("inp", "heat, part")):
        with pytest.warns(isoshell.RunWarning, match=lost):
            result.save(tmp_path / f"o.{ending}")
