// Makes an Input of what was read, and tells what that held.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "io/vdb/grid_kinds.h"
#include "io/vdb/held_grid.h"
#include "isoshell/io/input.h"

namespace isoshell {

class InputReader {
 public:
  InputReader(const std::string& path, const Context& context, const Tell& tell);

  void read(const InputRequest& request);
  /// Bytes of a .vdb or .nvdb file.
  void read(const MeshSource& source, const InputRequest& request);
  void hold(TriangleSoup soup);
  void hold_points(PointCloud cloud);
  void hold(const PointCloud& cloud, VolumeCreases creases, bool keep_open);
  void hold_volume(bool keep_open, const std::function<TriangleSoup(VolumeInfo&)>& extract);
  /// `of_triangles` gets the crossing of each triangle, where they are wanted.
  void hold(LabelVolume labels, const std::string& origin = "", std::vector<WallCrossing>* of_triangles = nullptr);
  void hold(const HeldGrid& grid, const InputRequest& request);
  Input taken() { return std::move(input_); }

 private:
  void hold(PointCloud cloud, const InputRequest& request);
  void read_ply(const InputRequest& request);
  void read_volume_file(const InputRequest& request);
  void read_any_volume(const MeshSource& source, const InputRequest& request);
  void check_fits(const InputRequest& request) const;
  void read_level_set(const MeshSource& source, const InputRequest& request);
  /// The bytes of standard input are there no second time: all that a run takes of them is read now.
  void read_grids(const MeshSource& source, const InputRequest& request, const std::string& meshed);
  void read_several(const MeshSource& source, const InputRequest& request);
  void read_labels_of(const MeshSource& source, const InputRequest& request);
  void hold(LabelGrid grid, const LabelReading& reading);
  void read_stage_file(const MeshSource& source);
  void note(const std::string& text) const { tell(MessageKind::note, text); }
  void warn(const std::string& text) const { tell(MessageKind::warning, text); }
  void tell(MessageKind kind, const std::string& text) const;

  Input input_;
  const Context& context_;
  const Tell& tell_;
};

}  // namespace isoshell
