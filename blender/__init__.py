# SPDX-License-Identifier: Apache-2.0
"""The extension of Blender: isotropic triangle meshes of objects and volumes, by isoshell."""

from . import operators, panel


def register():
    operators.register()
    panel.register()


def unregister():
    panel.unregister()
    operators.unregister()
