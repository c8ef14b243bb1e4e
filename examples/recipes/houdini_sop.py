"""A Python SOP of Houdini: remeshes its input to as many vertices as its parameter `vertices` says.

In the node's code: import houdini_sop, hou; houdini_sop.cook(hou.pwd()). Polygons are triangles or quads alone (Divide
SOP), and Houdini's turn clockwise about their normals.
"""
import isoshell
import numpy as np


def cook(node):
    geo = node.geometry()
    points = np.frombuffer(geo.pointFloatAttribValuesAsString("P"), np.float32).reshape(-1, 3)
    faces = np.array([[vertex.point().number() for vertex in prim.vertices()] for prim in geo.prims()])
    result = isoshell.remesh((points, faces[:, ::-1]), vertices=node.evalParm("vertices"))
    geo.clear()
    made = geo.createPoints(result.vertices.tolist())
    geo.createPolygons([[made[corner] for corner in face] for face in result.faces[:, ::-1].tolist()])
