// Grids of any numbers, sampled as OpenVDB does it.
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <type_traits>

#include "core/hash_bytes.h"
#include "core/number_type.h"
#include "io/openvdb/dense_lattice.h"
#include "io/openvdb/field_grid.h"
#include "io/openvdb/field_of_grid.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/grid_fields.h"
#include "io/vdb/grid_names.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

/// The numbers that a voxel's value is.
template <class T>
struct Numbers {
  using Number = T;
  static constexpr int kCount = 1;
  static double part(const T& value, int) { return double(value); }
};
template <class T>
struct Numbers<openvdb::math::Vec3<T>> {
  using Number = T;
  static constexpr int kCount = 3;
  static double part(const openvdb::math::Vec3<T>& value, int i) { return double(value[i]); }
};

template <class Number>
constexpr NumberType type_of() {
  if (std::is_same_v<Number, float>) return NumberType::f32;
  return std::is_same_v<Number, int32_t> ? NumberType::i32 : NumberType::f64;
}

template <class Value>
class VdbGridField final : public GridField {
 public:
  using Parts = Numbers<Value>;
  static constexpr int kCount = Parts::kCount;
  static constexpr NumberType kType = type_of<typename Parts::Number>();

  VdbGridField(const std::string& name, uint64_t digest, typename VdbGrid<Value>::ConstPtr grid)
      : GridField(name, digest),
        grid_(std::move(grid)),
        is_staggered_(kCount == 3 && grid_->getGridClass() == openvdb::GRID_STAGGERED) {}

  GridValues at(const std::vector<WorldPoint>& places) const override {
    const std::vector<Found> found = sample_field<Found>(*grid_, places, [&](auto& reader, WorldPoint p) {
      const openvdb::Vec3d at = grid_->worldToIndex({p.x, p.y, p.z});
      return is_staggered_ ? staggered(reader, at) : plain(reader, at);
    });
    GridValues values{{name(), kType, kCount, {}}};
    values.values.values.reserve(found.size() * size_t(kCount));
    for (const Found& f : found) {
      for (const double number : f.number) values.values.values.push_back(nearest_of(kType, number));
      values.outside += f.is_active ? 0 : 1;
    }
    return values;
  }

 private:
  struct Found {
    std::array<double, size_t(kCount)> number{};
    bool is_active = false;
  };

  template <class Reader>
  static Found plain(Reader& reader, const openvdb::Vec3d& at) {
    if constexpr (std::is_integral_v<typename Parts::Number>)
      return nearest(reader, at);
    else
      return between(reader, at);
  }

  template <class Reader>
  static Found nearest(Reader& reader, const openvdb::Vec3d& at) {
    Found found;
    Value value;
    found.is_active = reader.probeValue(openvdb::Coord::round(within_indices(at)), value);
    for (int i = 0; i < kCount; ++i) found.number[size_t(i)] = Parts::part(value, i);
    return found;
  }

  /// By differences from one of the values, so that where all are the same the result is, too.
  template <class Reader>
  static Found between(Reader& reader, const openvdb::Vec3d& at) {
    Found found, first;
    bool has_first = false;
    for_each_voxel_around(reader, at, [&](double weight, bool is_active, const Value& value) {
      if (weight == 0) return;
      found.is_active |= is_active;
      for (size_t i = 0; i < size_t(kCount); ++i) {
        const double number = Parts::part(value, int(i));
        if (!has_first) first.number[i] = number;
        found.number[i] += weight * (number - first.number[i]);
      }
      has_first = true;
    });
    for (size_t i = 0; i < size_t(kCount); ++i) found.number[i] += first.number[i];
    return found;
  }

  template <class Reader>
  static Found staggered(Reader& reader, const openvdb::Vec3d& at) {
    Found found;
    for (int axis = 0; axis < kCount; ++axis) {
      openvdb::Vec3d moved = at;
      moved[axis] += 0.5;
      const Found of_axis = plain(reader, moved);
      found.number[size_t(axis)] = of_axis.number[size_t(axis)];
      found.is_active |= of_axis.is_active;
    }
    return found;
  }

  const typename VdbGrid<Value>::ConstPtr grid_;
  const bool is_staggered_;
};

using Field = std::shared_ptr<const GridField>;

constexpr char kWhatIsSampled[] = "--grids takes grids of floats, whole numbers, and three of them";

template <class Value>
Field field_of(const std::string& name, uint64_t digest, openvdb::GridBase::ConstPtr grid) {
  return std::make_shared<VdbGridField<Value>>(name, digest,
                                               std::static_pointer_cast<const VdbGrid<Value>>(std::move(grid)));
}

