#!/usr/bin/env python3
"""Writes random parts as CAD programs and printers know them: what no one has tuned the library for.

    python3 bench/csg_shapes.py FOLDER [COUNT] [SEED]

Needs manifold3d, numpy and trimesh. A file's name tells its kind. The last fifth is dirty: shells that overlap, small
holes, faces that are there twice or are turned over.
"""
import math
import os
import sys

import manifold3d
import numpy
import trimesh
from manifold3d import CrossSection, Manifold

SIDES = (12, 16, 24, 32, 48, 64, 96)

# The strokes of letters, in a box of 4 by 6: polylines along their middle.
LETTERS = {
    "A": [[(0, 0), (2, 6), (4, 0)], [(0.8, 2.2), (3.2, 2.2)]],
    "E": [[(4, 0), (0, 0), (0, 6), (4, 6)], [(0, 3), (3, 3)]],
    "K": [[(0, 0), (0, 6)], [(4, 6), (0, 2.6)], [(1.4, 3.8), (4, 0)]],
    "M": [[(0, 0), (0, 6), (2, 2.5), (4, 6), (4, 0)]],
    "O": [[(1.2, 0), (2.8, 0), (4, 1.5), (4, 4.5), (2.8, 6), (1.2, 6), (0, 4.5), (0, 1.5), (1.2, 0)]],
    "R": [[(0, 0), (0, 6), (3, 6), (4, 5.2), (4, 3.8), (3, 3), (0, 3)], [(1.8, 3), (4, 0)]],
    "S": [[(0, 0.8), (1, 0), (3, 0), (4, 1), (4, 2.3), (3, 3), (1, 3), (0, 3.8), (0, 5.2), (1, 6), (3, 6), (4, 5.2)]],
    "T": [[(0, 6), (4, 6)], [(2, 0), (2, 6)]],
    "X": [[(0, 0), (4, 6)], [(0, 6), (4, 0)]],
    "2": [[(0, 5), (1, 6), (3, 6), (4, 5), (4, 4), (0, 0), (4, 0)]],
    "7": [[(0, 6), (4, 6), (1.5, 0)]],
}
LETTER_PITCH = 5.6


