// A cell gets the moments of the vertices that it labels, each with the triangles that are its own; then triangles
// between cells move pieces from one to another.
#include "cpu/relax/pass_simd.h"

#include "cpu/relax/cut_simd.h"
#include "cpu/relax/three_cell_simd.h"

namespace isoshell {
namespace {

using namespace relax_sheet;

struct FillBlockPatch {
  VisitPatch patch;
  View<const PointQ8> position;
  EdgeLengthsView lengths;
  View<const int64_t> first;
  View<BlockPatches::Triangle> triangles;
  View<PieceSum> of_vertex;
  void operator()(int64_t block) const {
    int64_t at = first[block];
    const PointQ8 origin = patch.blocks.centre[block];
    for (int64_t v = patch.blocks.first[block]; v < patch.blocks.first[block + 1]; ++v) of_vertex[v] = {};
    patch.visit(block, [&](TriangleIndices t, uint32_t index) {
      const PointQ8 a = position[t.a], b = position[t.b], c = position[t.c];
      const Vec64 n = cross(difference(b, a), difference(c, a));
      const uint32_t area2 = lengths.mass(uint32_t(isqrt(uint64_t(dot(n, n)))), t);
      triangles[at++] = {index, area2};
      PieceSum& sum = of_vertex[std::min({t.a, t.b, t.c})];
      sum = sum + piece_sum(area2, local(a, origin), local(b, origin), local(c, origin));
    });
  }
};

/// Sums of one block by cells.
class BlockSums {
 public:
  BlockSums(PointQ8 origin, View<const PointQ8> seed, View<CellSum> cell) : origin_(origin), seed_(seed), cell_(cell) {}

  void add(uint32_t id, const PieceSum& piece) {
    if (PieceSum* sum = sums_.of(id))
      *sum = *sum + piece;
    else
      flush(id, piece);
  }
  void take(uint32_t id, const PieceSum& piece) {
    if (PieceSum* sum = sums_.of(id))
      *sum = *sum - piece;
    else
      flush(id, PieceSum{} - piece);
  }
  /// Adds all to the cells; returns their energy.
  Int128 finish() {
    sums_.for_each([&](uint32_t id, const PieceSum& sum) { flush(id, sum); });
    return energy_;
  }

 private:
  void flush(uint32_t id, const PieceSum& sum) { energy_ += add_to_cell(cell_[id], sum, local(seed_[id], origin_)); }

  const PointQ8 origin_;
  const View<const PointQ8> seed_;
  const View<CellSum> cell_;
  LocalSums<64> sums_;
  Int128 energy_ = 0;
};

struct SumBlockSimd {
  VertexBlocksView blocks;
  View<const int64_t> first;
  View<const BlockPatches::Triangle> triangles;
  View<const PieceSum> of_vertex;
  View<const PointQ8> position;
  View<const TriangleIndices> corners;
  View<const uint32_t> label;
  View<const PointQ8> seed;
  View<CellSum> cell;
  View<SplitSum> energy;
  View<const PassState> state;

  void operator()(int64_t block) const {
    if (state[0].converged) return;
    const PointQ8 origin = blocks.centre[block];
    BlockSums sums(origin, seed, cell);
    add_vertices(block, sums);
    CutSimd lanes;
    ThreeCellSimd meeting;
    constexpr int64_t kChunk = 256;
    for (int64_t begin = first[block]; begin < first[block + 1]; begin += kChunk) {
      CutTriangles<kChunk> cut;
      list_cut(begin, std::min(begin + kChunk, first[block + 1]), cut);
      for (int i = 0; i < cut.two_count; ++i) {
        add_lane(triangles[cut.two[i]], origin, lanes);
        if (lanes.count == CutSimd::kLanes) empty(lanes, sums);
      }
      for (int i = 0; i < cut.three_count; ++i) {
        add_lane(triangles[cut.three[i]], origin, meeting);
        if (meeting.count == ThreeCellSimd::kLanes) empty(meeting, sums);
      }
    }
    empty(lanes, sums);
    empty(meeting, sums);
    energy[block] = SplitSum::of(sums.finish());
  }

 private:
  void add_vertices(int64_t block, BlockSums& sums) const {
    int64_t v = blocks.first[block];
    const int64_t end = blocks.first[block + 1];
    while (v < end) {
      const uint32_t id = label[v];
      PieceSum run = of_vertex[v++];
      for (; v < end && label[v] == id; ++v) run = run + of_vertex[v];
      sums.add(id, run);
    }
  }

