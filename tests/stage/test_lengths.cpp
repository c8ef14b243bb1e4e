// Edge lengths of a sheet: their limit, their way onto coarse proxies, and curvature.
#include <algorithm>
#include <cmath>
#include <queue>
#include <set>

#include "isoshell/advanced/to_host.h"
#include "isoshell/error.h"
#include "isoshell/remesh.h"
#include "stages/labels/edge_lengths.h"
#include "support/catch.h"
#include "support/relax_sheets.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

Buffer<uint32_t> random_lengths(const Sheet& sheet, uint32_t most) {
  Buffer<uint32_t> raw(sheet.vertex_count());
  for (int64_t v = 0; v < raw.size(); ++v) {
    const uint64_t r = random_bits(7, uint64_t(v));
    raw[v] = r % 400 == 0 ? 200 + uint32_t(r >> 40) % 1000 : most;
  }
  return raw;
}

/// Shortest paths from all vertices at once, by Dijkstra.
std::vector<uint32_t> limited(const Sheet& sheet, const Buffer<uint32_t>& raw, int64_t slope_q16) {
  std::vector<std::vector<uint32_t>> around(size_t(sheet.vertex_count()));
  for (const TriangleIndices& t : sheet.triangles)
    for (const auto& [u, v] : {std::pair{t.a, t.b}, {t.b, t.c}, {t.c, t.a}}) around[u].push_back(v);
  std::vector<uint32_t> length(raw.begin(), raw.end());
  using Reached = std::pair<uint64_t, uint32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
  for (int64_t v = 0; v < raw.size(); ++v) next.push({raw[v], uint32_t(v)});
  while (!next.empty()) {
    const auto [here, u] = next.top();
    next.pop();
    if (here > length[u]) continue;
    for (const uint32_t v : around[u]) {
      const auto way = int64_t(isqrt(uint64_t(distance_sq_q16(sheet.position[u], sheet.position[v]))));
      const uint64_t there = here + uint64_t(way * slope_q16 >> 16);
      if (there >= length[v]) continue;
      length[v] = uint32_t(there);
      next.push({there, v});
    }
  }
  return length;
}

}  // namespace

TEST_CASE("lengths: the limit of their growth is that of shortest paths, whatever the threads", "[lengths][stage]") {
  for (const int64_t slope_q16 : {int64_t(0), int64_t(13107), int64_t(65536), kMostLengthSlopeQ16})
    for (const int threads : {1, 3}) {
      TestContext context;
      context.threads = threads;
      const Sheet plain = torus_sheet();
      const Buffer<uint32_t> raw = random_lengths(plain, 100000);
      const std::vector<uint32_t> expected = limited(plain, raw, slope_q16);
      Sheet sheet = torus_sheet();
      sheet.lengths = limit_edge_lengths(sheet, raw.to_host(), slope_q16, context);
      const Buffer<uint32_t> at = sheet.lengths.at.to_host();
      CHECK(std::equal(at.begin(), at.end(), expected.begin(), expected.end()));
      CHECK(sheet.lengths.least == *std::min_element(expected.begin(), expected.end()));
      CHECK(sheet.lengths.largest == *std::max_element(expected.begin(), expected.end()));
    }
  TestContext context;
  Sheet sheet = torus_sheet();
  CHECK_THROWS_AS(limit_edge_lengths(sheet, Buffer<uint32_t>(3), 100, context), Error);
  CHECK_THROWS_AS(limit_edge_lengths(sheet, random_lengths(sheet, 9), -1, context), Error);
}

TEST_CASE("lengths: shares of the seeds add up to the area where lengths are equal", "[lengths][stage]") {
  TestContext context;
  const int64_t even = seed_shares_q16(torus_sheet(), context);
  CHECK(seed_shares_q16(with_lengths(torus_sheet(), 1), context) == even);
  const int64_t varied = seed_shares_q16(with_lengths(torus_sheet(), 8), context);
  CHECK(varied < even / 2);
  CHECK(varied > even / 64);
}

TEST_CASE("lengths: those of another sheet are taken from its nearest vertices", "[lengths][stage]") {
  TestContext context;
  const Sheet from = with_lengths(torus_sheet(), 8);
  Sheet to = torus_sheet();
  to.lengths = transfer_edge_lengths(from, 0, to, context);
  const Buffer<uint32_t> at = to.lengths.at.to_host();
  CHECK(std::equal(at.begin(), at.end(), from.lengths.at.begin(), from.lengths.at.end()));
  CHECK(to.lengths.least == from.lengths.least);
}

