// Self-intersections against oracles: separating axes for a pair, all pairs for a mesh.
#include <algorithm>
#include <vector>

#include "cpu/executor_tbb.h"
#include "stages/post_intersections.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/soup_sheet.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

bool is_zero(Vec64 v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// Two closed convex hulls are apart if and only if one of these directions has a gap between their shadows: the
/// normals, the products of an edge of each, and, for what lies in one plane, the normals of edges in that plane.
bool hulls_meet(const std::vector<PointQ8>& a, const std::vector<PointQ8>& b) {
  std::vector<Vec64> edges_a, edges_b, directions;
  const auto edges = [](const std::vector<PointQ8>& p, std::vector<Vec64>& out) {
    for (size_t i = 0; i < p.size(); ++i)
      for (size_t j = 0; j < i; ++j) out.push_back(difference(p[i], p[j]));
  };
  edges(a, edges_a);
  edges(b, edges_b);
  std::vector<Vec64> all = edges_a;
  all.insert(all.end(), edges_b.begin(), edges_b.end());
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
  if (!has_area(s) || !has_area(t)) return false;
  std::vector<PointQ8> shared, rest_s, rest_t;
  for (int i = 0; i < 3; ++i) {
    const bool common = std::count(t.id, t.id + 3, s.id[i]) > 0;
    (common ? shared : rest_s).push_back(s.at[i]);
    if (std::count(s.id, s.id + 3, t.id[i]) == 0) rest_t.push_back(t.at[i]);
  }
  const std::vector<PointQ8> all_s(s.at, s.at + 3), all_t(t.at, t.at + 3);
  if (shared.size() == 3) return false;
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

}  // namespace

TEST_CASE("intersections: pairs of triangles as separating axes say, whatever they share", "[post][stage]") {
  int64_t met[3] = {}, apart[3] = {};
  for (int32_t range : {3, 5, 40, 1000})
    for (uint64_t seed = 0; seed < 3000; ++seed) {
      const CornersOfTriangle s = random_triangle(seed, 0, range);
      for (int shared = 0; shared < 3; ++shared) {
        CornersOfTriangle t = random_triangle(seed, 3, range);
        for (int i = 0; i < shared; ++i) {
          const int from = int((seed + uint64_t(i)) % 3), to = int((seed / 3 + uint64_t(2 * i)) % 3);
          t.id[to] = s.id[from];
          t.at[to] = s.at[from];
        }
        const bool expected = oracle_intersect(s, t);
        INFO("range " << range << ", seed " << seed << ", shared " << shared);
        REQUIRE(triangles_intersect(s, t) == expected);
        REQUIRE(triangles_intersect(t, s) == expected);
        ++(expected ? met : apart)[shared];
      }
    }
  for (int shared = 0; shared < 3; ++shared) {
    CHECK(met[shared] > 20);
    CHECK(apart[shared] > 20);
  }
}

TEST_CASE("intersections: triangles at the far ends of the largest lattice are exact", "[post][stage]") {
  const int32_t far = (1 << 22) - 1;
  const CornersOfTriangle s{{0, 1, 2}, {{0, 0, 0}, {far, 0, far}, {0, far, far}}};
  // A needle that ends on the plane of s, and one that ends a step before it.
  const CornersOfTriangle on{{3, 4, 5}, {{far / 3, far / 3, far / 3 * 2}, {far / 3, far / 3, far}, {far / 3, 1, far}}};
  CHECK(triangles_intersect(s, on));
  CornersOfTriangle off = on;
  ++off.at[0].z;
  CHECK_FALSE(triangles_intersect(s, off));
}

TEST_CASE("intersections: every pair of a mesh is found, with any number of threads", "[post][stage]") {
  const TriangleSoup soups[] = {
      shapes::torus(2, 0.7, 40, 18),
      shapes::together(shapes::torus(2, 0.5, 40, 16), shapes::torus(2.2, 0.5, 30, 16)),
      shapes::together(shapes::sphere({0, 0, 0}, 1, 16), shapes::sphere({0.4, 0.1, 0.2}, 1, 14)),
  };
  int64_t most = 0;
  for (const TriangleSoup& soup : soups)
    for (int32_t noise : {0, 3000}) {
      WorldPoint lo, hi;
      bounding_box(soup, lo, hi);
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
        TbbExecutor exec(context, "test");
        const Buffer<TriangleIndices> t = to_buffer(triangles);
        const Buffer<PointQ8> p = to_buffer(position);
        Buffer<uint32_t> marked(p.size());
        const int32_t blocks[3] = {2, 2, 2};
        const int64_t pairs = run_with_threads(context, [&] {
          return post::find_intersections(exec, {t.view(), p.view()}, blocks, 4, marked.view());
        });
        CHECK(pairs == expected.first);
        CHECK(std::equal(marked.begin(), marked.end(), expected.second.begin()));
      }
    }
  CHECK(most > 100);
}