  /// Triangles between two cells, and between three.
  template <int64_t kMost>
  struct CutTriangles {
    int two_count = 0, three_count = 0;
    int64_t two[kMost], three[kMost];
  };
  /// Without a branch that would be guessed wrong.
  template <class Cut>
  void list_cut(int64_t begin, int64_t end, Cut& cut) const {
    for (int64_t t = begin; t < end; ++t) {
      const TriangleIndices corner = corners[triangles[t].index];
      const uint32_t a = label[corner.a], b = label[corner.b], c = label[corner.c];
      const int same = (a == b) + (b == c) + (c == a);
      cut.two[cut.two_count] = t;
      cut.two_count += same == 1;
      cut.three[cut.three_count] = t;
      cut.three_count += same == 0;
    }
  }

  Local here(uint32_t vertex, PointQ8 origin) const { return local(position[vertex], origin); }

  void add_lane(const BlockPatches::Triangle& of, PointQ8 origin, ThreeCellSimd& lanes) const {
    const int i = lanes.count++;
    const TriangleIndices t = corners[of.index];
    const uint32_t vertices[3] = {t.a, t.b, t.c}, smallest = std::min({t.a, t.b, t.c});
    for (int k = 0; k < 3; ++k) {
      const uint32_t id = label[vertices[k]];
      lanes.corner[k].set(i, here(vertices[k], origin));
      lanes.seed[k].set(i, local(seed[id], origin));
      lanes.cell[k][i] = id;
      lanes.has_all[k][i] = vertices[k] == smallest ? 1 : 0;
    }
    lanes.area2[i] = of.area2;
  }

  void add_lane(const BlockPatches::Triangle& of, PointQ8 origin, CutSimd& lanes) const {
    const int i = lanes.count++;
    const TriangleIndices t = corners[of.index];
    const uint32_t a = label[t.a], b = label[t.b], c = label[t.c];
    const uint32_t p = b == c ? t.a : (c == a ? t.b : t.c), q = b == c ? t.b : (c == a ? t.c : t.a),
                   r = b == c ? t.c : (c == a ? t.a : t.b);
    const uint32_t alone = b == c ? a : (c == a ? b : c), other = b == c ? b : a;
    lanes.p.set(i, here(p, origin));
    lanes.q.set(i, here(q, origin));
    lanes.r.set(i, here(r, origin));
    lanes.seed.set(i, local(seed[alone], origin));
    lanes.other_seed.set(i, local(seed[other], origin));
    lanes.area2[i] = of.area2;
    const bool all_is_at_p = p < q && p < r;
    lanes.all_is_at_p[i] = all_is_at_p ? 1 : 0;
    lanes.from[i] = all_is_at_p ? alone : other;
    lanes.to[i] = all_is_at_p ? other : alone;
  }

  static void empty(CutSimd& lanes, BlockSums& sums) {
    lanes.cut();
    for (int i = 0; i < lanes.count; ++i) {
      sums.take(lanes.from[i], lanes.moved(i));
      sums.add(lanes.to[i], lanes.moved(i));
    }
    lanes.count = 0;
  }
  static void empty(ThreeCellSimd& lanes, BlockSums& sums) {
    lanes.split();
    for (int i = 0; i < lanes.count; ++i)
      for (int k = 0; k < 3; ++k) sums.add(lanes.cell[k][i], lanes.gained(k, i));
    lanes.count = 0;
  }
};

}  // namespace

CpuPassSimd::CpuPassSimd(CpuExecutor& exec, const SurfaceMesh& surface, const SeedSpacing& spacing)
    : surface_(surface), labels_(exec, surface, spacing), label_(surface.vertex_count()) {
  const int64_t blocks = surface.blocks.count();
  const VisitPatch visit{surface.blocks.view(), surface.triangles.view(), surface.vertex_first.view(),
                         surface.vertex_triangles.view()};
  patches_ = {Buffer<int64_t>(blocks + 1), Buffer<BlockPatches::Triangle>(surface.triangles.size()),
              Buffer<PieceSum>(surface.vertex_count())};
  exec.fill(patches_.first.view().part(blocks, 1), int64_t(0));
  exec.for_each("count patch triangles", blocks, CountPatch{visit, patches_.first.view()});
  exec.exclusive_scan(patches_.first.view());
  exec.for_each("fill patches", blocks,
                FillBlockPatch{visit, surface.position.view(), lengths_of(surface), patches_.first.view(),
                               patches_.triangles.view(), patches_.of_vertex.view()});
}

void CpuPassSimd::measure(CpuExecutor& exec, const SeedSet& seeds, View<CellSum> cells, View<SplitSum> block_energy,
                          View<const PassState> state) {
  labels_.label(exec, seeds, label_.view());
  exec.for_each("sum cells", surface_.blocks.count(),
                SumBlockSimd{surface_.blocks.view(), patches_.first.view(), patches_.triangles.view(),
                             patches_.of_vertex.view(), surface_.position.view(), surface_.triangles.view(),
                             label_.view(), seeds.position.view(), cells, block_energy, state});
}

}  // namespace isoshell