/// Of the values of nodes above the leaves, where these are not the background.
template <class Value>
uint64_t digest_of_tiles(const VdbGrid<Value>& grid) {
  uint64_t sum = 0;
  auto tile = grid.tree().cbeginValueAll();
  for (tile.setMaxDepth(tile.getLeafDepth() - 1); tile; ++tile) {
    const Value value = tile.getValue();
    if (!tile.isValueOn() && value == grid.background()) continue;
    const openvdb::CoordBBox box = tile.getBoundingBox();
    const uint64_t parts[] = {sum, hash_bytes(box.min().asPointer(), 3 * int64_t(sizeof(int32_t))),
                              hash_bytes(box.max().asPointer(), 3 * int64_t(sizeof(int32_t))),
                              hash_bytes(&value, sizeof value), uint64_t(tile.isValueOn())};
    sum = hash_bytes(parts, int64_t(sizeof parts));
  }
  return sum;
}

/// Of what its nodes hold, where they are, and what is around them.
template <class Value>
uint64_t digest_of(const openvdb::GridBase& of) {
  const auto& grid = static_cast<const VdbGrid<Value>&>(of);
  const Value background = grid.background();
  const AffineMap map = affine_map_of(grid);
  std::vector<uint64_t> parts = {hash_bytes(&background, sizeof background), hash_bytes(map.at, int64_t(sizeof map.at)),
                                 digest_of_tiles<Value>(grid)};
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord at = leaf->origin();
    const auto mask = leaf->getValueMask();
    parts.insert(parts.end(),
                 {hash_bytes(at.asPointer(), 3 * int64_t(sizeof(int32_t))), hash_bytes(&mask, int64_t(sizeof mask)),
                  hash_bytes(leaf->buffer().data(), 512 * int64_t(sizeof(Value)))});
  }
  return hash_bytes(parts.data(), int64_t(parts.size() * sizeof parts[0]));
}

struct Sampled {
  const char* tree_type;
  Field (*field)(const std::string& name, uint64_t digest, openvdb::GridBase::ConstPtr grid);
  uint64_t (*digest)(const openvdb::GridBase& grid);
};

template <class Value>
constexpr Sampled as_sampled(const char* tree_type) {
  return {tree_type, field_of<Value>, digest_of<Value>};
}

constexpr Sampled kSampled[] = {
    as_sampled<float>("Tree_float_5_4_3"),          as_sampled<double>("Tree_double_5_4_3"),
    as_sampled<int32_t>("Tree_int32_5_4_3"),        as_sampled<int64_t>("Tree_int64_5_4_3"),
    as_sampled<openvdb::Vec3f>("Tree_vec3s_5_4_3"), as_sampled<openvdb::Vec3d>("Tree_vec3d_5_4_3"),
    as_sampled<openvdb::Vec3i>("Tree_vec3i_5_4_3"),
};

/// Null for grids that are not sampled.
const Sampled* sampled(const VdbGridSpan& grid) {
  const auto found = std::find_if(std::begin(kSampled), std::end(kSampled),
                                  [&](const Sampled& of) { return is_of_tree(grid, of.tree_type); });
  return found == std::end(kSampled) ? nullptr : found;
}

/// Of a file whose bytes were read.
class Reader {
 public:
  explicit Reader(const MeshSource& source)
      : source_(source),
        grids_(with_names_apart(read_vdb_layout(source.name(), {source.begin(), source.size()}).grids)) {}

  void read_all_but(const std::string& meshed) {
    for (const VdbGridSpan& grid : grids_)
      if (grid.name != meshed && sampled(grid)) read(grid);
  }
  void read(const std::string& name) {
    const auto found =
        std::find_if(grids_.begin(), grids_.end(), [&](const VdbGridSpan& grid) { return grid.name == name; });
    if (found == grids_.end()) refuse("has no grid \"" + name + "\"");
    if (!sampled(*found))
      refuse("grid \"" + name + "\" " +
             (found->instance ? "shares the values of another one" : "has type " + found->type));
    read(*found);
  }
  /// The grid of that name, or else the only one that can be; the field has the name.
  void read_only(const std::string& name) {
    const VdbGridSpan* found = nullptr;
    for (const VdbGridSpan& grid : grids_) {
      if (!sampled(grid) || (found && grid.name != name)) continue;
      if (found && found->name == name) break;
      found = &grid;
    }
    const auto can_be = std::count_if(grids_.begin(), grids_.end(), [](const auto& grid) { return sampled(grid); });
    if (!found || (found->name != name && can_be > 1)) refuse("has no grid \"" + name + "\"");
    read(*found, name);
  }
  std::vector<Field> taken() { return std::move(fields_); }

