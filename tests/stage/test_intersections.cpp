// Self-intersections against oracles: separating axes for a pair, all pairs for a mesh.
#include <algorithm>
#include <vector>

#include "cpu/executor_tbb.h"
#include "stages/halfedge/intersections.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/soup_sheet.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

bool is_zero(Vec64 v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// Two closed convex hulls are apart if and only if one of these directions has a gap between their shadows: the
/// normals, the products of an edge of each, for what lies in one plane the normals of edges in that plane, and for
/// what lies on one line that line. Lines between points of both stand for edges where a hull is a point.
bool hulls_meet(const std::vector<PointQ8>& a, const std::vector<PointQ8>& b) {
  std::vector<PointQ8> both = a;
  both.insert(both.end(), b.begin(), b.end());
  std::vector<Vec64> all;
  for (size_t i = 0; i < both.size(); ++i)
    for (size_t j = 0; j < i; ++j) all.push_back(difference(both[i], both[j]));
  std::vector<Vec64> directions = all;
  for (const Vec64& e : all)
    for (const Vec64& f : all) {
      const Vec64 n = cross(e, f);
      if (is_zero(n)) continue;
      directions.push_back(n);
      for (const Vec64& g : all) directions.push_back(cross(n, g));
    }
  for (const Vec64& d : directions) {
    const auto range = [&](const std::vector<PointQ8>& points) {
      std::pair<int64_t, int64_t> r{INT64_MAX, INT64_MIN};
      for (const PointQ8& p : points) {
        const int64_t at = dot(d, {p.x, p.y, p.z});
        r = {std::min(r.first, at), std::max(r.second, at)};
      }
      return r;
    };
    const auto ra = range(a), rb = range(b);
    if (ra.second < rb.first || rb.second < ra.first) return false;
  }
  return true;
}

bool has_area(const CornersOfTriangle& t) {
  return !is_zero(cross(difference(t.at[1], t.at[0]), difference(t.at[2], t.at[0])));
}

/// What triangles_intersect promises, from hulls alone.
bool oracle_intersect(const CornersOfTriangle& s, const CornersOfTriangle& t) {
  std::vector<PointQ8> shared, rest_s, rest_t;
  for (int i = 0; i < 3; ++i) {
    const bool common = std::count(t.id, t.id + 3, s.id[i]) > 0;
    (common ? shared : rest_s).push_back(s.at[i]);
    if (std::count(s.id, s.id + 3, t.id[i]) == 0) rest_t.push_back(t.at[i]);
  }
  const std::vector<PointQ8> all_s(s.at, s.at + 3), all_t(t.at, t.at + 3);
  if (shared.size() == 3) return false;
  if (shared.size() == 2 && (!has_area(s) || !has_area(t)))
    return hulls_meet(rest_s, all_t) || hulls_meet(rest_t, all_s);
  if (shared.size() == 2) {  // only in one plane, on one side of the edge
    const Vec64 e = difference(shared[1], shared[0]), m = cross(e, difference(rest_s[0], shared[0])),
                n = cross(e, difference(rest_t[0], shared[0]));
    return is_zero(cross(m, n)) && dot(m, n) > 0;
  }
  if (shared.size() == 1) return hulls_meet(rest_s, all_t) || hulls_meet(rest_t, all_s);
  return hulls_meet(all_s, all_t);
}

CornersOfTriangle random_triangle(uint64_t seed, uint32_t first_id, int32_t range) {
  CornersOfTriangle t;
  for (uint32_t i = 0; i < 3; ++i) {
    const uint64_t bits = random_bits(seed, first_id + i);
    t.id[i] = first_id + i;
    t.at[i] = {1000 + int32_t(bits % uint64_t(range)), 1000 + int32_t((bits >> 20) % uint64_t(range)),
               1000 + int32_t((bits >> 40) % uint64_t(range))};
  }
  return t;
}

/// Moves the corners of a triangle onto a line, or to a point.
void flatten(CornersOfTriangle& t, uint64_t how) {
  PointQ8 *a = &t.at[how % 3], *b = &t.at[(how + 1) % 3], *c = &t.at[(how + 2) % 3];
  const PointQ8 far = {2 * b->x - a->x, 2 * b->y - a->y, 2 * b->z - a->z};
  switch (how / 3 % 4) {
    case 0:
      *c = *b;
      break;
    case 1:
      *c = *b = *a;
      break;
    case 2:
      *c = far;
      break;
    default:
      *c = *b, *b = far;
      break;
  }
}

/// Gives t the corners of s in `count` places.
void share_corners(const CornersOfTriangle& s, CornersOfTriangle& t, int count, uint64_t how) {
  for (int i = 0; i < count; ++i) {
    const int from = int((how + uint64_t(i)) % 3), to = int((how / 3 + uint64_t(2 * i)) % 3);
    t.id[to] = s.id[from];
    t.at[to] = s.at[from];
  }
}

/// Pairs that intersect and the corners of their triangles.
std::pair<int64_t, std::vector<uint32_t>> brute_force(const std::vector<TriangleIndices>& triangles,
                                                      const std::vector<PointQ8>& position) {
  std::pair<int64_t, std::vector<uint32_t>> out{0, std::vector<uint32_t>(position.size())};
  const auto corners = [&](const TriangleIndices& i) {
    return CornersOfTriangle{{i.a, i.b, i.c}, {position[i.a], position[i.b], position[i.c]}};
  };
  for (size_t s = 0; s < triangles.size(); ++s)
    for (size_t t = 0; t < s; ++t) {
      if (!triangles_intersect(corners(triangles[s]), corners(triangles[t]))) continue;
      ++out.first;
      for (const TriangleIndices& i : {triangles[s], triangles[t]})
        out.second[i.a] = out.second[i.b] = out.second[i.c] = 1;
    }
  return out;
}

/// Holds the test to the oracle and counts, by the number of shared corners, how often each answer was right.
struct OracleTally {
  int64_t met[3] = {}, apart[3] = {};

  void compare(const CornersOfTriangle& s, const CornersOfTriangle& t, int shared) {
    const bool expected = oracle_intersect(s, t);
    INFO("shared " << shared);
    REQUIRE(triangles_intersect(s, t) == expected);
    REQUIRE(triangles_intersect(t, s) == expected);
    ++(expected ? met : apart)[shared];
  }
  void check_that_both_occur() const {
    for (int shared = 0; shared < 3; ++shared) {
      CHECK(met[shared] > 20);
      CHECK(apart[shared] > 20);
    }
  }
};

}  // namespace

