#include "run/warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <iterator>
#include <sstream>

#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr size_t kMostNamed = 10;     ///< regions of a sentence
constexpr double kLeastDihedral = 5;  ///< degrees between walls; generators of tetrahedra refuse less

std::string shown(const RegionName& region) {
  return std::to_string(region.label) + (region.name.empty() ? "" : " (" + region.name + ")");
}
std::string shown(const RegionVolumes& volumes) {
  std::ostringstream text;
  text << shown(volumes.region) << " by " << std::showpos << std::fixed << std::setprecision(1) << volumes.change_pct()
       << " %";
  return text.str();
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

bool is_zero(const WorldPoint& p) { return p.x == 0 && p.y == 0 && p.z == 0; }

/// What makes fewer curves that edges have to follow, where the result has any that need not be.
std::string ways_to_fewer_curves(const RunRecord& record) {
  const FeatureReport& f = record.report.features;
  std::string ways;
  if (record.regions && !record.options.regions.empty())
    return ", as may --snap W, which makes one what is nearer than W";
  if (!f.kept || record.regions) return ways;
  if (f.curves > f.seams + f.lines)
    ways += ", as does to give up creases by --features off, or those that turn by less than DEG by --features DEG";
  if (f.seams > 0) ways += ", or seams by --uv-seams ignore, or by leaving out of --attributes what has them";
  return ways;
}

std::string ways_to_finer_numbers(const HeldPositions& held, const WorldPoint& offset) {
  std::string ways;
  if (const WorldPoint& a = held.offset_world, &b = offset; a.x != b.x || a.y != b.y || a.z != b.z)
    ways = is_zero(offset) ? "leave out --recenter" : "--recenter auto subtracts " + exact_place(offset) + " from them";
  if (held.is_single) ways += (ways.empty() ? "" : ", or ") + std::string("write PLY or OBJ, which have all digits");
  return ways;
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
  const FarVertexReport& far = report.input.far;
  std::ostringstream pulled;
  pulled << "vertices pulled back that needles narrower than an edge held " << far.distance_world
         << " away from the rest, as at " << exact_place(far.farthest)
         << "; with shorter edges (--edge-length) they stay";
  note(far.vertices, pulled.str());
  note(m.joined_vertices, "vertices of boundaries joined over cracks");
  note(m.fins, "fins dropped: small patches that hang on edges of more than two faces");
  note(m.islands, "islands dropped: small open patches apart from the rest");
  note(m.turned_faces, "faces turned to agree with their neighbours");
  std::ostringstream caps;
  caps << "holes closed by new faces, up to " << m.widest_cap_world << " wide";
  note(m.capped_loops, caps.str());
  note(m.tubes, "pairs of them joined: they face each other like the ends of a tube");
  const UnionReport& u = report.input.united;
  note(u.turned_components, "closed components that were inside out, turned outward");
  note(u.swallowed_components, "closed components dropped, they lie inside of others");
  note(u.cut_faces, "faces cut where closed components meet; the result is their union");
  note(u.separated_edges, "edges of more than two faces where surfaces touch, which were moved apart a little there");
  note(u.inner_surfaces, "inner surfaces kept, they bound hollows; --outer-only drops them");
  note(u.dropped_inner, "inner components dropped, only outer ones are wanted");
  note(u.left_components, "open components left as they are, others were united beside them");
  if (!u.given_up.empty()) {
    std::string text = input + ": closed components that pass through or touch each other are not joined as one mesh";
    if (u.at) text += ", near " + readable_place(*u.at, report.grid.frame);
    warnings.push_back(text + ": " + u.given_up + "; creases where they meet are rounded off");
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

std::string words_of(const std::vector<RegionVolumes>& volumes) {
  std::vector<RegionVolumes> changed;
  std::copy_if(volumes.begin(), volumes.end(), std::back_inserter(changed), [](auto& v) { return v.has_changed(); });
  std::stable_sort(changed.begin(), changed.end(), [](const RegionVolumes& a, const RegionVolumes& b) {
    return std::abs(a.change_pct()) > std::abs(b.change_pct());
  });
  std::string text;
  list("regions have other volumes than in the input:", changed, text);
  if (changed.empty()) return text;
  return text +
         "; more --vertices, or a shorter --region-edge-length for them, keep volumes of regions that are "
         "narrower than edges are long";
}

namespace {

std::string words_of_angles(const RunRecord& record) {
  const MeshQuality& quality = *record.quality;
  std::ostringstream text;
  text << counted(quality.below_30_deg, "triangle has an angle", "triangles have angles") << " below 30 degrees:";
  const char* before = " ";
  for (const PoorAngle& p : quality.poor_angles) {
    text << before << p.degrees << " near " << readable_place(p.middle, record.report.grid.frame);
    before = ", ";
  }
  text << "; edges of the input may meet at less there, or run nearer to one another than edges are long: more "
          "--vertices make better triangles"
       << ways_to_fewer_curves(record);
  return text.str();
}

}  // namespace

std::vector<std::string> warnings_of_quality(const RunRecord& record) {
  std::vector<std::string> warnings;
  if (record.quality->below_30_deg > 0) warnings.push_back(words_of_angles(record));
  if (const LeastDihedral& least = record.quality->dihedral; record.regions && least.degrees < kLeastDihedral) {
    std::ostringstream text;
    text << "walls of regions meet at " << least.degrees << " degrees near "
         << readable_place(least.middle, record.report.grid.frame) << ", which programs that fill regions may refuse; "
         << (record.input.kind == InputKind::labels ? "another number of --vertices may open them"
                                                    : "those of the input may meet so there");
    warnings.push_back(text.str());
  }
  return warnings;
}

std::vector<std::string> warnings_of_files(const std::vector<WrittenFile>& files, const WorldPoint& offset) {
  std::vector<std::string> warnings;
  for (const WrittenFile& file : files) {
    const HeldPositions& held = file.held;
    if (&file == &files.front() && !is_zero(held.offset_world))
      warnings.push_back(file.path + ": " + exact_place(held.offset_world) + " is subtracted from the positions" +
                         (files.size() > 1 ? ", of files of regions too" : "") +
                         "; add it to have them where the input is");
    if (!held.is_coarse()) continue;
    std::ostringstream text;
    text << file.path << ": " << file.format << " files have " << (held.is_single ? "32" : "64")
         << "-bit floats, which move vertices by up to " << held.moved_world << " where edges are from "
         << held.shortest_edge_world << " long; what is measured of the result is of these";
    const std::string ways = ways_to_finer_numbers(held, offset);
    warnings.push_back(text.str() + (ways.empty() ? "" : ": " + ways));
  }
  return warnings;
}

std::string words_of_lost(const WrittenFile& file) {
  const HeldPositions& held = file.held;
  return file.path + ": its numbers are too coarse for " + counted(held.lost_triangles, "triangle") +
         (held.lost_triangles == 1 ? ", which tilts by more than 60 degrees or loses its area"
                                   : ", which tilt by more than 60 degrees or lose their area") +
         "; --recenter auto subtracts an offset from them, and PLY and OBJ files have finer ones";
}

}  // namespace isoshell
