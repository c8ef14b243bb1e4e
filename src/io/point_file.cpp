// Which reader a point cloud gets, and what needs no file of its own: PLY without faces, and text rows.
#include "isoshell/io/point_file.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "core/file_format.h"
#include "geometry/world_vector.h"
#include "io/bytes/text_scan.h"
#include "io/faces/face_collector.h"
#include "io/file_formats.h"
#include "io/ply/ply_body.h"
#include "io/ply/ply_reader.h"
#include "io/points/point_readers.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr int kMaxColumns = 16;
constexpr double kUnitTolerance = 0.02;
constexpr double kMostOdd = 0.02;  // rows without a unit vector among those of a column of normals

constexpr const char* kPosition[3] = {"x", "y", "z"};
constexpr const char* kNormal[3] = {"nx", "ny", "nz"};

PlyBody ply_vectors(const MeshSource& source, const PlyHeader& header, const char* const names[3]) {
  PlyBody body(source);
  PlyMeshLayout layout;
  layout.vertices = header.find("vertex");
  for (int axis = 0; layout.vertices && axis < 3; ++axis) {
    layout.xyz[axis] = layout.vertices->find(names[axis]);
    if (layout.xyz[axis] < 0 || layout.vertices->properties[size_t(layout.xyz[axis])].is_list) return body;
  }
  read_ply_body(source, header, layout, body);
  return body;
}

/// Empty, without a look at the rows, when the header names none.
std::vector<WorldPoint> read_ply_normals(const MeshSource& source, const PlyHeader& header) {
  return std::move(ply_vectors(source, header, kNormal).vertices.points);
}

/// Whether three columns from `first` on hold unit vectors.
bool holds_normals(const std::vector<double>& rows, int columns, int first) {
  if (first + 3 > columns) return false;
  const size_t count = rows.size() / size_t(columns);
  size_t odd = 0;
  for (size_t i = 0; i < count; ++i) {
    const double* n = &rows[i * size_t(columns) + size_t(first)];
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    odd += !(std::abs(length - 1) < kUnitTolerance);
  }
  return double(odd) <= kMostOdd * double(count);
}

/// Numbers of a row, at most kMaxColumns.
int count_columns(const char* p, const char* end) {
  int columns = 0;
  double value;
  for (p = skip_blanks(p, end); columns < kMaxColumns && parse_real(p, end, value); p = skip_blanks(p, end)) ++columns;
  return columns;
}

void drop_nonfinite(PointCloud& cloud) {
  size_t kept = 0;
  for (size_t i = 0; i < cloud.position.size(); ++i) {
    if (!is_finite(cloud.position[i])) continue;
    if (!cloud.normal.empty()) cloud.normal[kept] = is_finite(cloud.normal[i]) ? cloud.normal[i] : WorldPoint{0, 0, 0};
    cloud.position[kept++] = cloud.position[i];
  }
  cloud.dirt.nonfinite_vertices = int64_t(cloud.position.size() - kept);
  cloud.position.resize(kept);
  if (!cloud.normal.empty()) cloud.normal.resize(kept);
}

}  // namespace

PointCloud read_ply_points(const MeshSource& source) {
  const PlyHeader header = read_ply_header(source);
  PointCloud cloud;
  PlyBody body = ply_vectors(source, header, kPosition);
  cloud.position = std::move(body.vertices.points);
  cloud.dirt = body.dirt;
  const PlyElement* const vertices = header.find("vertex");
  if (cloud.position.empty() && vertices && vertices->count > 0)
    source.refuse_line_at(vertices->header_line, "element vertex has no numbers named x, y and z");
  cloud.normal = read_ply_normals(source, header);
  return cloud;
}

