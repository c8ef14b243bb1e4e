"""Volumes of labels: grains by formula, what is refused, and the regions that a result has."""

from __future__ import annotations

import json
import pickle

import isoshell
import numpy as np
import pytest
from isoshell import ErrorCode, Labels

QUICK = {"vertices": 3000, "device": "cpu"}
QUICKER = {"vertices": 600, "device": "cpu"}  # where meshes are only compared, of fewer voxels
N = 24


def grains(n: int = N, count: int = 5) -> np.ndarray:
    """A polycrystal that fills a cube: each voxel has the label of the nearest of a few random points, from 1."""
    points = np.random.default_rng(5).uniform(0, n, (count, 3))
    at = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1)[..., None, :]
    return (np.argmin(((at - points) ** 2).sum(axis=-1), axis=-1) + 1).astype(np.int32)


@pytest.fixture(scope="module")
def polycrystal() -> isoshell.Result:
    return isoshell.remesh(Labels(grains(), names={1: "ferrite", 3: "pearlite"}), stats=True, **QUICK)


def is_closed(faces: np.ndarray) -> bool:
    """Every edge has two faces, which pass it in opposite directions."""
    passed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    key = passed.min(axis=1) * (passed.max() + 1) + passed.max(axis=1)
    _, edge, uses = np.unique(key, return_inverse=True, return_counts=True)
    turns = np.bincount(edge, weights=np.sign(passed[:, 1] - passed[:, 0]))
    return bool(np.all(uses == 2) and np.all(turns == 0))


