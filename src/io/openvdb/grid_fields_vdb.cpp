// Grids of any numbers, sampled as OpenVDB does it.
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <type_traits>

#include "core/hash_bytes.h"
#include "core/number_type.h"
#include "io/openvdb/field_grid.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/grid_fields.h"
#include "io/vdb/grid_names.h"
#include "isoshell/error.h"

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

template <class Value>
Field field_of(const std::string& name, uint64_t digest, openvdb::GridBase::Ptr grid) {
  return std::make_shared<VdbGridField<Value>>(name, digest, std::static_pointer_cast<VdbGrid<Value>>(std::move(grid)));
}

struct Sampled {
  const char* tree_type;
  Field (*field)(const std::string& name, uint64_t digest, openvdb::GridBase::Ptr grid);
};

constexpr Sampled kSampled[] = {
    {"Tree_float_5_4_3", field_of<float>},          {"Tree_double_5_4_3", field_of<double>},
    {"Tree_int32_5_4_3", field_of<int32_t>},        {"Tree_int64_5_4_3", field_of<int64_t>},
    {"Tree_vec3s_5_4_3", field_of<openvdb::Vec3f>}, {"Tree_vec3d_5_4_3", field_of<openvdb::Vec3d>},
    {"Tree_vec3i_5_4_3", field_of<openvdb::Vec3i>},
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
  std::vector<Field> taken() { return std::move(fields_); }

 private:
  void read(const VdbGridSpan& grid) {
    const auto is_it = [&](const Field& field) { return field->name() == grid.name; };
    if (std::any_of(fields_.begin(), fields_.end(), is_it)) return;
    const uint64_t digest = hash_bytes(source_.begin() + grid.content, grid.end - grid.content);
    try {
      fields_.push_back(sampled(grid)->field(grid.name, digest, read_counted_grid(source_, grid)));
    } catch (const std::bad_alloc&) {
      throw Error(ErrorCode::out_of_memory, "read", source_.name() + ": out of memory; leave out --grids " + grid.name);
    }
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::usage, "read",
                source_.name() + ": " + what + "; --grids takes grids of floats, whole numbers, and three of them. " +
                    "Its grids are: " + list_of(grids_));
  }

  const MeshSource& source_;
  const std::vector<VdbGridSpan> grids_;
  std::vector<Field> fields_;
};

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

}  // namespace isoshell
