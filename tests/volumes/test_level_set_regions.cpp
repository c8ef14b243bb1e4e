// Level sets that are regions together: where walls between them run, and what of them is outside.
#include <algorithm>
#include <cmath>

#include "isoshell/region_census.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/temporary_file.h"
#include "volumes/level_sets.h"

using namespace isoshell;

namespace {

/// Of the walls between these two labels: their area, and how far their vertices are from x at most.
struct Wall {
  double area = 0, farthest_from_x = 0;
};
Wall wall_of(const TriangleSoup& soup, const std::array<int32_t, 2>& labels, double x) {
  Wall wall;
  for (size_t t = 0; t < soup.triangles.size(); ++t) {
    if (soup.regions.labels[t] != labels) continue;
    const auto& [a, b, c] = soup.triangles[t];
    const WorldPoint &p = soup.vertices[a], &q = soup.vertices[b], &r = soup.vertices[c];
    const WorldPoint u{q.x - p.x, q.y - p.y, q.z - p.z}, v{r.x - p.x, r.y - p.y, r.z - p.z};
    wall.area += norm(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x) / 2;
    for (const WorldPoint& at : {p, q, r}) wall.farthest_from_x = std::max(wall.farthest_from_x, std::abs(at.x - x));
  }
  return wall;
}

double farthest_along_y(const TriangleSoup& soup) {
  double farthest = 0;
  for (const WorldPoint& p : soup.vertices) farthest = std::max(farthest, std::abs(p.y));
  return farthest;
}

}  // namespace

TEST_CASE("level sets: two that overlap share one wall, where their values are equal", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  write(file.path, {level_set("piece_left", ball(-.5, .6)), level_set("piece_right", ball(.513, .6)),
                    level_set("other", ball(0, .2))});
  const Input input = read(request_for(file.path + ":piece_*"));
  const TriangleSoup& soup = input.soup;
  CHECK(input.facts.kind == InputKind::labels);
  REQUIRE(soup.regions.names.size() == 2);
  CHECK(soup.regions.names[0].name == "piece_left");
  CHECK(soup.regions.names[1].name == "piece_right");
  const Wall wall = wall_of(soup, {1, 2}, .0065);
  const double radius_sq = .36 - .5065 * .5065;
  CHECK(std::abs(wall.area / (M_PI * radius_sq) - 1) < .02);
  CHECK(wall.farthest_from_x < .03 * kVoxel);
}

TEST_CASE("level sets: a warning names two that overlap deeper than the narrower band reaches", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  const auto told = [&](double band_vox, double other_vox) {
    write(file.path, {level_set("a", ball(-.35, .6), 0, band_vox), level_set("b", ball(.353, .6), 0, other_vox)});
    return warnings_of(request_for(file.path + ":*"));
  };
  const std::string warned = "level sets \"a\" and \"b\" overlap deeper than their bands reach";
  CHECK(contains(told(3, 3), warned));
  CHECK(contains(told(3, 4), warned));
  CHECK(contains(told(1, 1), warned));
  CHECK(told(20, 20).empty());
}

TEST_CASE("level sets: one that has no voxel is named by a warning, and is no region", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  const auto check_lost = [&](const openvdb::GridPtrVec& grids, const std::string& warned) {
    write(file.path, grids);
    CHECK(contains(warnings_of(request_for(file.path + ":*")), warned));
    const auto names = read(request_for(file.path + ":*")).soup.regions.names;
    REQUIRE(names.size() == 1);
    CHECK(names[0].name == "a");
  };
  for (const double band_vox : {3., 20.})
    check_lost({level_set("a", ball(0, .8), 0, band_vox), level_set("inner", ball(.1, .4), 0, band_vox)},
               "level set \"inner\" lies within \"a\"");
  check_lost({level_set("a", ball(0, .6)), level_set("b", ball(0, .6))}, "level set \"b\" lies within \"a\"");
  check_lost({level_set("a", ball(0, .6)), level_set("none", ball(9, .1))}, "level set \"none\" holds no voxel");
}

TEST_CASE("level sets: a gap of less than a voxel is closed in its middle, and no slit is left", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  for (const double gap_vox : {0., .4, .9}) {
    for (const double off_vox : {0., .27, .5}) {
      const double middle = off_vox * kVoxel, side = gap_vox * kVoxel / 2;
      write(file.path, {level_set("a", box(-.8, middle - side)), level_set("b", box(middle + side, .8))});
      const TriangleSoup soup = read(request_for(file.path + ":*")).soup;
      INFO("gap of " << gap_vox << " voxels at " << off_vox);
      const Wall wall = wall_of(soup, {1, 2}, middle);
      CHECK(std::abs(wall.area / .64 - 1) < .13);
      CHECK(wall.farthest_from_x < .1 * kVoxel);
      CHECK(farthest_along_y(soup) < .4 + .1 * kVoxel);
      for (size_t t = 0; t < soup.triangles.size(); ++t) {  // none of one piece runs along the wall
        if (soup.regions.labels[t] == std::array<int32_t, 2>{1, 2}) continue;
        const auto& [a, b, c] = soup.triangles[t];
        const double y = (soup.vertices[a].y + soup.vertices[b].y + soup.vertices[c].y) / 3,
                     z = (soup.vertices[a].z + soup.vertices[b].z + soup.vertices[c].z) / 3,
                     x = (soup.vertices[a].x + soup.vertices[b].x + soup.vertices[c].x) / 3;
        CHECK_FALSE((std::abs(x - middle) < 3 * kVoxel && std::abs(y) < .3 && std::abs(z) < .3));
      }
    }
  }
}

