// Edge lengths of a run.
#include "pipeline/grid/sizing.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr int kRounds = 4;              // of limits that depend on the lengths they limit
constexpr int64_t kMostSmoothing = 32;  // of normals
constexpr int64_t kMostLengthSmoothing = 128;

/// Rounds of smoothing that spread a normal over most of an edge: each spreads it by half a voxel squared. More blunt
/// sharp bends, fewer take noise for curvature.
int32_t smoothing_rounds(double edge_vox) {
  return int32_t(std::clamp<int64_t>(std::llround(0.165 * edge_vox * edge_vox), 2, kMostSmoothing));
}

/// A part of the vertices, `adaptivity`, goes by curvature instead of area: so chord errors even out.
void shorten_where_curved(const RemeshOptions& options, const Sheet& sheet, double edge_world,
                          std::vector<double>& length, Context& context) {
  const Buffer<uint32_t> turn =
      measure_curvature(sheet, smoothing_rounds(edge_world / sheet.frame.voxel_size), context).to_host();
  int64_t sum = 0;  // a vertex stands for about the same area as any other
  for (const uint32_t t : turn) sum += t;
  const double mean = double(sum) / double(turn.size());
  if (!(mean > 0)) return;
  for (size_t v = 0; v < length.size(); ++v) {
    const double density = 1 - options.adaptivity + options.adaptivity * double(turn[int64_t(v)]) / mean;
    length[v] = length[v] / std::sqrt(std::max(density, kLeastDensity));
  }
}

std::vector<double> wanted_lengths(const PreparedSurface& p, Context& context) {
  const RemeshOptions& options = p.options;
  const Sheet& sheet = p.sheet;
  const double usual = p.target_of_input.edge_length_world;
  std::vector<double> length(size_t(sheet.vertex_count()), usual);
  if (options.sizing) {
    const Buffer<PointQ8> position = sheet.position.to_host();
    std::vector<WorldPoint> points;
    points.reserve(length.size());
    for (const PointQ8& q : position) points.push_back(sheet.frame.to_world(q));
    const std::vector<double> field = options.sizing->lengths_at(points);
    for (size_t v = 0; v < length.size(); ++v)
      if (field[v] > 0) length[v] = field[v];
  }
  if (options.adaptivity > 0) shorten_where_curved(options, sheet, usual, length, context);
  return length;
}

std::string near_vertex(const Sheet& sheet, size_t v) {
  const WorldPoint at = sheet.frame.to_world(sheet.position.to_host()[int64_t(v)]);
  return "near " + readable_place(at, sheet.frame);
}

/// Lengths within what the grid and the energy carry; `cell_of_length` is the width of cells over lengths.
class Bounded {
 public:
  Bounded(const std::vector<double>& wanted, double voxel_size, double cell_of_length)
      : floor_(shortest_edge_world(voxel_size, cell_of_length)), raw_(int64_t(wanted.size())) {
    least_at_ = size_t(std::min_element(wanted.begin(), wanted.end()) - wanted.begin());
    largest_at_ = size_t(std::max_element(wanted.begin(), wanted.end()) - wanted.begin());
    cap_ = kMostLengthRatio * std::max(wanted[least_at_], floor_);
    for (size_t v = 0; v < wanted.size(); ++v) {
      const double length_q8 = std::clamp(wanted[v], floor_, cap_) / voxel_size * kOneVoxelQ8;
      raw_[int64_t(v)] = uint32_t(std::clamp<int64_t>(std::llround(length_q8), 1, int64_t(1) << 28));
    }
  }
  Buffer<uint32_t> raw() const { return raw_.to_host(); }

  std::vector<std::string> warnings(const std::vector<double>& wanted, const Sheet& sheet, double scale) const {
    std::vector<std::string> warnings;
    std::ostringstream text;
    if (wanted[least_at_] < floor_) {
      text << "edges of " << wanted[least_at_] * scale << " are asked for " << near_vertex(sheet, least_at_)
           << "; a grid of resolution " << sheet.frame.resolution << " carries none shorter than " << floor_ * scale
           << ": raise --resolution or --max-memory";
      warnings.push_back(text.str());
    }
    if (wanted[largest_at_] > cap_) {
      text.str("");
      text << "edges of " << wanted[largest_at_] * scale << " are asked for " << near_vertex(sheet, largest_at_)
           << "; they are at most " << cap_ * scale << ", " << kMostLengthRatio << " times the shortest";
      warnings.push_back(text.str());
    }
    return warnings;
  }