TEST_CASE("intersections: pairs of triangles as separating axes say, whatever they share", "[optimize][stage]") {
  OracleTally tally;
  for (int32_t range : {3, 5, 40, 1000})
    for (uint64_t seed = 0; seed < 3000; ++seed) {
      const CornersOfTriangle s = random_triangle(seed, 0, range);
      for (int shared = 0; shared < 3; ++shared) {
        CornersOfTriangle t = random_triangle(seed, 3, range);
        share_corners(s, t, shared, seed);
        INFO("range " << range << ", seed " << seed);
        tally.compare(s, t, shared);
      }
    }
  tally.check_that_both_occur();
}

TEST_CASE("intersections: triangles without area are the segments or points that they span", "[optimize][stage]") {
  OracleTally tally;
  for (int32_t range : {2, 3, 5})
    for (uint64_t seed = 0; seed < 3000; ++seed)
      for (int shared = 0; shared < 3; ++shared) {
        CornersOfTriangle s = random_triangle(seed, 0, range), t = random_triangle(seed, 3, range);
        flatten(s, seed);
        share_corners(s, t, shared, seed / 5);
        if (shared < 2 && seed % 2 == 0) {
          flatten(t, seed / 7);
          share_corners(s, t, shared, seed / 5);  // they stay where they are in s
        }
        INFO("range " << range << ", seed " << seed);
        tally.compare(s, t, shared);
      }
  tally.check_that_both_occur();
}

TEST_CASE("intersections: a needle pierces, and one that ends on its own edge is folded", "[optimize][stage]") {
  const CornersOfTriangle wall{{0, 1, 2}, {{0, 0, 0}, {90, 0, 0}, {0, 90, 0}}};
  const auto needle = [](int32_t z0, int32_t z1) {
    return CornersOfTriangle{{3, 4, 5}, {{20, 20, z0}, {20, 20, z1}, {20, 20, (z0 + z1) / 2}}};
  };
  CHECK(triangles_intersect(wall, needle(-10, 10)));
  CHECK(triangles_intersect(wall, needle(0, 10)));
  CHECK_FALSE(triangles_intersect(wall, needle(1, 10)));
  CHECK(triangles_intersect(wall, needle(0, 0)));
  CHECK(triangles_intersect(wall, {{0, 1, 6}, {{0, 0, 0}, {90, 0, 0}, {45, 0, 0}}}));
  CHECK_FALSE(triangles_intersect(wall, {{0, 1, 6}, {{0, 0, 0}, {90, 0, 0}, {120, 0, 0}}}));
}