TEST_CASE("level sets: a gap of more than a voxel stays open", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  write(file.path, {level_set("a", box(-.8, -.04)), level_set("b", box(.04, .8))});
  CHECK(wall_of(read(request_for(file.path + ":*")).soup, {1, 2}, 0).area == 0);
}

TEST_CASE("level sets: a result has closed regions with shared walls and the volumes of the bodies", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  write(file.path, {level_set("a", box(-.8, .01)), level_set("b", box(.01, .8))});
  const Input input = read(request_for(file.path + ":*"));
  Context context;
  RemeshOptions options;
  options.vertices = 1500;
  const TriangleMesh mesh = remesh(input.soup, options, context).mesh;
  const RegionCensus census = take_region_census(mesh, context);
  REQUIRE(census.regions.size() == 2);
  for (const RegionCounts& region : census.regions) CHECK(region.closed);
  CHECK(std::abs(census.regions[0].volume_world / (.81 * .64) - 1) < .01);
  CHECK(std::abs(census.regions[1].volume_world / (.79 * .64) - 1) < .01);
}

TEST_CASE("level sets: their union is one surface around all of them", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  write(file.path, {level_set("a", ball(-.35, .6)), level_set("b", ball(.35, .6))});
  InputRequest request = request_for(file.path + ":*");
  request.unite = true;
  const Input input = read(request);
  CHECK(input.facts.kind == InputKind::volume);
  CHECK(input.soup.regions.empty());
  for (const WorldPoint& p : input.soup.vertices)
    CHECK(std::abs(std::min(norm(p.x + .35, p.y, p.z), norm(p.x - .35, p.y, p.z)) - .6) < .2 * kVoxel);
}

TEST_CASE("level sets: the union of two that touch, or face each other within a voxel, has no wall inside",
          "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  for (const double gap_vox : {0., .4, .9}) {
    for (const double off_vox : {0., .27, .5}) {
      const double middle = off_vox * kVoxel, side = gap_vox * kVoxel / 2;
      write(file.path, {level_set("a", box(-.8, middle - side)), level_set("b", box(middle + side, .8))});
      InputRequest request = request_for(file.path + ":*");
      request.unite = true;
      const TriangleSoup soup = read(request).soup;
      INFO("gap of " << gap_vox << " voxels at " << off_vox);
      bool is_wall = false;
      for (const WorldPoint& p : soup.vertices)
        is_wall |= std::abs(p.x) < .7 && std::abs(p.y) < .4 - kVoxel && std::abs(p.z) < .4 - kVoxel;
      CHECK_FALSE(is_wall);
      CHECK(farthest_along_y(soup) < .4 + .2 * kVoxel);
    }
  }
}

TEST_CASE("level sets: a union of what was clipped is left open there where borders are kept", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  const Distance whole = ball(0, .6);
  write(file.path, {level_set("a", [&](const WorldPoint& p) { return p.x < .1 ? whole(p) : .15; }),
                    level_set("b", ball(-.4, .3))});
  InputRequest request = request_for(file.path + ":*");
  request.unite = true;
  const auto faces_at_side = [&] {
    const TriangleSoup soup = read(request).soup;
    return std::count_if(soup.triangles.begin(), soup.triangles.end(), [&](const auto& triangle) {
      return std::all_of(triangle.begin(), triangle.end(), [&](uint32_t v) {
        const WorldPoint& p = soup.vertices[v];
        return p.x > 0 && norm(0, p.y, p.z) < .4;
      });
    });
  };
  CHECK(faces_at_side() > 0);
  request.keep_open = true;
  CHECK(faces_at_side() == 0);
}

TEST_CASE("level sets: faces on what pieces were cut from are exterior, others inner", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb"), whole("whole.vdb");
  write(file.path, {level_set("a", box(-.8, -.1)), level_set("b", box(.1, .8))});
  write(whole.path, {level_set("surface", box(-.8, .8))});
  InputRequest request = request_for(file.path + ":*");
  request.reference = whole.path;
  const TriangleSoup soup = read(request).soup;
  REQUIRE(soup.attributes.size() == 1);
  const Attribute& material = soup.attributes[0];
  CHECK(material.name == kMaterialName);
  CHECK(material.labels == std::vector<std::string>{"exterior", "inner"});
  for (size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& [a, b, c] = soup.triangles[t];
    const double x = (soup.vertices[a].x + soup.vertices[b].x + soup.vertices[c].x) / 3;
    const double y = (soup.vertices[a].y + soup.vertices[b].y + soup.vertices[c].y) / 3,
                 z = (soup.vertices[a].z + soup.vertices[b].z + soup.vertices[c].z) / 3;
    if (std::abs(x) < .1 + .2 * kVoxel && std::abs(y) < .4 - kVoxel && std::abs(z) < .4 - kVoxel)
      CHECK(material.values[t] == 1);
    if (std::abs(x) > .1 + kVoxel) CHECK(material.values[t] == 0);
  }
}

TEST_CASE("level sets: a reference that no face lies on is warned of, with the distance", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb"), whole("whole.vdb");
  write(file.path, {level_set("a", box(-.8, -.1)), level_set("b", box(.1, .6))});
  write(whole.path, {level_set("surface", ball(1.05, .2))});
  InputRequest request = request_for(file.path + ":*");
  request.reference = whole.path;
  const std::string told = warnings_of(request);
  CHECK(contains(told, "no face lies on the reference " + whole.path));
  CHECK(contains(told, "the nearest is 5"));
}
