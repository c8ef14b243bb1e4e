"""The judge of regions, on two cubes side by side that are made by hand, sound and with one thing wrong each."""

import sys

import numpy as np
import pytest
from conftest import SOURCE

pytest.importorskip("scipy")
sys.path.append(str(SOURCE / "bench/regions"))

from compare_regions import from_labels  # noqa: E402
from region_geometry import crossing  # noqa: E402
from region_judge import RegionMesh, heads, judge, line  # noqa: E402
from region_volumes import KINDS, grains, random_labels, sheets_in_t, touching_cubes  # noqa: E402

QUADS = [(0, 6, 9, 3), (1, 4, 10, 7), (0, 1, 7, 6), (3, 9, 10, 4), (0, 3, 4, 1), (6, 7, 10, 9)]  # of the cube at x 0 to 1
VOXELS = np.array([1, 2], np.int32).reshape(2, 1, 1)
CENTRE = (0.5, 0.5, 0.5)


def two_cubes():
    """Region 1 at x 0 to 1 and region 2 at x 1 to 2: 20 triangles of 12 vertices. Faces 2 and 3 are the wall."""
    vertices = np.array([(x, y, z) for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0)])
    second = [tuple(corner + 1 for corner in quad) for quad in QUADS[1:]]
    triangles = [t for a, b, c, d in QUADS + second for t in ((a, b, c), (a, c, d))]
    regions = [(1, 2) if i == 1 else (1, 0) for i in range(6)] + [(2, 0)] * 5
    return RegionMesh(vertices, np.array(triangles), np.repeat(np.array(regions, np.int32), 2, axis=0))


def without(mesh, face):
    keep = np.arange(len(mesh.triangles)) != face
    return RegionMesh(mesh.vertices, mesh.triangles[keep], mesh.regions[keep])


def judged(mesh):
    return judge(mesh, VOXELS, CENTRE)


def voxel_faces(labels):
    """Every face between two voxels of different labels as two triangles: a mesh that is right but for its steps."""
    padded = np.pad(labels, 1)
    corners, triangles, regions = {}, [], []
    for axis in range(3):
        step = np.eye(3, dtype=int)[axis]
        u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
        for at in np.argwhere(np.diff(padded, axis=axis) != 0):
            behind, front = int(padded[tuple(at)]), int(padded[tuple(at + step)])
            quad = [corners.setdefault(tuple(at + step + c), len(corners)) for c in (0 * u, u, u + v, v)]
            if behind == 0 or (front != 0 and front < behind):
                behind, front, quad = front, behind, quad[::-1]
            triangles += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
            regions += [(behind, front)] * 2
    return RegionMesh(np.array(list(corners)) - 1.5, np.array(triangles), np.array(regions, np.int32))


def test_two_sound_cubes_have_no_fault():
    found = judged(two_cubes())
    assert found["closed_regions"] == found["manifold_regions"] == found["same_topology_regions"] == "2 of 2"
    assert found["shared_wall_pct"] == found["kept_voxels_pct"] == 100
    assert found["lost_added_pairs"] == "0, 0" and found["volume_error_pct"] < 1e-9
    assert found["crossings"] == found["overlaps"] == found["bad_order"] == found["degenerate"] == 0
    assert found["least_angle"] == pytest.approx(45) and found["further_fans"] == 0
    assert line(found).count("|") == heads().split("\n")[0].count("|")


def test_a_missing_outer_face_opens_one_region_and_a_missing_wall_face_both():
    assert judged(without(two_cubes(), 0))["closed_regions"] == "1 of 2"
    assert judged(without(two_cubes(), 2))["closed_regions"] == "0 of 2"


def test_a_face_that_is_turned_over_is_out_of_balance():
    mesh = two_cubes()
    mesh.triangles[0] = mesh.triangles[0, ::-1]
    assert judged(mesh)["inside_out"] == [] and judged(mesh)["not_closed"] == [1] and judged(mesh)["edges_out_of_balance"] == 3


def test_a_region_that_is_turned_over_is_closed_but_inside_out():
    mesh = two_cubes()
    mesh.triangles = mesh.triangles[:, ::-1]
    assert judged(mesh)["inside_out"] == [1, 2] and judged(mesh)["torn_centres"] == 2


def test_a_wall_that_is_there_twice_is_not_shared():
    mesh = two_cubes()
    wall = slice(2, 4)
    twice = RegionMesh(mesh.vertices, np.vstack([mesh.triangles, mesh.triangles[wall]]),
                       np.vstack([mesh.regions, mesh.regions[wall]]))
    assert judged(twice)["shared_wall_pct"] == 0 and judged(twice)["manifold_regions"] == "0 of 2"
    owner = np.array([1] * 12 + [2] * 10 + [2, 2])
    of_each = judged(RegionMesh(mesh.vertices, twice.triangles, twice.regions, owner))
    assert of_each["closed_regions"] == "2 of 2"
    assert of_each["shared_wall_pct"] == 0 and of_each["matching_wall_pct"] == 100


def test_a_wrong_label_loses_a_pair_and_adds_another():
    mesh = two_cubes()
    mesh.regions[2:4] = 1, 3
    found = judged(mesh)
    assert found["lost_pairs"] == [(1, 2)] and found["added_pairs"] == [(1, 3)] and found["not_closed"] == [2, 3]


def test_a_region_that_shrinks_off_a_centre_loses_volume_and_the_voxel():
    mesh = two_cubes()
    mesh.vertices[mesh.vertices[:, 0] == 1, 0] = 0.4
    found = judged(mesh)
    assert found["volume_error_pct"] == pytest.approx(60)
    assert found["kept_voxels_pct"] < 100 and found["torn_centres"] == 0


