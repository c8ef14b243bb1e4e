// What a set of kernels makes of a surface and seeds: labels, and the cells of a pass.
#pragma once

#include <vector>

#include "cpu/relax/pass_simd.h"
#include "stages/relax/relax_sheet_body.h"

namespace isoshell {

template <class Exec>
std::vector<uint32_t> labels_by(const SurfaceMesh& surface, const SeedSet& seeds) {
  Context context;
  Exec exec(context, "test");
  Buffer<uint32_t> labels(surface.vertex_count());
  Exec::Kernels::LabelSheet::run(exec, surface, seeds, seed_spacing(exec, surface, seeds.size()), labels.view());
  return {labels.begin(), labels.end()};
}

/// The cells that a pass measures, and the energy.
template <class Exec>
std::vector<int64_t> cells_by(const SurfaceMesh& surface, const SeedSet& seeds) {
  Context context;
  Exec exec(context, "test");
  typename Exec::Kernels::PassWork work(exec, surface, seed_spacing(exec, surface, seeds.size()));
  Buffer<relax_sheet::CellSum> cells(seeds.size());
  Buffer<SplitSum> energy(surface.blocks.count());
  Buffer<PassState> state(1);
  exec.fill(cells.view(), relax_sheet::CellSum{0, 0, 0, 0});
  exec.for_each("start", 1, relax_sheet::StartPasses{state.view()});
  work.measure(exec, seeds, cells.view(), energy.view(), state.view());
  std::vector<int64_t> out;
  for (const auto& c : cells) out.insert(out.end(), {c.mass, c.first_x, c.first_y, c.first_z});
  int64_t high = 0, low = 0;
  for (const auto& e : energy) high += e.high, low += e.low;
  const Int128 sum = SplitSum{high, low}.value();
  out.insert(out.end(), {int64_t(sum >> 62), int64_t(sum & ((Int128(1) << 62) - 1))});
  return out;
}

inline int64_t doubled_area(const SurfaceMesh& surface) {
  int64_t sum = 0;
  for (const TriangleIndices& t : surface.triangles) {
    const Vec64 n = cross(difference(surface.position[t.b], surface.position[t.a]),
                          difference(surface.position[t.c], surface.position[t.a]));
    sum += int64_t(isqrt(uint64_t(dot(n, n))));
  }
  return sum;
}

}  // namespace isoshell
