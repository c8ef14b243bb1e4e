"""The packed extension by Blender's own rules."""

import math
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import pytest


PACKAGE = Path(os.environ["ISOSHELL_EXTENSION"])
LATER = PACKAGE.with_name(f"{PACKAGE.stem}-blender-5.1.zip")
PACKED = [(PACKAGE, "cp311-cp311")] + ([(LATER, "cp312-abi3")] if LATER.exists() else [])  # for another Python


@pytest.mark.parametrize("package, python", PACKED)
def test_blender_finds_nothing_wrong_with_the_packages(package, python):
    scripts = Path(bpy.utils.system_resource("SCRIPTS"))
    tool = next(scripts.glob("addons_core/bl_pkg/cli/blender_ext.py"))
    checked = subprocess.run([sys.executable, tool, "validate", package], text=True, capture_output=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    with zipfile.ZipFile(package) as files:
        manifest = files.read("blender_manifest.toml").decode()
        wheel, = (name for name in files.namelist() if name.endswith(".whl"))
    assert python in wheel and f'wheels = ["./{wheel}"]' in manifest


def test_operators_panel_and_menu_are_there_and_go_away(extension):
    assert bpy.ops.object.isoshell_remesh.poll() is False  # nothing is selected
    assert hasattr(bpy.types, "VIEW3D_PT_isoshell") and bpy.context.scene.isoshell_remesh.vertices == 10000
    extension.unregister()
    assert not hasattr(bpy.types, "VIEW3D_PT_isoshell") and not hasattr(bpy.types.Scene, "isoshell_remesh")
    extension.register()


def test_numbers_have_the_ranges_of_the_options():
    import isoshell

    options = {entry.name: entry for entry in isoshell._isoshell.option_table()}
    properties = bpy.context.scene.isoshell_remesh.bl_rna.properties
    assert properties["vertices"].hard_min == options["vertices"].low
    assert (properties["adaptivity"].hard_min, properties["adaptivity"].hard_max) == (0, options["adaptivity"].high)
    angle = properties["angle"]
    limits = [options["features"].low, options["features"].high]
    assert [math.degrees(angle.hard_min), math.degrees(angle.hard_max)] == pytest.approx(limits)
