#include "run/warnings.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <sstream>

#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr size_t kMostNamed = 10;  ///< regions of a sentence

std::string shown(const RegionName& region) {
  return std::to_string(region.label) + (region.name.empty() ? "" : " (" + region.name + ")");
}
std::string shown(const std::array<RegionName, 2>& pair) { return shown(pair[0]) + " and " + shown(pair[1]); }

/// Adds "; regions of the input are lost: 3, 4 (femur)".
template <class Of>
void list(const char* what, const std::vector<Of>& all, std::string& text) {
  if (all.empty()) return;
  text += (text.empty() ? "" : "; ") + std::string(what);
  for (size_t i = 0; i < std::min(all.size(), kMostNamed); ++i) text += (i > 0 ? ", " : " ") + shown(all[i]);
  if (all.size() > kMostNamed) text += " and " + std::to_string(all.size() - kMostNamed) + " more";
}

}  // namespace

std::vector<std::string> warnings_of_repair(const RemeshReport& report, const std::string& input, bool has_regions) {
  std::vector<std::string> warnings;
  const auto note = [&](int64_t count, const std::string& what) {
    if (count > 0) warnings.push_back(input + ": " + with_commas(count) + " " + what);
  };
  const DirtCounts& d = report.input.dirt;
  note(d.long_rows, "rows with values behind their last declared property, which were left out");
  note(d.surplus_rows, "rows left out behind the last that the header promises");
  note(d.surplus_bytes, "bytes left out behind the last one that the header promises");
  note(d.other_primitives, "primitives left out, they are no triangles with positions");
  note(d.posed_meshes, "meshes with skins or morph targets, which are left out; they stand as they are stored");
  note(d.nonfinite_vertices, "vertices that are not finite");
  note(d.dropped_faces_nonfinite, "faces dropped, they use vertices that are not finite");
  note(d.short_faces, "faces of fewer than three corners dropped");
  note(d.degenerate_faces, "faces without area");
  note(d.duplicate_faces, "repeated faces");
  note(d.unreferenced_vertices, "vertices that no face uses");
  if (!has_regions) note(d.nonmanifold_edges, "edges that more than two faces share");
  note(d.inconsistent_edges, "edges whose two faces disagree about the orientation");
  const RepairReport& m = report.input.repair;
  std::ostringstream far;
  far << "vertices pulled back that needles narrower than an edge held " << m.far_distance_world
      << " away from the rest, as near " << m.farthest.x << ' ' << m.farthest.y << ' ' << m.farthest.z
      << "; with shorter edges (--edge-length) they stay";
  note(m.far_vertices, far.str());
  note(m.joined_vertices, "vertices of boundaries joined over cracks");
  note(m.fins, "fins dropped: small patches that hang on edges of more than two faces");
  note(m.islands, "islands dropped: small open patches apart from the rest");
  note(m.turned_faces, "faces turned to agree with their neighbours");
  std::ostringstream caps;
  caps << "holes closed by new faces, up to " << m.widest_cap_world << " wide";
  note(m.capped_loops, caps.str());
  note(m.tubes, "pairs of them joined: they face each other like the ends of a tube");
  const UnionReport& u = report.input.united;
  note(u.turned_components, "closed components turned outward");
  note(u.swallowed_components, "closed components dropped, they lie inside of others");
  note(u.cut_faces, "faces cut where closed components pass through each other; the result is their union");
  note(u.inner_surfaces, "inner surfaces kept, they bound hollows; --outer-only drops them");
  note(u.dropped_inner, "inner components dropped, only outer ones are wanted");
  const JoinReport& j = report.input.joined;
  note(j.left_components, "open or inward looking components left as they are, others were united beside them");
  if (!j.given_up.empty()) {
    std::ostringstream text;
    text << input << ": closed components that pass through or touch each other are not joined as one mesh";
    if (j.at) text << ", near " << j.at->x << ' ' << j.at->y << ' ' << j.at->z;
    text << ": " << j.given_up << "; creases where they meet are rounded off";
    warnings.push_back(text.str());
  }
  if (report.features.border_loops == 0)
    note(m.open_loops, "open boundaries that are no holes; the result closes them or follows both sides");
  return warnings;
}

std::string words_of(const RegionChanges& changes) {
  std::string text;
  list("regions of the input are lost:", changes.lost, text);
  list("regions that touch in the input touch no more:", changes.lost_walls, text);
  list("regions touch that do not in the input:", changes.new_walls, text);
  return text;
}

std::vector<std::string> warnings_of_quality(const MeshQuality& quality) {
  if (quality.below_30_deg == 0) return {};
  std::ostringstream text;
  text << counted(quality.below_30_deg, "triangle has an angle", "triangles have angles") << " below 30 degrees:";
  const char* before = " ";
  for (const PoorAngle& p : quality.poor_angles) {
    text << before << p.degrees << " near " << p.middle.x << ' ' << p.middle.y << ' ' << p.middle.z;
    before = ", ";
  }
  text << "; edges of the input may meet at less there, or run nearer to one another than edges are long: more "
          "--vertices make better triangles";
  return {text.str()};
}

}  // namespace isoshell