def volume_of(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def digest(labels: Labels) -> str:
    return isoshell.remesh(labels, **QUICKER).digest


def test_each_face_has_the_region_behind_it_and_the_one_in_front(polycrystal):
    pairs = polycrystal.regions["labels"]
    assert pairs.shape == (len(polycrystal.faces), 2) and pairs.dtype == np.int32
    assert polycrystal.regions["background"] == 0 and np.all(pairs[:, 0] != 0)
    assert np.unique(pairs).tolist() == [0, 1, 2, 3, 4, 5]
    middles = polycrystal.vertices[polycrystal.faces].mean(axis=1)
    a, b, c = polycrystal.vertices[polycrystal.faces].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    padded = np.pad(grains(), 3)
    sides = [padded[tuple(np.rint(middles + way * normals).astype(int).T + 3)] for way in (-1.2, 1.2)]
    assert np.mean((sides[0] == pairs[:, 0]) & (sides[1] == pairs[:, 1])) > 0.9


def test_every_region_is_a_closed_mesh_as_large_as_its_voxels(polycrystal):
    counts = np.bincount(grains().ravel())
    for label in range(1, 6):
        region = polycrystal.region(label)
        assert is_closed(region.faces)
        assert volume_of(region.vertices, region.faces) == pytest.approx(counts[label], rel=0.08)
        assert len(region.faces) == np.any(polycrystal.regions["labels"] == label, axis=1).sum()
        kept = {tuple(row) for row in polycrystal.vertices.tolist()}
        assert {tuple(row) for row in region.vertices.tolist()} <= kept


def test_the_report_counts_what_the_meshes_of_regions_have(polycrystal):
    census = polycrystal.report["regions"]
    assert polycrystal.report["input"]["kind"] == "labels"
    assert census["every_region_closed"] and census["self_intersecting_pairs"] == 0
    for counted in census["regions"]:
        region = polycrystal.region(counted["label"])
        assert counted["triangles"] == len(region.faces) and counted["closed"]
        assert counted["volume"] == pytest.approx(volume_of(region.vertices, region.faces))
    assert [counted["name"] for counted in census["regions"]] == ["ferrite", None, "pearlite", None, None]


def test_regions_have_their_names(polycrystal):
    assert polycrystal.region_names == {1: "ferrite", 3: "pearlite"}
    assert polycrystal.region(3).name == "pearlite" and polycrystal.region(2).name == "region 2"


def test_a_region_is_a_source(polycrystal):
    again = isoshell.remesh(polycrystal.region(2), vertices=300, device="cpu", features="off")
    assert again.report["topology"]["closed"] and len(again.regions["labels"]) == 0


@pytest.mark.parametrize("label", [0, 9, 2**40, 1.5])
def test_a_region_that_is_not_there_is_refused(polycrystal, label):
    with pytest.raises(isoshell.Error) as caught:
        polycrystal.region(label)
    assert caught.value.code == ErrorCode.USAGE


def test_a_result_without_regions_says_so(ball):
    result = isoshell.remesh(ball, vertices=100, resolution=32, device="cpu")
    assert result.region_names == {} and result.regions["labels"].shape == (0, 2) and result.report["regions"] is None
    with pytest.raises(isoshell.Error):
        result.region(1)


def test_labels_in_any_order_and_type_give_the_same_mesh():
    labels = grains(12)
    same = digest(Labels(labels))
    for kind in (np.uint8, np.int8, np.int16, np.uint16, np.uint32, np.int64, np.uint64, ">i4", ">u8"):
        assert digest(Labels(labels.astype(kind))) == same, kind
    wide = np.zeros((24, 15, 12), np.uint16)
    wide[::2, 3:] = labels
    for order in (np.asfortranarray(labels), labels[::-1].copy()[::-1], wide[::2, 3:], labels.tolist(),
                  np.ascontiguousarray(labels.transpose(2, 1, 0)).transpose(2, 1, 0)):
        assert digest(Labels(order)) == same


def test_true_and_false_are_one_and_zero():
    inside = grains(12) == 2
    assert digest(Labels(inside)) == digest(Labels(inside.astype(np.int32)))


def test_a_voxel_is_centred_at_origin_and_multiples_of_spacing():
    labels = np.zeros((9, 8, 7), np.uint8)
    labels[2:7, 2:6, 2:5] = 4
    result = isoshell.remesh(Labels(labels, spacing=(1, 2, 3), origin=(10, 20, 30)), vertices=500, device="cpu")
    middle = (result.vertices.min(axis=0) + result.vertices.max(axis=0)) / 2
    assert middle == pytest.approx((10 + 4, 20 + 2 * 3.5, 30 + 3 * 3), abs=0.1)
    assert np.all(np.abs(np.ptp(result.vertices, axis=0) - (5, 8, 9)) < (1, 2, 3))  # half a voxel at each end


def test_an_affine_says_the_same_and_may_mirror():
    labels, spacing, origin = grains(), (0.5, 0.5, 0.75), (1, -2, 3)
    affine = np.diag([*spacing, 1.0])
    affine[:3, 3] = origin
    assert digest(Labels(labels, affine=affine)) == digest(Labels(labels, spacing, origin))
    mirrored = affine @ np.diag([-1, 1, 1, 1])
    result = isoshell.remesh(Labels(labels, affine=mirrored), **QUICK)
    for label in range(1, 6):
        region = result.region(label)
        assert is_closed(region.faces)
        assert volume_of(region.vertices, region.faces) == pytest.approx((labels == label).sum() * 0.1875, rel=0.08)


def test_the_background_may_be_any_label():
    labels = np.where(grains() == 1, -7, grains())
    pairs = isoshell.remesh(Labels(labels, background=-7), **QUICK).regions
    assert pairs["background"] == -7 and np.unique(pairs["labels"]).tolist() == [-7, 2, 3, 4, 5]


LARGE = np.array([0, 1, 2**31, 0, 1, 2, 0, 1], np.int64).reshape(2, 2, 2)


@pytest.mark.parametrize("labels, said", [
    (Labels(LARGE), r"labels\[0, 1, 0\] is 2147483648"),
    (Labels(LARGE.astype(np.uint64)), r"labels\[0, 1, 0\] is 2147483648"),
    (Labels(-LARGE - 1), r"labels\[0, 1, 0\] is -2147483649"),
    (Labels(np.full((1, 1, 1), 2**64 - 1, np.uint64)), r"labels\[0, 0, 0\] is 18446744073709551615"),
    (Labels(np.ones((2, 2, 2))), "round them"),
    (Labels(np.ones((2, 2, 2), np.float16)), "round them"),
    (Labels(np.ones((2, 2, 2), complex)), "labels must be an array of numbers"),
    (Labels(np.ones((2, 2), int)), "labels must have 3 dimensions"),
    (Labels(np.ones((0, 2, 2), int)), "labels"),
    (Labels(grains(), spacing=0), "spacing must be above 0"),
    (Labels(grains(), spacing=(1, -1, 1)), "needs affine"),
    (Labels(grains(), spacing=(1, 1)), "spacing must be one number or three"),
    (Labels(grains(), spacing=np.nan), "spacing must be above 0"),
    (Labels(grains(), origin=(0, np.inf, 0)), "labels"),
    (Labels(grains(), affine=np.eye(3)), r"affine must have the shape \(4, 4\)"),
    (Labels(grains(), affine=np.ones((4, 4))), "the last row of affine"),
    (Labels(grains(), affine=np.diag([1, 1, 0, 1])), "span no volume"),
    (Labels(grains(), affine=np.eye(4), spacing=2), "affine says spacing"),
    (Labels(grains(), names={"a": "b"}), "a key of names is 'a'"),
    (Labels(grains(), names={1: 2}), r"names\[1\] is 2"),
    (Labels(grains(), names={1: "a\nb"}), r"names\[1\]"),
    (Labels(grains(), names={2**31: "a"}), "a key of names is 2147483648"),
    (Labels(grains(), background=0.5), "background is 0.5"),
])
def test_what_is_no_volume_of_labels_is_refused(labels, said):
    with pytest.raises(isoshell.Error, match=said) as caught:
        isoshell.remesh(labels, **QUICK)
    assert caught.value.code == ErrorCode.USAGE


def test_nothing_but_background_is_nothing_to_mesh():
    with pytest.raises(isoshell.Error, match="background") as caught:
        isoshell.remesh(Labels(np.zeros((4, 4, 4), int)))
    assert caught.value.code == ErrorCode.NOTHING_TO_MESH


def test_isovalues_are_for_volumes_of_values():
    with pytest.raises(isoshell.Error, match="iso is for volumes"):
        isoshell.remesh(Labels(grains()), iso=1, **QUICK)


def test_labels_are_meshed_in_contexts_and_side_by_side_and_estimated(polycrystal):
    labels = Labels(grains())
    with isoshell.Context(device="cpu", threads=1) as context:
        assert isoshell.remesh(labels, context=context, vertices=3000).digest == polycrystal.digest
        assert isoshell.estimate(labels, context=context, vertices=3000)["memory_bytes"] > 0
    many = isoshell.remesh_many([labels, labels], workers=2, **QUICK)
    assert [result.digest for result in many] == [polycrystal.digest] * 2


def test_islands_of_few_voxels_are_absorbed_unless_all_shall_stay():
    speckled = np.ones((14, 14, 14), np.int32)
    speckled[3, 3, 3] = speckled[9:12, 9:12, 9:12] = 2
    with pytest.warns(isoshell.RunWarning, match="1 island of fewer than 8 voxels, 1 in all"):
        absorbed = isoshell.remesh(Labels(speckled), stats=True, **QUICK)
    kept = isoshell.remesh(Labels(speckled, smallest_island=0), stats=True, **QUICK)
    components = [[region["components"] for region in result.report["regions"]["regions"]] for result in (absorbed, kept)]
    assert components[0][1] == 1 and components[1][1] == 2
    absorbed_walls, of_all = (result.report["regions"]["walls_absorbed"] for result in (absorbed, kept))
    assert absorbed_walls == of_all == []


def test_pairs_that_touch_in_absorbed_islands_alone_are_reported():
    labels = np.zeros((18, 10, 10), np.int32)
    labels[2:8, 2:8, 2:8], labels[8:10, 2:8, 2:8], labels[10:16, 2:8, 2:8] = 1, 2, 3
    labels[9, 5, 5] = 1
    with pytest.warns(isoshell.RunWarning, match="touch no more: 1 and 3"):
        result = isoshell.remesh(Labels(labels, names={3: "skin"}), **QUICK)
    assert result.report["regions"]["walls_absorbed"] == [[{"label": 1, "name": None}, {"label": 3, "name": "skin"}]]
    assert result.report["regions"]["walls_lost"] == []


def test_files_of_labels_are_read_as_labels_say_it(tmp_path):
    speckled = np.ones((14, 14, 14), np.int32)
    speckled[3, 3, 3] = speckled[9:12, 9:12, 9:12] = 2
    path = tmp_path / "speckled.vdb"
    Labels(speckled).save(path)
    for how in ({"smallest_island": 0}, {"background": 1, "smallest_island": 0}, {"smoothing": 0.25},
                {"periodic": "x,z"}):
        assert isoshell.remesh(path, **how, **QUICKER).digest == digest(Labels(speckled, **how))
    with pytest.raises(isoshell.Error, match="give it to isoshell.Labels"):
        isoshell.remesh(Labels(speckled), background=1, **QUICK)
    with pytest.raises(isoshell.Error, match="smallest_island is for volumes of labels"):
        isoshell.remesh(([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), smallest_island=1, **QUICK)


def test_labels_that_are_not_smoothed_are_the_faces_of_their_voxels(tmp_path):
    steps = np.zeros((12, 12, 12), np.int32)
    steps[2:6, 2:10, 2:10] = 1
    steps[6:10, 2:6, 2:10] = 2
    made = isoshell.remesh(Labels(steps, smoothing=0), vertices=600)
    volumes = {region["label"]: region["volume"] for region in made.report["regions"]["regions"]}
    assert volumes[1] == pytest.approx(256) and volumes[2] == pytest.approx(128)
    for smoothing in (-1, 0.01, 1.5, "0.5", True, None, float("nan")):
        with pytest.raises(isoshell.Error, match="smoothing is"):
            Labels(steps, smoothing=smoothing).save(tmp_path / "refused.vdb")


def test_walls_between_regions_are_those_of_the_voxels(polycrystal):
    regions = polycrystal.report["regions"]
    assert regions["regions_lost"] == regions["walls_lost"] == regions["walls_new"] == []
    padded = np.pad(grains(), 1)
    touching = {(0, 0)}
    for axis in range(3):
        one, other = np.delete(padded, 0, axis), np.delete(padded, -1, axis)
        touching |= set(map(tuple, np.unique(np.sort(np.stack([one.ravel(), other.ravel()], 1), axis=1), axis=0)))
    assert {tuple(wall["labels"]) for wall in regions["walls"]} == {pair for pair in touching if pair[0] != pair[1]}
    isoshell.remesh(Labels(grains()), require="regions,adjacency", **QUICK)
    with pytest.raises(isoshell.Error, match="adjacency: the input has no regions"):
        isoshell.remesh(polycrystal.region(1), require="adjacency", vertices=500, device="cpu")


def test_regions_have_edge_lengths_of_their_own_by_label_and_name():
    labels = Labels(grains(), names={2: "femur"})
    result = isoshell.remesh(labels, edge_length=1.2, region_edge_length={np.int32(1): 0.8, "femur": np.float64(0.7)},
                             device="cpu")
    pairs = result.regions["labels"]
    for label, length in ((1, 0.8), (2, 0.7)):
        faces = result.faces[(pairs == label).any(axis=1) & ((label == 2) | (pairs != 2).all(axis=1))]
        edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
        mean = np.linalg.norm(np.diff(result.vertices[edges], axis=1)[:, 0], axis=1).mean()
        assert abs(mean / length - 1) < 0.1
    assert len(isoshell.remesh(labels, region_edge_length={1: 2.0}, **QUICK).vertices) == 3000
    for lengths, said in (({"tibia": 1}, r"region_edge_length names region 'tibia'.*regions are 1, 2 \(femur\)"),
                          ({1: -1}, "it must be more than 0"), ({1.5: 1}, "a key of region_edge_length is 1.5")):
        with pytest.raises(isoshell.Error, match=said):
            isoshell.remesh(labels, region_edge_length=lengths, **QUICK)


def test_a_field_of_edge_lengths_holds_on_all_walls():
    lengths = np.broadcast_to(np.linspace(0.7, 1.9, N)[:, None, None], (N, N, N))
    result = isoshell.remesh(Labels(grains()), sizing=isoshell.Volume(lengths), device="cpu")
    assert result.report["regions"]["every_region_closed"] and result.report["sizing"]["edge_error_mean"] < 0.15
    pairs = result.regions["labels"]
    for is_inner in (True, False):
        faces = result.faces[(pairs != 0).all(axis=1) == is_inner]
        ends = result.vertices[np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)]
        length, x = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), ends[..., 0].mean(axis=1)
        assert abs(length[x > 20].mean() / length[x < 4].mean() / (1.78 / 0.78) - 1) < 0.2


