// Point clouds: every way to write them gives the same points, and points give the closed surface they lie on.
#include <tbb/global_control.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "implicit/points/point_support.h"
#include "io/bytes/lzf.h"
#include "io/points/point_readers.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/source_folder.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

PointCloud parse(const std::string& text, const std::string& format) {
  const MeshSource source("cloud", {text.data(), int64_t(text.size())});
  return format == "ply" ? read_ply_points(source) : format == "xyz" ? read_xyz(source) : read_pcd(source);
}

ErrorCode refusal(const std::string& text, const std::string& format) {
  return error_of([&] { parse(text, format); }).code();
}

/// A ball's points along a spiral, each moved by up to `noise`; only those above `lowest`.
PointCloud ball(int count, double lowest, double noise, bool normals) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), turn = 2.399963229728653 * i;
    if (z < lowest) continue;
    const auto shift = [&](uint64_t axis) {
      return noise * (double(random_bits(axis, uint64_t(i)) >> 11) / double(uint64_t(1) << 52) - 1);
    };
    const WorldPoint p{r * std::cos(turn), r * std::sin(turn), z};
    cloud.position.push_back({10 + 3 * (p.x + shift(0)), 3 * (p.y + shift(1)), 3 * (p.z + shift(2))});
    if (normals) cloud.normal.push_back(p);
  }
  return cloud;
}

InputTopology topology_of(const TriangleSoup& soup) {
  Context context;
  return measure_topology(soup, context).topology;
}

double worst_radius_error(const TriangleSoup& soup, double above) {
  double worst = 0;
  for (const WorldPoint& p : soup.vertices) {
    const double x = (p.x - 10) / 3, y = p.y / 3, z = p.z / 3;
    if (z > above) worst = std::max(worst, std::abs(std::sqrt(x * x + y * y + z * z) - 1));
  }
  return worst;
}

/// Of the angle between the normals of two triangles that share an edge.
double sharpest_cosine(const TriangleSoup& soup) {
  std::map<std::pair<uint32_t, uint32_t>, WorldPoint> normal_at;
  double sharpest = 1;
  for (const auto& t : soup.triangles) {
    const WorldPoint n = doubled_area(soup.vertices[t[0]], soup.vertices[t[1]], soup.vertices[t[2]]);
    for (int i = 0; i < 3; ++i) {
      const uint32_t a = t[size_t(i)], b = t[size_t((i + 1) % 3)];
      const auto other = normal_at.find({b, a});
      if (other == normal_at.end())
        normal_at[{a, b}] = n;
      else if (const double sizes = length(n) * length(other->second); sizes > 0)
        sharpest = std::min(sharpest, dot(n, other->second) / sizes);
    }
  }
  return sharpest;
}

std::string raw(const void* data, size_t size) { return {static_cast<const char*>(data), size}; }

const std::string kPcd =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";

}  // namespace

TEST_CASE("points: rows of text with titles, comments, colours and normals", "[points][unit]") {
  CHECK(parse("1 2 3\n4 5 6\n", "xyz").position[1].z == 6);
  CHECK(parse("2\n# two\n1 2 3\n4 5 6", "xyz").position.size() == 2);
  CHECK(parse("x y z\n1 2 3\n", "xyz").position[0].y == 2);
  const PointCloud normals = parse("1 2 3 0 0 1\n4 5 6 0.6 0 -0.8\n", "xyz");
  REQUIRE(normals.normal.size() == 2);
  CHECK(normals.normal[1].z == -0.8);
  CHECK(parse("1 2 3 255 0 12\n4 5 6 1 2 3\n", "xyz").normal.empty());
  CHECK(parse("1 2 3 255 0 12 0 1 0\n", "xyz").normal.size() == 1);
  CHECK(refusal("1 2 3\n4 five 6\n", "xyz") == ErrorCode::unreadable_input);
  CHECK(refusal("1 2\n", "xyz") == ErrorCode::unreadable_input);
  CHECK(refusal("# nothing\n", "xyz") == ErrorCode::nothing_to_mesh);
}

