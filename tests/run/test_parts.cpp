// Random parts, as a lathe and an extruder make them: whatever their proportions, creases are kept and triangles good.
#include <algorithm>
#include <cmath>
#include <map>

#include "isoshell/mesh_topology.h"
#include "isoshell/quality.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

constexpr double kTurn = 6.283185307179586;

class Random {
 public:
  explicit Random(uint64_t seed) : seed_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * double(random_bits(seed_, next_++) >> 11) / double(uint64_t(1) << 53);
  }
  uint32_t below(uint32_t end) { return uint32_t(random_bits(seed_, next_++) % end); }

 private:
  uint64_t seed_, next_ = 0;
};

struct Part {
  std::string name;
  TriangleSoup soup;
  int64_t genus = 0;
};

/// Rings of `sides` points each, joined one to the next by quads. Faces look away from what is on the left of the
/// rings' order.
void join_rings(TriangleSoup& soup, uint32_t sides, uint32_t from, uint32_t to) {
  for (uint32_t i = 0; i < sides; ++i) {
    const uint32_t j = (i + 1) % sides;
    soup.triangles.push_back({from + i, from + j, to + j});
    soup.triangles.push_back({from + i, to + j, to + i});
  }
}

/// A profile of cylinders and cones turned around z: with four sides boxes on one another, with bevels.
Part turned_part(uint64_t seed) {
  Random random(seed);
  const uint32_t sides = std::array<uint32_t, 5>{4, 5, 6, 24, 48}[random.below(5)];
  Part part{"lathe of " + std::to_string(sides) + " sides", {}, 0};
  std::vector<std::array<double, 2>> profile;  // radius, height
  double height = 0;
  for (uint32_t step = 0, steps = 1 + random.below(3); step <= steps; ++step) {
    const double radius = random.between(0.5, 1.5), top = random.below(2) ? radius : radius * random.between(0.7, 0.95);
    profile.push_back({radius, height});
    height += random.between(0.3, 1.2);
    profile.push_back({top, height});
  }
  for (const auto& [radius, z] : profile)
    for (uint32_t i = 0; i < sides; ++i)
      part.soup.vertices.push_back({radius * std::cos(kTurn * i / sides), radius * std::sin(kTurn * i / sides), z});
  for (uint32_t r = 0; r + 1 < profile.size(); ++r) join_rings(part.soup, sides, r * sides, (r + 1) * sides);
  const auto bottom = uint32_t(part.soup.vertices.size()), last = uint32_t(profile.size() - 1) * sides;
  part.soup.vertices.push_back({0, 0, 0});
  part.soup.vertices.push_back({0, 0, height});
  for (uint32_t i = 0; i < sides; ++i) {
    part.soup.triangles.push_back({bottom, (i + 1) % sides, i});
    part.soup.triangles.push_back({bottom + 1, last + i, last + (i + 1) % sides});
  }
  return part;
}

/// A random polygon with a hole, drawn out to a plate.
Part drawn_part(uint64_t seed) {
  Random random(seed);
  const uint32_t sides = 5 + random.below(8);
  Part part{"plate of " + std::to_string(sides) + " sides", {}, 1};
  const double hole = random.between(0.3, 0.6), thickness = random.between(0.1, 0.6);
  std::vector<double> radius;
  for (uint32_t i = 0; i < sides; ++i) radius.push_back(random.between(0.9, 1.4));
  // outer below, outer above, inner above, inner below
  for (const auto& [is_inner, z] : {std::pair(false, 0.), {false, thickness}, {true, thickness}, {true, 0.}})
    for (uint32_t i = 0; i < sides; ++i) {
      const double r = is_inner ? hole : radius[i];
      part.soup.vertices.push_back({r * std::cos(kTurn * i / sides), r * std::sin(kTurn * i / sides), z});
    }
  for (uint32_t ring = 0; ring < 4; ++ring) join_rings(part.soup, sides, ring * sides, (ring + 1) % 4 * sides);
  return part;
}

WorldPoint minus(const WorldPoint& a, const WorldPoint& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double dot(const WorldPoint& a, const WorldPoint& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
WorldPoint cross(const WorldPoint& a, const WorldPoint& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The edges whose faces turn by more than 50 degrees.
std::vector<std::array<uint32_t, 2>> sharp_edges(const TriangleSoup& soup) {
  std::map<std::array<uint32_t, 2>, std::vector<WorldPoint>> normals;
  for (const auto& t : soup.triangles) {
    const WorldPoint n =
        cross(minus(soup.vertices[t[1]], soup.vertices[t[0]]), minus(soup.vertices[t[2]], soup.vertices[t[0]]));
    for (size_t i = 0; i < 3; ++i)
      normals[{std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])}].push_back(n);
  }
  std::vector<std::array<uint32_t, 2>> sharp;
  for (const auto& [edge, n] : normals)
    if (dot(n[0], n[1]) < 0.6427876 * std::sqrt(dot(n[0], n[0]) * dot(n[1], n[1]))) sharp.push_back(edge);
  return sharp;
}

double distance_to_segment(const WorldPoint& p, const WorldPoint& a, const WorldPoint& b) {
  const WorldPoint along = minus(b, a);
  const double t = std::clamp(dot(minus(p, a), along) / dot(along, along), 0., 1.);
  const WorldPoint off = minus(p, {a.x + t * along.x, a.y + t * along.y, a.z + t * along.z});
  return std::sqrt(dot(off, off));
}

/// Farthest that the middle of a sharp edge of the input is from all edges of the result.
double farthest_sharp_edge(const TriangleSoup& soup, const TriangleMesh& mesh) {
  double farthest = 0;
  for (const auto& [u, v] : sharp_edges(soup)) {
    const WorldPoint &a = soup.vertices[u], &b = soup.vertices[v];
    double nearest = 1e300;
    for (const auto& t : mesh.triangles)
      for (size_t i = 0; i < 3; ++i)
        nearest = std::min(nearest, distance_to_segment({(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2},
                                                        mesh.vertices[t[i]], mesh.vertices[t[(i + 1) % 3]]));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

}  // namespace

TEST_CASE("parts: turned and drawn ones keep their creases, with good triangles and the count", "[parts]") {
  TestContext context;
  constexpr int64_t kVertices = 900;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const Part part = seed % 2 ? turned_part(seed) : drawn_part(seed);
    INFO(part.name << ", seed " << seed);
    RemeshOptions options;
    options.vertices = kVertices;
    const RemeshResult result = remesh(part.soup, options, context);
    const MeshTopology topology = check_mesh(result.mesh);
    CHECK(topology.is_closed_manifold());
    CHECK(topology.components == 1);
    CHECK(topology.genus == part.genus);
    CHECK(result.report.features.kept);
    CHECK(result.report.optimize.self_intersections == 0);
    CHECK(int64_t(result.mesh.vertices.size()) == kVertices);
    CHECK(measure_quality(result.mesh).theta_min_deg > 20);
    const double edge = std::sqrt(result.report.input.topology.area_world * 1.1547 / kVertices);
    CHECK(farthest_sharp_edge(part.soup, result.mesh) < 0.1 * edge);
  }
}
