"""Arrays of every type, order and make; what cannot be one is refused by the argument's name."""

import isoshell
import numpy as np
import pytest
from isoshell import ErrorCode

SMALL = {"vertices": 60, "resolution": 24}


class Dlpack:
    """Numbers that give themselves by DLPack alone, as tensors do."""

    def __init__(self, array, device=1):
        self.array = np.ascontiguousarray(array)
        self.device = device

    def __dlpack__(self, **keywords):
        return self.array.__dlpack__(**keywords)

    def __dlpack_device__(self):
        return self.device, 0 if self.device == 1 else 99


@pytest.fixture(scope="module")
def expected(ball):
    return isoshell.remesh(ball, **SMALL).digest


def in_the_middle(array):
    wide = np.zeros((2 * array.shape[0], 7), array.dtype)
    wide[::2, 1:7:2] = array
    return wide[::2, 1:7:2]


MAKES = {
    "C order": np.ascontiguousarray,
    "Fortran order": np.asfortranarray,
    "view with strides": in_the_middle,
    "negative strides": lambda a: np.ascontiguousarray(a[::-1, ::-1])[::-1, ::-1],
    "read-only": lambda a: np.broadcast_to(a, a.shape),
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "not aligned": lambda a: np.frombuffer(b"x" + a.tobytes(), np.uint8)[1:].view(a.dtype).reshape(a.shape),
    "list": lambda a: a.tolist(),
    "DLPack": Dlpack,
    "memoryview": lambda a: memoryview(np.ascontiguousarray(a)),
}


@pytest.mark.parametrize("make", MAKES)
def test_the_mesh_is_the_same_however_its_arrays_lie(ball, expected, make):
    vertices, faces = ball
    assert isoshell.remesh((MAKES[make](vertices), MAKES[make](faces)), **SMALL).digest == expected


@pytest.mark.parametrize("kind", ["int16", "int32", "int64", "uint16", "uint32", "uint64"])
def test_faces_may_be_of_any_whole_type(ball, expected, kind):
    assert isoshell.remesh((ball[0], ball[1].astype(kind)), **SMALL).digest == expected


@pytest.mark.parametrize("kind", ["float16", "float32", "longdouble", "int32"])
def test_vertices_of_other_types_are_those_numbers_as_double(ball, kind):
    vertices = (ball[0] * 100).astype(kind)
    same = isoshell.remesh((vertices.astype(np.float64), ball[1]), **SMALL).digest
    assert isoshell.remesh((vertices, ball[1]), **SMALL).digest == same


def test_the_arrays_given_are_not_changed(ball):
    vertices, faces = ball[0].copy(), ball[1].copy()
    isoshell.remesh((vertices, faces), **SMALL)
    assert np.array_equal(vertices, ball[0]) and np.array_equal(faces, ball[1])


def refusal(source, **options):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.remesh(source, **SMALL, **options)
    return caught.value.code, str(caught.value)


VERTICES = np.zeros((3, 3))
FACES = np.array([[0, 1, 2]])