TEST_CASE("lengths: a transfer refuses a surface without lengths, and halvings that can not be", "[lengths][stage]") {
  TestContext context;
  const Sheet without = torus_sheet(), from = with_lengths(torus_sheet(), 8), to = torus_sheet();
  CHECK_THROWS_AS(transfer_edge_lengths(without, 0, to, context), Error);
  CHECK_THROWS_AS(transfer_edge_lengths(SurfaceMesh(), 0, to, context), Error);
  for (const int halvings : {-1, 31}) CHECK_THROWS_AS(transfer_edge_lengths(from, halvings, to, context), Error);
}

TEST_CASE("lengths: smoothing that is cancelled leaves the caller's lengths as they are", "[lengths][stage]") {
  TestContext context;
  Context& plain = context.plain();
  const Sheet sheet = torus_sheet();
  EdgeLengths lengths = limit_edge_lengths(sheet, random_lengths(sheet, 100000), 13107, plain);
  const Buffer<uint32_t> before = lengths.at.to_host();
  plain.cancel = true;
  CHECK_THROWS_AS(smooth_edge_lengths(sheet, static_cast<EdgeLengths&&>(lengths), 1, plain), Error);  // lent, no more
  const Buffer<uint32_t> after = lengths.at.to_host();
  CHECK(std::equal(before.begin(), before.end(), after.begin(), after.end()));
}

TEST_CASE("lengths: the curvature of a ball is one over its radius, of a flat wall nothing", "[lengths][stage]") {
  TestContext context;
  RemeshOptions options;
  options.resolution = 100;
  const Prepared prepared = prepare(shapes::sphere({0, 0, 0}, 1, 80), options, context);
  const Sheet& ball = prepared.sheet();
  const double radius_vox = 1 / ball.frame.voxel_size;
  const Buffer<uint32_t> turn = measure_curvature(ball, 16, context).to_host();
  double mean = 0;
  for (const uint32_t t : turn) mean += t / 65536.0 / double(turn.size());
  CHECK(std::abs(mean * radius_vox - 1) < 0.15);
  const Sheet plate = plate_sheet();
  const Buffer<uint32_t> flat = measure_curvature(plate, 16, context).to_host();
  PointQ8 lo = plate.position[0], hi = lo;
  for (const PointQ8& p : plate.position)
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), 0}, hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), 0};
  constexpr int32_t kClear = 32 * kOneVoxelQ8;  // of the rim, whose turn is spread
  int64_t inner = 0;
  for (int64_t v = 0; v < plate.vertex_count(); ++v) {
    const PointQ8 p = plate.position[v];
    if (std::min({p.x - lo.x, hi.x - p.x, p.y - lo.y, hi.y - p.y}) < kClear) continue;
    ++inner;
    CHECK(flat[v] < 200);  // 3 / 1000 a voxel
  }
  CHECK(inner > 500);
}

TEST_CASE("lengths: smoothing gives every vertex the mean of its own and its neighbours' length", "[lengths][stage]") {
  TestContext context;
  Sheet sheet = torus_sheet();
  sheet.lengths = limit_edge_lengths(sheet, random_lengths(sheet, 100000), kMostLengthSlopeQ16, context);
  const Buffer<uint32_t> before = sheet.lengths.at.to_host();
  std::vector<std::set<uint32_t>> around(size_t(before.size()));
  for (const TriangleIndices& t : torus_sheet().triangles)
    for (const auto& [u, v] : {std::pair{t.a, t.b}, {t.b, t.c}, {t.c, t.a}})
      around[u].insert({u, v}), around[v].insert(u);
  std::vector<uint32_t> expected;
  for (const std::set<uint32_t>& ring : around) {
    uint64_t sum = ring.size() / 2;
    for (const uint32_t u : ring) sum += before[u];
    expected.push_back(uint32_t(sum / ring.size()));
  }
  sheet.lengths = smooth_edge_lengths(sheet, std::move(sheet.lengths), 1, context);
  const Buffer<uint32_t> after = sheet.lengths.at.to_host();
  CHECK(std::equal(after.begin(), after.end(), expected.begin(), expected.end()));
  CHECK(sheet.lengths.least == *std::min_element(expected.begin(), expected.end()));
  CHECK(sheet.lengths.largest == *std::max_element(expected.begin(), expected.end()));
}