TEST_CASE("points: a PLY without faces, with its normals", "[points][unit]") {
  const PointCloud cloud = parse(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty uchar red\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n1 7 2 3 0 1 0\n",
      "ply");
  REQUIRE(cloud.normal.size() == 1);
  CHECK(cloud.position[0].y == 2);
  CHECK(cloud.normal[0].y == 1);
}

TEST_CASE("points: a PLY with more values or rows than its header declares gives those that it declares",
          "[points][unit]") {
  const std::string head =
      "element vertex 2\nproperty uchar nx\nproperty uchar ny\nproperty uchar nz\nproperty uchar x\n"
      "property uchar y\nproperty uchar z\nend_header\n";
  const PointCloud text = parse("ply\nformat ascii 1.0\n" + head + "0 0 1 1 2 3 4\n0 0 1 5 6 7\n8 9\n", "ply");
  const PointCloud binary =
      parse("ply\nformat binary_big_endian 1.0\n" + head + std::string("\0\0\1\1\2\3\0\0\1\5\6\7\x8\x9", 14), "ply");
  for (const PointCloud* cloud : {&text, &binary}) {
    REQUIRE(cloud->position.size() == 2);
    CHECK(cloud->position[1].x == 5);
    CHECK(cloud->normal[1].z == 1);
  }
  CHECK(text.dirt.long_rows == 1);
  CHECK(text.dirt.surplus_rows == 1);
  CHECK(binary.dirt.surplus_bytes == 2);
  CHECK(refusal("ply\nformat ascii 1.0\n" + head + "0 0 1 1 2 3 4 5 6 7\n", "ply") == ErrorCode::unreadable_input);
  CHECK(refusal("ply\nformat ascii 1.0\n" + head + "0 0 1 1 2 3 4\n0 0 1 5 6\n", "ply") == ErrorCode::unreadable_input);
}

TEST_CASE("points: a PLY of which no face has area is a cloud, one with a face that has is a mesh", "[points][unit]") {
  const auto content_of = [](const std::string& faces, int count) {
    const TemporaryFolder folder;
    put_file(folder / "a.ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
             "property float nx\nproperty float ny\nproperty float nz\nelement face " +
                 std::to_string(count) +
                 "\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 2\n2 0 0 0 0 3\n"
                 "nan 1 0 0 0 4\n" +
                 faces);
    return read_ply_content(folder / "a.ply");
  };
  const PlyContent cloud = content_of("3 0 1 1\n3 0 1 2\n2 0 1\n3 0 1 3\n", 4);
  CHECK(cloud.is_points);
  CHECK(cloud.mesh.vertices.empty());
  CHECK(cloud.points.position.size() == 3);
  REQUIRE(cloud.points.normal.size() == 3);
  CHECK(cloud.points.normal[2].z == 3);
  CHECK(cloud.unusable_faces == 4);
  CHECK(cloud.points.dirt.unreferenced_vertices == 0);
  CHECK(cloud.points.dirt.degenerate_faces == 2);
  CHECK(cloud.points.dirt.short_faces == 1);
  CHECK(cloud.points.dirt.dropped_faces_nonfinite == 1);
  CHECK(cloud.points.dirt.nonfinite_vertices == 1);
  CHECK_THROWS_AS(content_of("3 0 1 4\n", 1), Error);  // a face that lies is no cloud's
  const PlyContent no_faces = content_of("", 0);
  CHECK(no_faces.is_points);
  CHECK(no_faces.points.normal.size() == 3);
  CHECK(no_faces.unusable_faces == 0);
  CHECK_FALSE(read_ply_content(source_folder() + "/tests/data/nefertiti.ply").is_points);
}

