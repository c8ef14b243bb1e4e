// Conditions on the result of a run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/run/record.h"

namespace isoshell {

/// What the result must be; a run that misses any is not an error, but the command then exits with 6.
struct Gates {
  std::vector<std::string> requested;  ///< as they were written
  bool closed = false, manifold = false, no_self_intersections = false;
  bool allow_intersections = false;  ///< of a run that asks for nothing else: it misses that without this
  std::optional<int64_t> genus, components, boundary_loops;
  bool count = false;                       ///< vertices are as many as were asked for, to a tenth
  bool features = false;                    ///< no curve was lost
  bool regions = false;                     ///< RegionCensus::is_sound()
  bool adjacency = false;                   ///< no region and no wall between two is lost, and none is new
  std::optional<double> region_volume_pct;  ///< by which volumes of regions may differ from the input's
  std::optional<double> min_angle_deg, min_dihedral_deg, max_deviation_world, normal_deviation_deg;
  std::optional<double> kept_edges_pct;  ///< of a frame that follows another; others meet them
  std::optional<int64_t> born;

  bool any() const;
  bool needs_distance() const;
};

/// What gates look at. References to what is there for as long as they are asked. Where there are regions, each of them
/// is what must be closed, or a manifold.
struct Measured {
  const std::optional<MeshTopology>& topology;
  const std::optional<MeshQuality>& quality;
  const std::optional<MeshDistance>& distance;
  std::optional<int64_t> self_intersections = {};  ///< pairs of triangles; none where the mesh was not tested
  const RegionCensus* regions = nullptr;           ///< of a mesh that has any
  const RegionChanges* region_changes = nullptr;   ///< of a run whose input has any
  const FeatureReport* features = nullptr;         ///< of a run
  const CountReport* count = nullptr;              ///< of a run
  LatticeFrame frame = {};                         ///< of a run, for how exact places are
  const CoherenceReport* coherence = nullptr;      ///< of a frame that follows another

  int64_t border_loops() const { return features ? features->border_loops : 0; }
};

/// From a list as --require takes it, of the gates that listed_gates() names. Throws: usage.
Gates parse_gates(const std::string& list);

/// "closed, manifold, min-angle=DEG", with a word on each that needs one, or not.
std::string listed_gates(bool with_words);
/// The same of those that any mesh can be asked, whoever made it.
std::string listed_gates_of_meshes(bool with_words);

/// Throws: usage for a gate that only a run can be asked, or that asks for distances where there is no reference.
void check_gates_of_mesh(const Gates& gates, bool has_reference);

/// A sentence for each gate that is not met, in the order of listed_gates(). All that the gates ask for must be there:
/// topology and quality, the distance for both deviations. Throws: usage when it is not.
std::vector<std::string> missed_gates(const Gates& gates, const Measured& measured);
/// The same of a run. That its result is known to intersect itself is one of them unless allowed, and that a file's
/// numbers are too coarse for its triangles is one always.
std::vector<std::string> missed_gates(const Gates& gates, const RunRecord& record);

}  // namespace isoshell
