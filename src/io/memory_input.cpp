// Inputs of what is in memory.
#include "isoshell/io/memory_input.h"

#include <sstream>
#include <utility>

#include "geometry/given_surface.h"
#include "geometry/world_vector.h"
#include "io/faces/face_collector.h"
#include "io/input_reader.h"
#include "isoshell/error.h"
#include "isoshell/io/memory_grid.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::unreadable_input, "read", message); }
[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "read", message); }

/// Readers leave out points that are not finite; those from memory may be anything.
void check_points(const PointCloud& cloud, const std::string& name) {
  for (const auto* values : {&cloud.position, &cloud.normal})
    for (size_t i = 0; i < values->size(); ++i) {
      const WorldPoint& p = (*values)[i];
      if (is_finite(p)) continue;
      std::ostringstream text;
      text << name << ": " << (values == &cloud.position ? "point " : "normal ") << i << " is (" << p.x << ", " << p.y
           << ", " << p.z << "); positions and normals must be finite";
      refuse(text.str());
    }
  if (!cloud.normal.empty() && cloud.normal.size() != cloud.position.size())
    refuse_use(name + ": there are " + std::to_string(cloud.normal.size()) + " normals and " +
               counted(int64_t(cloud.position.size()), "point") + "; give one normal a point");
}

}  // namespace

TriangleSoup split_polygons(PolygonSoup polygons, const std::string& name) {
  const MeshSource source(name, {});
  VertexTable vertices(source, int64_t(polygons.vertices.size()));
  vertices.points = std::move(polygons.vertices);
  vertices.count_nonfinite();
  const size_t vertex_count = vertices.points.size();
  std::vector<FaceCollector> parts(1, FaceCollector(vertices));
  size_t corner = 0;
  for (size_t f = 0; f < polygons.sizes.size(); ++f) {
    const size_t end = corner + polygons.sizes[f];
    if (end > polygons.corners.size())
      source.refuse("face " + std::to_string(f) + " ends behind the last corner; sizes of faces must sum up to " +
                    std::to_string(polygons.corners.size()));
    for (size_t c = corner; c < end; ++c)
      if (polygons.corners[c] >= vertex_count)
        source.refuse("face " + std::to_string(f) + " has vertex " + std::to_string(polygons.corners[c]) +
                      " of a surface of " + counted(int64_t(vertex_count), "vertex", "vertices") +
                      "; indices count from 0 and are below that");
    parts[0].add_polygon(polygons.corners.data() + corner, polygons.sizes[f]);
    corner = end;
  }
  if (corner != polygons.corners.size())
    source.refuse("its faces have " + std::to_string(corner) + " corners, and " +
                  std::to_string(polygons.corners.size()) + " are given; sizes of faces must sum up to that");
  return join_soup(source, std::move(vertices), parts);
}

Input input_of(TriangleSoup soup, const std::string& name, const Tell& tell) {
  check_surface(soup, name);
  if (soup.faces_in_file == 0) soup.faces_in_file = int64_t(soup.triangles.size());  // it comes from no file
  const Context unlimited;
  InputReader reader(name, unlimited, tell);
  reader.hold(std::move(soup));
  return reader.taken();
}

Input input_of(const PointCloud& cloud, const std::string& name, int64_t memory_limit_bytes, const Tell& tell,
               VolumeCreases creases, bool keep_open) {
  check_points(cloud, name);
  Context context;
  context.memory_limit_bytes = memory_limit_bytes;
  InputReader reader(name, context, tell);
  reader.hold(cloud, creases, keep_open);
  return reader.taken();
}

Input input_of_points(PointCloud cloud, const std::string& name, const Tell& tell) {
  check_points(cloud, name);
  const Context unlimited;
  InputReader reader(name, unlimited, tell);
  reader.hold_points(std::move(cloud));
  return reader.taken();
}

Input input_of(LabelVolume volume, const std::string& name, const Context& context, const Tell& tell) {
  InputReader reader(name, context, tell);
  reader.hold(std::move(volume));
  return reader.taken();
}

Input input_of(const DenseVolume& volume, const std::string& name, const VolumeReadOptions& options, const Tell& tell) {
  const Context unlimited;  // the options have the limit
  InputReader reader(name, unlimited, tell);
  reader.hold_volume(options.keep_open,
                     [&](VolumeInfo& info) { return surface_of_volume(volume, name, options, info); });
  return reader.taken();
}

Input input_of(const MemoryGrid& grid, const std::string& name, const InputRequest& request, const Context& context,
               const Tell& tell) {
  InputReader reader(name, context, tell);
  reader.hold(grid.held(), request);
  return reader.taken();
}

std::shared_ptr<const GridField> grid_field(const MemoryGrid& grid, const std::string& name) {
  return grid.held().sampled(name);
}

Input input_of_vdb(View<const char> bytes, const std::string& name, const InputRequest& request, const Context& context,
                   const Tell& tell) {
  InputReader reader(name, context, tell);
  VolumeReadOptions options;
  options.grid = request.grid;
  options.iso = request.iso;
  options.memory_limit_bytes = context.memory_limit_bytes;
  if (const std::shared_ptr<const HeldGrid> grid = copied_nano_grid(bytes, name, options))
    reader.hold(*grid, request);
  else
    reader.read(MeshSource(name, bytes), request);
  return reader.taken();
}

}  // namespace isoshell
