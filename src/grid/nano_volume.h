// A scalar NanoVDB grid in memory, walked without trusting an offset in it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

constexpr int64_t kNanoAlignment = 32;

struct NanoLeafRef {
  Voxel origin;
  const void* leaf;  ///< in the grid's bytes
};

struct NanoTileRef {
  Voxel origin;
  int32_t size;
  float value;
};

struct NanoVolume {
  std::vector<NanoLeafRef> leaves;
  std::vector<NanoTileRef> tiles;  ///< other than the background
  double background = 0;
  double matrix[9] = {}, shift[3] = {};                      ///< world = matrix index + shift, rows first
  float (*value)(const void* leaf, int offset) = nullptr;    ///< of a leaf's voxel, z fastest
  bool (*is_unset)(const void* leaf, int offset) = nullptr;  ///< whether it is inactive and 0, but for packing
  std::string fault;                                         ///< what is wrong with the bytes; empty when sound
};

/// What a file's index says about a grid.
struct NanoKind {
  const char* type;        ///< name for users
  bool scalar;             ///< a type that open_nano_volume reads
  const char* grid_class;  ///< as OpenVDB spells it
};
NanoKind nano_kind(uint32_t grid_type, uint32_t grid_class);

/// What the header of a grid in memory says.
struct NanoHead {
  std::string name;
  uint32_t grid_type = 0, grid_class = 0;  ///< as nano_kind() takes them
  uint64_t grid_bytes = 0;
  std::string fault;  ///< why these bytes are no grid of a layout that is read; empty: they are
};
NanoHead nano_head_of(View<const std::byte> grid);

/// The grid in these bytes, which start at a multiple of kNanoAlignment and must outlive the result. Every node lies in
/// them and no more nodes are visited than they have room for.
NanoVolume open_nano_volume(View<const std::byte> grid);

}  // namespace isoshell