TEST_CASE("points: PCD as text, binary and packed", "[points][unit]") {
  const float rows[2][4] = {{1, 2, 3, 0}, {4, 5, 6, 0}}, columns[4][2] = {{1, 4}, {2, 5}, {3, 6}, {0, 0}};
  const std::string plain = raw(columns, sizeof columns);
  std::string packed;  // 24 plain bytes, one more, then 7 that stand one byte before
  packed += char(24);
  packed += plain.substr(0, 25);
  packed += char(5 << 5);
  packed += char(0);
  const uint32_t sizes[2] = {uint32_t(packed.size()), uint32_t(plain.size())};
  const std::string text = kPcd + "ascii\n1 2 3 9\n4 5 6 9\n", binary = kPcd + "binary\n" + raw(rows, sizeof rows),
                    lzf = kPcd + "binary_compressed\n" + raw(sizes, sizeof sizes) + packed;
  for (const std::string& file : {text, binary, lzf}) {
    const PointCloud cloud = parse(file, "pcd");
    REQUIRE(cloud.position.size() == 2);
    CHECK(cloud.position[0].x == 1);
    CHECK(cloud.position[1].y == 5);
    CHECK(cloud.position[1].z == 6);
    CHECK(refusal(file.substr(0, file.size() - 8), "pcd") == ErrorCode::unreadable_input);
  }
  CHECK(refusal("VERSION 0.7\nFIELDS x y z\nPOINTS 4294967295\nDATA binary\n", "pcd") == ErrorCode::unreadable_input);
  CHECK(refusal("VERSION 0.7\nFIELDS x y\nPOINTS 1\nDATA ascii\n1 2\n", "pcd") == ErrorCode::unreadable_input);
}

TEST_CASE("points: a packed piece never reads before its beginning nor writes beyond its end", "[points][unit]") {
  char out[4];
  const auto fits = [&](const std::string& packed) {
    return unpack_lzf({packed.data(), int64_t(packed.size())}, {out, 4});
  };
  CHECK(fits(std::string("\3abcd")));
  CHECK_FALSE(fits(std::string("\3abc")));
  CHECK_FALSE(fits(std::string("\4abcde")));
  CHECK_FALSE(fits(std::string("\0a\x20\5", 4)));  // before the beginning
  CHECK_FALSE(fits(std::string("\0a\xe0", 3)));    // length missing
  CHECK_FALSE(fits(std::string("\0a\xe0\xff\0", 5)));
}

TEST_CASE("points: a ball's points give the ball, with normals or without, in any order and with any threads",
          "[points][unit]") {
  for (const bool normals : {true, false}) {
    PointSurfaceInfo info;
    PointCloud cloud = ball(3000, -2, 0, normals);
    const TriangleSoup soup = surface_of_points(cloud, 0, info);
    const InputTopology t = topology_of(soup);
    CHECK(t.closed);
    CHECK(t.oriented);
    CHECK(t.components == 1);
    CHECK(t.genus == 0);
    CHECK(worst_radius_error(soup, -2) < 0.01);
    CHECK(volume(soup) > 0);
    CHECK(info.open_part == 0);
    std::reverse(cloud.position.begin(), cloud.position.end());
    std::reverse(cloud.normal.begin(), cloud.normal.end());
    cloud.position.push_back(cloud.position.front());
    if (normals) cloud.normal.push_back(cloud.normal.front());
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const TriangleSoup again = surface_of_points(cloud, 0, info);
    CHECK(again.triangles == soup.triangles);
    CHECK(std::memcmp(again.vertices.data(), soup.vertices.data(), soup.vertices.size() * sizeof(WorldPoint)) == 0);
  }
}

TEST_CASE("points: normals that point anywhere, or all inwards, are turned", "[points][unit]") {
  for (const int every : {1, 3}) {
    PointCloud cloud = ball(3000, -2, 0, true);
    for (size_t i = 0; i < cloud.normal.size(); i += size_t(every))
      cloud.normal[i] = {-2 * cloud.normal[i].x, -2 * cloud.normal[i].y, -2 * cloud.normal[i].z};
    PointSurfaceInfo info;
    const TriangleSoup soup = surface_of_points(cloud, 0, info);
    CHECK(info.normals_turned == (every == 3));
    CHECK(volume(soup) == Approx(4.0 / 3 * 3.14159265 * 27).epsilon(0.02));
  }
}

