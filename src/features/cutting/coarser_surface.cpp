// See coarser_surface.h.
#include "features/cutting/coarser_surface.h"

#include <algorithm>
#include <numeric>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/cutting/curve_seeds.h"
#include "features/cutting/cut_fine_mesh.h"
#include "features/mesh/collapsing_mesh.h"
#include "geometry/triangle_list.h"
#include "voxel/exact_int.h"

namespace isoshell {
namespace {

// In the edge lengths of the seeds that the surface is for.
constexpr double kLongestOnCurve = 0.28;
constexpr double kLeastCosine = 0.5;     ///< between a triangle's normal and those of the surface at its corners
constexpr int64_t kFewestPerSeed = 6;    ///< vertices inside of a patch whose vertices go
constexpr uint32_t kTogether = 1 << 14;  ///< vertices that one task goes through

/// The triangles of a surface while its vertices become fewer.
class ThinnedTriangles : public CollapsingMesh<ThinnedTriangles, int64_t> {
 public:
  ThinnedTriangles(const CutSurface& cut, const FreeSeeds::Counts& seeds, int levels)
      : CollapsingMesh(list_of(cut.surface.triangles.view()), size_t(cut.surface.vertex_count())),
        cut_(cut),
        surface_(cut.surface),
        scale_(1 << levels),
        seeds_(seeds),
        before_(vertices(), kNone),
        after_(vertices(), kNone) {
    for (uint32_t v = 0; v < vertices(); ++v) {
      if (cut_.place[v] == kNone) continue;
      before_[v] = surface_.border_before[v];
      after_[before_[v]] = v;
    }
    for (const CutCurve& curve : cut.curves) {
      is_seed_.emplace_back(curve.place.size(), 0);
      for (const size_t s : seeds_of_level(curve, levels)) is_seed_.back()[s] = 1;
      left_.emplace_back(curve.place.size());
      std::iota(left_.back().begin(), left_.back().end(), size_t(0));
    }
  }

  void run(const Context& context) {
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      check_cancel(context, "relax");
      if (!thin(sweep % 2 == 0 ? 0 : kTogether / 2)) return;
    }
  }

  const std::vector<size_t>& left_of(size_t curve) const { return left_[curve]; }
  std::vector<uint32_t> vertices_left() const {
    std::vector<uint32_t> out;
    for (uint32_t v = 0; v < vertices(); ++v)
      if (is_there(v)) out.push_back(v);
    return out;
  }
  std::vector<TriangleIndices> triangles_left() const {
    std::vector<TriangleIndices> out;
    for (const auto& [a, b, c] : triangles_)
      if (a != kNone) out.push_back({a, b, c});
    return out;
  }

 private:
  friend CollapsingMesh;
  static constexpr double kLongest = 0.45;

  int64_t distance_sq(uint32_t u, uint32_t v) const {
    return distance_sq_q16(surface_.position[u], surface_.position[v]);
  }
  int64_t square_of(double lengths, uint32_t v) const {
    const Buffer<uint32_t>& at = surface_.lengths.at;
    const double length = lengths * scale_ * (at.empty() ? cut_.longest_edge_q8 : double(at[v]));
    return int64_t(length * length);
  }

  static bool may_take(uint32_t) { return true; }

  /// Whether the triangle of a corner, once that is another vertex, faces as the surface does at its corners.
  bool fits(uint32_t c, uint32_t at, const Ring&) const {
    const uint32_t next = next_in_triangle(c);
    const uint32_t t[3] = {at, corner(next), corner(next_in_triangle(next))};
    const PointQ8 origin = surface_.position[at];
    const Vec64 n = cross(difference(surface_.position[t[1]], origin), difference(surface_.position[t[2]], origin));
    const double least_sq = kLeastCosine * kLeastCosine * 127 * 127 * double(dot(n, n));
    return std::all_of(t, t + 3, [&](uint32_t v) {
      const Normal8 m = surface_.normal[v];
      const auto along = double(n.x * m.x + n.y * m.y + n.z * m.z);
      return along > 0 && along * along >= least_sq;
    });
  }

  bool go(uint32_t v, uint32_t into, const Scratch& s) {
    take_into(v, s.ring, into);
    return true;
  }

