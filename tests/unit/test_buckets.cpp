// Sorting by counting, against one stable sort of all items.
#include <algorithm>
#include <utility>
#include <vector>

#include "core/buckets.h"
#include "support/catch.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

using Item = std::pair<uint32_t, uint32_t>;  // bucket, value

/// Per source up to seven items; of few values, so that many are equal.
std::vector<std::vector<Item>> random_items(uint64_t seed, uint32_t buckets, size_t sources, uint32_t values) {
  std::vector<std::vector<Item>> items(sources);
  for (size_t i = 0; i < sources; ++i)
    for (uint64_t k = 0; k < random_bits(seed, i) % 8; ++k) {
      const uint64_t bits = random_bits(seed + 1, 8 * i + k);
      items[i].push_back({uint32_t(bits >> 32) % buckets, uint32_t(bits) % values});
    }
  return items;
}

Buckets<uint32_t> sorted(const std::vector<std::vector<Item>>& items, int64_t buckets) {
  return sort_into_buckets<uint32_t>(buckets, int64_t(items.size()), [&](int64_t i, auto put) {
    for (const auto& [bucket, value] : items[size_t(i)]) put(bucket, value);
  });
}

std::vector<Item> sorted_at_once(const std::vector<std::vector<Item>>& items) {
  std::vector<Item> all;
  for (const auto& of_source : items) all.insert(all.end(), of_source.begin(), of_source.end());
  std::stable_sort(all.begin(), all.end());
  return all;
}

std::vector<Item> listed(const Buckets<uint32_t>& buckets) {
  std::vector<Item> all;
  for (int64_t b = 0; b < buckets.count(); ++b)
    for (const uint32_t value : buckets.in(b)) all.push_back({uint32_t(b), value});
  return all;
}

}  // namespace

TEST_CASE("buckets: random items with many ties are in the order of one stable sort of all", "[core]") {
  for (const uint64_t seed : {1, 2, 3, 4})
    for (const uint32_t buckets : {1u, 7u, 5000u}) {
      const auto items = random_items(seed, buckets, 3000, 50);
      const Buckets<uint32_t> found = sorted(items, buckets);
      CHECK(found.count() == buckets);
      CHECK(listed(found) == sorted_at_once(items));
    }
}

TEST_CASE("buckets: without repeats, every item is once in its bucket", "[core]") {
  for (const uint32_t buckets : {1u, 7u, 5000u}) {
    const auto items = random_items(5, buckets, 3000, 20);
    std::vector<Item> once = sorted_at_once(items);
    once.erase(std::unique(once.begin(), once.end()), once.end());
    const Buckets<uint32_t> found = without_repeats(sorted(items, buckets));
    CHECK(found.count() == buckets);
    CHECK(listed(found) == once);
  }
}

TEST_CASE("buckets: without sources all of them are empty, and there may be none", "[core]") {
  for (const int64_t buckets : {0, 4}) {
    const Buckets<uint32_t> found = without_repeats(sorted({}, buckets));
    CHECK(found.count() == buckets);
    CHECK(listed(found).empty());
  }
}

TEST_CASE("buckets: each offset is the sum of the counts before it", "[core]") {
  Buffer<int64_t> counts(5);
  const std::vector<int64_t> given{3, 0, 2, 5, 0}, offsets{0, 3, 3, 5, 10};
  std::copy(given.begin(), given.end(), counts.begin());
  offsets_from_counts(counts.view());
  CHECK(std::vector<int64_t>(counts.begin(), counts.end()) == offsets);
}