@pytest.mark.parametrize("vertices, faces, name, code", [
    (np.zeros((3, 2)), FACES, "vertices", ErrorCode.USAGE),
    (np.zeros(9), FACES, "vertices", ErrorCode.USAGE),
    (np.zeros((1, 3, 3)), FACES, "vertices", ErrorCode.USAGE),
    (np.float64(3), FACES, "vertices", ErrorCode.USAGE),
    (np.zeros((3, 3), complex), FACES, "vertices", ErrorCode.USAGE),
    (np.zeros((3, 3), bool), FACES, "vertices", ErrorCode.USAGE),
    (np.full((3, 3), "a"), FACES, "vertices", ErrorCode.USAGE),
    ([[0, 0], [1]], FACES, "vertices", ErrorCode.USAGE),
    (None, FACES, "vertices", ErrorCode.USAGE),
    (object(), FACES, "vertices", ErrorCode.USAGE),
    (np.zeros((3, 3), "datetime64[s]"), FACES, "vertices", ErrorCode.USAGE),
    (Dlpack(VERTICES, device=2), FACES, "vertices lies in the memory of a device", ErrorCode.USAGE),
    (VERTICES, Dlpack(FACES, device=2), "faces lies in the memory of a device", ErrorCode.USAGE),
    (Dlpack(VERTICES, device=2), FACES, "tensor.cpu()", ErrorCode.USAGE),
    (Dlpack(VERTICES, device=10), FACES, "kind 10", ErrorCode.USAGE),
    (VERTICES, np.zeros((1, 2), int), "faces", ErrorCode.USAGE),
    (VERTICES, np.zeros((1, 1, 3), int), "faces", ErrorCode.USAGE),
    (VERTICES, FACES.astype(float), "faces", ErrorCode.USAGE),
    (VERTICES, FACES.astype(bool), "faces", ErrorCode.USAGE),
    (VERTICES, None, "faces", ErrorCode.USAGE),
    (VERTICES, [[0, 1, 2], [0, 1, "a", 2]], "faces", ErrorCode.USAGE),
    (VERTICES, np.array([[0, 1, 3]]), "faces[0, 2] is 3", ErrorCode.UNREADABLE_INPUT),
    (VERTICES, np.array([[0, 1, 2], [0, -1, 2]]), "faces[1, 1] is -1", ErrorCode.UNREADABLE_INPUT),
    (VERTICES, np.array([[0, 1, 2**32]]), "faces[0, 2] is 4294967296", ErrorCode.UNREADABLE_INPUT),
    (VERTICES, np.array([[0, 1, 2**64 - 1]], np.uint64), "faces[0, 2] is 18446744073709551615",
     ErrorCode.UNREADABLE_INPUT),
    (VERTICES, np.array([3, 0, 1]), "faces[0] is 3", ErrorCode.USAGE),
    (VERTICES, np.array([-1, 0, 1]), "faces[0] is -1", ErrorCode.USAGE),
    (VERTICES, [[0, 1, 2], [0, 1, 2, 9]], "faces[6] is 9", ErrorCode.UNREADABLE_INPUT),
    (VERTICES, np.array([4, 0, 1, 2, 9]), "faces[3] is 9", ErrorCode.UNREADABLE_INPUT),
])
def test_what_is_no_mesh_is_refused_by_the_name_of_the_argument(vertices, faces, name, code):
    found, message = refusal((vertices, faces))
    assert name in message and found == code


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_vertex_that_is_not_finite_is_refused_by_its_place(ball, value):
    vertices = ball[0].copy()
    vertices[5, 1] = value
    code, message = refusal((vertices, ball[1]))
    assert code == ErrorCode.UNREADABLE_INPUT and "vertex 5" in message and "(vertices, faces)" in message


@pytest.mark.parametrize("vertices, faces", [
    (np.zeros((0, 3)), np.zeros((0, 3), int)),
    (VERTICES, np.zeros((0, 3), int)),
    (VERTICES, np.zeros((0, 4), int)),
    (VERTICES, FACES),
    (VERTICES, np.zeros((5, 3), int)),
])
def test_without_a_triangle_that_has_area_there_is_nothing_to_mesh(vertices, faces):
    assert refusal((vertices, faces))[0] == ErrorCode.NOTHING_TO_MESH


@pytest.mark.parametrize("source", [
    None, 7, object(), (), ([1],), ([1], [2], [3]), {"vertices": 1}, b"path", [], np.zeros(3)])
def test_what_is_no_source_is_refused(source):
    code, message = refusal(source)
    assert code in (ErrorCode.USAGE, ErrorCode.UNREADABLE_INPUT) and message


def test_numbers_at_random_never_crash():
    random = np.random.default_rng(1)
    for _ in range(60):
        vertices = random.choice([0.0, 1.0, -1.0, 1e300, 1e-300, 0.5], (random.integers(0, 8), 3))
        faces = random.integers(0, max(1, len(vertices)), (random.integers(0, 12), random.integers(3, 5)))
        try:
            isoshell.remesh((vertices, faces), vertices=8, resolution=8)
        except isoshell.Error as error:
            assert error.code != ErrorCode.INTERNAL, str(error)
