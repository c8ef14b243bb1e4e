#!/usr/bin/env python3
"""One mesh as glTF files of many kinds, and whether each is meshed as the same bytes as from a PLY file.

    bench/gltf_files.py VDB_ISOMESH FOLDER MESH...

Writes FOLDER/MESH/KIND.glb and mesh.ply, all with the same positions in single precision, meshes each of them to 4000
vertices and prints which results differ. `far` stands 10^6 away and is only written. Needs numpy and trimesh.
"""
import json
import pathlib
import struct
import subprocess
import sys

import numpy as np
import trimesh

FLOAT, U8, U16, U32 = 5126, 5121, 5123, 5125
TYPES = {U8: np.uint8, U16: np.uint16, U32: np.uint32}


class File:
    """A .glb file of one mesh."""

    def __init__(self):
        self.bytes, self.views, self.accessors, self.primitives = bytearray(), [], [], []

    def view(self, data, **more):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.views.append(dict(buffer=0, byteOffset=len(self.bytes), byteLength=len(data), **more))
        self.bytes += data
        return len(self.views) - 1

    def accessor(self, component, count, kind, **more):
        self.accessors.append(dict(componentType=component, count=int(count), type=kind, **more))
        return len(self.accessors) - 1

    def positions(self, v, values=None, **more):
        if values is not None:
            more["bufferView"] = self.view(values.astype("<f4").tobytes())
        return self.accessor(FLOAT, len(v), "VEC3", min=v.min(0).tolist(), max=v.max(0).tolist(), **more)

    def sparse(self, v, which):
        return dict(count=len(which), values=dict(bufferView=self.view(v[which].tobytes())),
                    indices=dict(bufferView=self.view(which.astype("<u4").tobytes()), componentType=U32))

    def indices(self, f, component=U32):
        view = self.view(f.astype(TYPES[component]).tobytes())
        return self.accessor(component, f.size, "SCALAR", bufferView=view)

    def primitive(self, position, indices=None, attributes={}, **more):
        if indices is not None:
            more["indices"] = indices
        self.primitives.append(dict(attributes=dict(POSITION=position, **attributes), **more))
        return self

    def write(self, path, nodes=None):
        doc = dict(asset=dict(version="2.0"), scene=0, scenes=[dict(nodes=[0])], nodes=nodes or [dict(mesh=0)],
                   meshes=[dict(primitives=self.primitives)], accessors=self.accessors, bufferViews=self.views,
                   buffers=[dict(byteLength=len(self.bytes))])
        text = json.dumps(doc).encode()
        text += b" " * (-len(text) % 4)
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        with open(path, "wb") as out:
            out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.bytes)))
            out.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
            out.write(struct.pack("<II", len(self.bytes), 0x004E4942) + self.bytes)


def plain(v, f):
    file = File()
    return file.primitive(file.positions(v, v), file.indices(f))


def parts(v, f, component):
    """Faces in order, in primitives of no more vertices than the width of indices can name."""
    file, most, start = File(), int(np.iinfo(TYPES[component]).max), 0
    while start < len(f):
        count = min(most // 3, len(f) - start)
        used = np.unique(f[start:start + count])
        file.primitive(file.positions(v[used], v[used]),
                       file.indices(np.searchsorted(used, f[start:start + count]), component))
        start += count
    return file


def sparse(v, f, which, base):
    file = File()
    return file.primitive(file.positions(v, base, sparse=file.sparse(v, which)), file.indices(f))


def interleaved(v, f):
    rows = np.zeros(len(v), [("position", "<f4", 3), ("uv", "<u2", 2), ("color", "u1", 4)])
    rows["position"] = v
    file = File()
    view, n = file.view(rows.tobytes(), byteStride=rows.itemsize), len(v)
    attributes = dict(TEXCOORD_0=file.accessor(U16, n, "VEC2", bufferView=view, byteOffset=12, normalized=True),
                      COLOR_0=file.accessor(U8, n, "VEC4", bufferView=view, byteOffset=16, normalized=True))
    return file.primitive(file.positions(v, bufferView=view), file.indices(f), attributes)


def unindexed(v, f):
    file, corners = File(), v[f].reshape(-1, 3)
    return file.primitive(file.positions(corners, corners))


def strip(v, f):
    """All faces in one strip, joined by triangles without area."""
    s = list(f[0])
    for a, b, c in f[1:]:
        s += [s[-1], a] + ([a] if len(s) % 2 else []) + [a, b, c]
    file = File()
    return file.primitive(file.positions(v, v), file.indices(np.array(s)), mode=5)


def write_all(v, f, folder):
    """All kinds; transforms are quarter turns and powers of two, so positions stay what they are, bit by bit."""
    plain(v, f).write(folder / "u32.glb")
    parts(v, f, U16).write(folder / "u16.glb")
    parts(v, f, U8).write(folder / "u8.glb")
    sparse(v, f, np.arange(0, len(v), 3), np.where(np.arange(len(v))[:, None] % 3, v, 7)).write(folder / "sparse.glb")
    sparse(v, f, np.arange(len(v)), None).write(folder / "sparse_alone.glb")
    interleaved(v, f).write(folder / "interleaved.glb")
    unindexed(v, f).write(folder / "unindexed.glb")
    strip(v, f).write(folder / "strip.glb")
    turned = np.stack([v[:, 1], -v[:, 0], v[:, 2]], 1) / 2
    plain(turned, f).write(folder / "two_level.glb",
                           [dict(children=[1], scale=[4, 4, 4]),
                            dict(mesh=0, matrix=[0, .5, 0, 0, -.5, 0, 0, 0, 0, 0, .5, 0, 0, 0, 0, 1])])
    plain(v * np.float32([-1, 1, 1]), f[:, ::-1]).write(folder / "mirrored.glb",
                                                        [dict(children=[1], scale=[-1, 1, 1]), dict(mesh=0)])
    plain(v, f).write(folder / "far.glb", [dict(children=[1], translation=[1e6, 0, 0]),
                                           dict(mesh=0, translation=[0, -1e6, 0])])
    mesh = trimesh.Trimesh(v.astype(float), f, process=False)
    mesh.export(folder / "mesh.ply", vertex_normal=False)
    mesh.export(folder / "trimesh.glb")


def meshed(command, path):
    out = path.with_suffix(".out.ply")
    subprocess.run([command, path, out, "--vertices", "4000", "--attributes", "none", "--force", "--quiet"])
    return out.read_bytes()


def main():
    command, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    for name in map(pathlib.Path, sys.argv[3:]):
        mesh = trimesh.load(name, process=False, force="mesh")
        here = folder / name.stem
        here.mkdir(parents=True, exist_ok=True)
        write_all(np.array(mesh.vertices, np.float32), np.array(mesh.faces), here)
        expected = meshed(command, here / "mesh.ply")
        kinds = sorted(p for p in here.glob("*.glb") if p.stem != "far")
        other = [p.stem for p in kinds if meshed(command, p) != expected]
        print(f"{name.stem}: {len(kinds) - len(other)} of {len(kinds)} kinds are the same", *other)


if __name__ == "__main__":
    main()
