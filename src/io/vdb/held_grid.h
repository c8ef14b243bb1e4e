// What a MemoryGrid holds.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "implicit/volumes/scalar_field.h"
#include "io/vdb/volume_readers.h"
#include "isoshell/io/grid_field.h"
#include "isoshell/io/label_file.h"

namespace isoshell {

class HeldGrid {
 public:
  /// The grid as a volume and as labels: what keeps it from being either is its flaw.
  HeldGrid(VolumeGrid volume, VolumeGrid labels) : volume_(std::move(volume)), labels_(std::move(labels)) {}
  virtual ~HeldGrid() = default;

  const VolumeGrid& volume() const { return volume_; }
  const VolumeGrid& labels() const { return labels_; }

  /// Of a grid that is a volume. The grid outlives the field.
  virtual std::unique_ptr<ScalarField> field() const = 0;
  /// Of a grid of labels. `place` is what messages call where it is. Throws: as read_labels().
  virtual LabelVolume label_volume(const std::string& place, const LabelReadOptions& options) const = 0;
  /// Its values anywhere. Throws: usage for a grid that is not sampled.
  virtual std::shared_ptr<const GridField> sampled(const std::string& name) const = 0;

 private:
  VolumeGrid volume_, labels_;
};

/// A copy of the grid of NanoVDB whose bytes these are, wherever they begin, or of the one of several that the options
/// name; null where they are none, as those of a .nvdb file. `name` is what messages call the bytes. Throws: as
/// read_nano_volume() does.
std::shared_ptr<const HeldGrid> copied_nano_grid(View<const char> bytes, const std::string& name,
                                                 const VolumeReadOptions& options);

}  // namespace isoshell
