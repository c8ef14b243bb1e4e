// Scalar grids of .vdb files as fields.
#include <openvdb/io/Compression.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <istream>

#include "io/bytes/memory_stream.h"
#include "io/openvdb/field_of_grid.h"
#include "io/openvdb/grid_map.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/grid_kinds.h"
#include "io/vdb/volume_readers.h"

namespace isoshell {
namespace {

Voxel voxel_of(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }

template <class GridT>
class VdbField : public ScalarField {
 public:
  using Tree = typename GridT::TreeType;
  using Leaf = typename Tree::LeafNodeType;

  explicit VdbField(typename GridT::ConstPtr grid) : grid_(std::move(grid)) {
    background = double(grid_->background());
    to_world = affine_map_of(*grid_);
  }

  std::vector<Voxel> blocks() const override {
    std::vector<Voxel> origins;
    for (auto leaf = grid_->tree().cbeginLeaf(); leaf; ++leaf) origins.push_back(voxel_of(leaf->origin()));
    return origins;
  }

  std::vector<FieldTile> tiles() const override {
    std::vector<FieldTile> tiles;
    auto value = grid_->tree().cbeginValueAll();
    value.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; value; ++value) {
      if (*value == grid_->background()) continue;
      const openvdb::CoordBBox box = value.getBoundingBox();
      tiles.push_back({voxel_of(box.min()), int32_t(box.dim().x()), float(*value)});
    }
    return tiles;
  }

  void copy(Voxel origin, const int size[3], float* to) const override {
    const openvdb::Coord at(origin.x, origin.y, origin.z);
    if (const Leaf* leaf = grid_->tree().probeConstLeaf(at)) {
      const auto* values = leaf->buffer().data();
      if (is_band_alone())
        copy_block(size, to, [&](int i) {
          return values[i] == 0 && !leaf->isValueOn(openvdb::Index(i)) ? NAN : float(values[i]);
        });
      else
        copy_block(size, to, [&](int i) { return values[i]; });
    } else {
      const auto value = grid_->tree().getValue(at);
      copy_block(size, to, [&](int) { return is_band_alone() && value == 0 ? NAN : float(value); });
    }
  }

 private:
  const typename GridT::ConstPtr grid_;
};

}  // namespace

// NanoVDB packs as OpenVDB does: the packed size in front. Blosc packs pieces of a GiB, and believes its own header.
bool unpack_stream(View<const char> packed, bool zip, View<char> to) {
  constexpr int64_t kPiece = int64_t(1) << 30, kBloscHeaderBytes = 16;
  while (to.size > 0) {
    const int64_t plain = zip ? to.size : std::min(to.size, kPiece);
    int64_t bytes = 0;
    if (packed.size < int64_t(sizeof bytes)) return false;
    std::memcpy(&bytes, packed.data, sizeof bytes);
    if (bytes <= (zip ? 0 : kBloscHeaderBytes) || bytes > packed.size - int64_t(sizeof bytes)) return false;
    if (!zip) {
      uint32_t sizes[3];  // of the plain data, of a block, of the packed data
      std::memcpy(sizes, packed.data + sizeof bytes + 4, sizeof sizes);
      if (sizes[0] != plain || sizes[2] != bytes) return false;
    }
    MemorySource source({packed.data, int64_t(sizeof bytes) + bytes}, {});
    std::istream in(&source);
    try {
      if (zip)
        openvdb::io::unzipFromStream(in, to.data, size_t(plain));
      else
        openvdb::io::bloscFromStream(in, to.data, size_t(plain));
    } catch (const openvdb::Exception&) {
      return false;
    }
    packed = packed.part(int64_t(sizeof bytes) + bytes, packed.size - int64_t(sizeof bytes) - bytes);
    to = to.part(plain, to.size - plain);
  }
  return true;
}

std::unique_ptr<ScalarField> read_vdb_volume(const MeshSource& source, const VolumeReadOptions& options) {
  initialize_openvdb();
  const View<const char> bytes{source.begin(), source.size()};
  const VdbLayout layout = read_vdb_layout(source.name(), bytes);
  std::vector<VolumeGrid> grids;
  for (const VdbGridSpan& span : layout.grids) grids.push_back(as_volume(span));
  const size_t chosen = choose_grid(source.name(), grids, options);
  const VdbGridSpan& span = layout.grids[chosen];
  check_volume_memory(source, grids[chosen], check_vdb_tree(source.name(), bytes, span), options);
  return field_of_grid(read_vdb_grid(source.name(), bytes, span), grids[chosen]);
}

std::unique_ptr<ScalarField> field_of_grid(const openvdb::GridBase::ConstPtr& grid, const VolumeGrid& about) {
  std::unique_ptr<ScalarField> field;
  if (about.type == "float")
    field = std::make_unique<VdbField<openvdb::FloatGrid>>(openvdb::gridConstPtrCast<openvdb::FloatGrid>(grid));
  else
    field = std::make_unique<VdbField<openvdb::DoubleGrid>>(openvdb::gridConstPtrCast<openvdb::DoubleGrid>(grid));
  field->name = about.name;
  field->grid_class = about.grid_class;
  return field;
}

}  // namespace isoshell