class Parts:
    def __init__(self, random):
        self.random = random

    def between(self, low, high):
        return float(self.random.uniform(low, high))

    def chance(self, share=0.5):
        return self.random.random() < share

    def sides(self):
        return int(self.random.choice(SIDES))

    def cylinder(self, radius, height, at=(0, 0, 0), top=None):
        return Manifold.cylinder(height, radius, radius if top is None else top, self.sides()).translate(list(at))

    def box(self, size, at=(0, 0, 0)):
        return Manifold.cube(list(size)).translate(list(at))

    def chamfered_plate(self, x, y, z, edge):
        """A plate whose upper edges are bevelled, or whose corners are round."""
        if self.chance():
            section = CrossSection.square([x - 2 * edge, y - 2 * edge]).translate([edge, edge])
            round_corners = section.offset(edge, manifold3d.JoinType.Round, 2.0, self.sides())
            return Manifold.extrude(round_corners, z)
        low = Manifold.cube([x, y, z - edge])
        high = Manifold.cube([x - 2 * edge, y - 2 * edge, 1e-3 * z]).translate([edge, edge, z - 1e-3 * z])
        return Manifold.batch_hull([low, high])

    def plate(self):
        x, y = self.between(40, 120), self.between(30, 90)
        z = min(x, y) * self.between(0.03, 0.25)
        part = self.chamfered_plate(x, y, z, min(z, 0.1 * min(x, y)) * self.between(0.2, 0.8))
        for _ in range(self.random.integers(1, 5)):
            radius = min(x, y) * self.between(0.03, 0.12)
            at = (self.between(2 * radius, x - 2 * radius), self.between(2 * radius, y - 2 * radius), -1)
            part -= self.cylinder(radius, z + 2, at)
            if self.chance(0.4):
                part -= self.cylinder(1.6 * radius, z, (at[0], at[1], z * self.between(0.5, 0.8)))
        if self.chance():
            half = min(x, y) * self.between(0.02, 0.06)
            slot = self.cylinder(half, z + 2) + self.cylinder(half, z + 2, (0.25 * x, 0, 0))
            slot += self.box((0.25 * x, 2 * half, z + 2), (0, -half, 0))
            part -= slot.rotate([0, 0, self.between(0, 90)]).translate([0.4 * x, 0.4 * y, -1])
        if self.chance():
            part += self.box((x * self.between(0.5, 0.9), y * self.between(0.02, 0.08), z * self.between(1, 4)),
                             (0.05 * x, y * self.between(0.2, 0.8), 0.5 * z))
        return part

    def l_bracket(self):
        x, y, z = self.between(40, 80), self.between(20, 60), self.between(30, 80)
        thick = self.between(2, 8)
        part = self.box((x, y, thick)) + self.box((thick, y, z))
        for _ in range(self.random.integers(1, 4)):
            radius = y * self.between(0.05, 0.12)
            part -= self.cylinder(radius, thick + 2, (self.between(0.4, 0.85) * x, self.between(0.2, 0.8) * y, -1))
            part -= self.cylinder(radius, thick + 2).rotate([0, 90, 0]).translate(
                [-1, self.between(0.2, 0.8) * y, self.between(0.4, 0.85) * z])
        for side in range(self.random.integers(0, 3)):
            wide = self.between(1.5, 5)
            gusset = Manifold.extrude(CrossSection([[(0, 0), (0.5 * x, 0), (0, 0.6 * z)]]), wide)
            part += gusset.rotate([90, 0, 0]).translate([0.5 * thick, wide + side * (y - wide), 0.5 * thick])
        return part

    def u_bracket(self):
        x, y, z, thick = self.between(30, 80), self.between(20, 60), self.between(20, 60), self.between(2, 8)
        part = self.box((x, y, z)) - self.box((x - 2 * thick, y + 2, z), (thick, -1, thick))
        bore = self.cylinder(min(y, z) * self.between(0.1, 0.3), x + 2).rotate([0, 90, 0])
        part -= bore.translate([-1, 0.5 * y, thick + 0.5 * (z - thick)])
        part -= self.cylinder(0.1 * min(x, y), thick + 2, (0.5 * x, 0.5 * y, -1))
        return part

    def gear(self):
        teeth, radius, high = int(self.random.integers(9, 40)), self.between(15, 60), self.between(4, 25)
        depth = 2 * math.pi * radius / teeth * self.between(0.5, 0.8)
        points = []
        for i in range(teeth):
            for share, r in ((-0.27, radius - depth), (-0.13, radius), (0.13, radius), (0.27, radius - depth)):
                angle = 2 * math.pi * (i + share) / teeth
                points.append((r * math.cos(angle), r * math.sin(angle)))
        twist = self.between(10, 30) if self.chance(0.3) else 0
        part = Manifold.extrude(CrossSection([points]), high, 12 if twist else 0, twist)
        hub = radius * self.between(0.25, 0.45)
        if self.chance(0.7):
            part += self.cylinder(hub, high * self.between(1.3, 2))
        bore = hub * self.between(0.4, 0.7)
        part -= self.cylinder(bore, 4 * high, (0, 0, -high))
        if self.chance():
            part -= self.box((1.25 * bore, 0.5 * bore, 4 * high), (0, -0.25 * bore, -high))
        return part

    def housing(self):
        x, y, z, wall = self.between(40, 100), self.between(30, 80), self.between(20, 50), self.between(1, 4)
        part = self.box((x, y, z)) - self.box((x - 2 * wall, y - 2 * wall, z), (wall, wall, wall))
        for cx in (0.15, 0.85):
            for cy in (0.15, 0.85):
                boss = self.cylinder(0.06 * x, 0.8 * z, (cx * x, cy * y, 0.5 * wall))
                part += boss ^ self.box((x - wall, y - wall, z), (0.5 * wall, 0.5 * wall, 0))
                part -= self.cylinder(0.03 * x, z, (cx * x, cy * y, wall + self.between(0.1, 0.3) * z))
        for _ in range(self.random.integers(0, 6)):
            part -= self.box((self.between(0.05, 0.2) * x, 2 * y, 0.15 * z),
                             (self.between(0.1, 0.7) * x, -0.5 * y, 0.5 * z))
        return part

    def shaft(self):
        part, at = Manifold(), 0.0
        for _ in range(self.random.integers(2, 6)):
            radius, length = self.between(5, 25), self.between(5, 40)
            top = radius * self.between(0.7, 1) if self.chance(0.3) else radius
            part += self.cylinder(radius, length + 1e-2, (0, 0, at), top)
            at += length
        if self.chance():
            part -= self.cylinder(self.between(1.5, 4), 2 * at, (0, 0, -0.5 * at))
        if self.chance():
            part -= self.box((100, 4, at * self.between(0.2, 0.4)), (3, -2, 0.6 * at))
        return part

    def fillet(self):
        """Two boxes that meet in a hollow round, with a bevelled edge."""
        x, y, z, r = self.between(30, 80), self.between(20, 60), self.between(20, 60), self.between(3, 10)
        part = self.box((x, y, z)) - self.box((x, y + 2, z), (0.4 * x + r, -1, 0.3 * z + r))
        part -= self.box((x, y + 2, z), (0.4 * x + r, -1, 0.3 * z + r))
        part -= self.box((x, y + 2, z), (0.4 * x, -1, 0.3 * z + r))
        part -= self.box((x, y + 2, z), (0.4 * x + r, -1, 0.3 * z))
        part -= self.cylinder(r, y + 2).rotate([90, 0, 0]).translate([0.4 * x + r, y + 1, 0.3 * z + r])
        bevel = self.between(2, 8)
        cut = self.box((2 * bevel, 2 * y, 2 * bevel), (-bevel, -0.5 * y, -bevel)).rotate([0, 45, 0])
        return part - cut.translate([0, 0, z])

    def tilted(self):
        part = self.box((40, 30, 20))
        for _ in range(self.random.integers(1, 5)):
            size = [self.between(8, 40) for _ in range(3)]
            kind = self.random.integers(3)
            if kind == 0:
                other = self.box(size)
            elif kind == 1:
                other = self.cylinder(0.4 * size[0], size[1])
            else:
                other = Manifold.extrude(CrossSection([[(0, 0), (size[0], 0), (0, size[1])]]), size[2])
            other = other.rotate([self.between(0, 360) for _ in range(3)])
            other = other.translate([self.between(5, 35), self.between(5, 25), self.between(2, 18)])
            part = part - other if self.chance(0.3) else part + other
        return part

    def ring(self):
        radius, high = self.between(15, 60), self.between(3, 40)
        inner = radius * self.between(0.5, 0.93)
        part = self.cylinder(radius, high) - self.cylinder(inner, high + 2, (0, 0, -1))
        for i in range(self.random.integers(0, 7)):
            hole = self.cylinder(0.12 * high, 3 * radius).rotate([0, 90, 0]).translate([0, 0, 0.5 * high])
            part -= hole.rotate([0, 0, 360 * i / 7])
        return part

    def grid(self):
        """A plate full of holes."""
        n, m = int(self.random.integers(2, 7)), int(self.random.integers(2, 6))
        pitch, thick = self.between(6, 15), self.between(1, 6)
        part = self.box((n * pitch, m * pitch, thick))
        sides = self.random.choice([4, 6, 16, 24])
        for i in range(n):
            for j in range(m):
                hole = Manifold.cylinder(thick + 2, pitch * self.between(0.25, 0.4), -1, int(sides))
                part -= hole.translate([(i + 0.5) * pitch, (j + 0.5) * pitch, -1])
        return part

    def stroke(self, line, pen):
        """What a pen leaves that goes along a polyline."""
        tips = [pen.translate(list(at)) for at in line]
        return CrossSection.batch_boolean(
            [CrossSection.batch_hull(list(pair)) for pair in zip(tips, tips[1:])], manifold3d.OpType.Add)

    def word(self, letters):
        half = self.between(0.3, 0.6)
        pen = CrossSection.circle(half, 12) if self.chance() else CrossSection.square([2 * half, 2 * half], True)
        strokes = [self.stroke(line, pen).translate([LETTER_PITCH * i, 0])
                   for i, letter in enumerate(letters) for line in LETTERS[letter]]
        return CrossSection.batch_boolean(strokes, manifold3d.OpType.Add)

    def text(self):
        """A word on a plate, or in it."""
        letters = self.random.choice(sorted(LETTERS), self.random.integers(2, 6))
        wide, thick, deep = LETTER_PITCH * len(letters) + 1, self.between(1, 4), self.between(0.3, 1)
        part = self.chamfered_plate(wide, 9, thick, 0.4 * min(thick, 3)).translate([-1.3, -1.5, 0])
        if self.chance(0.3):
            return part - Manifold.extrude(self.word(letters), thick).translate([0, 0, thick - 0.5 * deep])
        return part + Manifold.extrude(self.word(letters), thick + deep)

    def ridge(self, profile, pitch, turns, sides):
        """A section, points (radius, height) around it, that winds around the axis while it rises."""
        n, count = len(profile), int(sides * turns)
        angle = numpy.arange(count + 1)[:, None] * 2 * math.pi / sides
        radius, height = numpy.array(profile).T
        points = numpy.stack([radius * numpy.cos(angle), radius * numpy.sin(angle),
                              height + angle * pitch / (2 * math.pi)], -1).reshape(-1, 3)
        faces = [(0, k, k + 1) for k in range(1, n - 1)]
        faces += [(count * n, count * n + k + 1, count * n + k) for k in range(1, n - 1)]
        for i in range(0, count * n, n):
            for k in range(n):
                a, b = i + k, i + (k + 1) % n
                faces += [(b, a, a + n), (b, a + n, b + n)]
        return Manifold(manifold3d.Mesh(points.astype(numpy.float32), numpy.array(faces, numpy.uint32)))

    def screw(self):
        radius, turns, sides = self.between(3, 8), self.between(3, 9), int(self.random.choice((24, 32, 48, 64)))
        pitch = radius * self.between(0.3, 0.6)
        depth, crest, foot = pitch * self.between(0.4, 0.6), pitch * self.between(0.03, 0.12), 0.46 * pitch
        root = radius - depth
        profile = [(0.9 * root, -foot), (root, -foot), (radius, -crest),
                   (radius, crest), (root, foot), (0.9 * root, foot)]
        long = pitch * (turns - 1)  # the thread begins in the head and is cut off at the other end
        part = self.ridge(profile, pitch, turns, sides).translate([0, 0, -0.5 * pitch])
        part = (part + Manifold.cylinder(2 * long, root, -1, sides)) ^ self.box(
            (4 * radius, 4 * radius, long + 0.5 * pitch), (-2 * radius, -2 * radius, -0.5 * pitch))
        high, head = radius * self.between(0.8, 1.5), radius * self.between(1.5, 2)
        if self.chance():
            return part + Manifold.cylinder(high, head, -1, 6).translate([0, 0, -high])
        slot = self.box((3 * head, 0.25 * head, 0.4 * high), (-1.5 * head, -0.125 * head, -1.01 * high))
        return part + self.cylinder(head, high, (0, 0, -high)) - slot


