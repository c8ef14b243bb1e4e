#include "support/sizing_fields.h"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <algorithm>

namespace isoshell {

struct TestGrid::Data {
  openvdb::GridBase::Ptr grid;
};

TestGrid::TestGrid(const std::string& name, double background, double voxel, WorldPoint origin) {
  openvdb::initialize();
  auto grid = openvdb::FloatGrid::create(float(background));
  auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  transform->postTranslate({origin.x, origin.y, origin.z});
  grid->setName(name);
  grid->setTransform(transform);
  data_ = std::make_shared<Data>(Data{grid});
}

TestGrid TestGrid::of_integers(const std::string& name) {
  openvdb::initialize();
  auto grid = openvdb::Int32Grid::create(1);
  grid->setName(name);
  return TestGrid(std::make_shared<Data>(Data{grid}));
}

void TestGrid::set(int i, int j, int k, double value) {
  if (auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(data_->grid))
    floats->tree().setValue({i, j, k}, float(value));
  else
    openvdb::gridPtrCast<openvdb::Int32Grid>(data_->grid)->tree().setValue({i, j, k}, int32_t(value));
}

void TestGrid::call_it_a_level_set() { data_->grid->setGridClass(openvdb::GRID_LEVEL_SET); }

void write_grids(const std::string& path, const std::vector<TestGrid>& grids) {
  openvdb::GridPtrVec all;
  for (const TestGrid& grid : grids) all.push_back(grid.data().grid);
  openvdb::io::File file(path);
  file.write(all);
  file.close();
}

TestGrid sizing_grid(const std::string& name, double side, double voxel, double background, const LengthAt& length) {
  TestGrid grid(name, background, voxel);
  const int n = int(side / voxel) + 1;
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      for (int z = -n; z <= n; ++z) {
        const double here = length({x * voxel, y * voxel, z * voxel});
        if (here != 0) grid.set(x, y, z, here);
      }
  return grid;
}

TestGrid ball_sizing(double shortest, double ratio) {
  return sizing_grid("edge_length", 1.2, 0.05, -1,
                     [=](WorldPoint p) { return shortest * (1 + (ratio - 1) * std::max(0., p.z + 1) / 2); });
}

}  // namespace isoshell
