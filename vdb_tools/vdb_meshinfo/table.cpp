// A certificate as a table: a title a group, a line a measure.
#include "vdb_meshinfo/table.h"

#include <iomanip>
#include <sstream>

#include "isoshell/readable.h"

namespace isoshell::tool {
namespace {

constexpr int kNameWidth = 30, kBarWidth = 40;

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

void add_topology(const MeshCensus& census, Table& table) {
  const ComplexCounts& c = census.counts;
  table.title("Topology");
  table.row("kind", c.closed_manifold
                        ? c.nonorientable_components > 0 ? "closed 2-manifold, not orientable" : "closed 2-manifold"
                    : c.closed_components + c.bordered_components == c.components && c.repeated_corners == 0
                        ? "2-manifold with borders"
                        : "not a 2-manifold");
  table.count("vertices", c.vertices);
  table.count("triangles", c.triangles);
  table.count("edges", c.edges);
  table.count("components", c.components);
  table.count("closed components", c.closed_components);
  table.count("genus of these", c.genus);
  table.count("Euler characteristic", c.euler);
  table.count("boundary edges", c.boundary_edges);
  table.count("boundary loops", c.boundary_loops);
  table.count("non-manifold edges", c.nonmanifold_edges);
  table.count("non-manifold vertices", c.nonmanifold_vertices);
  table.count("inconsistently oriented edges", c.inconsistent_edges);
  table.count("components inside out", c.inverted_components);
  table.count("unreferenced vertices", c.vertices - c.referenced_vertices);
  table.count("duplicate vertices", c.duplicate_vertices);
  table.count("duplicate triangles", c.duplicate_triangles);
  table.count("triangles, corner repeated", c.repeated_corners);
  table.count("degenerate triangles", census.shapes.degenerate);
  table.number("volume", c.volume_world);
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

void add_side(const char* title, const OneSidedDistance& d, const NormalDeviation& normals, double diagonal,
              Table& table) {
  const auto row = [&](const char* name, double world) {
    table.row(name, Table::text_of(world) +
                        (diagonal > 0 ? " (" + Table::text_of(100 * world / diagonal) + " % of the diagonal)" : ""));
  };
  table.title(title);
  row("mean", d.mean);
  row("RMS", d.rms);
  row("max", d.max);
  table.number("normal deviation, mean", normals.mean_deg, " deg");
  table.number("normal deviation, max", normals.max_deg, " deg");
}

}  // namespace

std::string mesh_info_table(const MeshInfo& info) {
  Table table;
  add_topology(info.census, table);
  add_quality(info.census, table);
  if (info.distance) {
    const MeshDistance& d = *info.distance;
    add_side("Distance to the reference", d.to_reference, d.normal_to_reference, d.diagonal, table);
    add_side("Distance from the reference", d.from_reference, d.normal_from_reference, d.diagonal, table);
  }
  return table.text();
}

}  // namespace isoshell::tool