 private:
  double floor_, cap_;
  size_t least_at_, largest_at_;
  Buffer<uint32_t> raw_;
};

/// Width of the cells that so many vertices have, over the lengths.
double cell_of_length(const Sheet& sheet, int64_t vertices, Context& context) {
  const double h_sq = double(seed_shares_q16(sheet, context)) / 2 / double(vertices);
  return std::sqrt(h_sq) / double(sheet.lengths.least);
}

int64_t vertices_of_lengths(const Sheet& sheet, Context& context) {
  const double edge_q8 = double(sheet.lengths.least);
  const double vertices = double(seed_shares_q16(sheet, context)) / 2 / (kCellOfEdge * kCellOfEdge * edge_q8 * edge_q8);
  return std::max<int64_t>(4, std::llround(vertices));
}

/// Spreads lengths over six tenths of a mean edge: where limits bend them sharply, cells can only fit by irregular
/// vertices. The limit on their growth still holds. Not those of a field alone, which the user has drawn.
void smooth_lengths(int64_t vertices, int64_t slope_q16, Sheet& sheet, Context& context) {
  const double edge_vox = std::sqrt(sheet_area_world(sheet) / double(vertices)) / kCellOfEdge / sheet.frame.voxel_size;
  const int64_t rounds = std::llround(0.7 * edge_vox * edge_vox);
  EdgeLengths smooth =
      smooth_edge_lengths(sheet, std::move(sheet.lengths), int32_t(std::min(rounds, kMostLengthSmoothing)), context);
  sheet.lengths = limit_edge_lengths(sheet, std::move(smooth.at), slope_q16, context);
}

void measure_edges(const SurfaceMesh& surface, double voxel_size, double edge_of_length,
                   const Buffer<uint32_t>& home_of_vertex, const DualMesh& mesh, SizingReport& report) {
  const Buffer<uint32_t> length = surface.lengths.at.to_host(), home = home_of_vertex.to_host();
  const Buffer<PointQ8> position = mesh.position.to_host();
  const Buffer<TriangleIndices> triangles = mesh.triangles.to_host();
  const double world = voxel_size / kOneVoxelQ8 * edge_of_length;
  report.varies = true;
  report.least_world = surface.lengths.least * world;
  report.largest_world = surface.lengths.largest * world;
  double sum = 0;
  const auto add = [&](uint32_t a, uint32_t b) {
    const double dx = position[b].x - position[a].x, dy = position[b].y - position[a].y,
                 dz = position[b].z - position[a].z;
    const double target = (double(length[home[a]]) + double(length[home[b]])) / 2 * edge_of_length;
    sum += std::abs(std::sqrt(dx * dx + dy * dy + dz * dz) / target - 1);
  };
  for (const TriangleIndices& t : triangles) add(t.a, t.b), add(t.b, t.c), add(t.c, t.a);
  report.edge_error_mean = sum / double(3 * triangles.size());
}

/// The length that a field has at all vertices of the soup, or 0 when it varies or says nothing somewhere.
double even_length_world(const SizingField& field, const TriangleSoup& soup) {
  const std::vector<double> length = field.lengths_at(soup.vertices);
  for (const double l : length)
    if (l != length[0]) return 0;
  return length.empty() ? 0 : length[0];
}

