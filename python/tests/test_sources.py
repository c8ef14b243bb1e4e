"""Everything that a run can start from."""

from types import SimpleNamespace

import isoshell
import numpy as np
import pytest
from conftest import write_obj
from isoshell import ErrorCode

SMALL = {"vertices": 100, "resolution": 32}


def digest(source, **options):
    return isoshell.remesh(source, **SMALL, **options).digest


def test_objects_with_vertices_and_faces_are_meshes(ball):
    assert digest(SimpleNamespace(vertices=ball[0], faces=ball[1])) == digest(ball)


def test_a_result_is_a_source(ball):
    made = isoshell.remesh(ball, **SMALL)
    assert digest(made) == digest((made.vertices, made.faces))


def test_a_mesh_of_trimesh_comes_and_goes(ball):
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(*ball, process=False)
    result = isoshell.remesh(mesh, **SMALL)
    assert result.digest == digest(ball)
    assert result.to_trimesh().is_watertight
    assert result.to_trimesh().volume == pytest.approx(4.19, rel=0.1)


def test_a_mesh_of_pyvista_comes_and_goes(ball, box):
    pyvista = pytest.importorskip("pyvista")
    rows = np.column_stack([np.full(len(ball[1]), 3), ball[1]])
    result = isoshell.remesh(pyvista.PolyData(ball[0], rows.ravel()), **SMALL)
    assert result.digest == digest(ball)
    assert result.to_pyvista().n_cells == len(result.faces)


def test_faces_of_any_number_of_corners_are_the_same_in_a_row_a_list_and_columns(box):
    vertices, quads = box
    mixed = [quads[0][:3].tolist(), quads[0][[0, 2, 3]].tolist(), *quads[1:].tolist()]
    row = np.concatenate([[len(face), *face] for face in mixed])
    assert digest((vertices, row)) == digest((vertices, mixed))
    in_a_row = SimpleNamespace(points=vertices, faces=np.column_stack([np.full(6, 4), quads]).ravel())
    assert digest(in_a_row) == digest(box)


def test_points_become_the_surface_that_a_file_of_them_becomes(tmp_path, ball):
    rows = np.column_stack([ball[0], ball[0]])
    np.savetxt(tmp_path / "points.xyz", rows, fmt="%.17g")
    assert digest(isoshell.Points(ball[0], normals=ball[0])) == digest(tmp_path / "points.xyz")
    assert isoshell.remesh(isoshell.Points(ball[0]), **SMALL).report["input"]["kind"] == "points"


@pytest.mark.parametrize("features", ["auto", "off"])
def test_points_of_a_cube_keep_their_creases_as_those_of_a_file_do(tmp_path, features):
    random = np.random.default_rng(1)
    points = random.uniform(-1, 1, (20_000, 3))
    points[np.arange(len(points)), random.integers(0, 3, len(points))] = random.choice([-1.0, 1.0], len(points))
    np.savetxt(tmp_path / "points.xyz", points, fmt="%.17g")
    result = isoshell.remesh(isoshell.Points(points), vertices=500, features=features)
    assert result.digest == isoshell.remesh(tmp_path / "points.xyz", vertices=500, features=features).digest
    assert (len(result.features["curve_edges"]) > 0) == (features == "auto")


@pytest.mark.parametrize("positions, normals, name", [
    (np.zeros((4, 2)), None, "points"),
    (np.zeros((4, 3)), np.zeros((3, 3)), "normals"),
    (np.zeros((4, 3)), np.zeros((4, 2)), "normals"),
    (np.zeros((4, 3)), "up", "normals"),
])
def test_points_that_are_none_are_refused_by_the_name_of_the_argument(positions, normals, name):
    with pytest.raises(isoshell.Error, match=name) as caught:
        isoshell.remesh(isoshell.Points(positions, normals))
    assert caught.value.code == ErrorCode.USAGE


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_points_that_are_not_finite_are_refused_by_their_place(ball, value):
    wrong = ball[0].copy()
    wrong[3] = value
    for points in (isoshell.Points(wrong), isoshell.Points(ball[0], wrong)):
        with pytest.raises(isoshell.Error, match="(point|normal) 3 is") as caught:
            isoshell.remesh(points, **SMALL)
        assert caught.value.code == ErrorCode.UNREADABLE_INPUT