// Rows of x y z, then perhaps colours and a normal: the first three columns behind them that hold unit vectors. A first
// row that is a title or a count is passed over.
PointCloud read_xyz(const MeshSource& source) {
  const Text text(source);
  const TextRows rows(text, text.begin(), '#');
  if (rows.count() == 0) source.nothing_to_mesh("holds no rows of points");
  const char* const first = rows.find(0);
  const int64_t head = count_columns(first, line_end(first, text.end())) < 3 ? 1 : 0;
  const int64_t count = rows.count() - head;
  if (count == 0) text.refuse(first, "a point needs three numbers; found " + quoted_token(first, text.end()));
  const char* const sample = rows.find(head);
  const int columns = count_columns(sample, line_end(sample, text.end()));
  if (columns < 3) text.refuse(sample, "a point needs three numbers; found " + quoted_token(sample, text.end()));
  std::vector<double> numbers;
  resize_counted(source, numbers, size_t(count) * size_t(columns));
  rows.for_each(head, rows.count(), [&](int64_t row, const char* p, const char* end, int64_t) {
    for (int c = 0; c < columns; ++c) {
      p = skip_blanks(p, end);
      if (!parse_real(p, end, numbers[size_t(row - head) * size_t(columns) + size_t(c)]))
        text.refuse(p, "a row needs " + std::to_string(columns) + " numbers, as the first one; found " +
                           quoted_token(p, end) + " instead of one");
    }
    return p;
  });
  int normals = -1;
  for (const int column : {3, 6, 7})
    if (normals < 0 && holds_normals(numbers, columns, column)) normals = column;
  PointCloud cloud;
  make_room(source, cloud.position, size_t(count));
  if (normals > 0) make_room(source, cloud.normal, size_t(count));
  for (int64_t i = 0; i < count; ++i) {
    const double* row = &numbers[size_t(i) * size_t(columns)];
    cloud.position.push_back({row[0], row[1], row[2]});
    if (normals > 0) cloud.normal.push_back({row[normals], row[normals + 1], row[normals + 2]});
  }
  return cloud;
}

namespace {

/// What every format gives: finite points, at least one.
PointCloud finished(const MeshSource& source, PointCloud cloud) {
  drop_nonfinite(cloud);
  if (cloud.position.empty()) source.nothing_to_mesh("holds no finite point");
  return cloud;
}

bool holds_rows(const PlyHeader& header, const char* element) {
  const PlyElement* const found = header.find(element);
  return found && found->count > 0;
}

bool has_area(const TriangleSoup& soup) {
  const std::vector<WorldPoint>& p = soup.vertices;
  return std::any_of(soup.triangles.begin(), soup.triangles.end(), [&](const Triangle& t) {
    const WorldPoint area = doubled_area(p[t[0]], p[t[1]], p[t[2]]);
    return area.x != 0 || area.y != 0 || area.z != 0;
  });
}

/// The vertices of a mesh whose faces span no area, and what became of those; nothing of the mesh is kept beside them.
PointCloud vertices_of(TriangleSoup mesh) {
  PointCloud cloud;
  cloud.position = std::move(mesh.vertices);
  cloud.dirt = mesh.dirt;
  cloud.dirt.degenerate_faces += int64_t(mesh.triangles.size());
  cloud.dirt.unreferenced_vertices = 0;
  return cloud;
}

template <class Read>
auto read_or_say_why(const MeshSource& source, const char* what, Read read) {
  if (source.size() == 0) source.nothing_to_mesh(std::string("is empty (0 bytes); give a file with ") + what);
  try {
    return read();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "read",
                source.name() + ": " + std::to_string(source.size()) + " bytes do not fit into memory as " + what);
  }
}

}  // namespace

PointCloud read_points(const std::string& path, const std::string& format, int64_t memory_limit_bytes) {
  const FormatRow* row = find_row(format.empty() ? format_of_path(path) : format_name(format));
  if (!row || !row->read_points)
    throw Error(ErrorCode::usage, "read",
                path + ": the format of points must be one of " + listed_formats(reads_points));
  ReadingBudget budget(memory_limit_bytes);
  const MeshSource source(path, budget);
  return read_or_say_why(source, "points", [&] { return finished(source, row->read_points(source)); });
}

PlyContent read_ply_content(const std::string& path, int64_t memory_limit_bytes) {
  ReadingBudget budget(memory_limit_bytes);
  const MeshSource source(path, budget);
  return read_or_say_why(source, "faces or points", [&] {
    const PlyHeader header = read_ply_header(source);
    if (!holds_rows(header, "vertex")) return PlyContent{false, read_ply(source), {}, 0};
    PlyContent content;
    PointCloud cloud;
    if (holds_rows(header, "face") || holds_rows(header, "tristrips")) {
      content.mesh = read_ply_faces(source);
      if (has_area(content.mesh)) return content;
      content.unusable_faces = content.mesh.faces_in_file;
      cloud = vertices_of(std::exchange(content.mesh, {}));
      cloud.normal = read_ply_normals(source, header);  // a second look at the rows, once it is known that they count
    } else {
      cloud = read_ply_points(source);
    }
    content.is_points = true;
    content.points = finished(source, std::move(cloud));
    return content;
  });
}

}  // namespace isoshell
