// Sizing fields: a float grid of a .vdb file or from memory, checked once, then sampled.
#include "isoshell/io/sizing_vdb.h"

#include <openvdb/openvdb.h>

#include <cmath>
#include <sstream>

#include "core/parallel_ranges.h"
#include "io/openvdb/dense_lattice.h"
#include "io/openvdb/field_grid.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/vdb_cursor.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr FieldKind kEdgeLengths{"Tree_float_5_4_3", "floats", "a sizing field is a FloatGrid of edge lengths",
                                 "the field"};

struct Source {
  std::string path, grid;  ///< grid empty: the only float grid
};

/// A name may hold colons; what follows ".vdb:" is the grid's.
Source parse_source(const std::string& text) {
  const size_t at = text.rfind(".vdb:");
  if (at == std::string::npos) return {text, ""};
  return {text.substr(0, at + 4), text.substr(at + 5)};
}

bool is_length(double value) { return value > 0 && std::isfinite(value); }

VdbFloatGrid::Ptr grid_of(const DenseVolume& lengths, const std::string& name) {
  initialize_openvdb();
  auto grid = new_vdb_grid<VdbFloatGrid>(name.c_str(), 0);
  grid->setTransform(transform_of(lengths, name));
  auto voxels = grid->getAccessor();
  for (int64_t i = 0; i < lengths.size[0]; ++i)
    for (int64_t j = 0; j < lengths.size[1]; ++j)
      for (int64_t k = 0; k < lengths.size[2]; ++k) {
        const float length = lengths.values[i * lengths.stride[0] + j * lengths.stride[1] + k * lengths.stride[2]];
        if (!std::isnan(length)) voxels.setValueOn(openvdb::Coord(int(i), int(j), int(k)), length);
      }
  return grid;
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
    std::vector<double> out(points.size());
    for_ranges(int64_t(points.size()), 1024, [&](int64_t begin, int64_t end) {
      auto reader = grid_->getConstAccessor();
      for (size_t i = size_t(begin); i < size_t(end); ++i) out[i] = length_at(reader, points[i]);
    });
    return out;
  }
  std::string source() const override { return source_; }

 private:
  /// The mean of the eight voxels around the point, by nearness; those that say nothing do not count.
  template <class Reader>
  double length_at(Reader& reader, WorldPoint p) const {
    double sum = 0, weights = 0;
    for_each_voxel_around(*grid_, reader, {p.x, p.y, p.z}, [&](double weight, bool is_active, float value) {
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
  const Source source = parse_source(text);
  const auto grid =
      std::static_pointer_cast<const VdbFloatGrid>(read_field_grid(source.path, source.grid, kEdgeLengths, max_bytes));
  check_values(source.path, *grid);
  return std::make_shared<VdbSizing>(text, grid);
}

std::shared_ptr<const SizingField> sizing_of(const DenseVolume& lengths, const std::string& name) {
  auto grid = grid_of(lengths, name);
  check_values(name, *grid);
  return std::make_shared<VdbSizing>("", std::move(grid));
}

}  // namespace isoshell