def ball_values(shape=(30, 26, 22), spacing=(0.1, 0.12, 0.14)):
    """Distances from a ball of radius 1 around the middle of the array, negative inside."""
    axes = [(np.arange(n) - (n - 1) / 2) * s for n, s in zip(shape, spacing)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    return np.sqrt(x**2 + y**2 + z**2) - 1, spacing, tuple(axis[0] for axis in axes)


def radii(result):
    return np.linalg.norm(result.vertices, axis=1)


def test_a_volume_of_signed_distances_is_meshed_at_zero_where_it_stands():
    values, spacing, origin = ball_values()
    result = isoshell.remesh(isoshell.Volume(values, spacing, origin), **SMALL)
    assert result.report["input"]["kind"] == "volume"
    assert np.allclose(radii(result), 1, atol=0.05)


def test_a_volume_is_meshed_at_its_isovalue_with_the_dense_side_inside():
    values, spacing, origin = ball_values()
    result = isoshell.remesh(isoshell.Volume(1000 - 500 * values, spacing, origin), iso=900, **SMALL)
    assert np.allclose(radii(result), 1.2, atol=0.05)
    normals = np.cross(*(result.vertices[result.faces[:, i]] - result.vertices[result.faces[:, 0]] for i in (1, 2)))
    assert np.all(np.einsum("ij,ij->i", normals, result.vertices[result.faces[:, 0]]) > 0)


def test_a_hole_in_something_dense_is_a_cavity():
    values, spacing, origin = ball_values()
    result = isoshell.remesh(isoshell.Volume(values, spacing, origin), iso=-0.2, **SMALL)
    assert np.allclose(radii(result), 0.8, atol=0.05)


def test_the_same_volume_in_any_order_and_type_gives_the_same_mesh():
    values, spacing, origin = ball_values()
    single = values.astype(np.float32)
    expected = digest(isoshell.Volume(single, spacing, origin))
    turned = np.ascontiguousarray(single.transpose(2, 1, 0)).transpose(2, 1, 0)
    assert digest(isoshell.Volume(turned, spacing, origin)) == expected
    assert digest(isoshell.Volume(single.astype(np.float64), spacing, origin)) == expected
    assert digest(isoshell.Volume(np.pad(single, 1, constant_values=9)[1:-1, 1:-1, 1:-1], spacing, origin)) == expected


def test_a_volume_of_true_and_false_needs_no_isovalue():
    values, spacing, origin = ball_values()
    result = isoshell.remesh(isoshell.Volume(values < 0, spacing, origin), **SMALL)
    assert np.allclose(radii(result), 1, atol=0.12)
    assert digest(isoshell.Volume((values < 0).astype(np.uint8), spacing, origin), iso=0.5) == result.digest


def test_a_body_that_reaches_the_end_of_the_array_is_closed_there():
    values, spacing, origin = ball_values()
    half = isoshell.remesh(isoshell.Volume((values < 0)[:, :, 11:], spacing, origin), **SMALL)
    assert half.report["topology"]["closed"]
    assert half.report["topology"]["components"] == 1


def volume_of(result):
    a, b, c = (result.vertices[result.faces[:, i]] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def test_a_field_that_reaches_the_sides_of_its_array_ends_there_in_flat_faces_with_creases():
    at = np.linspace(0, 4 * np.pi, 40)
    x, y, z = np.meshgrid(at, at, at, indexing="ij")
    gyroid = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)  # half of space is inside
    for sides, longer in (("sample", 0), ("cell", at[1])):
        made = isoshell.remesh(isoshell.Volume(gyroid, at[1], sides=sides), iso=0, vertices=6000)
        assert volume_of(made) == pytest.approx((4 * np.pi + longer) ** 3 / 2, rel=0.005)
        assert np.allclose([made.vertices.min(axis=0), made.vertices.max(axis=0)],
                           np.outer([-longer / 2, 4 * np.pi + longer / 2], [1, 1, 1]), atol=0.03 * at[1])
        if sides == "sample":
            assert made.report["quality"]["theta_min_deg"] >= 30


def test_true_is_inside_however_much_of_the_array_it_is():
    x, y, z = np.meshgrid(*[np.arange(12)] * 3, indexing="ij")
    assert volume_of(isoshell.remesh(isoshell.Volume(z < 9), **SMALL)) == pytest.approx(12 * 12 * 9, rel=0.01)
    assert volume_of(isoshell.remesh(isoshell.Volume(z < 99), **SMALL)) == pytest.approx(12**3, rel=0.01)


def test_a_surface_that_reaches_the_sides_of_its_array_may_stay_open_there():
    x, _, z = np.meshgrid(*[np.arange(20.0)] * 3, indexing="ij")
    terrain = isoshell.Volume(z - 8.3 - np.sin(x / 3), sides="open")
    made = isoshell.remesh(terrain, boundary="keep", **SMALL)
    assert made.report["topology"]["boundary_loops"] == 1
    assert made.vertices[:, 2].min() > 7


@pytest.mark.parametrize("seed", [32, 33])
def test_intersections_that_angles_end_once_they_are_widened_are_none(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.choice([1500, 3000, 6000]))
    turn, radius = rng.uniform(0, 2 * np.pi, count), 3 + 27 * rng.uniform(0, 1, count)**2
    ground = np.c_[radius * np.cos(turn), radius * np.sin(turn), 0.02 * rng.normal(size=count)].round(4)
    made = isoshell.remesh(isoshell.Points(ground), vertices=200, boundary="keep", device="cpu")
    assert made.report["topology"]["boundary_loops"] == 1 and made.report["topology"]["self_intersections"] == 0


TURNED = np.array([[-0.1, 0.03, 0, 4], [0.02, 0.09, 0.05, -2], [0.01, -0.04, 0.11, 7], [0, 0, 0, 1.0]])  # and mirrored, skewed


def turned_ball(shape=(44, 40, 36)):
    """Distances in the world from a ball of radius 1 where TURNED puts the middle of the array, which is returned, too."""
    at = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1) @ TURNED[:3, :3].T + TURNED[:3, 3]
    middle = TURNED[:3] @ [*((np.array(shape) - 1) / 2), 1]
    return np.linalg.norm(at - middle, axis=-1) - 1, middle