KINDS = ("plate", "l_bracket", "u_bracket", "gear", "housing", "shaft", "fillet", "tilted", "ring", "grid",
         "text", "screw")


def to_trimesh(part):
    mesh = part.to_mesh()
    return trimesh.Trimesh(numpy.asarray(mesh.vert_properties)[:, :3], numpy.asarray(mesh.tri_verts), process=False)


def turned_and_sized(mesh, parts):
    """Half of them as they lie, half turned by odd angles; of sizes from 1 to 300."""
    if parts.chance():
        mesh.apply_transform(trimesh.transformations.rotation_matrix(
            parts.between(0, 6.28), parts.random.normal(size=3)))
    longest = (mesh.bounds[1] - mesh.bounds[0]).max()
    mesh.apply_scale(math.exp(parts.between(0, math.log(300))) / longest)
    return mesh


def clean(parts, kind):
    solids = getattr(parts, kind)().decompose()
    return to_trimesh(max(solids, key=lambda solid: solid.volume()))


def overlapping(parts):
    """Shells that pass through each other, as many files for printers have them."""
    meshes = [to_trimesh(parts.box((40, 30, 10)))]
    for _ in range(parts.random.integers(1, 4)):
        size = [parts.between(8, 25) for _ in range(3)]
        other = parts.cylinder(0.4 * size[0], 2 * size[1]) if parts.chance() else parts.box(size)
        if parts.chance():
            other = other.rotate([parts.between(0, 90) for _ in range(3)])
        meshes.append(to_trimesh(other.translate([parts.between(5, 25), parts.between(5, 20), 4.5])))
    return trimesh.util.concatenate(meshes)


