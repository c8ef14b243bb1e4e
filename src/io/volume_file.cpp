// Which reader a volume gets, which grid and which value.
#include "isoshell/io/volume_file.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/parallel_ranges.h"
#include "geometry/common_step.h"
#include "implicit/volumes/dense_field.h"
#include "implicit/volumes/field_sharpness.h"
#include "implicit/volumes/iso_surface.h"
#include "implicit/volumes/unsigned_field.h"
#include "io/vdb/grid_kinds.h"
#include "io/vdb/volume_readers.h"
#include "isoshell/error.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr char kLevelSet[] = "level set", kUnknown[] = "unknown";

constexpr double kCrustVoxels = 0.9;     // half a voxel's diagonal and a little: every voxel of the surface is inside
constexpr double kLeastEnclosing = 0.5;  // of the zero set: with less it is an open surface

[[noreturn]] void refuse_without_iso(const ScalarField& field, const ValueRange& range, const std::string& why) {
  std::ostringstream text;
  text << field.title();
  if (range.low == range.high) {
    text << " has no surface: all its values are " << range.low;
    throw Error(ErrorCode::nothing_to_mesh, "read", text.str());
  }
  text << " is no level set (class " << field.grid_class << ", values " << range.low << " to " << range.high << ")"
       << why << "; say by --iso at which value its surface lies, for example --iso "
       << (double(range.low) + range.high) / 2;
  throw Error(ErrorCode::usage, "read", text.str());
}

[[noreturn]] void refuse_unknown(const ScalarField& field, Voxel v) {
  throw Error(ErrorCode::unreadable_input, "read",
              field.title() + ", voxel (" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " +
                  std::to_string(v.z) +
                  "): its value is not a number, and unsigned distances do not tell which side of "
                  "the surface it is on; give it a value, or signs to the others");
}

/// Whether the class leaves open what the values are, or says that they have no sign.
bool may_be_unsigned(const std::string& grid_class) {
  return grid_class == kUnknown || grid_class.find("unsigned") != std::string::npos;
}

/// The surface of unsigned distances: of their sides, or around the zero set where that encloses nothing.
TriangleSoup surface_of_unsigned(ScalarField& field, const VolumeReadOptions& options, VolumeInfo& info) {
  const ValueRange range = value_range(field);
  if (range.low == range.high) refuse_without_iso(field, range, "");
  const DistanceKind kind = kind_of_distance(field);
  if (kind.voxel == 0) refuse_without_iso(field, range, ", and no unsigned distance: " + kind.why);
  if (field.background <= 0)
    refuse_without_iso(field, range,
                       ". Its values look like unsigned distances, but its background of 0 puts a surface at the end "
                       "of the grid: save it with a background above its largest value");
  if (range.unknown) refuse_unknown(field, *range.unknown);
  info.kind = VolumeKind::unsigned_distance;
  const SignedSides sides = find_sides(field, kind.voxel, options.memory_limit_bytes);
  if (sides.enclosing_part >= kLeastEnclosing)
    return extract_iso_surface(*sides.field, 0, options.memory_limit_bytes, options.creases);
  if (options.keep_open)
    throw Error(ErrorCode::usage, "read",
                field.title() +
                    ": the zero set of its unsigned distances encloses nothing, and --boundary keep has no "
                    "side to leave open; leave it out for the crust around it, or give distances with signs");
  info.kind = VolumeKind::open_unsigned_distance;
  info.iso = kCrustVoxels * kind.voxel;
  return extract_iso_surface(field, info.iso, options.memory_limit_bytes);
}

/// The surface at the value asked for, or at 0 in a level set; one that does not say so shows it by a background
/// outside and values inside.
TriangleSoup surface_of(ScalarField& field, const VolumeReadOptions& options, VolumeInfo& info) {
  if (options.iso) {
    info.iso = *options.iso;
  } else if (field.grid_class != kLevelSet) {
    const ValueRange range = value_range(field);
    if (range.low >= 0 && may_be_unsigned(field.grid_class)) return surface_of_unsigned(field, options, info);
    if (field.grid_class != kUnknown || range.low >= 0 || field.background <= 0) refuse_without_iso(field, range, "");
  }
  if (!options.iso) {
    const std::unique_ptr<ScalarField> continued = field.continued();
    field.most_rise = most_rise_of(continued ? *continued : field, inside_of(field, 0));
    field.opens_at_jumps = options.keep_open;
  }
  UnknownValues unknown;
  TriangleSoup soup = extract_iso_surface(field, info.iso, options.memory_limit_bytes, options.creases, &unknown);
  info.unknown_values = unknown.values;
  info.open_cells = unknown.cells;
  info.first_open_world = unknown.first_world;
  info.jumping_part = unknown.jumping_part;
  return soup;
}

double voxel_size(const AffineMap& map) {
  double longest_sq = 0;
  for (int i = 0; i < 3; ++i) {
    double sq = 0;
    for (const auto& row : map.at) sq += row[i] * row[i];
    longest_sq = std::max(longest_sq, sq);
  }
  return std::sqrt(longest_sq);
}

void check_map(const ScalarField& field) {
  if (std::isnan(field.background))
    throw Error(ErrorCode::unreadable_input, "read", field.title() + " has a background that is not a number");
  if (!is_invertible(field.to_world))
    throw Error(ErrorCode::unreadable_input, "read",
                field.title() + " has a transform that is not finite or has no inverse");
}

double step_world(const DenseVolume& volume) {
  return common_step_world(volume.step_world, {volume.size[0], volume.size[1], volume.size[2]});
}