def check_ball(result, middle):
    about = result.vertices - middle
    assert result.report["topology"]["closed"]
    assert np.allclose(np.linalg.norm(about, axis=1), 1, atol=0.01)
    corners = about[result.faces].transpose(1, 0, 2)
    parts = np.einsum("ij,ij->i", corners[0], np.cross(corners[1], corners[2])) / 6
    assert np.all(parts > 0)  # faces look outward
    assert parts.sum() == pytest.approx(4 / 3 * np.pi, rel=0.03)
    assert np.allclose((parts[:, None] * corners.mean(axis=0)).sum(axis=0) / parts.sum(), 0, atol=0.005)


def test_an_affine_puts_a_volume_where_spacing_and_origin_do_to_the_same_bytes():
    values, spacing, origin = ball_values()
    affine = np.diag([*spacing, 1.0])
    affine[:3, 3] = origin
    for kind, options in ((values, {}), (values < 0, {}), (1 - values, {"iso": 0.8})):
        assert digest(isoshell.Volume(kind, affine=affine), **options) == digest(isoshell.Volume(kind, spacing, origin), **options)
    lengths = 0.1 + 0.1 * np.abs(values)
    assert (digest(isoshell.Volume(values, spacing, origin), sizing=isoshell.Volume(lengths, affine=affine))
            == digest(isoshell.Volume(values, spacing, origin), sizing=isoshell.Volume(lengths, spacing, origin)))


def test_a_volume_may_be_turned_skewed_and_mirrored():
    values, middle = turned_ball()
    options = {"vertices": 1500}
    check_ball(isoshell.remesh(isoshell.Volume(values, affine=TURNED), **options), middle)
    check_ball(isoshell.remesh(isoshell.Volume(300 - values, affine=TURNED), iso=300, **options), middle)
    check_ball(isoshell.remesh(isoshell.Volume(values[::-1], affine=TURNED @ [[-1, 0, 0, 43], [0, 1, 0, 0], [0, 0, 1, 0],
                                                                              [0, 0, 0, 1]]), **options), middle)


def test_a_sizing_field_may_be_turned(ball):
    finer = isoshell.Volume(np.where(np.arange(24) < 12, 0.05, 0.2)[:, None, None] * np.ones((24, 24, 24)),
                            affine=[[0, 0.1, 0, -1.15], [0, 0, -0.1, 1.15], [0.1, 0, 0, -1.15], [0, 0, 0, 1]])
    made = isoshell.remesh(ball, sizing=finer, vertices=1000)
    low = np.count_nonzero(made.vertices < 0, axis=0) / len(made.vertices)
    assert np.allclose(low[:2], 0.5, atol=0.03) and low[2] > 0.7  # the array's first axis is z


