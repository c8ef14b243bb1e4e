// The edges of a mesh, cut into parts.
#pragma once

#include "core/buckets.h"
#include "features/mesh/refine_mesh.h"

namespace isoshell {

/// The longest that an edge of a fine mesh may be where the result has edges of such a length: well within the reach of
/// blocks.
double longest_fine_edge(const FineMesh& mesh, double edge_length);
/// How many equal parts of at most `longest` a line takes, and where part i of so many begins. The same from both ends.
int64_t parts_of(const WorldPoint& a, const WorldPoint& b, double longest);
WorldPoint point_between(const WorldPoint& a, const WorldPoint& b, int64_t i, int64_t parts);
/// The value there, of the values at both ends.
inline double value_between(double a, double b, int64_t i, int64_t parts) {
  return a == b ? a : (a * double(parts - i) + b * double(i)) / double(parts);
}

/// The inner points of edges: consecutive vertices from the end of the smaller number to the other.
class EdgeSubdivision {
 public:
  /// Appends their vertices to the mesh, and cuts its paths. `memory_bytes`: what is made of them may take so much; 0:
  /// any. `only`: keys of the edges off paths that are cut, ascending; null: all. Throws: usage when they are far more
  /// than the area needs, or more than that.
  EdgeSubdivision(FineMesh& mesh, int64_t memory_bytes, const std::vector<uint64_t>* only);
  /// The vertices from u to v along their edge, without v.
  void append_chain(uint32_t u, uint32_t v, std::vector<uint32_t>& out) const;

 private:
  /// Inner points of an edge of a path, with the edge length at each.
  struct InnerPoints {
    std::vector<WorldPoint> position;
    std::vector<double> edge_length;
  };
  struct Parts {
    uint32_t first, count;  ///< of its inner points
    uint32_t on_path;       ///< place among those of paths; kNone off them
  };

  int64_t find(uint32_t u, uint32_t v) const;
  static InnerPoints cut_path_edge(const FineMesh& mesh, const CurvePath& path, size_t i, size_t& seed,
                                   std::vector<size_t>& seed_at);
  std::vector<InnerPoints> cut_paths(FineMesh& mesh);
  void count_points(const FineMesh& mesh, const std::vector<InnerPoints>& on_paths, int64_t memory_bytes,
                    const std::vector<uint64_t>* only);
  void place_points(FineMesh& mesh, const std::vector<InnerPoints>& on_paths) const;
  void split_paths(FineMesh& mesh) const;

  Buckets<uint32_t> larger_end_;  ///< of the edges, by their smaller ends
  std::vector<Parts> parts_;      ///< per edge
};

}  // namespace isoshell
