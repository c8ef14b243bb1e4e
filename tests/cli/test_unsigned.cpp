// Unsigned distances given to the command: a mesh of one skin, a crust with a warning, or a refusal that helps.
#include <algorithm>
#include <cmath>

#include "cli/command.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/sizing_fields.h"

using namespace isoshell;
using namespace isoshell::cli;

namespace {

constexpr double kVoxel = 0.05, kBackground = 3 * kVoxel;

/// A grid of `distance` in a band of three voxels around its zero set; no value of it is exactly 0.
TestGrid unsigned_grid(const std::string& name, const LengthAt& distance, double scale = 1) {
  return sizing_grid(name, 1.4, kVoxel, kBackground * scale, [=](WorldPoint p) {
    const double d = distance(p);
    return d < kBackground ? d * scale : 0;
  });
}

double to_ball(WorldPoint p) { return std::abs(std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - 1.0123); }

double to_bowl(WorldPoint p) {
  if (p.z >= 0.0077) return to_ball(p);
  const double rim = std::sqrt(1.0123 * 1.0123 - 0.0077 * 0.0077);
  return std::hypot(std::hypot(p.x, p.y) - rim, p.z - 0.0077);
}

const std::string kRun = " out.ply --force --device cpu --vertices 500 ";

}  // namespace

TEST_CASE("unsigned: a ball is one skin, a bowl a crust with a warning, and --iso takes the value", "[unsigned]") {
  Folder folder;
  write_grids((folder / "udf.vdb").string(), {unsigned_grid("ball", to_ball), unsigned_grid("bowl", to_bowl)});
  const Folder::Result ball = folder.run("udf.vdb:ball" + kRun + "-v --require closed,genus=0,components=1");
  CHECK(ball.status == 0);
  CHECK(contains(ball.err, "unsigned distances"));
  CHECK_FALSE(contains(ball.err, "warning"));
  const Folder::Result bowl = folder.run("udf.vdb:bowl" + kRun + "--require closed,genus=0,components=1");
  CHECK(bowl.status == 0);
  CHECK(contains(bowl.err, "encloses nothing; the closed crust around it is meshed"));
  CHECK(folder.run("udf.vdb:ball" + kRun + "--iso 0.07 --require closed,components=2").status == 0);
}

TEST_CASE("unsigned: a grid that may be one but rises otherwise is refused with its name and a remedy", "[unsigned]") {
  Folder folder;
  write_grids((folder / "udf.vdb").string(), {unsigned_grid("half", to_ball, 0.5)});
  const Folder::Result refused = folder.run("udf.vdb" + kRun);
  CHECK(refused.status == 2);
  CHECK(contains(refused.err, "grid \"half\" is no level set (class unknown, values "));
  CHECK(contains(refused.err, "no unsigned distance: "));
  CHECK(contains(refused.err, "--iso"));
  CHECK_FALSE(folder.has("out.ply"));
}
