// Frames of a sequence: one begins with the mesh of the frame before, so that vertex i stays vertex i.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// The result of the frame before, and where its vertices have gone.
struct PreviousFrame {
  std::vector<WorldPoint> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<WorldPoint> carried;  ///< per vertex where it is in this frame, on its surface or near it
  bool has_other_faces = false;     ///< the surface is meshed anew in every frame: a volume, or with other triangles
  bool had_curves = false;          ///< its surface was cut along curves; the mesh is the same if that is not told
};

/// How steady a frame is beside the one before.
struct CoherenceReport {
  bool began_warm = false;  ///< from the vertices of the frame before; else vertices only got numbers of near ones
  std::string why_cold;     ///< empty when it began warm
  int64_t born = 0;  ///< vertices that are not where those of their number went, by nine tenths of an edge or more
  double kept_edges_pct = 0;  ///< of the edges of this frame: the frame before has one between the same two vertices
  double excess =
      0;  ///< motion beside the carried vertices, without those born: root mean square over mean edge length
};

/// Where vertices of a mesh of the surface `before` are when its triangles have moved to where they are in `now`, which
/// has the same: a vertex keeps its place in the triangle that it lies on, and its offset along the normal. That
/// triangle is the nearest one, unless it faces the other way than the vertex does and one that faces its way is under
/// it, too, half an edge's length farther at most: the other side of a wall may be nearer. Which way is out is what
/// most of the nearest triangles say. Cost: a search for each, two where walls are close. Throws: usage when the
/// triangles are not the same, or there are none; interrupted.
std::vector<WorldPoint> carry_with_triangles(const TriangleMesh& mesh, const TriangleSoup& before,
                                             const TriangleSoup& now, Context& context);

/// Where a surface goes until the next frame, as a function of the place. Result: a function of each point alone.
class VelocityField {
 public:
  virtual ~VelocityField() = default;
  /// In world units a frame; not numbers where the field says nothing.
  virtual std::vector<WorldPoint> velocities_at(const std::vector<WorldPoint>& points) const = 0;
};

/// The velocity of the nearest place of a surface, from those of its vertices. A triangle with one that is not a number
/// says nothing. Throws: usage without triangles, or for another number of velocities than of vertices;
/// unreadable_input for an infinite one.
std::shared_ptr<const VelocityField> velocity_on(TriangleSoup surface, std::vector<WorldPoint> velocities);

/// Where points are a frame later: by the velocity at the middle of their way, or, where fields in a narrow band say
/// nothing there, by that where they are; where it says nothing there either, they stay.
std::vector<WorldPoint> carry_with_velocity(const std::vector<WorldPoint>& points, const VelocityField& field);

/// Where vertices of a mesh are on a surface that lies near it: each at the nearest place that faces as its normal
/// does, up to an edge's length away, or else where it was. Throws: usage without triangles; interrupted.
std::vector<WorldPoint> carry_onto(const TriangleMesh& mesh, const TriangleSoup& now, Context& context);

/// Whether both have the same triangles, corner by corner.
bool have_same_triangles(const TriangleSoup& a, const TriangleSoup& b);

/// Gives the vertices of a mesh that has not kept the numbers of the frame before, because it began cold or was made of
/// patches, those of the nearest ones, each to one at most and no farther than half an edge's length; the others take
/// the numbers that are free. Cost: a sort of the near pairs.
void number_as_before(const PreviousFrame& previous, TriangleMesh& mesh);

/// Per vertex 1 where it is not the one of its number in the frame before: nine tenths of the mean edge's length or
/// more from where that went, or beyond its vertices.
std::vector<uint8_t> born_vertices(const PreviousFrame& previous, const TriangleMesh& mesh);

/// The measures of a frame; began_warm and why_cold stay as they are.
void measure_coherence(const PreviousFrame& previous, const TriangleMesh& mesh, CoherenceReport& report);

}  // namespace isoshell
