// A cell gets the moments of the triangles whose first corner it labels; then triangles between cells move pieces from
// one to another.
#include "cpu/relax/pass_simd.h"

#include "cpu/relax/cut_simd.h"
#include "cpu/relax/three_cell_simd.h"
#include "cpu/relax/triangle_simd.h"

namespace isoshell {
namespace {

using namespace relax_sheet;

struct FillBlockPatch {
  VisitPatch patch;
  View<const PointQ8> position;
  EdgeLengthsView lengths;
  View<const int64_t> first;
  View<uint32_t> triangles, mass;
  void operator()(int64_t block) const {
    int64_t at = first[block];
    patch.visit(block, [&](TriangleIndices t, uint32_t index) {
      if (lengths.vary()) {
        const Vec64 n = cross(difference(position[t.b], position[t.a]), difference(position[t.c], position[t.a]));
        mass[at] = lengths.mass(uint32_t(isqrt(uint64_t(dot(n, n)))), t);
      }
      triangles[at++] = index;
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
  View<const uint32_t> triangles, mass;
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
    TriangleSimd these;
    CutSimd lanes;
    ThreeCellSimd meeting;
    for (int64_t begin = first[block]; begin < first[block + 1]; begin += TriangleSimd::kLanes) {
      load(begin, std::min(begin + TriangleSimd::kLanes, first[block + 1]), origin, these);
      add_whole(these, sums);
      CutTriangles cut;
      list_cut(these, cut);
      for (int i = 0; i < cut.two_count; ++i) {
        add_lane(these, cut.two[i], origin, lanes);
        if (lanes.count == CutSimd::kLanes) empty(lanes, sums);
      }
      for (int i = 0; i < cut.three_count; ++i) {
        add_lane(these, cut.three[i], origin, meeting);
        if (meeting.count == ThreeCellSimd::kLanes) empty(meeting, sums);
      }
    }
    empty(lanes, sums);
    empty(meeting, sums);
    energy[block] = SplitSum::of(sums.finish());
  }

 private:
  void load(int64_t begin, int64_t end, PointQ8 origin, TriangleSimd& to) const {
    to.count = int(end - begin);
    for (int i = 0; i < to.count; ++i) {
      const TriangleIndices t = corners[triangles[begin + i]];
      const uint32_t vertices[3] = {t.a, t.b, t.c};
      for (int k = 0; k < 3; ++k) {
        to.corner[k].set(i, local(position[vertices[k]], origin));
        to.label[k][i] = label[vertices[k]];
      }
    }
    to.measure();
    if (!mass.empty()) std::copy(&mass[begin], &mass[begin] + to.count, to.area2);
  }

  /// Every triangle goes to the cell of its first corner.
  static void add_whole(const TriangleSimd& of, BlockSums& sums) {
    for (int i = 0; i < of.count;) {
      const uint32_t id = of.label[0][i];
      PieceSum run = of.whole(i++);
      for (; i < of.count && of.label[0][i] == id; ++i) run = run + of.whole(i);
      sums.add(id, run);
    }
  }

  /// Triangles between two cells, and between three.
  struct CutTriangles {
    int two_count = 0, three_count = 0;
    int two[TriangleSimd::kLanes], three[TriangleSimd::kLanes];
  };
  /// Without a branch that would be guessed wrong.
  static void list_cut(const TriangleSimd& of, CutTriangles& cut) {
    for (int i = 0; i < of.count; ++i) {
      const uint32_t a = of.label[0][i], b = of.label[1][i], c = of.label[2][i];
      const int same = (a == b) + (b == c) + (c == a);
      cut.two[cut.two_count] = i;
      cut.two_count += same == 1;
      cut.three[cut.three_count] = i;
      cut.three_count += same == 0;
    }
  }

  void add_lane(const TriangleSimd& of, int from, PointQ8 origin, ThreeCellSimd& lanes) const {
    const int i = lanes.count++;
    for (int k = 0; k < 3; ++k) {
      const uint32_t id = of.label[k][from];
      lanes.corner[k].set(i, of.corner[k].at(from));
      lanes.seed[k].set(i, local(seed[id], origin));
      lanes.cell[k][i] = id;
      lanes.has_all[k][i] = k == 0 ? 1 : 0;
    }
    lanes.area2[i] = of.area2[from];
  }

  void add_lane(const TriangleSimd& of, int from, PointQ8 origin, CutSimd& lanes) const {
    const int i = lanes.count++;
    const uint32_t a = of.label[0][from], b = of.label[1][from], c = of.label[2][from];
    const int p = b == c ? 0 : (c == a ? 1 : 2), q = p == 2 ? 0 : p + 1, r = 3 - p - q;
    const uint32_t alone = of.label[p][from], other = of.label[q][from];
    lanes.p.set(i, of.corner[p].at(from));
    lanes.q.set(i, of.corner[q].at(from));
    lanes.r.set(i, of.corner[r].at(from));
    lanes.seed.set(i, local(seed[alone], origin));
    lanes.other_seed.set(i, local(seed[other], origin));
    lanes.area2[i] = of.area2[from];
    lanes.all_is_at_p[i] = p == 0 ? 1 : 0;
    lanes.from[i] = p == 0 ? alone : other;
    lanes.to[i] = p == 0 ? other : alone;
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
  const EdgeLengthsView lengths = lengths_of(surface);
  const int64_t triangles = surface.triangles.size();
  patches_ = {Buffer<int64_t>(blocks + 1), Buffer<uint32_t>(triangles),
              Buffer<uint32_t>(lengths.vary() ? triangles : 0)};
  exec.fill(patches_.first.view().part(blocks, 1), int64_t(0));
  exec.for_each("count patch triangles", blocks, CountPatch{visit, patches_.first.view()});
  exec.exclusive_scan(patches_.first.view());
  exec.for_each("fill patches", blocks,
                FillBlockPatch{visit, surface.position.view(), lengths, patches_.first.view(),
                               patches_.triangles.view(), patches_.mass.view()});
}

void CpuPassSimd::measure(CpuExecutor& exec, const SeedSet& seeds, View<CellSum> cells, View<SplitSum> block_energy,
                          View<const PassState> state) {
  labels_.label(exec, seeds, label_.view());
  exec.for_each("sum cells", surface_.blocks.count(),
                SumBlockSimd{surface_.blocks.view(), patches_.first.view(), patches_.triangles.view(),
                             patches_.mass.view(), surface_.position.view(), surface_.triangles.view(), label_.view(),
                             seeds.position.view(), cells, block_energy, state});
}

}  // namespace isoshell