def test_a_corner_that_is_pushed_through_a_wall_crosses_it():
    mesh = two_cubes()
    mesh.vertices[0] = 1.5, 0.3, 0.4
    assert judged(mesh)["crossings"] > 0


def test_voxels_that_touch_in_an_edge_have_four_faces_there_and_fans_in_its_ends():
    labels = np.zeros((2, 2, 1), np.int32)
    labels[0, 0], labels[1, 1] = 1, 1
    found = judge(voxel_faces(labels), labels)
    assert found["closed_regions"] == "1 of 1" and found["manifold_regions"] == "0 of 1"
    assert found["edges_with_4"] == len(found["edges_with_4_listed"]) == 1 and found["further_fans"] == 2
    assert found["shells"] == {1: 2} and found["euler"] == {1: 4} and found["same_topology_regions"] == "1 of 1"


SMALL = [labels for i in range(2 * len(KINDS)) if (labels := random_labels(i)[:10, :10, :10]).any()]


@pytest.mark.parametrize("labels", [touching_cubes(4), sheets_in_t(10), *SMALL])
def test_the_faces_of_voxels_are_faultless(labels):
    found = judge(voxel_faces(labels), labels)
    count = f"{found['regions']} of {found['regions']}"
    assert found["closed_regions"] == found["same_topology_regions"] == count
    assert found["shared_wall_pct"] == 100 or found["wall_faces"] == 0
    assert found["kept_voxels_pct"] == 100 and found["lost_added_pairs"] == "0, 0"
    assert found["volume_error_pct"] < 1e-9 and found["edges_with_others"] == 0
    assert found.get("crossings") == found.get("overlaps") == 0


def test_the_planes_of_grains_are_half_a_voxel_or_less_from_the_faces_of_voxels():
    labels, planes = grains(20, 8)
    found = judge(voxel_faces(labels), labels, planes=planes)
    assert 0 < found["plane_rms_vox"] < 0.9 and 0 < found["line_rms_vox"] < 1.2
    assert 20 < found["normal_deg"] < 60


def test_a_mesh_on_the_planes_of_two_grains_is_exact():
    mesh = two_cubes()
    assert judge(mesh, planes={(1, 2): np.array([1.0, 0, 0, 1])})["normal_deg"] == pytest.approx(0)


def crosses_exactly(a, b):
    """Whether an edge of one of two triangles of whole numbers meets the inside of the other."""
    def side(p, q, r, s):
        return int(np.sign(np.linalg.det(np.array([q - p, r - p, s - p], float)).round()))

    for edges, face in ((a, b), (b, a)):
        for i in range(3):
            p, q = edges[i], edges[(i + 1) % 3]
            if side(*face, p) * side(*face, q) < 0 and len({side(p, q, face[j], face[(j + 1) % 3]) for j in range(3)}) == 1:
                return True
    return False


def test_crossings_of_random_triangles_are_found_exactly():
    triangles = np.random.default_rng(5).integers(-20, 20, (2000, 2, 3, 3))
    expected = {i for i, (a, b) in enumerate(triangles) if crosses_exactly(a, b)}
    found, overlaps = crossing(triangles[:, 0].astype(float), triangles[:, 1].astype(float), 1e-9)
    assert set(found.tolist()) == expected and 100 < len(expected) < 1900 and len(overlaps) == 0


def test_triangles_that_share_a_corner_or_an_edge_cross_or_overlap_only_if_they_do():
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    others = {"beside": [[0, 0, 0], [1, 0, 0], [0, -1, 0]], "folded": [[0, 0, 0], [1, 0, 0], [0.2, 0.7, 0]],
              "upright": [[0, 0, 0], [1, 0, 0], [0, 1, 1]], "corner": [[0, 0, 0], [-1, 0, 1], [-1, 0, -1]],
              "through": [[0, 0, 0], [0.3, 0.3, 1], [0.3, 0.3, -1]], "corner, folded": [[0, 0, 0], [1, 1, 0], [2, 1, 0]]}
    pairs = np.array(list(others.values()), float)
    found, overlaps = crossing(np.repeat(flat[None], len(pairs), axis=0), pairs, 1e-6)
    assert [list(others)[i] for i in found] == ["through"]
    assert [list(others)[i] for i in overlaps] == ["folded", "corner, folded"]


def test_meshes_by_label_find_the_labels_in_front_of_their_faces():
    labels = np.pad(VOXELS, 1)
    mesh = voxel_faces(labels)
    by_label = {}
    for label in (1, 2):
        bounds = (mesh.regions == label).any(axis=1)
        turned = mesh.regions[bounds, 1] == label
        by_label[label] = mesh.vertices, np.where(turned[:, None], mesh.triangles[bounds][:, ::-1], mesh.triangles[bounds])
    found = judge(from_labels(by_label, labels), labels)
    assert found["closed_regions"] == "2 of 2" and found["lost_added_pairs"] == "0, 0" and found["wall_faces"] == 4
    assert found["shared_wall_pct"] == 0 and found["matching_wall_pct"] == 100 and found["crossings"] == 0
    by_label[2] = by_label[2][0] + [0.01, 0, 0], by_label[2][1]
    found = judge(from_labels(by_label, labels), labels)
    assert found["matching_wall_pct"] == 0 and found["lost_added_pairs"] == "0, 0" and found["wall_faces"] == 4