  /// One sweep, in which none of two neighbours goes, so that what is left is even. Tasks have vertices from `offset`
  /// on; one whose neighbours are not all of the same task stays, so that no task sees what another one does. Result:
  /// whether any vertex went.
  bool thin(uint32_t offset) {
    std::fill(stays_.begin(), stays_.end(), 0);
    bool has_changed = false;
    for (size_t c = 0; c < left_.size(); ++c) has_changed |= thin_curve(c);
    const std::vector<char> is_dense = dense_patches();
    const auto task_of = [&](uint32_t v) { return (v + offset) / kTogether; };
    std::vector<char> changed(task_of(vertices() - 1) + 1, 0);
    for_each_index(uint32_t(0), uint32_t(changed.size()), [&](uint32_t task) {
      Scratch s;
      const uint32_t end = std::min((task + 1) * kTogether - offset, vertices());
      for (uint32_t v = task == 0 ? 0 : task * kTogether - offset; v < end; ++v) {
        if (!may_change_[v] || stays_[v] || cut_.place[v] != kNone || !is_there(v) || !is_dense[surface_.patch[v]])
          continue;
        find_ring(v, s.ring);
        if (std::all_of(s.ring.begin(), s.ring.end(), [&](uint32_t w) { return task_of(w) == task; }))
          changed[task] |= may_change_[v] = thin_inside(v, s);
      }
    });
    return has_changed || std::count(changed.begin(), changed.end(), 1) > 0;
  }

  /// Which patches have so many vertices inside that some may go.
  std::vector<char> dense_patches() const {
    std::vector<int64_t> inside(seeds_.size(), 0);
    for (uint32_t v = 0; v < vertices(); ++v)
      inside[surface_.patch[v]] += cut_.place[v] == kNone && is_there(v) ? 1 : 0;
    std::vector<char> out;
    for (size_t p = 0; p < inside.size(); ++p) out.push_back(inside[p] > kFewestPerSeed * seeds_[p] ? 1 : 0);
    return out;
  }

  /// Takes out places that are no seeds.
  bool thin_curve(size_t c) {
    const CutCurve& curve = cut_.curves[c];
    const std::vector<size_t>& left = left_[c];
    std::vector<size_t> kept;
    for (size_t i = 0; i < left.size(); ++i) {
      const size_t after = left[i + 1 == left.size() ? 0 : i + 1];
      if (is_seed_[c][left[i]] || !take_out(curve.place[left[i]], curve.place[kept.back()], curve.place[after]))
        kept.push_back(left[i]);
    }
    const bool has_changed = kept.size() < left.size();
    left_[c] = std::move(kept);
    return has_changed;
  }

  View<const uint32_t> copies_of(uint32_t place) const {
    const int64_t first = cut_.copies_first[place];
    return {cut_.copies.data() + first, cut_.copies_first[place + 1] - first};
  }

  /// Takes all copies of a place into those of one beside it.
  bool take_out(uint32_t place, uint32_t before, uint32_t after) {
    const View<const uint32_t> copies = copies_of(place);
    const uint32_t u = copies_of(before)[0], w = copies_of(after)[0];
    if (before == after || distance_sq(u, w) > std::min(square_of(kLongestOnCurve, u), square_of(kLongestOnCurve, w)) ||
        std::any_of(copies.begin(), copies.end(), [&](uint32_t v) { return stays_[v]; }))
      return false;
    std::vector<Ring> rings(size_t(copies.size));
    Ring touched, other;
    for (size_t i = 0; i < rings.size(); ++i) {
      find_ring(copies[int64_t(i)], rings[i]);
      touched.insert(touched.end(), rings[i].begin(), rings[i].end());
    }
    std::sort(touched.begin(), touched.end());  // what is around one copy must not change by another one
    if (std::adjacent_find(touched.begin(), touched.end()) != touched.end()) return false;
    for (const uint32_t to : {before, after}) {
      Ring into;
      for (size_t i = 0; i < rings.size(); ++i) {
        const uint32_t v = copies[int64_t(i)], along = cut_.place[before_[v]] == to ? before_[v] : after_[v];
        const bool is_last = along == after_[v] ? after_[along] == before_[v] : before_[along] == after_[v];
        if (!is_last && may_go(v, rings[i], along, other)) into.push_back(along);
      }
      if (into.size() < rings.size()) continue;
      for (size_t i = 0; i < rings.size(); ++i) {
        const uint32_t v = copies[int64_t(i)];
        take_into(v, rings[i], into[i]);
        before_[after_[v]] = before_[v];
        after_[before_[v]] = after_[v];
      }
      return true;
    }
    return false;
  }