def test_labels_can_be_pickled():
    assert digest(pickle.loads(pickle.dumps(Labels(grains(12))))) == digest(Labels(grains(12)))


def test_a_file_of_labels_gives_the_command_and_python_the_same_mesh(tmp_path, command, polycrystal):
    affine = np.array([[0.5, 0, 0, 1], [0, 0.5, 0, 2], [0, 0.25, 1, 3], [0, 0, 0, 1]])
    labels = Labels(grains(), affine=affine, names={1: "ferrite", 3: "pearlite"})
    labels.save(tmp_path / "grains.vdb")
    made = isoshell.remesh(labels, **QUICK)
    read = isoshell.remesh(tmp_path / "grains.vdb", **QUICK)
    assert read.digest == made.digest and read.region_names == {1: "ferrite", 3: "pearlite"}
    assert np.array_equal(read.regions["labels"], made.regions["labels"])
    done = command(tmp_path / "grains.vdb", tmp_path / "grains.ply", "--vertices", 3000, "--device", "cpu", "--stats",
                   tmp_path / "stats.json", "--require", "regions")
    assert done.returncode == 0, done.stderr
    stats = json.loads((tmp_path / "stats.json").read_text())
    assert len(stats["regions"]["regions"]) == 5
    made.save(tmp_path / "python.ply")
    assert (tmp_path / "python.ply").read_bytes() == (tmp_path / "grains.ply").read_bytes()
    with pytest.raises(isoshell.Error) as caught:
        labels.save(tmp_path / "grains.vdb")
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT
    labels.save(tmp_path / "grains.vdb", overwrite=True)