/// Result: warnings.
std::vector<std::string> find_lengths(PreparedSurface& p, Context& context) {
  const RemeshOptions& options = p.options;
  std::vector<std::string> warnings;
  if (!wants_lengths(options)) return warnings;
  Sheet& sheet = p.sheet;
  const std::vector<double> wanted = wanted_lengths(p, context);
  const double first = wanted[0], voxel_size = sheet.frame.voxel_size;
  if (std::all_of(wanted.begin(), wanted.end(), [&](double l) { return l == first; })) {
    if (field_decides(options)) p.vertices_of_lengths = vertices_of_edge(first, sheet_area_world(sheet));
    return warnings;
  }
  const int64_t requested = field_decides(options) ? 0 : target_of(options, sheet_area_world(sheet)).vertices;
  double cell = kCellOfEdge;
  if (requested > 0) {
    sheet.lengths = limit_edge_lengths(sheet, Bounded(wanted, voxel_size, cell).raw(), kMostLengthSlopeQ16, context);
    cell = cell_of_length(sheet, requested, context);
  }
  int64_t slope_q16 = 0;
  for (int round = 0; round < kRounds; ++round) {
    const Bounded bounded(wanted, voxel_size, cell);
    slope_q16 =
        std::min<int64_t>(std::llround((options.gradation - 1) * kCellOfEdge / cell * 65536), kMostLengthSlopeQ16);
    sheet.lengths = limit_edge_lengths(sheet, bounded.raw(), slope_q16, context);
    const double now = requested > 0 ? cell_of_length(sheet, requested, context) : cell;
    const bool has_converged = std::abs(now / cell - 1) < 0.01;
    if (has_converged || round + 1 == kRounds) warnings = bounded.warnings(wanted, sheet, cell / kCellOfEdge);
    cell = now;
    if (has_converged) break;
  }
  if (options.adaptivity > 0)
    smooth_lengths(requested > 0 ? requested : vertices_of_lengths(sheet, context), slope_q16, sheet, context);
  if (requested == 0) p.vertices_of_lengths = vertices_of_lengths(sheet, context);
  return warnings;
}

}  // namespace

double shortest_edge_world(double voxel_size, double cell_of_length) {
  return kFewestCellVox * voxel_size / cell_of_length;
}

bool field_decides(const RemeshOptions& options) {
  return (options.sizing || !options.region_edge_lengths.empty()) && !options.vertices;
}

RequestedLengths requested_lengths(const PreparedSurface& p, bool vary, double usual_world) {
  const RemeshOptions& options = p.options;
  RequestedLengths requested;
  requested.growth = options.gradation - 1;
  if (!vary) return requested;
  requested.field = options.sizing.get();
  requested.adaptivity = options.adaptivity;
  requested.usual_world = usual_world;
  requested.shortest_world = shortest_edge_world(p.surface.frame.voxel_size, kCellOfEdge);
  return requested;
}

bool wants_lengths(const RemeshOptions& options) {
  return options.sizing || options.adaptivity > 0 || !options.region_edge_lengths.empty();
}

double edge_of_strips_world(const PreparedSurface& p) {
  const bool are_creases_off = p.options.features.creases == Features::Creases::off;
  return wants_lengths(p.options) || are_creases_off ? 0 : p.target_of_input.edge_length_world;
}

RemeshOptions with_even_length(RemeshOptions options, const TriangleSoup& soup) {
  if (options.sizing && !options.vertices && options.adaptivity <= 0)
    if (const double length = even_length_world(*options.sizing, soup); length > 0) options.edge_length_world = length;
  return options;
}

std::vector<std::string> set_lengths(PreparedSurface& p, Context& context) {
  std::vector<std::string> warnings = find_lengths(p, context);
  set_target(p);
  return warnings;
}

double smallest_cell_vox(const PreparedSurface& p, Context& context) {
  return cell_of_length(p.sheet, p.target.vertices, context) * double(p.sheet.lengths.least) / kOneVoxelQ8;
}

double edge_of_length(const Sheet& sheet, int64_t vertices, Context& context) {
  return cell_of_length(sheet, vertices, context) / kCellOfEdge;
}

void measure_edges(const Sheet& sheet, const SeedSet& seeds, const DualMesh& mesh, SizingReport& report,
                   Context& context) {
  if (sheet.lengths.at.empty()) return;
  measure_edges(sheet, sheet.frame.voxel_size, edge_of_length(sheet, seeds.size(), context), seeds.home, mesh, report);
}

void measure_edges(const CutSurface& cut, const JoinedPatches& made, SizingReport& report) {
  if (cut.is_requested && !cut.surface.lengths.at.empty())
    measure_edges(cut.surface, cut.frame.voxel_size, 1, made.home, made.mesh, report);
}

}  // namespace isoshell
