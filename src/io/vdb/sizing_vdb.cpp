// Sizing fields: a float grid of a .vdb file or from memory, checked once, then sampled.
#include "isoshell/io/sizing_vdb.h"

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "io/vdb/dense_lattice.h"
#include "io/vdb/grid_names.h"
#include "io/vdb/vdb_cursor.h"
#include "io/vdb/vdb_grids.h"
#include "io/vdb/vdb_layout.h"
#include "io/vdb/vdb_stream.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr char kFloatType[] = "Tree_float_5_4_3";

struct Source {
  std::string path, grid;  ///< grid empty: the only float grid
};

/// A name may hold colons; what follows ".vdb:" is the grid's.
Source parse_source(const std::string& text) {
  const size_t at = text.rfind(".vdb:");
  if (at == std::string::npos) return {text, ""};
  return {text.substr(0, at + 4), text.substr(at + 5)};
}

bool holds_floats(const VdbGridSpan& span) {
  return span.type == kFloatType || span.type == std::string(kFloatType) + "_HalfFloat";
}

std::string list_of(const std::vector<VdbGridSpan>& grids) {
  std::string text;
  for (const VdbGridSpan& span : grids) text += (text.empty() ? "\"" : ", \"") + span.name + "\" (" + span.type + ")";
  return text.empty() ? "none" : text;
}

const VdbGridSpan& choose_grid(const Source& source, const std::vector<VdbGridSpan>& grids) {
  const VdbGridSpan* found = nullptr;
  int floats = 0;
  for (const VdbGridSpan& span : grids) {
    if (source.grid.empty() ? !holds_floats(span) : span.name != source.grid) continue;
    if (!found) found = &span;
    ++floats;
  }
  if (!found)
    throw_unreadable_vdb(source.path,
                         (source.grid.empty() ? std::string("no grid of floats") : "no grid \"" + source.grid + "\"") +
                             "; a sizing field is a FloatGrid of edge lengths. Its grids are: " + list_of(grids));
  if (!holds_floats(*found) || found->instance)
    throw_unreadable_vdb(source.path, "grid \"" + found->name + "\" has type " + found->type +
                                          "; a sizing field is a FloatGrid of its own, of edge lengths");
  if (source.grid.empty() && floats > 1)
    throw_unreadable_vdb(
        source.path, "there are several grids of floats; say which by FILE.vdb:NAME. Its grids are: " + list_of(grids));
  return *found;
}

VdbFloatGrid::ConstPtr load(const Source& source, int64_t max_bytes) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(source.path, failed);
  if (!failed && max_bytes > 0 && size > uint64_t(max_bytes))
    throw Error(ErrorCode::out_of_memory, "read",
                source.path + ": has " + std::to_string(size >> 20) + " MiB, more than the limit of " +
                    std::to_string(max_bytes >> 20) + " MiB; coarsen the field or raise --max-memory");
  try {
    initialize_openvdb();
    const Buffer<char> bytes = read_file_start(source.path, std::numeric_limits<int64_t>::max());
    const VdbLayout layout = read_vdb_layout(source.path, bytes.view());
    const std::vector<VdbGridSpan> grids = with_names_apart(layout.grids);
    return std::static_pointer_cast<const VdbFloatGrid>(
        read_vdb_grid(source.path, bytes.view(), choose_grid(source, grids)));
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "read", source.path + ": out of memory; coarsen the field");
  }
}

bool is_length(double value) { return value > 0 && std::isfinite(value); }

VdbFloatGrid::Ptr grid_of(const DenseVolume& lengths, const std::string& name) {
  initialize_openvdb();
  auto grid = VdbFloatGrid::create(0);
  grid->setName(name);
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
  if (grid.activeVoxelCount() == 0)
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
    tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), 1024), [&](const tbb::blocked_range<size_t>& range) {
      auto reader = grid_->getConstAccessor();
      for (size_t i = range.begin(); i < range.end(); ++i) out[i] = length_at(reader, points[i]);
    });
    return out;
  }
  std::string source() const override { return source_; }

 private:
  /// The mean of the eight voxels around the point, by nearness; those that say nothing do not count.
  template <class Reader>
  double length_at(Reader& reader, WorldPoint p) const {
    const openvdb::Vec3d at = grid_->worldToIndex({p.x, p.y, p.z});
    const openvdb::Coord low = openvdb::Coord::floor(at);
    double sum = 0, weights = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const openvdb::Coord c = low.offsetBy(corner >> 2, corner >> 1 & 1, corner & 1);
      float value = 0;
      const double length = reader.probeValue(c, value) ? double(value) : background_;
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const double t = at[axis] - low[axis];
        weight *= c[axis] > low[axis] ? t : 1 - t;
      }
      if (!(length > 0)) continue;
      sum += weight * length;
      weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
  }

  const std::string source_;
  const VdbFloatGrid::ConstPtr grid_;
  double background_;
};

}  // namespace

std::shared_ptr<const SizingField> read_sizing(const std::string& text, int64_t max_bytes) {
  const Source source = parse_source(text);
  auto grid = load(source, max_bytes);
  check_values(source.path, *grid);
  return std::make_shared<VdbSizing>(text, std::move(grid));
}

std::shared_ptr<const SizingField> sizing_of(const DenseVolume& lengths, const std::string& name) {
  auto grid = grid_of(lengths, name);
  check_values(name, *grid);
  return std::make_shared<VdbSizing>("", std::move(grid));
}

}  // namespace isoshell