def test_regions_are_split_into_files_of_their_own(tmp_path, polycrystal):
    result = isoshell.remesh(Labels(grains(), names={1: "ferrite", 3: "a/b c"}), output=tmp_path / "all.off",
                             split_regions=tmp_path / "parts", **QUICK)
    files = sorted(path.name for path in (tmp_path / "parts").iterdir())
    assert files == ["2.off", "4.off", "5.off", "a_b_c.off", "ferrite.off"]
    info = isoshell.mesh_info(tmp_path / "parts/a_b_c.off", require="closed")
    assert info["topology"]["triangles"] == len(result.region(3).faces)


def test_a_file_of_a_region_that_is_there_is_found_before_the_work(tmp_path):
    (tmp_path / "2.ply").write_text("precious")
    with pytest.raises(isoshell.Error, match="2.ply: exists already") as caught:
        isoshell.remesh(Labels(grains()), split_regions=tmp_path, **QUICK)
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT
    assert [path.name for path in tmp_path.iterdir()] == ["2.ply"]
    isoshell.remesh(Labels(grains()), split_regions=tmp_path, force=True, **QUICK)
    assert len(list(tmp_path.iterdir())) == 5 and (tmp_path / "2.ply").read_bytes()[:4] == b"ply\n"


def test_surfaces_without_regions_are_not_split(tmp_path, ball):
    with pytest.raises(isoshell.Error, match="split_regions is for volumes of labels"):
        isoshell.remesh(ball, vertices=100, split_regions=tmp_path / "parts", device="cpu")
    assert not (tmp_path / "parts").exists()
    with pytest.raises(isoshell.Error, match="split_regions"):
        isoshell.remesh_many([ball], split_regions=tmp_path)


