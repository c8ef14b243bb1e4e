// Faces of a file into triangles, one collector a chunk; then all chunks into one soup.
#pragma once

#include <vector>

#include "geometry/triangle_list.h"
#include "io/bytes/mesh_source.h"
#include "io/faces/polygon_split.h"
#include "isoshell/surface_source.h"

namespace isoshell {

using Triangle = std::array<uint32_t, 3>;

constexpr int64_t kMaxSoupVertices = 0xfffffffe;

/// Positions read, and how many of them are NaN or infinite.
struct VertexTable {
  std::vector<WorldPoint> points;
  int64_t nonfinite = 0;
  const MeshSource* source;  ///< counts what is held of faces, too

  /// Throws unreadable_input when 32-bit indices cannot name that many, and out_of_memory.
  VertexTable(const MeshSource& source, int64_t count);
  /// Counts in parallel; call it once all positions are set.
  void count_nonfinite();
};

/// Takes faces whose indices are in range; drops and counts the dirty ones and splits polygons.
class FaceCollector {
 public:
  enum class Keep { triangles, faces_too };
  explicit FaceCollector(const VertexTable& vertices, Keep keep = Keep::triangles)
      : vertices_(&vertices), keeps_faces_(keep == Keep::faces_too) {}

  void add_triangle(uint32_t a, uint32_t b, uint32_t c) {
    ++faces_;
    if (a == b || b == c || c == a) {
      ++dirt_.degenerate_faces;
    } else if (vertices_->nonfinite && !(finite(a) && finite(b) && finite(c))) {
      ++dirt_.dropped_faces_nonfinite;
    } else {
      push({a, b, c});
      if (keeps_faces_) face_of_.push_back(uint32_t(faces_ - 1));
    }
  }
  /// A face of any number of corners. A corner that repeats the one before it is passed over, so that a quad closed to
  /// a triangle stays one; what keeps fewer than three different corners is degenerate.
  void add_polygon(const uint32_t* corners, int64_t count);
  /// A triangle strip; every second triangle is turned. Triangles with equal corners are the strip's way to turn a
  /// corner, not dirt.
  void add_strip(const uint32_t* corners, int64_t count);
  /// Many triangles at once that are counted already, to a collector that holds none. Cost: no copy when all of them
  /// are clean.
  void adopt(std::vector<Triangle> triangles);
  /// For so many more. Throws: out_of_memory, as all that adds does.
  void reserve(int64_t triangles) {
    make_room(*vertices_->source, triangles_, size_t(triangles));
    if (keeps_faces_) make_room(*vertices_->source, face_of_, size_t(triangles));
  }

  /// Per triangle, if that is kept, which of the faces and strips that were added it is of. Stays when parts are
  /// joined.
  const std::vector<uint32_t>& face_of() const { return face_of_; }

 private:
  friend TriangleSoup join_parts(VertexTable, std::vector<FaceCollector>&);
  bool finite(uint32_t i) const { return is_finite(vertices_->points[i]); }
  void push(const Triangle& triangle) {
    if (triangles_.size() == triangles_.capacity()) reserve(1);
    triangles_.push_back(triangle);
  }

  const VertexTable* vertices_;
  bool keeps_faces_;
  std::vector<Triangle> triangles_;
  std::vector<uint32_t> face_of_;
  int64_t faces_ = 0;
  DirtCounts dirt_;
  PolygonSplitter splitter_;
  std::vector<uint32_t> corners_;
};

/// All triangles in the order of the collectors, and the sums of what they counted. An unreferenced vertex is finite
/// and in no triangle that was kept.
TriangleSoup join_parts(VertexTable vertices, std::vector<FaceCollector>& parts);
/// Throws nothing_to_mesh, with what became of the faces, when there is no triangle.
void require_triangles(const MeshSource& source, const TriangleSoup& soup);
/// Both.
TriangleSoup join_soup(const MeshSource& source, VertexTable vertices, std::vector<FaceCollector>& parts);

}  // namespace isoshell
