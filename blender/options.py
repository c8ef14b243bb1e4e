# SPDX-License-Identifier: Apache-2.0
"""What a user chooses: the same for the panel and for the operator."""

import math

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

LEVEL_SET, FOG = "level set", "fog volume"  # classes of grids


def names_of_grids(_options, context, text):
    """What may follow a text of names with commas: every grid of the active volume that is not among them."""
    obj = context.active_object
    if obj is None or obj.type != "VOLUME" or not (obj.data.grids.is_loaded or obj.data.grids.load()):
        return []
    before = [name.strip() for name in text.split(",")[:-1]]
    names = dict.fromkeys(grid.name for grid in obj.data.grids)
    return [",".join([*before, name]) for name in names if name not in before]


class Size:
    by: EnumProperty(name="Size", default="COUNT", items=(
        ("COUNT", "Count", "Number of vertices of the result"),
        ("LENGTH", "Edge Length", "Edges of the result are about as long, in world units")))
    vertices: IntProperty(name="Vertices", default=10000, min=4, soft_max=1000000,
                          description="Number of vertices of the result")
    edge_length: FloatProperty(name="Edge Length", default=0.1, min=1e-6, soft_min=0.001, unit="LENGTH", precision=4,
                               description="Length of the edges of the result in the world, after the object's scale")
    features: EnumProperty(name="Creases", default="AUTO", items=(
        ("AUTO", "Auto", "Sharp edges of crisp parts stay; scans have none"),
        ("ANGLE", "Angle", "All edges stay whose faces turn by so much"),
        ("OFF", "Off", "All edges are rounded off")))
    angle: FloatProperty(name="Angle", default=math.radians(30), min=math.radians(1), max=math.radians(179),
                         subtype="ANGLE", description="Edges stay whose faces turn by so much or more")
    adaptivity: FloatProperty(name="Adaptivity", default=0, min=0, max=1, subtype="FACTOR",
                              description="Fraction of the vertices that are distributed by curvature, not by area")
    device: EnumProperty(name="Device", default="auto", items=(
        ("auto", "Auto", "The GPU if this build of isoshell has CUDA and there is one"),
        ("cpu", "CPU", "The processor"),
        ("cuda", "CUDA", "The GPU; an error if there is none, or this build has no CUDA")))

    def keywords(self):
        """Of isoshell.remesh."""
        words = {"vertices": self.vertices} if self.by == "COUNT" else {"edge_length": self.edge_length}
        words["features"] = math.degrees(self.angle) if self.features == "ANGLE" else self.features.lower()
        return words | {"adaptivity": self.adaptivity}

    def draw_size(self, layout):
        layout.prop(self, "by", expand=True)
        layout.prop(self, "vertices" if self.by == "COUNT" else "edge_length")
        layout.prop(self, "adaptivity")
        layout.prop(self, "features")
        if self.features == "ANGLE":
            layout.prop(self, "angle")


class Remesh(Size):
    boundary: EnumProperty(name="Borders", default="CLOSE", items=(
        ("CLOSE", "Close", "The result is closed"),
        ("KEEP", "Keep", "Borders of the surface are borders of the result, if they are wider than the gaps")))
    gaps: EnumProperty(name="Gaps", default="AUTO", items=(
        ("AUTO", "Auto", "Those of holes and gaps that the surface has"),
        ("NONE", "None", "No gaps are bridged; every border may stay"),
        ("WIDTH", "Width", "Up to a width")))
    gap_width: FloatProperty(name="Gap Width", default=0.1, min=0, unit="LENGTH", precision=4,
                             description="Widest gap that is bridged, in the world")
    density: StringProperty(name="Density", description="Vertex group: the higher the weight, the shorter the edges")
    density_ratio: FloatProperty(name="Ratio", default=4, min=1, max=16,
                                 description="How many times shorter edges are where the weight is 1 than where it is "
                                             "0. An edge length is that where it is 0")
    keep_uv_seams: BoolProperty(name="Keep UV Seams", default=False,
                                description="Seams of UV maps are edges of the result. Otherwise triangles, which are "
                                            "better shaped then, lie across them, each with the UVs of one island")
    apply_modifiers: BoolProperty(name="Apply Modifiers", default=True,
                                  description="Remesh what the viewport shows, and remove the modifiers that it shows; "
                                              "otherwise remesh the mesh below them, and keep them")

    def keywords(self):
        gaps = {"AUTO": "auto", "NONE": 0, "WIDTH": self.gap_width}[self.gaps]
        uv_seams = "keep" if self.keep_uv_seams else "ignore"
        return super().keywords() | {"boundary": self.boundary.lower(), "close_gaps": gaps, "uv_seams": uv_seams}

    def draw_remesh(self, layout, obj):
        self.draw_size(layout)
        layout.prop_search(self, "density", obj, "vertex_groups")
        if self.density:
            layout.prop(self, "density_ratio")
        layout.prop(self, "boundary")
        layout.prop(self, "gaps")
        if self.gaps == "WIDTH":
            layout.prop(self, "gap_width")
        layout.prop(self, "keep_uv_seams")
        layout.prop(self, "apply_modifiers")
        layout.prop(self, "device")