  const CutSurface& cut_;
  const SurfaceMesh& surface_;
  const int scale_;
  const FreeSeeds::Counts& seeds_;
  std::vector<uint32_t> before_, after_;    ///< per vertex its neighbours on the border
  std::vector<std::vector<char>> is_seed_;  ///< per curve, of its places; both ends of an open curve are
  std::vector<std::vector<size_t>> left_;   ///< per curve, which of its places
};

/// What is left of a curve.
CutCurve coarser_curve(const CutCurve& curve, const std::vector<size_t>& left, int levels) {
  CutCurve out = curve;
  out.place.clear();
  out.at_q8.clear();
  out.seeds.clear();
  out.length_q8 /= 2;
  for (const size_t i : left) {
    out.place.push_back(curve.place[i]);
    out.at_q8.push_back(curve.at_q8[i] / 2);
  }
  for (const size_t s : seeds_of_level(curve, levels))
    out.seeds.push_back(size_t(std::lower_bound(left.begin(), left.end(), s) - left.begin()));
  return out;
}

LatticeFrame coarser_frame(LatticeFrame frame) {
  frame.voxel_size *= 2;
  frame.resolution = (frame.resolution + 1) / 2;
  for (int32_t& extent : frame.extent_vox) extent = (extent / 2 + 7) / 8 * 8;
  return frame;
}

EdgeLengths coarser_lengths(const EdgeLengths& finer, const std::vector<uint32_t>& in_finer, int levels) {
  EdgeLengths out;
  if (finer.at.empty()) return out;
  const auto coarser = [&](uint32_t length) { return std::max(1u, uint32_t(uint64_t(length) << levels >> 1)); };
  out.at = Buffer<uint32_t>(int64_t(in_finer.size()));
  for (size_t v = 0; v < in_finer.size(); ++v) out.at[int64_t(v)] = coarser(finer.at[in_finer[v]]);
  out.least = coarser(finer.least);
  out.largest = coarser(finer.largest);
  return out;
}

}  // namespace

CoarserSurface coarser_surface(const CutSurface& finer, const FreeSeeds::Counts& seeds, int levels, Context& context) {
  return run_with_threads(context, [&] {
    ThinnedTriangles thinned(finer, seeds, levels);
    thinned.run(context);
    CoarserSurface out;
    CutSurface& cut = out.cut;
    cut.frame = coarser_frame(finer.frame);
    cut.longest_edge_q8 = finer.longest_edge_q8 * (1 << levels) / 2;
    cut.corner_count = finer.corner_count;
    for (size_t c = 0; c < finer.curves.size(); ++c)
      cut.curves.push_back(coarser_curve(finer.curves[c], thinned.left_of(c), levels));
    const std::vector<uint32_t> left = thinned.vertices_left();
    std::vector<uint32_t> number(size_t(finer.surface.vertex_count()), kNone);
    SurfaceTriangles from;
    std::copy(cut.frame.extent_vox, cut.frame.extent_vox + 3, from.extent_vox);
    for (const uint32_t v : left) {
      const PointQ8 p = finer.surface.position[v];
      number[v] = uint32_t(from.position.size());
      from.position.push_back({p.x >> 1, p.y >> 1, p.z >> 1});
      from.patch.push_back(finer.surface.patch[v]);
    }
    from.triangles = thinned.triangles_left();
    for (TriangleIndices& t : from.triangles) t = {number[t.a], number[t.b], number[t.c]};
    MadeSurface made = make_surface_mesh(from, context);
    cut.surface = std::move(made.surface);
    out.in_finer.resize(left.size());
    for (size_t i = 0; i < left.size(); ++i) out.in_finer[made.number[i]] = left[i];
    cut.surface.lengths = coarser_lengths(finer.surface.lengths, out.in_finer, levels);
    for (const uint32_t v : out.in_finer) cut.place.push_back(finer.place[v]);
    list_copies(finer.copies_first.size() - 1, cut);
    return out;
  });
}

void bring_to_finer(const CoarserSurface& coarser, SeededMesh& made) {
  const auto twice = [](PointQ8& p) { p = {2 * p.x, 2 * p.y, 2 * p.z}; };
  std::for_each(made.mesh.position.begin(), made.mesh.position.end(), twice);
  std::for_each(made.seeds.position.begin(), made.seeds.position.end(), twice);
  for (uint32_t& home : made.seeds.home) home = coarser.in_finer[home];
}

}  // namespace isoshell