/// With steps along the axes of the world, as those that common_step_world() allows are but for rounding.
DenseVolume straightened(DenseVolume volume) {
  for (WorldPoint& step : volume.step_world) {
    const size_t axis = world_axis(step);
    step = {axis == 0 ? step.x : 0, axis == 1 ? step.y : 0, axis == 2 ? step.z : 0};
  }
  return volume;
}

/// Whether options.is_periodic names an axis. Throws: usage where it does, for an array with a single value along an
/// axis, with steps that are not along the axes of the world and whole multiples of the shortest one, or whose sides
/// are not those of its samples.
bool check_periodic(const DenseVolume& volume, const std::string& name, const VolumeReadOptions& options) {
  const auto& axes = options.is_periodic;
  if (std::none_of(axes.begin(), axes.end(), [](bool is) { return is; })) return false;
  const auto refuse = [&](const std::string& what) { throw Error(ErrorCode::usage, "read", name + ": " + what); };
  if (options.sides != VolumeSides::sample || options.keep_open)
    refuse("a periodic volume is closed at its samples; leave out sides and boundary=\"keep\"");
  if (*std::min_element(volume.size, volume.size + 3) < 2)
    refuse("a periodic volume has two values or more along each axis");
  if (step_world(volume) == 0)
    refuse(
        "a periodic volume has steps along the axes of the world that are whole multiples of the shortest one; "
        "resample it");
  return true;
}

/// Says of the surface of such a field that it is that of one solid, region 1, which triangles lie on its sides, and
/// how long its periods are.
void set_periodic_regions(const DenseVolume& volume, const VolumeReadOptions& options, TriangleSoup& surface) {
  FaceRegions& regions = surface.regions;
  regions.are_of_voxels = true;
  regions.voxel_size_world = step_world(volume);
  regions.labels.assign(surface.triangles.size(), {1, 0});
  regions.side.assign(surface.triangles.size(), 0);
  double low[3], high[3];  // by axes of the array
  double* const period_world[3] = {&regions.period_world.x, &regions.period_world.y, &regions.period_world.z};
  for (size_t axis = 0; axis < 3; ++axis) {
    const bool is_periodic = options.is_periodic[axis];
    const size_t world = world_axis(volume.step_world[axis]);
    const double step = coordinate(volume.step_world[axis], world);
    low[axis] = coordinate(volume.origin_world, world);
    high[axis] = step * double(is_periodic ? volume.size[axis] : volume.size[axis] - 1) + low[axis];
    if (step < 0) std::swap(low[axis], high[axis]);
    if (is_periodic) *period_world[world] = std::abs(step) * double(volume.size[axis]);
  }
  for_each_index(size_t(0), surface.triangles.size(), [&](size_t t) {
    const auto lies_at = [&](size_t world, double place) {
      const auto& corners = surface.triangles[t];
      return std::all_of(corners.begin(), corners.end(),
                         [&](uint32_t v) { return coordinate(surface.vertices[v], world) == place; });
    };
    for (size_t axis = 0; axis < 3; ++axis) {
      const size_t world = world_axis(volume.step_world[axis]);
      regions.side[t] = uint8_t(lies_at(world, low[axis])    ? 2 * world + 1
                                : lies_at(world, high[axis]) ? 2 * world + 2
                                                             : regions.side[t]);
    }
  });
}

}  // namespace

TriangleSoup surface_of_field(ScalarField& field, const VolumeReadOptions& options, VolumeInfo& info) {
  info.grid = field.name;
  info.grid_class = field.grid_class;
  info.voxel_size_world = voxel_size(field.to_world);
  info.blocks = int64_t(field.blocks().size());
  return surface_of(field, options, info);
}

TriangleSoup read_volume(const std::string& path, const VolumeReadOptions& options, VolumeInfo& info) {
  ReadingBudget budget(options.memory_limit_bytes);
  const MeshSource source(path, budget);
  return read_volume(source, options, info);
}

TriangleSoup read_volume(const MeshSource& source, const VolumeReadOptions& options, VolumeInfo& info) {
  if (source.size() == 0) source.nothing_to_mesh("is empty (0 bytes); give a file with a volume");
  return read_volume(is_nano_file(source) ? read_nano_volume(source, options) : read_vdb_volume(source, options),
                     source.name(), options, info);
}

TriangleSoup read_volume(std::unique_ptr<ScalarField> field, const std::string& file, const VolumeReadOptions& options,
                         VolumeInfo& info) {
  field->file = file;
  check_map(*field);
  if (field->is_band_alone()) field = with_points_beside_band(std::move(field), options.memory_limit_bytes);
  return surface_of_field(*field, options, info);
}

TriangleSoup surface_of_volume(const DenseVolume& given, const std::string& name, const VolumeReadOptions& options,
                               VolumeInfo& info) {
  if (!check_periodic(given, name, options)) {
    DenseField field(given, name, options);
    return surface_of_field(field, options, info);
  }
  const DenseVolume volume = straightened(given);
  VolumeReadOptions rounded = options;
  rounded.creases = VolumeCreases::none;
  DenseField field(volume, name, rounded);
  TriangleSoup surface = surface_of_field(field, rounded, info);
  if (info.kind != VolumeKind::at_value)
    throw Error(ErrorCode::usage, "read", name + ": a periodic volume has values of both signs; give an isovalue");
  if (info.open_cells > 0)
    throw Error(
        ErrorCode::usage, "read",
        name + ": a periodic volume has values that are numbers all along its surface, and this one has none near " +
            exact_place(info.first_open_world));
  set_periodic_regions(volume, options, surface);
  return surface;
}

}  // namespace isoshell
