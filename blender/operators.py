# SPDX-License-Identifier: Apache-2.0
"""The operators: what they take, the run, what they put back."""

import bpy

from . import mesh_result, mesh_source, options, regions, sizing, volume_source
from .job import Job

PLACE = ("parent", "parent_type", "parent_bone", "matrix_parent_inverse", "location", "rotation_mode", "rotation_euler",
         "rotation_quaternion", "rotation_axis_angle", "scale")


class Run:
    """An operator whose work is done by a Job: straight, or with the progress shown and Esc to cancel.

    An operator has work(context), which gives the function that the job works on, and put(context, made), which gives
    notes for the user.
    """

    _job = _timer = None

    def execute(self, context):
        job = self._started(context)
        return {"CANCELLED"} if job is None else self._finished(context, job.wait())

    def invoke(self, context, _event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        self._job = self._started(context)
        if self._job is None:
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._job.cancel()
        elif event.type == "TIMER":
            if self._job.is_done:
                self._hide_progress(context)
                return self._finished(context, self._job)
            text = f"isoshell: {self._job.stage} {self._job.fraction:.0%}    Esc: cancel"
            context.workspace.status_text_set(text)
            context.window_manager.progress_update(100 * self._job.fraction)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Blender ends, or opens another file."""
        self._job.cancel()
        self._job.wait()
        self._hide_progress(context)

    def _started(self, context):
        try:
            return Job(self.work(context), self.device).start()
        except mesh_source.Refused as refused:
            self.report({"ERROR"}, str(refused))
        except Exception as error:
            self._report_failure(error)
        return None

    def _finished(self, context, job):
        try:
            made = job.result()
        except Exception as error:
            self._report_failure(error)
            return {"CANCELLED"}
        if made is None:
            self.report({"INFO"}, "isoshell: cancelled, nothing is changed")
            return {"CANCELLED"}
        for note in self.put(context, made):
            self.report({"WARNING"}, f"isoshell: {note}")
        return {"FINISHED"}

    def _report_failure(self, error):
        """What isoshell refuses says why and what to do; anything else is a fault, and is raised."""
        import isoshell

        if not isinstance(error, isoshell.Error):
            raise error
        self.report({"ERROR"}, f"isoshell, {error.stage}: {error}")

    def _hide_progress(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _tell(self, obj, result):
        report = result.report
        angle = report["quality"]["theta_min_deg"]
        self.report({"INFO"}, f"{obj.name}: {len(result.vertices)} vertices, smallest angle {angle:.1f}°")
        return report["warnings"]


class OBJECT_OT_isoshell_remesh(Run, options.Remesh, bpy.types.Operator):
    """Replace the mesh by an isotropic one: triangles of nearly one size, 2-manifold. UVs, colours, materials and
    vertex groups are carried over"""

    bl_idname = "object.isoshell_remesh"
    bl_label = "Isotropic Remesh (isoshell)"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        obj = context.active_object
        if obj is None or obj.type != "MESH" or context.mode != "OBJECT":
            cls.poll_message_set("Needs a mesh object, in Object Mode")
            return False
        if not obj.is_editable or not obj.data.is_editable:
            cls.poll_message_set("The object or its mesh is linked from another file; make it local")
            return False
        return True

    def work(self, context):
        import isoshell

        obj = context.active_object
        words = self.keywords()
        group = obj.vertex_groups.get(self.density) if self.density else None
        if self.density and group is None:
            raise mesh_source.Refused(f"{obj.name} has no vertex group {self.density}; choose one of its own")
        taken = mesh_source.take(obj, context.evaluated_depsgraph_get(), self.apply_modifiers)
        self._name, self._taken = obj.name, taken
        weights, ratio = (taken.weights[group.index] if group else None), self.density_ratio

        def remesh(run):
            if weights is not None:
                vertices, triangles = taken.world_vertices, taken.corners
                base = words.get("edge_length") or sizing.even_length(vertices, triangles, words["vertices"])
                words["sizing"] = sizing.lengths(vertices, triangles, weights, base, ratio)
                words.pop("edge_length", None)
            return isoshell.remesh(taken.mesh, context=run, allow_intersections=True, **words)

        return remesh

    def put(self, context, result):
        obj = context.scene.objects[self._name]
        return mesh_result.put(obj, self._taken, result, self.apply_modifiers) + self._tell(obj, result)

    def draw(self, context):
        self.layout.use_property_split = True
        self.draw_remesh(self.layout, context.active_object)


class OBJECT_OT_isoshell_volume_to_mesh(Run, options.Extract, bpy.types.Operator):
    """Make a mesh object of a volume: triangles of nearly one size, closed, 2-manifold. Of labels, the walls of all
    their regions"""

    bl_idname = "object.isoshell_volume_to_mesh"
    bl_label = "Volume to Isotropic Mesh (isoshell)"
    bl_options = {"REGISTER", "UNDO"}

    # Of the last run, for the panel that changes it: then the mesh is active, not the volume.
    meshed_grid: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})
    grid_class: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        obj = context.active_object
        if obj is None or obj.type != "VOLUME" or context.mode != "OBJECT":
            cls.poll_message_set("Needs a volume object, in Object Mode")
            return False
        return True

    def work(self, context):
        import isoshell

        obj = context.active_object
        taken = volume_source.TakenVolume(obj, context.evaluated_depsgraph_get(), self.grid)
        if self.properties.is_property_set("iso") and not self.properties.is_property_set("use_iso"):
            self.use_iso = True
        self.meshed_grid, self.grid_class = taken.name, taken.grid_class
        words = self.keywords_of_labels() if taken.is_of_labels else self.keywords_of_values(taken.grid_class)
        self._name = obj.name
        return lambda run: taken.remesh(words | {"allow_intersections": True}, run, isoshell)

    def put(self, context, made):
        result, to_object, grids = made
        volume = context.scene.objects[self._name]
        collections = volume.users_collection
        if self.split_regions and regions.are_in(result):
            objects = regions.objects_of(result, to_object)
            whole = bpy.data.collections.new(volume.name)
            for collection in collections:
                collection.children.link(whole)
            collections = [whole]
        else:
            objects = [self._object(volume, result, to_object, grids)]
            whole = objects[0]
        volume.select_set(False)
        for obj in objects:
            for name in PLACE:
                setattr(obj, name, getattr(volume, name))
            for collection in collections:
                collection.objects.link(obj)
            obj.select_set(True)
        context.view_layer.objects.active = objects[0]
        return self._tell(whole, result)

    def _object(self, volume, result, to_object, grids):
        """All of the result as one mesh."""
        mesh = bpy.data.meshes.new(f"{volume.name} mesh")
        mesh_result.new_geometry(mesh, *mesh_result.in_object(result.vertices, result.faces, to_object))
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        mesh_result.write_values(mesh, result.attributes, grids)
        if regions.are_in(result):
            regions.write(mesh, result)
        return bpy.data.objects.new(mesh.name, mesh)

    def draw(self, _context):
        self.layout.use_property_split = True
        self.draw_extract(self.layout, (self.meshed_grid, self.grid_class) if self.grid_class else None)


CLASSES = (OBJECT_OT_isoshell_remesh, OBJECT_OT_isoshell_volume_to_mesh)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
