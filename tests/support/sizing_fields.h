// Grids of numbers as .vdb files. OpenVDB's headers take seconds, so only sizing_fields.cpp includes them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// A grid that a test fills and writes; copies are the same grid.
class TestGrid {
 public:
  struct Data;

  /// Of floats, with the origin of its voxel (0, 0, 0) in world units.
  explicit TestGrid(const std::string& name, double background = 0, double voxel = 1, WorldPoint origin = {0, 0, 0});
  static TestGrid of_integers(const std::string& name);

  /// Makes the voxel active.
  void set(int i, int j, int k, double value);
  void call_it_a_level_set();
  const Data& data() const { return *data_; }

 private:
  explicit TestGrid(std::shared_ptr<Data> data) : data_(std::move(data)) {}

  std::shared_ptr<Data> data_;
};

void write_grids(const std::string& path, const std::vector<TestGrid>& grids);

using LengthAt = std::function<double(WorldPoint)>;

/// A grid over the box from -side to side, with what `length` says in its active voxels, and none where it says 0.
TestGrid sizing_grid(const std::string& name, double side, double voxel, double background, const LengthAt& length);

/// Edges on a ball of radius 1 that grow along z, from `shortest` at the bottom to `ratio` times that at the top.
TestGrid ball_sizing(double shortest, double ratio);

}  // namespace isoshell