TEST_CASE("points: normals at random, all the same, zero or far from right are not used", "[points][unit]") {
  for (const int kind : {0, 1, 2, 3}) {
    PointCloud cloud = ball(3000, -2, 0, true);
    for (size_t i = 0; i < cloud.normal.size(); ++i) {
      const auto at = [&](uint64_t axis) { return double(random_bits(9, 3 * i + axis) % 2001) / 1000. - 1; };
      const WorldPoint& n = cloud.normal[i];
      if (kind == 3)
        cloud.normal[i] = {n.x + .8 * at(0), n.y + .8 * at(1), n.z + .8 * at(2)};
      else
        cloud.normal[i] = kind == 0 ? WorldPoint{at(0), at(1), at(2)} : WorldPoint{0, 0, double(kind - 1)};
    }
    PointSurfaceInfo info;
    const TriangleSoup soup = surface_of_points(cloud, 0, info);
    CHECK(info.normals_ignored);
    CHECK(volume(soup) == Approx(4.0 / 3 * 3.14159265 * 27).epsilon(0.02));
  }
  PointSurfaceInfo info;
  surface_of_points(ball(3000, -2, 0, true), 0, info);
  CHECK_FALSE(info.normals_ignored);
}

TEST_CASE("points: right normals of a ring as thin as points are apart are kept", "[points][unit]") {
  PointCloud cloud;
  for (uint64_t i = 0; i < 800; ++i) {
    const double turn = 6.283185307179586 * double(i) / 800,
                 around = 6.283185307179586 * double(random_bits(5, i) % 1000) / 1000;
    const WorldPoint n = {std::cos(turn) * std::cos(around), std::sin(turn) * std::cos(around), std::sin(around)};
    cloud.position.push_back({std::cos(turn) + .05 * n.x, std::sin(turn) + .05 * n.y, .05 * n.z});
    cloud.normal.push_back(n);
  }
  PointSurfaceInfo info;
  surface_of_points(cloud, 0, info);
  CHECK_FALSE(info.normals_ignored);
}

TEST_CASE("points: five in a hundred far from all others are left out, sparse parts are not", "[points][unit]") {
  PointCloud cloud = ball(3000, -2, 0, true);
  const std::vector<WorldPoint> on_ball = cloud.position;
  for (uint64_t i = 0; i < 150; ++i) {
    const auto at = [&](uint64_t axis) {
      return double(random_bits(5, 3 * i + axis) >> 11) / 9007199254740992. * 16 - 8;
    };
    cloud.position.push_back({at(0), at(1), at(2)});
    cloud.normal.push_back({0, 0, 1});
  }
  PointSurfaceInfo info;
  const TriangleSoup soup = surface_of_points(cloud, 0, info);
  CHECK(info.outliers > 120);
  CHECK(info.outliers <= 150);
  const InputTopology t = topology_of(soup);
  CHECK(t.components == 1);
  CHECK(t.genus == 0);
  CHECK(volume(soup) == Approx(4.0 / 3 * 3.14159265 * 27).epsilon(0.03));
  PointCloud uneven;
  for (size_t i = 0; i < on_ball.size(); ++i)
    if (on_ball[i].z < 0 || i % 10 == 0) uneven.position.push_back(on_ball[i]);
  surface_of_points(uneven, 0, info);
  CHECK(info.outliers == 0);
}

TEST_CASE("points: a scan from one side becomes one closed surface, true where there are points", "[points][unit]") {
  PointSurfaceInfo info;
  const TriangleSoup soup = surface_of_points(ball(6000, 0.2, 0.004, false), 0, info);
  const InputTopology t = topology_of(soup);
  CHECK(t.closed);
  CHECK(t.components == 1);
  CHECK(t.genus == 0);
  CHECK(volume(soup) > 0);
  CHECK(worst_radius_error(soup, 0.3) < 0.02);
  CHECK(info.open_part > 0.1);
}