 private:
  void read(const VdbGridSpan& grid) { read(grid, grid.name); }
  void read(const VdbGridSpan& grid, const std::string& name) {
    const auto is_it = [&](const Field& field) { return field->name() == name; };
    if (std::any_of(fields_.begin(), fields_.end(), is_it)) return;
    const uint64_t digest = hash_bytes(source_.begin() + grid.content, grid.end - grid.content);
    try {
      fields_.push_back(sampled(grid)->field(name, digest, read_counted_grid(source_, grid)));
    } catch (const std::bad_alloc&) {
      throw Error(ErrorCode::out_of_memory, "read", source_.name() + ": out of memory; leave out --grids " + grid.name);
    }
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::usage, "read",
                source_.name() + ": " + what + "; " + kWhatIsSampled + ". Its grids are: " + list_of(grids_));
  }

  const MeshSource& source_;
  const std::vector<VdbGridSpan> grids_;
  std::vector<Field> fields_;
};

constexpr int64_t kLeafBytes = 512 * 4 + 192;  // of 32 bits a value, with masks and allocation

void check_memory(const DenseVolume& volume, const std::string& name, int64_t limit_bytes) {
  double bytes = double(kLeafBytes);
  for (const int64_t size : volume.size) bytes *= double((size + 7) / 8);
  if (limit_bytes <= 0 || bytes <= double(limit_bytes)) return;
  throw Error(ErrorCode::out_of_memory, "memory",
              name + ": its values take " + readable_bytes(int64_t(bytes)) + " as a grid, more than the limit of " +
                  readable_bytes(limit_bytes) + "; crop it, resample it coarser or raise --max-memory");
}

constexpr float kMostWhole = 1 << 24;  // whole numbers that single precision holds

bool is_held_whole(float value) { return std::abs(value) <= kMostWhole && value == std::floor(value); }

[[noreturn]] void refuse_value(const std::string& name, const std::array<int64_t, 3>& at, float value) {
  const std::string place =
      "[" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " + std::to_string(at[2]) + "]";
  std::ostringstream number;
  number << std::setprecision(9) << value;
  throw Error(ErrorCode::usage, "arguments",
              name + ": value " + place + " is " + number.str() +
                  (std::isinf(value) ? "; values are finite in single precision, or NaN where nothing is known"
                                     : "; whole numbers are whole, and none is beyond 16777216; or give floats"));
}

}  // namespace

std::vector<Field> read_grid_fields(const MeshSource& source, const std::vector<std::string>& names,
                                    const std::string& meshed) {
  initialize_openvdb();
  Reader reader(source);
  for (const std::string& name : names) name == kAllGrids ? reader.read_all_but(meshed) : reader.read(name);
  return reader.taken();
}

std::vector<Field> read_grid_fields(const std::string& path, const std::vector<std::string>& names, int64_t max_bytes) {
  initialize_openvdb();
  ReadingBudget budget(max_bytes);
  const MeshSource source(path, budget);
  Reader reader(source);
  for (const std::string& name : names) reader.read(name);
  return reader.taken();
}

Field grid_field_of_vdb(View<const char> bytes, const std::string& name) {
  initialize_openvdb();
  const MeshSource source(name, bytes);
  if (is_nano_file(source))
    throw Error(ErrorCode::usage, "arguments",
                name + ": its bytes are of NanoVDB, whose values are not sampled; convert them by nanoToOpenVDB()");
  Reader reader(source);
  reader.read_only(name);
  return reader.taken().front();
}

Field field_of_values(const openvdb::GridBase::ConstPtr& grid, const std::string& name) {
  VdbGridSpan span;
  span.type = grid->type();
  const Sampled* const kind = sampled(span);
  if (!kind)
    throw Error(ErrorCode::usage, "arguments", "grid " + name + " has type " + grid->type() + "; " + kWhatIsSampled);
  return kind->field(name, kind->digest(*grid), grid);
}

Field grid_field(const DenseVolume& volume, const std::string& name, bool is_whole, int64_t memory_limit_bytes) {
  check_memory(volume, name, memory_limit_bytes);
  const auto read = [&](int64_t i, int64_t j, int64_t k, auto& value) {
    const float given = value_of(volume, i, j, k);
    if (std::isnan(given)) return false;
    if (std::isinf(given) || (is_whole && !is_held_whole(given))) refuse_value(name, {i, j, k}, given);
    value = std::decay_t<decltype(value)>(given);
    return true;
  };
  if (is_whole) return field_of_values(dense_grid<VdbIntGrid>(volume, name, read), name);
  return field_of_values(dense_grid<VdbFloatGrid>(volume, name, read), name);
}

}  // namespace isoshell
