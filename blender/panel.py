# SPDX-License-Identifier: Apache-2.0
"""Where users find the operators: the Object menu, and a panel in the sidebar that keeps their choices."""

import bpy

from . import options
from .operators import OBJECT_OT_isoshell_remesh, OBJECT_OT_isoshell_volume_to_mesh
from .volume_source import grid_of


class IsoshellRemeshSettings(options.Remesh, bpy.types.PropertyGroup):
    pass


class IsoshellExtractSettings(options.Extract, bpy.types.PropertyGroup):
    pass


def button(layout, operator, kind, settings):
    """The operator, with the choices of the panel."""
    layout.operator_context = "INVOKE_DEFAULT"
    given = layout.operator(operator.bl_idname)
    for name in options.names_of(kind):
        setattr(given, name, getattr(settings, name))


def buttons(layout, context):
    if context.active_object and context.active_object.type == "VOLUME":
        button(layout, OBJECT_OT_isoshell_volume_to_mesh, options.Extract, context.scene.isoshell_volume_to_mesh)
    else:
        button(layout, OBJECT_OT_isoshell_remesh, options.Remesh, context.scene.isoshell_remesh)


class VIEW3D_PT_isoshell(bpy.types.Panel):
    bl_label = "Isotropic Remesh"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "isoshell"

    @classmethod
    def poll(cls, context):
        return context.active_object is not None and context.active_object.type in {"MESH", "VOLUME"}

    def draw(self, context):
        self.layout.use_property_split = True
        if context.active_object.type == "VOLUME":
            settings = context.scene.isoshell_volume_to_mesh
            settings.draw_extract(self.layout, grid_of(context.active_object, settings.grid))
        else:
            context.scene.isoshell_remesh.draw_remesh(self.layout, context.active_object)
        buttons(self.layout, context)


def draw_menu(self, context):
    self.layout.separator()
    buttons(self.layout, context)


CLASSES = (IsoshellRemeshSettings, IsoshellExtractSettings, VIEW3D_PT_isoshell)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.isoshell_remesh = bpy.props.PointerProperty(type=IsoshellRemeshSettings)
    bpy.types.Scene.isoshell_volume_to_mesh = bpy.props.PointerProperty(type=IsoshellExtractSettings)
    bpy.types.VIEW3D_MT_object.append(draw_menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(draw_menu)
    del bpy.types.Scene.isoshell_volume_to_mesh
    del bpy.types.Scene.isoshell_remesh
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