TEST_CASE("intersections: triangles at the far ends of the largest lattice are exact", "[optimize][stage]") {
  const int32_t far = (1 << 22) - 1;
  const CornersOfTriangle s{{0, 1, 2}, {{0, 0, 0}, {far, 0, far}, {0, far, far}}};
  // A needle that ends on the plane of s, and one that ends a step before it.
  const CornersOfTriangle on{{3, 4, 5}, {{far / 3, far / 3, far / 3 * 2}, {far / 3, far / 3, far}, {far / 3, 1, far}}};
  CHECK(triangles_intersect(s, on));
  CornersOfTriangle off = on;
  ++off.at[0].z;
  CHECK_FALSE(triangles_intersect(s, off));
}

namespace {

/// What find_intersections says of triangles on a lattice of 2048 voxels a side.
std::pair<int64_t, std::vector<uint32_t>> found_in(const std::vector<TriangleIndices>& triangles,
                                                   const std::vector<PointQ8>& position, int64_t spacing_vox,
                                                   Context& context, const std::vector<uint32_t>& has_moved = {}) {
  PlainExecutor exec(context, "test");
  const Buffer<TriangleIndices> t = to_buffer(triangles);
  const Buffer<PointQ8> p = to_buffer(position);
  const Buffer<uint32_t> moved = to_buffer(has_moved);
  Buffer<uint32_t> marked(p.size());
  const int32_t extent_vox[3] = {2048, 2048, 2048};
  const int64_t pairs = run_with_threads(context, [&] {
    return optimize::find_intersections(exec, {t.view(), p.view()}, extent_vox, spacing_vox, marked.view(),
                                        moved.view());
  });
  return {pairs, {marked.begin(), marked.end()}};
}

/// A square tube along x of small triangles, eight a ring.
void add_tube(int32_t rings, int32_t step, std::vector<TriangleIndices>& triangles, std::vector<PointQ8>& position) {
  const auto first = uint32_t(position.size());
  for (int32_t i = 0; i < rings; ++i)
    for (const auto& [y, z] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      position.push_back({1000 + i * step, 1000 + y * step, 1000 + z * step});
  for (uint32_t i = 0; i + 1 < uint32_t(rings); ++i)
    for (uint32_t side = 0; side < 4; ++side) {
      const uint32_t a = first + 4 * i + side, b = first + 4 * i + (side + 1) % 4;
      triangles.push_back({a, b, b + 4});
      triangles.push_back({a, b + 4, a + 4});
    }
}

}  // namespace

TEST_CASE("intersections: triangles of all sizes find each other", "[optimize][stage]") {
  std::vector<TriangleIndices> triangles;
  std::vector<PointQ8> position;
  add_tube(60, 512, triangles, position);
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const int32_t range = 800 << seed % 8;  // the largest is as large as the lattice
    const CornersOfTriangle t = random_triangle(seed, uint32_t(position.size()), range);
    triangles.push_back({t.id[0], t.id[1], t.id[2]});
    position.insert(position.end(), t.at, t.at + 3);
  }
  const auto expected = brute_force(triangles, position);
  CHECK(expected.first > 200);
  for (int threads : {1, 2})
    for (int64_t spacing_vox : {1, 2, 30}) {
      Context context;
      context.threads = threads;
      CHECK(found_in(triangles, position, spacing_vox, context) == expected);
    }
}