TEST_CASE("points: a steep scan from one side folds nowhere, though its back is near", "[points][unit]") {
  PointCloud cloud;
  for (uint64_t i = 0; i < 1500; ++i) {
    const auto at = [&](uint64_t axis) { return double(random_bits(7, 2 * i + axis) >> 11) / 9007199254740992.; };
    const double x = at(0), y = at(1);
    cloud.position.push_back({x, y, .4 * std::sin(9 * x) * std::cos(8 * y) + .2 * std::sin(23 * x + 11 * y)});
  }
  PointSurfaceInfo info;
  CHECK(sharpest_cosine(surface_of_points(cloud, 0, info)) > -0.98);
  CHECK(info.open_part > 0.3);
}

TEST_CASE("points: a hollow whose points look into it stays, whose points are turned outwards goes", "[points][unit]") {
  for (const bool normals : {true, false}) {
    PointCloud cloud = ball(6000, -2, 0, normals);
    const PointCloud inner = ball(2000, -2, 0, normals);
    for (const WorldPoint& p : inner.position) cloud.position.push_back({5 + .5 * p.x, .5 * p.y, .5 * p.z});
    for (const WorldPoint& n : inner.normal) cloud.normal.push_back({-n.x, -n.y, -n.z});
    PointSurfaceInfo info;
    const TriangleSoup soup = surface_of_points(cloud, 0, info);
    CHECK(topology_of(soup).components == (normals ? 2 : 1));
    CHECK(volume(soup) == Approx((normals ? 7. / 8 : 1) * 4 / 3 * 3.14159265 * 27).epsilon(0.03));
  }
}

TEST_CASE("points: parts of a surface that no point supports from their own side are left out", "[points][unit]") {
  const auto shape = [](double inner_radius) {
    return shapes::together(shapes::sphere({0, 0, 0}, 1, 48),
                            shapes::inside_out(shapes::sphere({0, 0, 0}, inner_radius, 48)));
  };
  const auto points_of = [](const TriangleSoup& soup) {
    OrientedPoints points;
    for (const auto& t : soup.triangles) {
      const WorldPoint &p = soup.vertices[t[0]], &q = soup.vertices[t[1]], &r = soup.vertices[t[2]];
      const WorldPoint n = doubled_area(p, q, r);
      points.position.push_back((1. / 3) * (p + q + r));
      points.normal.push_back((1 / length(n)) * n);
      points.area.push_back(length(n) / 2);
    }
    points.as_given = true;
    return points;
  };
  // Points of the outer surface are as near to the inner one as a voxel is wide, but look the other way.
  for (const double inner_radius : {.5, .95}) {
    const OrientedPoints outer = points_of(shapes::sphere({0, 0, 0}, 1, 48)), both = points_of(shape(inner_radius));
    TriangleSoup soup = shape(inner_radius);
    drop_unsupported({both, PointTree(both.position), .05}, soup);
    CHECK(topology_of(soup).components == 2);
    drop_unsupported({outer, PointTree(outer.position), .05}, soup);
    CHECK(topology_of(soup).components == 1);
    CHECK(volume(soup) > 4);
  }
}

TEST_CASE("points: what spans nothing is nothing to mesh, and memory is asked for before it is taken",
          "[points][unit]") {
  PointSurfaceInfo info;
  const auto code = [&](const PointCloud& cloud, int64_t limit) {
    return error_of([&] { surface_of_points(cloud, limit, info); }).code();
  };
  PointCloud same;
  same.position.assign(100, {1, 2, 3});
  CHECK(code(same, 0) == ErrorCode::nothing_to_mesh);
  PointCloud huge;
  huge.position = {{0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}, {0, 0, 1e300}};
  CHECK(code(huge, 0) == ErrorCode::nothing_to_mesh);
  CHECK(code(ball(3000, -2, 0, true), 1 << 10) == ErrorCode::out_of_memory);
  surface_of_points(ball(3000, -2, 0, true), 8 << 20, info);
  CHECK(info.voxel_size_world > info.spacing_world);
}
