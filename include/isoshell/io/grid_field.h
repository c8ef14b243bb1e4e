// Grids of .vdb files beside the one that is meshed, sampled where the vertices of a result are.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/attribute.h"

namespace isoshell {

/// A grid as a person names it.
struct GridName {
  std::string file;  ///< a .vdb file; empty: that of the input
  std::string grid;  ///< as in VolumeReadOptions
};

/// In place of a name all grids of the input's file that can be sampled, but the one that is meshed.
constexpr const char* kAllGrids = "all";

/// "FILE.vdb:NAME" names a grid of a file, any other text one of the input.
GridName grid_name_of(const std::string& text);

/// What a grid has at places.
struct GridValues {
  Attribute values;     ///< under the grid's name, one of each component
  int64_t outside = 0;  ///< places around which no voxel is active
};

class GridField {
 public:
  GridField(std::string name, uint64_t digest) : name_(std::move(name)), digest_(digest) {}
  virtual ~GridField() = default;

  const std::string& name() const { return name_; }
  uint64_t digest() const { return digest_; }  ///< of the grid's bytes, with its transform

  /// Real numbers are interpolated between the eight voxels around a place, whole ones are those of the nearest voxel.
  /// Component i of a staggered grid of vectors is that of the middle of a voxel's lower side along axis i. Where no
  /// voxel is active the values are those that the grid has there, its background where it has none. Whole numbers of
  /// 64 bits become doubles. Result: the same for any number of threads. Cost: linear in the places, on all threads.
  virtual GridValues at(const std::vector<WorldPoint>& places) const = 0;

 private:
  std::string name_;
  uint64_t digest_;
};

/// Reads grids of floats, doubles, whole numbers of 32 or 64 bits, or three of them, by their names. Throws:
/// unreadable_input for a file that is damaged; usage for a name that is not there, or is that of a grid of another
/// type, which lists what the file holds; out_of_memory over the limit in bytes (0: none).
std::vector<std::shared_ptr<const GridField>> read_grid_fields(const std::string& path,
                                                               const std::vector<std::string>& names,
                                                               int64_t max_bytes = 0);

/// One grid in the bytes of a .vdb file, or of a stream that OpenVDB wrote: that of this name, or else the only one
/// that can be sampled. Its values have the name. Borrows the bytes for the call. Throws: as the other does.
std::shared_ptr<const GridField> grid_field_of_vdb(View<const char> bytes, const std::string& name);

/// Three grids of numbers as one of vectors. Outside of it is what is outside of the first one. Sampling throws usage
/// for one of vectors.
std::shared_ptr<const GridField> vector_field(const std::string& name,
                                              std::array<std::shared_ptr<const GridField>, 3> components);

}  // namespace isoshell
