// A certificate as a table: a title a group, a line a measure.
#include "vdb_meshinfo/table.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "isoshell/readable.h"

namespace isoshell::tool {
namespace {

constexpr int kNameWidth = 30, kBarWidth = 40;
constexpr size_t kMostRows = 100;  ///< of regions, and of walls; JSON has them all

class Table {
 public:
  void title(const std::string& text) { out_ << (out_.tellp() > 0 ? "\n" : "") << text << '\n'; }
  void row(const std::string& name, const std::string& value) {
    out_ << "  " << std::left << std::setw(kNameWidth) << name << value << '\n';
  }
  void count(const std::string& name, int64_t value) { row(name, with_commas(value)); }
  void number(const std::string& name, double value, const std::string& unit = "") { row(name, text_of(value) + unit); }
  template <size_t kBins>
  void histogram(const std::string& name, const std::array<int64_t, kBins>& bins, double from, double to) {
    int64_t most = 1;
    for (const int64_t bin : bins) most = std::max(most, bin);
    out_ << "  " << name << '\n';
    for (size_t i = 0; i < kBins; ++i)
      out_ << "    " << std::right << std::setw(5) << text_of(from + (to - from) * double(i) / double(kBins)) << "  "
           << std::setw(11) << with_commas(bins[i]) << "  "
           << std::string(size_t((kBarWidth * bins[i] + most - 1) / most), '#') << '\n';
  }
  static std::string text_of(double value) {
    std::ostringstream text;
    text.precision(6);
    text << value;
    return text.str();
  }
  std::string text() const { return out_.str(); }

