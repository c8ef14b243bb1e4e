// The same digests whatever the threads, the order of the faces or the backend.
#include <algorithm>
#include <numeric>

#include "golden/golden_cases.h"
#include "support/catch.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

/// The same faces in another order, with other vertex numbers and each face starting at another corner.
TriangleSoup shuffled(const TriangleSoup& soup, uint64_t seed) {
  const auto by_hash = [&](size_t count, uint64_t salt) {
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return random_bits(seed + salt, a) < random_bits(seed + salt, b); });
    return order;
  };
  TriangleSoup out = soup;
  const std::vector<uint32_t> vertex_at = by_hash(soup.vertices.size(), 0),
                              triangle_at = by_hash(soup.triangles.size(), 1);
  for (size_t i = 0; i < vertex_at.size(); ++i) out.vertices[vertex_at[i]] = soup.vertices[i];
  for (size_t i = 0; i < triangle_at.size(); ++i) {
    std::array<uint32_t, 3> t = soup.triangles[i];
    std::rotate(t.begin(), t.begin() + random_bits(seed, i) % 3, t.end());
    for (uint32_t& v : t) v = vertex_at[v];
    out.triangles[triangle_at[i]] = t;
  }
  return out;
}

template <class Case>
std::string run_with_threads(const Case& c, int threads) {
  TestContext context;
  context.threads = threads;
  return golden::run(c, context);
}

}  // namespace

TEST_CASE("parity: one thread and several give the same products", "[parity]") {
  for (const golden::Case& c : golden::cases()) {
    const std::string one = run_with_threads(c, 1);
    CHECK(run_with_threads(c, 2) == one);
    CHECK(run_with_threads(c, 5) == one);
  }
}

TEST_CASE("parity: one thread and several give the same files of whole runs with default options", "[parity]") {
  for (const golden::RunCase& c : golden::run_cases()) CHECK(run_with_threads(c, 1) == run_with_threads(c, 3));
}

TEST_CASE("parity: the order of faces and vertices in the input does not matter", "[parity]") {
  for (golden::Case c : golden::cases()) {
    const std::string as_given = run_with_threads(c, 2);
    const TriangleSoup other = shuffled(c.shape(), 5);
    c.shape = [&] { return other; };
    CHECK(run_with_threads(c, 2) == as_given);
  }
}
