// The simple-point test against its definition, and growing on shapes whose handles are known.
#include <cstdlib>
#include <vector>

#include "cpu/sheet/handle_cutter.h"
#include "support/catch.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

struct Place {
  int x, y, z;
};
Place place(int bit) { return {bit / 9 - 1, bit / 3 % 3 - 1, bit % 3 - 1}; }
int apart(int a, int b) { return std::abs(a - b); }

/// Parts of the bits of `among` by flooding, two bits joined when join(a, b); only those that hold a bit of `starts`.
template <class Join>
int parts(uint32_t among, uint32_t starts, Join join) {
  std::vector<int> part(27, -1);
  int count = 0;
  for (int start = 0; start < 27; ++start) {
    if (!((among & starts) >> start & 1) || part[size_t(start)] >= 0) continue;
    std::vector<int> stack{start};
    part[size_t(start)] = count;
    while (!stack.empty()) {
      const Place p = place(stack.back());
      stack.pop_back();
      for (int b = 0; b < 27; ++b) {
        if (!(among >> b & 1) || part[size_t(b)] >= 0 || !join(p, place(b))) continue;
        part[size_t(b)] = count;
        stack.push_back(b);
      }
    }
    ++count;
  }
  return count;
}

VoxelContacts contacts_by_definition(uint32_t solid) {
  const auto share_corner = [](Place a, Place b) {
    return apart(a.x, b.x) <= 1 && apart(a.y, b.y) <= 1 && apart(a.z, b.z) <= 1;
  };
  const auto share_face = [](Place a, Place b) { return apart(a.x, b.x) + apart(a.y, b.y) + apart(a.z, b.z) == 1; };
  uint32_t faces = 0, edges = 0, around = 0;
  for (int b = 0; b < 27; ++b) {
    const Place p = place(b);
    const int away = apart(p.x, 0) + apart(p.y, 0) + apart(p.z, 0);
    faces |= uint32_t(away == 1) << b;
    edges |= uint32_t(away == 1 || away == 2) << b;
    around |= uint32_t(away != 0) << b;
  }
  return {parts(solid & around, around, share_corner), parts(~solid & edges, faces, share_face)};
}

/// A box of 24^3 voxels with the solid of inside(x, y, z); the ranks are x.
template <class Inside>
HandleCutter cutter_of(Inside inside) {
  const int32_t extent[3] = {24, 24, 24};
  HandleCutter cutter(extent);
  for (int32_t x = 1; x < 23; ++x)
    for (int32_t y = 1; y < 23; ++y)
      for (int32_t z = 1; z < 23; ++z)
        if (inside(x, y, z)) cutter.add(cutter.index_of({x, y, z}), x);
  return cutter;
}
bool square_ring(int x, int y, int z, int lo, int hi) {
  const auto within = [](int a, int from, int to) { return a >= from && a <= to; };
  return within(x, lo, hi) && within(y, lo, hi) && within(z, 10, 12) &&
         !(within(x, lo + 3, hi - 3) && within(y, lo + 3, hi - 3));
}

}  // namespace

TEST_CASE("handle cutter: contacts of a voxel are those of the definition", "[sheet][unit]") {
  for (uint64_t i = 0; i < 30000; ++i) {
    uint32_t solid = uint32_t(random_bits(1, i));
    if (i % 3 == 1) solid &= uint32_t(random_bits(2, i));  // few neighbours, and many
    if (i % 3 == 2) solid |= uint32_t(random_bits(3, i));
    solid &= 0x7ffffff;
    const VoxelContacts found = contacts_of(solid), expected = contacts_by_definition(solid);
    REQUIRE(found.solid == expected.solid);
    REQUIRE(found.empty == expected.empty);
  }
}

TEST_CASE("handle cutter: a ring is cut where its ranks are highest, or not when it may have a handle",
          "[sheet][unit]") {
  const auto ring = [](int x, int y, int z) { return square_ring(x, y, z, 3, 16); };
  HandleCutter cut = cutter_of(ring);
  cut.grow(0, [] {});
  REQUIRE_FALSE(cut.cuts().empty());
  for (const int64_t v : cut.cuts()) CHECK(cut.voxel_of(v).x >= 14);
  HandleCutter whole = cutter_of(ring);
  whole.grow(1, [] {});
  CHECK(whole.cuts().empty());
  cut.close_cuts_below(14);  // the cut lies beyond
  CHECK_FALSE(cut.cuts().empty());
  cut.close_cuts_below(24);
  CHECK(cut.cuts().empty());
}

TEST_CASE("handle cutter: a solid without handles is grown whole, each component of it", "[sheet][unit]") {
  HandleCutter cutter = cutter_of([](int x, int y, int z) {
    const bool ball = (x - 7) * (x - 7) + (y - 7) * (y - 7) + (z - 7) * (z - 7) <= 30;
    const bool plate = x >= 15 && x <= 16 && y > 2 && y < 20 && z > 2 && z < 20;
    return ball || plate;
  });
  cutter.grow(0, [] {});
  CHECK(cutter.cuts().empty());
}