 private:
  std::ostringstream out_;
};

std::string kind_of(const MeshInfo& info) {
  const ComplexCounts& c = info.census.counts;
  if (info.regions)
    return info.regions->every_region_closed ? "walls of closed regions" : "walls of regions that are not all closed";
  if (c.closed_manifold)
    return c.nonorientable_components > 0 ? "closed 2-manifold, not orientable" : "closed 2-manifold";
  const bool has_borders_only = c.closed_components + c.bordered_components == c.components && c.repeated_corners == 0;
  return has_borders_only ? "2-manifold with borders" : "not a 2-manifold";
}

std::string shape_of(const RegionCounts& r) {
  std::string text = r.closed ? "closed, genus " + with_commas(r.genus) : "not closed";
  if (r.open_edges > 0) text += ", " + counted(r.open_edges, "open edge");
  if (r.inconsistent_edges > 0) text += ", " + counted(r.inconsistent_edges, "inconsistent edge");
  if (r.touching_vertices > 0) text += ", touches itself in " + counted(r.touching_vertices, "vertex", "vertices");
  if (r.is_inside_out()) text += ", inside out";
  return text + ", " + counted(r.components, "component") + ", " + counted(r.faces, "triangle") + ", volume " +
         Table::text_of(r.volume_world) + ", area " + Table::text_of(r.area_world);
}

void add_rest(size_t rows, Table& table) {
  if (rows > kMostRows) table.row("and more", with_commas(int64_t(rows - kMostRows)) + "; --json has them all");
}

void add_regions(const RegionCensus& census, Table& table) {
  table.title("Regions");
  for (size_t i = 0; i < std::min(census.regions.size(), kMostRows); ++i) {
    const RegionCounts& r = census.regions[i];
    table.row(std::to_string(r.label) + (r.name.empty() ? "" : " (" + r.name + ")") + ' ', shape_of(r));
  }
  add_rest(census.regions.size(), table);
  table.row("every one closed", census.every_region_closed ? "yes" : "no");
  table.count("edges of three faces or more", census.curve_edges);
  table.count("corners of these", census.corners);
  table.count("triangles there twice", census.duplicate_faces);
  table.title("Walls");
  for (size_t i = 0; i < std::min(census.walls.size(), kMostRows); ++i) {
    const RegionWall& w = census.walls[i];
    table.row(std::to_string(w.labels[0]) + " | " + std::to_string(w.labels[1]),
              counted(w.faces, "triangle") + ", area " + Table::text_of(w.area_world));
  }
  add_rest(census.walls.size(), table);
}

void add_topology(const MeshInfo& info, Table& table) {
  const MeshCensus& census = info.census;
  const ComplexCounts& c = census.counts;
  const bool is_of_one = !info.regions;  // otherwise this is said of each region
  table.title("Topology");
  table.row("kind", kind_of(info));
  table.count("vertices", c.vertices);
  table.count("triangles", c.triangles);
  table.count("edges", c.edges);
  table.count("components", c.components);
  if (is_of_one) {
    table.count("closed components", c.closed_components);
    table.count("genus of these", c.genus);
  }
  table.count("Euler characteristic", c.euler);
  table.count("boundary edges", c.boundary_edges);
  table.count("boundary loops", c.boundary_loops);
  if (is_of_one) {
    table.count("non-manifold edges", c.nonmanifold_edges);
    table.count("non-manifold vertices", c.nonmanifold_vertices);
    table.count("inconsistently oriented edges", c.inconsistent_edges);
    table.count("components inside out", c.inverted_components);
  }
  table.count("unreferenced vertices", c.vertices - c.referenced_vertices);
  table.count("duplicate vertices", c.duplicate_vertices);
  table.count("duplicate triangles", c.duplicate_triangles);
  table.count("triangles, corner repeated", c.repeated_corners);
  table.count("degenerate triangles", census.shapes.degenerate);
  if (is_of_one) table.number("volume", c.volume_world);
  table.number("area", census.shapes.area_world);
  table.title("Self-intersections");
  table.count("pairs of triangles", census.intersecting_pairs);
  table.count("triangles", census.intersecting_triangles);
}

void add_quality(const MeshCensus& census, Table& table) {
  const TriangleShapes& s = census.shapes;
  table.title("Quality");
  table.number("Q min", s.q_min);
  table.number("Q mean", s.q_mean);
  table.number("smallest angle", s.angle_min_deg, " deg");
  table.number("mean of smallest angles", s.smallest_angle_mean_deg, " deg");
  table.number("largest angle", s.angle_max_deg, " deg");
  table.number("smallest dihedral angle", census.dihedral.degrees, " deg");
  table.number("smallest angle below 30 deg", s.below_30_pct, " %");
  table.number("obtuse", s.above_90_pct, " %");
  table.number("edge length, mean", census.edges.mean);
  table.number("edge length, min", census.edges.min);
  table.number("edge length, max", census.edges.max);
  table.number("edge length, variation", census.edges.variation());
  table.number("area, variation", s.area_variation);
  table.number("irregular interior vertices", 100 * census.valence.irregular_ratio, " %");
  table.number("valence 5 to 7", census.valence.with_5_to_7_pct, " %");
  table.row("valence", std::to_string(census.valence.smallest) + " to " + std::to_string(census.valence.largest));
  table.histogram("triangles by Q, from", s.q_histogram, 0, 1);
  table.histogram("triangles by smallest angle, degrees from", s.smallest_angle_histogram, 0, 60);
}

void add_side(const char* title, const OneSidedDistance& d, double diagonal, Table& table) {
  const auto row = [&](const char* name, double world) {
    table.row(name, Table::text_of(world) +
                        (diagonal > 0 ? " (" + Table::text_of(100 * world / diagonal) + " % of the diagonal)" : ""));
  };
  table.title(title);
  row("mean", d.mean);
  row("RMS", d.rms);
  row("max", d.max);
}

void add_normals(const NormalDeviation& normals, Table& table) {
  table.number("normal deviation, mean", normals.mean_deg, " deg");
  table.number("normal deviation, max", normals.max_deg, " deg");
}

void add_distance(const MeshDistance& d, Table& table) {
  if (d.is_one_way) {
    add_side("Distance from the points of the reference to the mesh", d.from_reference, d.diagonal, table);
    table.row("from the mesh to the points", "not measured: they are no surface");
    return;
  }
  add_side("Distance to the reference", d.to_reference, d.diagonal, table);
  add_normals(d.normal_to_reference, table);
  add_side("Distance from the reference", d.from_reference, d.diagonal, table);
  add_normals(d.normal_from_reference, table);
}

}  // namespace

std::string mesh_info_table(const MeshInfo& info) {
  Table table;
  add_topology(info, table);
  if (info.regions) add_regions(*info.regions, table);
  add_quality(info.census, table);
  if (info.distance) add_distance(*info.distance, table);
  return table.text();
}

}  // namespace isoshell::tool
