# SPDX-License-Identifier: Apache-2.0
"""What a mesh of Blender has beside its positions, as arrays."""

from dataclasses import dataclass

import numpy as np

# Of each type of attribute that can be carried: the member of its elements, how many numbers it is, and their type.
KINDS = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
    "QUATERNION": ("value", 4, np.float32),
}
OF_BLENDER = {"position", "sharp_face", "material_index", "sharp_edge", "custom_normal"}  # with a meaning of their own


@dataclass
class Layer:
    """An attribute: a row of numbers for each element of its domain."""

    name: str
    kind: str
    domain: str
    rows: np.ndarray


def read(collection, member, shape, kind=np.float32):
    values = np.empty(shape, kind)
    collection.foreach_get(member, values.reshape(-1))
    return values


def uv_layers(mesh):
    """(name, (L, 2) of corners) each."""
    return [(layer.name, read(layer.uv, "vector", (len(mesh.loops), 2))) for layer in mesh.uv_layers]


def layers_of(mesh):
    """The attributes that can be carried, but for texture coordinates, and the names of those that cannot."""
    taken, left_out = [], []
    uv_names = {layer.name for layer in mesh.uv_layers}
    for attribute in mesh.attributes:
        name = attribute.name
        if name in OF_BLENDER or name in uv_names or attribute.is_internal or name.startswith("."):
            continue
        if attribute.domain == "EDGE" or attribute.data_type not in KINDS:
            left_out.append(name)
            continue
        member, size, kind = KINDS[attribute.data_type]
        rows = read(attribute.data, member, (len(attribute.data), size), kind)
        taken.append(Layer(name, attribute.data_type, attribute.domain, rows))
    return taken, left_out


def at_vertices(layer, corners, vertex_count):
    """A layer of corners as one of vertices: the mean of the corners of each, and whether they differ anywhere."""
    of_each = np.maximum(np.bincount(corners, minlength=vertex_count), 1)
    rows = np.stack([np.bincount(corners, column, vertex_count) / of_each for column in layer.rows.T], axis=1)
    differ = bool((np.abs(rows[corners] - layer.rows) > 1 / 255).any())
    return Layer(layer.name, layer.kind, "POINT", rows.astype(np.float32)), differ


def write(mesh, layer):
    member, _, kind = KINDS[layer.kind]
    attribute = mesh.attributes.new(layer.name, layer.kind, layer.domain)
    rows = np.rint(layer.rows) if np.issubdtype(kind, np.integer) else layer.rows > 0.5 if kind is bool else layer.rows
    attribute.data.foreach_set(member, np.ascontiguousarray(rows, kind).reshape(-1))


def group_weights(mesh, count):
    """Of each of that many vertex groups the weights of all vertices."""
    weights = np.zeros((count, len(mesh.vertices)), np.float32)
    if count:
        for i, vertex in enumerate(mesh.vertices):
            for element in vertex.groups:
                if element.group < count:
                    weights[element.group, i] = element.weight
    return weights


def write_group(group, weights):
    """Vertices of one weight are given it together."""
    held = np.flatnonzero(weights > 1e-6)
    held = held[np.argsort(weights[held], kind="stable")]
    begins = np.flatnonzero(np.diff(weights[held], prepend=-1))
    indices, begins, of_each = held.tolist(), begins.tolist(), weights[held[begins]].tolist()
    for begin, end, weight in zip(begins, [*begins[1:], len(indices)], of_each):
        group.add(indices[begin:end], weight, "REPLACE")