def dirty(parts, kind):
    if kind == "overlap":
        return overlapping(parts)
    mesh = clean(parts, KINDS[parts.random.integers(len(KINDS))])
    faces = mesh.faces.copy()
    some = parts.random.choice(len(faces), max(1, len(faces) // 100), replace=False)
    if kind == "holes":
        faces = numpy.delete(faces, some, axis=0)
    elif kind == "twice":
        faces = numpy.concatenate([faces, faces[some]])
    else:
        faces[some] = faces[some][:, ::-1]
    return trimesh.Trimesh(mesh.vertices, faces, process=False)


DIRTY = ("overlap", "holes", "twice", "turned")


def write_parts(folder, count, seed):
    """The same files for the same count and seed."""
    random = numpy.random.default_rng(seed)
    os.makedirs(folder, exist_ok=True)
    first_dirty = count - count // 5
    for i in range(count):
        parts = Parts(random)
        kind = KINDS[i % len(KINDS)] if i < first_dirty else DIRTY[i % len(DIRTY)]
        mesh = clean(parts, kind) if i < first_dirty else dirty(parts, kind)
        suffix = "stl" if parts.chance() else "off"
        turned_and_sized(mesh, parts).export(os.path.join(folder, f"{i:03d}_{kind}.{suffix}"))


if __name__ == "__main__":
    given = sys.argv[1:]
    write_parts(given[0], int(given[1]) if len(given) > 1 else 60, int(given[2]) if len(given) > 2 else 1)