def test_a_periodic_volume_may_be_mirrored_and_have_its_axes_in_another_order():
    at = np.arange(24) * 2 * np.pi / 24
    x, y, z = np.meshgrid(at, at, at, indexing="ij")
    gyroid = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x) + 0.3 * np.cos(x)
    affine = [[0, 0.5, 0, 3], [1e-17, 0, -0.5, 2], [0.5, 0, 0, 1], [0, 0, 0, 1]]  # nearly 0, as turns by angles leave it
    options = {"iso": 0, "vertices": 1500}
    made = isoshell.remesh(isoshell.Volume(gyroid, affine=affine, periodic="x,y,z"), **options)
    expected = isoshell.remesh(isoshell.Volume(gyroid, spacing=0.5, periodic="x,y,z"), **options)
    assert volume_of(made) == pytest.approx(volume_of(expected), rel=0.002)
    assert np.allclose([made.vertices.min(axis=0), made.vertices.max(axis=0)], [[3, -10, 1], [15, 2, 13]])
    for axis, (low, high) in enumerate([(3, 15), (-10, 2), (1, 13)]):
        ends = [np.delete(made.vertices[made.vertices[:, axis] == end], axis, axis=1) for end in (low, high)]
        assert len(ends[0]) > 20
        assert np.allclose(*(end[np.lexsort(end.round(6).T)] for end in ends), atol=1e-9)
    with pytest.raises(isoshell.Error, match="steps along the axes of the world") as caught:
        isoshell.remesh(isoshell.Volume(gyroid, affine=TURNED, periodic="x"), **options)
    assert caught.value.code == ErrorCode.USAGE


def test_values_that_are_no_numbers_leave_the_surface_open_beside_them():
    values, spacing, origin = ball_values()
    values[:, :, 12:] = np.nan
    with pytest.warns(isoshell.RunWarning, match="are not known, and its surface is open in"):
        half = isoshell.remesh(isoshell.Volume(values, spacing, origin), boundary="keep", **SMALL)
    assert half.report["topology"]["boundary_loops"] == 1
    assert half.vertices[:, 2].max() <= origin[2] + 11 * spacing[2] + 1e-3


@pytest.mark.parametrize("volume, name, code", [
    (isoshell.Volume(np.zeros((3, 3))), "volume", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((0, 3, 3))), "volume", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3), complex)), "volume", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), spacing=0), "spacing", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), spacing=(1, 1)), "spacing", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), spacing=(1, -1, 1)), "spacing must be above 0.*needs affine", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), affine=np.eye(3)), r"affine must have the shape \(4, 4\)", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), affine=np.ones((4, 4))), "the last row of affine", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), affine=np.diag([1, 1, 0, 1])), "span no volume", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), affine=np.eye(4), spacing=2), "affine says spacing", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), origin=(0, np.nan, 0)), "origin", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3))), "volume", ErrorCode.NOTHING_TO_MESH),
    (isoshell.Volume(np.arange(27.0).reshape(3, 3, 3) ** 2), "iso", ErrorCode.USAGE),
    (isoshell.Volume(np.zeros((3, 3, 3)), sides="left"), 'sides must be "sample", "cell" or "open"', ErrorCode.USAGE),
    (isoshell.Volume(np.where(np.arange(27) == 14, np.inf, 1).reshape(3, 3, 3)), r"value \(1, 1, 2\) is inf",
     ErrorCode.UNREADABLE_INPUT),
])
def test_what_is_no_volume_is_refused_by_the_name_of_the_argument(volume, name, code):
    with pytest.raises(isoshell.Error, match=name) as caught:
        isoshell.remesh(volume)
    assert caught.value.code == code


def test_isovalues_are_for_volumes_and_formats_for_files(tmp_path, ball):
    with pytest.raises(isoshell.Error, match="iso is for volumes"):
        isoshell.remesh(ball, iso=1)
    with pytest.raises(isoshell.Error, match="input_format is for files"):
        isoshell.remesh(ball, input_format="obj")
    write_obj(tmp_path / "ball.mesh", *ball)
    assert digest(tmp_path / "ball.mesh", input_format="obj") == digest(ball)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(isoshell.Error, match="none.obj: no such file") as caught:
        isoshell.remesh(tmp_path / "none.obj")
    assert caught.value.code == ErrorCode.UNREADABLE_INPUT == 3
    assert caught.value.stage == "read"


def test_options_are_named_as_keywords_and_files_as_they_are(tmp_path, ball):
    with pytest.raises(isoshell.Error, match=r"scan--close-gaps\.off"):
        isoshell.remesh(tmp_path / "scan--close-gaps.off")
    with pytest.raises(isoshell.Error, match=r"--close\.off"):
        isoshell.remesh(tmp_path / "--close.off")
    with pytest.raises(isoshell.Error, match=r"^resolution excludes voxel_size; see help\(isoshell.Options\)$"):
        isoshell.remesh(ball, voxel_size=1, resolution=32)