def test_a_result_that_is_a_source_keeps_its_regions_and_their_names(tmp_path, polycrystal):
    again = isoshell.remesh(polycrystal, vertices=1000, device="cpu")
    assert again.report["regions"]["every_region_closed"] and again.region_names == polycrystal.region_names
    assert np.unique(again.regions["labels"]).tolist() == [0, 1, 2, 3, 4, 5]


def test_frames_of_labels_have_regions_and_are_not_split(tmp_path):
    moving = [Labels(np.roll(grains(), step, axis=0)) for step in range(3)]
    frames = isoshell.remesh_sequence(moving, vertices=1000, device="cpu")
    assert [frame.report["regions"]["every_region_closed"] for frame in frames] == [True] * 3
    with pytest.raises(isoshell.Error, match="split_regions is for one frame"):
        isoshell.remesh_sequence([Labels(grains())], split_regions=tmp_path)


def test_a_stage_of_usd_of_labels_has_subsets_and_files_of_regions_beside_it(tmp_path):
    pytest.importorskip("pxr")
    isoshell.remesh(Labels(grains(), origin=(1, 2, 3)), output=tmp_path / "grains.usda", split_regions=tmp_path / "parts",
                    **QUICK)
    assert "region_1_0" in (tmp_path / "grains.usda").read_text()
    assert sorted(path.name for path in (tmp_path / "parts").iterdir()) == [f"{label}.ply" for label in range(1, 6)]


