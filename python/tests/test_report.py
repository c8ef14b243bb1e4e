"""The page of a run: what it says, and when there is none."""

import html
import json
import os
import re
import subprocess
import sys
from types import SimpleNamespace

import isoshell
import numpy as np
import pytest
from conftest import make_box, write_obj
from isoshell import ErrorCode

pytest.importorskip("k3d", reason="a report needs k3d: pip install 'isoshell[report]'")

pytestmark = pytest.mark.filterwarnings("ignore::isoshell.RunWarning")
SMALL = {"vertices": 150, "resolution": 32}


def json_of(text, name):
    return json.loads(re.search(rf'<script type="application/json" id="{name}">(.*?)</script>', text, re.S)[1])


def words_of(text):
    """What a person reads."""
    body = re.sub(r"<(script|style)\b.*?</\1>", "", text, flags=re.S)
    return html.unescape(re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", body)))


@pytest.fixture(scope="module")
def holed(ball):
    """A ball without its northern cap."""
    vertices, faces = ball
    return vertices, faces[vertices[faces][:, :, 2].max(axis=1) < 0.95]


@pytest.fixture(scope="module")
def page(tmp_path_factory, holed):
    path = tmp_path_factory.mktemp("report") / "holed.html"
    isoshell.report(isoshell.remesh(holed, stats=True, require="closed,genus=0", **SMALL), path, source=holed)
    return path.read_text()


def test_the_page_is_one_file_that_asks_for_no_other(page):
    assert len(page) < 8e6
    before_scripts = re.sub(r"<script\b.*?</script>", "", page, flags=re.S)
    assert not re.search(r'(src|href)="(?!data:|https://k3d-jupyter.org")', before_scripts)
    assert "default-src 'none'" in page and "{{" not in before_scripts


def test_it_shows_both_meshes_and_the_numbers_of_the_run(page, holed):
    data, words = json_of(page, "data"), words_of(page)
    assert set(data["sides"]) == {"before", "after"}
    counts = f"{len(np.unique(holed[1]))} vertices, {len(holed[1])} triangles"
    assert f"Before (vertices, faces): {counts}" in words.replace("\u202f", "")
    for expected in ("Remeshed to 150 vertices", "Closed 2-manifold", "No self-intersections", "genus=0",
                     "holes capped 1", "Distance between", "All statistics"):
        assert expected in words, expected


def test_distances_name_what_they_are_to_and_are_all_to_the_same(page, holed, tmp_path):
    within = re.compile(r"Within (\S+) % of the diagonal of (the input as it was read|the repaired input)")
    percent, reference = within.search(words_of(page)).groups()
    assert reference == "the input as it was read"
    largest = float(json_of(page, "data")["largest"])
    diagonal = np.linalg.norm(np.ptp(holed[0][np.unique(holed[1])], axis=0))
    assert largest * 0.999 <= float(percent) / 100 * diagonal < 0.52  # vertices alone; the middle of the cap
    assert "Distance between the result and the input as it was read" in words_of(page)
    assert "Farthest from the input as it was read" in words_of(page)
    result = isoshell.remesh(holed, stats=True, **SMALL)
    isoshell.report(result, tmp_path / "alone.html")
    alone = within.search(words_of((tmp_path / "alone.html").read_text()))
    assert alone[2] == "the repaired input" and float(alone[1]) < float(percent)  # the cap is no distance from that


@pytest.mark.parametrize("path, up", [("scan.ply", "z"), ("part.STL", "z"), ("a.b/tree.obj", "y"), ("car.glb", "y"),
                                      ("fluid.vdb:surface", "y"), ("points.xyz", "z")])
def test_the_axis_that_is_up_is_that_of_the_format(path, up):
    assert up_axis_of(path, None) == up


def test_the_axis_that_is_up_is_what_a_scene_says():
    assert up_axis_of("scene.usd", SimpleNamespace(up_axis="Z")) == "z"
    assert up_axis_of("scene.usd", SimpleNamespace(up_axis="Y")) == "y"


def up_axis_of(path, origin):
    from isoshell._report._page import _up_axis

    return _up_axis(SimpleNamespace(origin=origin, report={"input": {"path": path}, "options": {}}))


def test_regions_shut_in_others_are_pulled_out_of_them(tmp_path):
    labels = np.zeros((18, 18, 18), np.uint8)
    labels[1:17, 1:17, 1:17], labels[4:14, 4:14, 4:14], labels[7:11, 7:11, 7:11] = 1, 2, 3
    source = isoshell.Labels(labels)
    isoshell.report(isoshell.remesh(source, vertices=600), tmp_path / "page.html", source=source)
    ways = np.array([region["away"] for region in json_of((tmp_path / "page.html").read_text(), "data")["regions"]])
    assert np.allclose(ways[0], 0, atol=0.05) and np.allclose(ways[:, 1:], 0, atol=0.05)
    assert ways[1, 0] > 0.8 and ways[2, 0] > ways[1, 0] + 0.4  # the widths of what is around, of 1 in all


def test_places_are_where_things_happened(page):
    data, words = json_of(page, "data"), words_of(page)
    assert "Open borders of the input that were closed 1" in words and "Gaps bridged 1" in words
    assert page.count("data-place=") == len(data["places"])
    top = data["box"][2]
    gap = data["places"][0]  # of 1: positions are parts of the longest side, and the hole is around the north pole
    assert gap["at"][2] > 0.95 * top and gap["from"][2] > 0.9
    assert all(np.isclose(np.linalg.norm(place["from"]), 1) and place["distance"] > 0 for place in data["places"])


def test_a_place_is_seen_from_where_nothing_is_between():
    from isoshell._report._sight import FAR_ENOUGH, clear_sight
    from isoshell._report._surface import Surface

    square = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    faces = np.array([(0, 1, 2), (0, 2, 3)])
    floor = Surface(square, faces)
    roof = square * 0.8 + [0.1, 0.1, 1]
    roofed = Surface(np.concatenate([square, roof]), np.concatenate([faces, faces[:, ::-1] + 4]))
    middle = np.array([0.5, 0.5, 0])
    above, distance = clear_sight(middle, 1, {"after": floor})
    assert np.allclose(above, [0, 0, 1]) and distance == FAR_ENOUGH
    aside, distance = clear_sight(middle, 1, {"after": roofed})
    assert 0.5 < aside[2] < 0.8 and np.isclose(np.linalg.norm(aside), 1) and distance == FAR_ENOUGH
    shut_in = Surface(*joined_box())
    _, distance = clear_sight(np.array([0.5, 0.5, 0.01]), 1, {"after": shut_in})
    assert 0.3 < distance < 1.2


def joined_box():
    """Around the square of size 1, faces inward."""
    vertices, quads = make_box()
    return vertices, quads[:, [0, 2, 1, 0, 3, 2]].reshape(-1, 3)


def test_everything_that_statistics_place_can_be_gone_to(tmp_path, ball):
    result = isoshell.remesh(ball, **SMALL)
    at, report = [0.0, 0.0, 1.0], result.report
    report["topology"].update(self_intersections=3, intersection_at=at)
    report["features"].update(lost_curves=1, lost=[{"index": 7, "kind": "crease", "length": 0.5, "at": at, "reason": "too short"}])
    report["quality"].update(below_30_deg=2, poor_angles=[{"degrees": 21.5, "at": at}, {"degrees": 11.5, "at": at}])
    report["input"]["united"].update(not_joined="crosses itself", not_joined_at=at)
    isoshell.report(result, tmp_path / "page.html", source=ball)
    words = words_of((tmp_path / "page.html").read_text())
    for expected in ("Self-intersections of the result 3 the first of 3 pairs",
                     "Curves that were lost 1 crease, 0.5 long: too short", "Poor angles 2 11.5° 21.5°",
                     "Parts that were not united 1 crosses itself", "3 pairs of triangles intersecting",
                     "1 curve lost"):
        assert expected in words, expected


def test_a_run_that_measured_nothing_has_a_page(tmp_path, ball):
    isoshell.report(isoshell.remesh(ball, quiet=True, **SMALL), tmp_path / "page.html", source=ball)
    assert "Farthest from the input" in words_of((tmp_path / "page.html").read_text())


def test_pieces_that_the_result_leaves_out_are_listed(tmp_path, ball):
    vertices, faces = ball
    both = np.concatenate([vertices, 0.02 * vertices + [1.6, 0, 0]]), np.concatenate([faces, faces + len(vertices)])
    result = isoshell.remesh(ball, **SMALL)  # as one that has dropped the small ball
    isoshell.report(result, tmp_path / "page.html", source=both)
    expected = f"Pieces of the input that are not in the result 1 {len(faces)} faces, 0.59"
    assert expected in words_of((tmp_path / "page.html").read_text())


def test_a_missed_requirement_is_marked(tmp_path, ball):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.remesh(ball, require=["closed", "genus=3"], report=tmp_path / "missed.html", **SMALL)
    assert caught.value.code == ErrorCode.GATE_FAILED
    text = (tmp_path / "missed.html").read_text()
    assert 'missed"></td><td class="text">genus=3: the mesh has 0' in text
    assert 'met"></td><td class="text">closed' in text


def test_the_option_of_remesh_writes_the_page_of_the_function(tmp_path, ball):
    source = write_obj(tmp_path / "ball.obj", *ball)
    by_option, by_function = tmp_path / "option.html", tmp_path / "function.html"
    result = isoshell.remesh(source, report=by_option, **SMALL)
    isoshell.report(result, by_function)
    assert result.report["distance"] is not None  # measured without being asked for
    assert by_option.read_bytes() == by_function.read_bytes()
    assert "Before ball.obj" in words_of(by_option.read_text())


@pytest.mark.parametrize("name, source", [
    ("volume", isoshell.Volume(np.linalg.norm(np.indices((24, 24, 24)) - 11.5, axis=0) - 8)),
    ("far away", "far"),
])
def test_sources_of_memory_are_shown_when_they_are_given(tmp_path, ball, name, source):
    source = (ball[0] + 1e6, ball[1]) if source == "far" else source
    result = isoshell.remesh(source, **SMALL)
    isoshell.report(result, tmp_path / "alone.html")
    isoshell.report(result, tmp_path / "both.html", source=source)
    assert set(json_of((tmp_path / "alone.html").read_text(), "data")["sides"]) == {"after"}
    assert set(json_of((tmp_path / "both.html").read_text(), "data")["sides"]) == {"before", "after"}


def test_a_stage_file_shows_the_surface_that_it_holds(tmp_path, ball):
    isoshell.remesh(ball, output=tmp_path / "shell.vdb", stop_after="shell", **SMALL)
    isoshell.remesh(tmp_path / "shell.vdb", report=tmp_path / "page.html", vertices=150)
    assert "shell.vdb, the surface it holds" in words_of((tmp_path / "page.html").read_text())


def test_names_of_files_are_text(tmp_path, ball):
    name = "<img src=x onerror=alert(1)> & {{js}}.obj"
    result = isoshell.remesh(write_obj(tmp_path / name, *ball), **SMALL)
    isoshell.report(result, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    assert "<img" not in text.split('<script type="application/json"')[0] and html.escape(name) in text


@pytest.mark.parametrize("name", ["<!--<script>", "</script>", "<!--"])
def test_a_name_that_begins_a_script_or_a_comment_is_text(tmp_path, name):
    vertices, faces = make_box()
    path = tmp_path / "boxes.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in np.concatenate([vertices, vertices + [1, 0, 0]]).tolist()]
    for group, first in ((name, 1), ("plain", 1 + len(vertices))):
        lines += [f"g {group}"] + ["f " + " ".join(str(corner + first) for corner in face) for face in faces.tolist()]
    path.write_text("\n".join(lines) + "\n")
    isoshell.remesh(path, vertices=300, regions="groups", report=tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    # As a browser reads it: a script that holds <!-- and <script goes on behind the next </script>.
    of_data = re.findall(r'<script type="[a-z/]+" id="\w+">(.*?)</script>', text, re.S)
    assert of_data and not any("<" in content for content in of_data)
    assert {region["words"].rsplit(" (", 1)[0] for region in json_of(text, "data")["regions"]} >= {name, "plain"}


def test_a_page_that_is_there_stays_unless_it_may_be_replaced(tmp_path, ball):
    path = tmp_path / "page.html"
    path.write_text("mine")
    result = isoshell.remesh(ball, **SMALL)
    for write in (lambda: isoshell.report(result, path), lambda: isoshell.remesh(ball, report=path, **SMALL)):
        with pytest.raises(isoshell.Error) as caught:
            write()
        assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT
    assert path.read_text() == "mine"
    isoshell.report(result, path, overwrite=True)
    isoshell.remesh(ball, report=path, force=True, **SMALL)
    assert path.read_text().startswith("<!doctype html>")
    assert os.listdir(tmp_path) == ["page.html"]


def test_a_folder_that_is_not_there_is_named(tmp_path, ball):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.report(isoshell.remesh(ball, **SMALL), tmp_path / "no" / "page.html")
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT and "page.html" in str(caught.value)


def test_a_report_needs_a_mesh_and_a_file(ball):
    for options in ({"stop_after": "shell", "output": "out.vdb"}, {"report": "-"}):
        with pytest.raises(isoshell.Error) as caught:
            isoshell.remesh(ball, **{"report": "page.html", **options})
        assert caught.value.code == ErrorCode.USAGE and "report" in str(caught.value)


def test_without_k3d_the_remedy_is_named_before_the_run(tmp_path, ball, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(isoshell.Error, match=r"pip install 'isoshell\[report\]'"):
        isoshell.remesh(ball, report=tmp_path / "page.html", output=tmp_path / "out.ply", **SMALL)
    assert not os.listdir(tmp_path)


def test_the_script_writes_the_page_and_the_command_says_who_does(tmp_path, ball, command):
    source = write_obj(tmp_path / "ball.obj", *ball)
    words = [source, tmp_path / "out.ply", "--vertices", 150, "--resolution", 32, "--report", tmp_path / "page.html"]
    run = [sys.executable, "-m", "isoshell", *map(str, words)]
    done = subprocess.run(run, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    isoshell.remesh(source, report=tmp_path / "module.html", **SMALL)
    sides = [json_of((tmp_path / name).read_text(), "data") for name in ("page.html", "module.html")]
    assert sides[0] == sides[1]
    again = subprocess.run(run, capture_output=True, text=True)
    assert again.returncode == ErrorCode.UNWRITABLE_OUTPUT and "--force" in again.stderr
    if os.environ.get("VDB_ISOMESH"):
        refused = command(*words, "--force")
        assert refused.returncode == ErrorCode.USAGE and "pip install 'isoshell[report]'" in refused.stderr


def test_names_of_options_and_requirements_are_marked_so_that_no_line_breaks_them():
    from isoshell._report._tables import gates, warnings

    told = warnings({"warnings": ["<a> was closed; --close-gaps 0 leaves it, --features off, too"]})
    assert told.count('<span class="name">') == 2 and '<span class="name">--close-gaps</span> 0' in told
    assert "&lt;a&gt; was" in told
    asked = gates(["closed", "min-angle=30"], ["min-angle: 2.5, a-well-known fault"])
    assert asked.count('<span class="name">') == 1 and '<span class="name">min-angle</span>: 2.5' in asked


def test_thinning_keeps_the_worst_values():
    from isoshell._report._surface import Surface, thinned

    side = 60
    x, y = np.meshgrid(np.arange(side + 1.0), np.arange(side + 1.0), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros((side + 1) ** 2)])
    a = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    b = a + side + 1
    faces = np.concatenate([np.column_stack([a, b, a + 1]), np.column_stack([a + 1, b, b + 1])])
    poor = np.zeros(len(vertices))
    poor[1234] = 7
    sliver = np.zeros(len(faces))
    sliver[2345] = 9
    border = np.array([[0, 1], [1, 2], [2, 3], [3, 4]])
    whole = Surface(vertices, faces, {"deviation": poor}, {"poorness": sliver}, {"border": border})
    few = thinned(whole, 1000)
    assert 500 < len(few.faces) <= 1000 and len(few.vertices) < 600
    worst = few.of_vertices["deviation"].argmax()
    assert few.of_vertices["deviation"][worst] == 7 and (few.of_vertices["deviation"] > 0).sum() == 1
    assert np.linalg.norm(few.vertices[worst] - vertices[1234]) < 4
    worst = few.vertices[few.faces[few.of_faces["poorness"] == 9]].mean(axis=(0, 1))
    assert np.linalg.norm(worst - vertices[faces[2345]].mean(axis=0)) < 4
    assert (few.of_faces["poorness"] > 0).mean() < 0.05
    assert thinned(whole, 10**6) is whole


def test_what_is_measured_for_the_page_agrees_with_the_statistics(ball):
    from isoshell._report._surface import Edges, Surface, angles_deg, face_quality

    result = isoshell.remesh(ball, **SMALL)
    surface = Surface(result.vertices, result.faces.astype(np.int64))
    quality = result.report["quality"]
    assert np.isclose(face_quality(surface).min(), quality["q_min"]) and np.isclose(
        face_quality(surface).mean(), quality["q_avg"])
    assert np.isclose(angles_deg(surface).min(), quality["theta_min_deg"])
    valence = Edges.of(surface).valence(len(surface.vertices))
    assert np.isclose((valence != 6).mean(), quality["irregular_ratio"])


def test_distances_are_those_to_the_nearest_point(box):
    vertices, quads = box
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    points = np.array([(0.5, 0.5, 0.5), (2, 0.5, 0.5), (2, 2, 0.5), (0.25, 0, 0.5), (0.5, 0.1, 0.5)])
    found = isoshell._isoshell.distances(points, vertices, faces)
    assert np.allclose(found, [0.5, 1, np.sqrt(2), 0, 0.1])


def test_the_numbers_below_a_curve_are_evenly_apart_and_begin_at_the_first():
    from isoshell._report._charts import curve

    for count in range(2, 40):
        axis = re.findall(r'<text x="[0-9.]+" y="159" text-anchor="\w+">(\d+)</text>', curve("", "", range(count)))
        numbers = [int(number) for number in axis]
        assert numbers[0] == 1 and 2 <= len(numbers) <= 6 and len(set(np.diff(numbers))) == 1
