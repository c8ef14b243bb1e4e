#include "implicit/volumes/crease_intersections.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "core/parallel_ranges.h"
#include "implicit/volumes/tile_borders.h"
#include "voxel/intersect.h"

namespace isoshell {
namespace {

constexpr double kGrains = 65536;  // a voxel: triangles beside creases span a few voxels, intersect.h takes 64

constexpr int kMovedReach = 2;  // voxels: triangles beside a vertex end in cells around its own, or one farther

/// A triangle in a cell that it may reach into.
struct Entry {
  Voxel cell;
  uint32_t triangle;
  bool operator<(const Entry& o) const { return cell == o.cell ? triangle < o.triangle : comes_before(cell, o.cell); }
};

/// Cells that triangles reach into which changed with vertices of these cells, ascending.
std::vector<Voxel> cells_around(const std::vector<Voxel>& moved) {
  std::vector<Voxel> cells;
  for (const Voxel& v : moved)
    for (int x = -kMovedReach; x <= kMovedReach; ++x)
      for (int y = -kMovedReach; y <= kMovedReach; ++y)
        for (int z = -kMovedReach; z <= kMovedReach; ++z) cells.push_back({v.x + x, v.y + y, v.z + z});
  tbb::parallel_sort(cells.begin(), cells.end(), comes_before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

/// Whether the boxes of two triangles are.
bool are_apart(const CornersOfTriangle& s, const CornersOfTriangle& t) {
  const auto apart = [&](auto axis) {
    const auto [low_s, high_s] = std::minmax({s.at[0].*axis, s.at[1].*axis, s.at[2].*axis});
    const auto [low_t, high_t] = std::minmax({t.at[0].*axis, t.at[1].*axis, t.at[2].*axis});
    return high_s < low_t || high_t < low_s;
  };
  return apart(&PointQ8::x) || apart(&PointQ8::y) || apart(&PointQ8::z);
}

class Intersections {
 public:
  Intersections(const TriangleSoup& soup, const std::vector<uint8_t>& is_crease) : soup_(soup), is_crease_(is_crease) {}

  std::vector<uint32_t> find(const std::vector<Voxel>* moved) {
    const std::vector<Voxel> around = moved ? cells_around(*moved) : std::vector<Voxel>{};
    std::vector<Entry> entries =
        list([&](uint32_t t) { return has_crease(t); }, [&](Voxel cell) { return !moved || holds(around, cell); });
    std::vector<Voxel> cells;
    for (const Entry& e : entries)
      if (cells.empty() || cells.back() != e.cell) cells.push_back(e.cell);
    const std::vector<Entry> others =
        list([&](uint32_t t) { return !has_crease(t); }, [&](Voxel cell) { return holds(cells, cell); });
    entries.insert(entries.end(), others.begin(), others.end());
    tbb::parallel_sort(entries.begin(), entries.end());
    return test(entries, cells);
  }

 private:
  static bool holds(const std::vector<Voxel>& cells, Voxel cell) {
    return std::binary_search(cells.begin(), cells.end(), cell, comes_before);
  }
  bool has_crease(uint32_t t) const {
    const auto& v = soup_.triangles[t];
    return is_crease_[v[0]] || is_crease_[v[1]] || is_crease_[v[2]];
  }

  /// Entries of the triangles that are wanted, in the cells that are, ascending.
  template <class WantsTriangle, class WantsCell>
  std::vector<Entry> list(WantsTriangle wants_triangle, WantsCell wants_cell) const {
    tbb::enumerable_thread_specific<std::vector<Entry>> lists;
    for_each_index(size_t(0), soup_.triangles.size(), [&](size_t t) {
      if (!wants_triangle(uint32_t(t))) return;
      std::vector<Entry>& to = lists.local();
      int32_t low[3], high[3];
      for (int a = 0; a < 3; ++a) {
        const double p = place(t, 0, a), q = place(t, 1, a), r = place(t, 2, a);
        low[a] = int32_t(std::floor(std::min({p, q, r}) - 1 / kGrains));
        high[a] = int32_t(std::floor(std::max({p, q, r}) + 1 / kGrains));
      }
      for (int32_t x = low[0]; x <= high[0]; ++x)
        for (int32_t y = low[1]; y <= high[1]; ++y)
          for (int32_t z = low[2]; z <= high[2]; ++z)
            if (wants_cell(Voxel{x, y, z})) to.push_back({{x, y, z}, uint32_t(t)});
    });
    std::vector<Entry> all;
    for (const auto& part : lists) all.insert(all.end(), part.begin(), part.end());
    tbb::parallel_sort(all.begin(), all.end());
    return all;
  }

  double place(size_t t, int corner, int axis) const {
    const WorldPoint& p = soup_.vertices[soup_.triangles[t][size_t(corner)]];
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  }

  CornersOfTriangle corners(uint32_t t, Voxel origin) const {
    CornersOfTriangle made;
    const auto grain = [](double p, int32_t o) { return int32_t(std::floor((p - o) * kGrains + .5)); };
    for (int i = 0; i < 3; ++i) {
      const WorldPoint& p = soup_.vertices[made.id[i] = soup_.triangles[t][size_t(i)]];
      made.at[i] = {grain(p.x, origin.x), grain(p.y, origin.y), grain(p.z, origin.z)};
    }
    return made;
  }

  std::vector<uint32_t> test(const std::vector<Entry>& entries, const std::vector<Voxel>& cells) const {
    std::vector<std::vector<uint32_t>> of_cell(cells.size());
    for_each_index(size_t(0), cells.size(), [&](size_t c) {
      auto first = std::lower_bound(entries.begin(), entries.end(), Entry{cells[c], 0}), last = first;
      while (last != entries.end() && last->cell == cells[c]) ++last;
      std::vector<CornersOfTriangle> here;
      for (auto e = first; e != last; ++e) here.push_back(corners(e->triangle, cells[c]));
      for (auto a = first; a != last; ++a)
        for (auto b = a + 1; b != last; ++b) {
          if (!has_crease(a->triangle) && !has_crease(b->triangle)) continue;
          const CornersOfTriangle &s = here[size_t(a - first)], &t = here[size_t(b - first)];
          if (are_apart(s, t) || !triangles_intersect(s, t)) continue;
          for (const uint32_t either : {a->triangle, b->triangle})
            for (const uint32_t v : soup_.triangles[either])
              if (is_crease_[v]) of_cell[c].push_back(v);
        }
    });
    std::vector<uint32_t> found;
    for (const auto& part : of_cell) found.insert(found.end(), part.begin(), part.end());
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  const TriangleSoup& soup_;
  const std::vector<uint8_t>& is_crease_;
};

}  // namespace

std::vector<uint32_t> find_intersecting(const TriangleSoup& soup, const std::vector<uint8_t>& is_crease,
                                        const std::vector<Voxel>* moved) {
  return Intersections(soup, is_crease).find(moved);
}

}  // namespace isoshell