@pytest.mark.parametrize("last_has_regions", [True, False])
def test_a_sequence_as_a_stage_of_usd_has_subsets_at_every_frame(tmp_path, ball, last_has_regions):
    usd, geom = pytest.importorskip("pxr.Usd"), pytest.importorskip("pxr.UsdGeom")
    merged = np.where(grains() == 5, 1, grains())  # one region fewer, and fewer walls
    sources = [Labels(merged, names={2: "iron"}), Labels(grains(), names={2: "iron"}),
               Labels(merged) if last_has_regions else ball]
    made = list(isoshell.remesh_sequence(sources, output=tmp_path / "out.usda", vertices=800, device="cpu"))
    stage = usd.Stage.Open(str(tmp_path / "out.usda"))
    mesh = next(geom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(geom.Mesh))
    subsets = {tuple(subset.GetPrim().GetCustomDataByKey("isoshell:regions")): subset
               for subset in geom.Subset.GetGeomSubsets(mesh, "face", "regions")}
    assert subsets[2, 0].GetPrim().GetName() == "region_iron_0" and (1, 5) in subsets
    for result in made:
        pairs = result.regions["labels"]
        for pair, subset in subsets.items():
            faces = np.array(subset.GetIndicesAttr().Get(result.frame), np.int32)
            assert np.array_equal(faces, np.flatnonzero((pairs == pair).all(axis=1)))
    assert set(map(tuple, made[1].regions["labels"].tolist())) == set(subsets)
    assert geom.Subset.GetFamilyType(mesh, "regions") == ("partition" if last_has_regions else "nonOverlapping")
    assert geom.Subset.ValidateFamily(mesh, "face", "regions")[0]


def test_the_certificate_has_distances_from_the_walls(polycrystal):
    distance = polycrystal.report["distance"]
    assert 0 < distance["to_input_max"] < 1 and 0 < distance["from_input_max"] < 1
    with pytest.raises(isoshell.Error, match="max-deviation") as caught:
        isoshell.remesh(Labels(grains()), require="max-deviation=0.001", **QUICK)
    assert caught.value.code == ErrorCode.GATE_FAILED