TEST_CASE("intersections: after some vertices have moved, their triangles find what intersects", "[optimize][stage]") {
  std::vector<TriangleIndices> triangles;
  std::vector<PointQ8> position;
  add_tube(60, 512, triangles, position);
  for (uint64_t seed = 0; seed < 20; ++seed) {  // of all sizes, apart from each other and from the tube
    const auto first = uint32_t(position.size());
    const auto x = int32_t(20000 * (seed + 1)), size = int32_t(300 << seed % 6);
    position.insert(position.end(), {{x, 90000, 1000}, {x + size, 90000, 1000}, {x, 90000 + size, 1000}});
    triangles.push_back({first, first + 1, first + 2});
  }
  Context context;
  REQUIRE(found_in(triangles, position, 2, context).first == 0);
  std::vector<uint32_t> has_moved(position.size(), 0);
  for (size_t v = 0; v < position.size(); v += 7) {
    has_moved[v] = 1;
    position[v] = {position[v].x + 700, position[v].y - int32_t(v % 3) * 600, position[v].z + 300};
  }
  for (size_t v = position.size() - 1; v > position.size() - 31; v -= 5)
    has_moved[v] = 1, position[v] = {9000, 1200, 900};
  const auto expected = found_in(triangles, position, 2, context);
  CHECK(expected.first > 20);
  CHECK(found_in(triangles, position, 2, context, has_moved) == expected);
}

TEST_CASE("intersections: one huge triangle beside a rod of 100,000 small ones", "[optimize][stage]") {
  std::vector<TriangleIndices> triangles;
  std::vector<PointQ8> position;
  const int32_t step = 40, rings = 12501, length = rings * step;
  add_tube(rings, step, triangles, position);
  REQUIRE(triangles.size() == 100000);
  const auto at = [&](int32_t x, int32_t y) {
    position.push_back({x, y, 1000 + step / 2});
    return uint32_t(position.size() - 1);
  };
  // It runs along the rod, and passes through it at one end.
  triangles.push_back({at(1000 + length / 2 + 7, 990), at(1000 + length, 1100), at(500, 1100)});
  Context context;
  const auto found = found_in(triangles, position, 1, context);
  int64_t pairs = 0;
  const auto corners = [&](const TriangleIndices& i) {
    return CornersOfTriangle{{i.a, i.b, i.c}, {position[i.a], position[i.b], position[i.c]}};
  };
  for (size_t t = 0; t + 1 < triangles.size(); ++t)
    pairs += triangles_intersect(corners(triangles.back()), corners(triangles[t]));
  CHECK(found.first == pairs);
  CHECK(pairs > 1000);
}

TEST_CASE("intersections: every pair of a mesh is found, with any number of threads", "[optimize][stage]") {
  const TriangleSoup soups[] = {
      shapes::torus(2, 0.7, 40, 18),
      shapes::together(shapes::torus(2, 0.5, 40, 16), shapes::torus(2.2, 0.5, 30, 16)),
      shapes::together(shapes::sphere({0, 0, 0}, 1, 16), shapes::sphere({0.4, 0.1, 0.2}, 1, 14)),
  };
  int64_t most = 0;
  for (const TriangleSoup& soup : soups)
    for (int32_t noise : {0, 3000}) {
      const auto [lo, hi] = bounding_box(soup);
      const LatticeFrame frame = LatticeFrame::around(lo, hi, 100);
      std::vector<PointQ8> position;
      for (const WorldPoint& p : soup.vertices) {
        const uint64_t bits = random_bits(7, position.size());
        PointQ8 q = frame.snap(p);
        if (noise > 0) q.x += int32_t(bits % uint64_t(noise)), q.y += int32_t((bits >> 30) % uint64_t(noise));
        position.push_back(q);
      }
      std::vector<TriangleIndices> triangles;
      for (const auto& t : soup.triangles) triangles.push_back({t[0], t[1], t[2]});
      const auto expected = brute_force(triangles, position);
      most = std::max(most, expected.first);
      for (int threads : {1, 2}) {
        Context context;
        context.threads = threads;
        PlainExecutor exec(context, "test");
        const Buffer<TriangleIndices> t = to_buffer(triangles);
        const Buffer<PointQ8> p = to_buffer(position);
        Buffer<uint32_t> marked(p.size());
        const int32_t extent_vox[3] = {256, 256, 256};
        const int64_t pairs = run_with_threads(context, [&] {
          return optimize::find_intersections(exec, {t.view(), p.view()}, extent_vox, 4, marked.view());
        });
        CHECK(pairs == expected.first);
        CHECK(std::equal(marked.begin(), marked.end(), expected.second.begin()));
      }
    }
  CHECK(most > 100);
}
