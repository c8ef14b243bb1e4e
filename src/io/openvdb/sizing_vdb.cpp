// Sizing fields: a float grid of a .vdb file or from memory, checked once, then sampled.
#include "isoshell/io/sizing_vdb.h"

#include <openvdb/openvdb.h>

#include <cmath>
#include <sstream>

#include "io/openvdb/dense_lattice.h"
#include "io/openvdb/field_grid.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/vdb_cursor.h"
#include "isoshell/error.h"
#include "isoshell/io/grid_field.h"

namespace isoshell {
namespace {

constexpr FieldKind kEdgeLengths{"Tree_float_5_4_3", "floats", "a sizing field is a FloatGrid of edge lengths",
                                 "the field"};

bool is_length(double value) { return value > 0 && std::isfinite(value); }

VdbFloatGrid::Ptr grid_of(const DenseVolume& lengths, const std::string& name) {
  return dense_grid<VdbFloatGrid>(lengths, name, [&](int64_t i, int64_t j, int64_t k, float& length) {
    length = value_of(lengths, i, j, k);
    return !std::isnan(length);
  });
}

void check_values(const std::string& path, const VdbFloatGrid& grid) {
  const openvdb::GridBase& any_grid = grid;  // OpenVDB's own code counts, not a copy of it here
  if (any_grid.activeVoxelCount() == 0)
    throw_unreadable_vdb(path, "grid \"" + grid.getName() +
                                   "\" has no active voxels; a sizing field holds edge lengths in active voxels");
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (is_length(*value)) continue;
    std::ostringstream text;
    text << "grid \"" << grid.getName() << "\", voxel " << value.getCoord() << ": " << *value
         << " is no edge length; every active voxel must hold one, more than 0, in world units"
         << (grid.getGridClass() == openvdb::GRID_LEVEL_SET ? " (this is a level set: it holds distances)" : "");
    throw_unreadable_vdb(path, text.str());
  }
}

class VdbSizing final : public SizingField {
 public:
  VdbSizing(std::string source, VdbFloatGrid::ConstPtr grid) : source_(std::move(source)), grid_(std::move(grid)) {
    background_ = is_length(grid_->background()) ? double(grid_->background()) : 0;
  }

  std::vector<double> lengths_at(const std::vector<WorldPoint>& points) const override {
    return sample_field<double>(*grid_, points, [&](auto& reader, WorldPoint p) { return length_at(reader, p); });
  }
  std::string source() const override { return source_; }

 private:
  /// The mean of the eight voxels around the point, by nearness; those that say nothing do not count.
  template <class Reader>
  double length_at(Reader& reader, WorldPoint p) const {
    double sum = 0, weights = 0;
    for_each_voxel_around(reader, grid_->worldToIndex({p.x, p.y, p.z}),
                          [&](double weight, bool is_active, float value) {
                            const double length = is_active ? double(value) : background_;
                            if (!(length > 0)) return;
                            sum += weight * length;
                            weights += weight;
                          });
    return weights > 0 ? sum / weights : 0;
  }

  const std::string source_;
  const VdbFloatGrid::ConstPtr grid_;
  double background_;
};

}  // namespace

std::shared_ptr<const SizingField> read_sizing(const std::string& text, int64_t max_bytes) {
  const GridName named = grid_name_of(text);
  const std::string path = named.file.empty() ? text : named.file;
  const std::string name = named.file.empty() ? "" : named.grid;
  const auto grid = std::static_pointer_cast<const VdbFloatGrid>(read_field_grid(path, name, kEdgeLengths, max_bytes));
  check_values(path, *grid);
  return std::make_shared<VdbSizing>(text, grid);
}

std::shared_ptr<const SizingField> sizing_of(const DenseVolume& lengths, const std::string& name) {
  auto grid = grid_of(lengths, name);
  check_values(name, *grid);
  return std::make_shared<VdbSizing>("", std::move(grid));
}

}  // namespace isoshell