class Extract(Size):
    use_iso: BoolProperty(name="Set Iso Value", default=False,
                          description="The surface is where the values of the grid are the iso value, whatever its "
                                      "class is. Otherwise that is so of fog volumes, and of a level set the surface "
                                      "is where it is 0. A grid without a class holds distances")
    iso: FloatProperty(name="Iso Value", default=0.1,  # as the threshold of Blender's own modifier
                       description="Value of the grid on the surface: of a fog volume, or with Set Iso Value of any")
    grid: StringProperty(name="Grid", search=names_of_grids, description="Name of the grid; empty: the active one")
    use_background: BoolProperty(name="Use Background", default=False,
                                 description="Of a grid of labels: what is no region has the label below. Otherwise it "
                                             "has the background value of the grid")
    background: IntProperty(name="Background", default=0, description="Label of what is no region")
    smallest_island: IntProperty(name="Smallest Island", default=8, min=0, soft_max=1000,
                                 description="Of a grid of labels: islands of fewer voxels get the label around them, "
                                             "but the largest one of each region")
    smoothing: FloatProperty(name="Smoothing", default=0.5, min=0, max=1,
                             description="Of a grid of labels: how far, in voxels, walls may leave the faces of their "
                                         "voxels to be smooth. At 0 they are these faces, flat, with creases")
    grids: StringProperty(name="Values Of", search=names_of_grids,
                          description="Grids of the volume, as v,Cd,temperature, whose values are attributes of "
                                      "the mesh; all: all but the one that is meshed")
    split_regions: BoolProperty(name="Split Regions", default=False,
                                description="Of a grid of labels: an object for each region, closed, in a collection "
                                            "with the name of the volume. Otherwise one mesh has all walls once")

    def keywords_of_labels(self):
        """Of isoshell.remesh, for a grid of labels."""
        words = {"background": self.background} if self.use_background else {}
        words |= {"smallest_island": self.smallest_island, "smoothing": self.smoothing}
        return super().keywords() | self._keywords_of_grids() | words

    def keywords_of_values(self, grid_class):
        """Of isoshell.remesh, for a grid of values. Where it has no class the library says where its surface is."""
        iso = self.iso if self.use_iso or grid_class == FOG else 0.0 if grid_class == LEVEL_SET else None
        return super().keywords() | self._keywords_of_grids() | {"iso": iso}

    def _keywords_of_grids(self):
        return {"grids": self.grids} if self.grids else {}

    def draw_extract(self, layout, grid=None):
        """With the name and the class of the grid where they are known."""
        self.draw_size(layout)
        layout.prop(self, "grid")
        if grid:
            layout.label(text=f"{grid[0]}: {grid[1]}")
        is_fog, is_level_set = (grid is not None and grid[1] == name for name in (FOG, LEVEL_SET))
        if not is_fog:
            layout.prop(self, "use_iso")
        if is_fog or self.use_iso:
            layout.prop(self, "iso")
        elif is_level_set:
            layout.label(text="Surface at 0")
        layout.prop(self, "grids")
        labels = layout.box().column()
        labels.label(text="Grids of Labels")
        labels.prop(self, "use_background")
        if self.use_background:
            labels.prop(self, "background")
        labels.prop(self, "smallest_island")
        labels.prop(self, "smoothing")
        labels.prop(self, "split_regions")
        layout.prop(self, "device")


def names_of(options):
    """All properties, those of base classes too."""
    return [name for base in reversed(options.__mro__) for name in getattr(base, "__annotations__", {})]
