// Compiled instead of the files that use OpenVDB when ISOSHELL_VDB is off.
#include "io/vdb/grid_fields.h"
#include "io/vdb/grid_kinds.h"
#include "io/vdb/stage_reader.h"
#include "io/vdb/volume_readers.h"
#include "isoshell/error.h"
#include "isoshell/io/memory_grid.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/sizing_vdb.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/io/velocity_vdb.h"

namespace isoshell {
namespace {

[[noreturn]] void throw_without_openvdb(ErrorCode code, const std::string& path) {
  throw Error(code, "vdb", path + ": this build cannot read or write .vdb files; build with -DISOSHELL_VDB=ON");
}

}  // namespace

bool can_write_vdb() { return false; }
void save_shell(const std::string& path, const LatticeSurface&, const SiteSamples&, const Shell&,
                const StageWriteOptions&) {
  throw_without_openvdb(ErrorCode::unwritable_output, path);
}
void save_voronoi(const std::string& path, const LatticeSurface&, const SiteSamples&, const Shell&, const SeedSet&,
                  const VoronoiLabels&, const StageWriteOptions&) {
  throw_without_openvdb(ErrorCode::unwritable_output, path);
}
void save_preview(const std::string& path, const LatticeFrame&, const Shell&, const VoronoiLabels&,
                  const StageWriteOptions&) {
  throw_without_openvdb(ErrorCode::unwritable_output, path);
}
void save_level_set(const std::string& path, const LevelSet&, const LevelSetWriteOptions&) {
  throw_without_openvdb(ErrorCode::unwritable_output, path);
}
std::unique_ptr<ScalarField> read_vdb_volume(const MeshSource& source, const VolumeReadOptions&) {
  throw_without_openvdb(ErrorCode::unreadable_input, source.name());
}
LabelVolume read_labels(const std::string& path, const LabelReadOptions&) {
  throw_without_openvdb(ErrorCode::unreadable_input, path);
}
LabelGrid read_label_grid(const MeshSource& source, const LabelReadOptions&) {
  throw_without_openvdb(ErrorCode::unreadable_input, source.name());
}
void write_labels(const std::string& path, const LabelVolume&, const LabelWriteOptions&) {
  throw_without_openvdb(ErrorCode::unwritable_output, path);
}
bool unpack_stream(View<const char>, bool, View<char>) {
  throw_without_openvdb(ErrorCode::unreadable_input, "a packed .nvdb file");
}
std::shared_ptr<const SizingField> read_sizing(const std::string& source, int64_t) {
  throw_without_openvdb(ErrorCode::unreadable_input, source);
}
std::shared_ptr<const SizingField> sizing_of(const DenseVolume&, const std::string& name) {
  throw_without_openvdb(ErrorCode::unreadable_input, name);
}
Buffer<std::byte> nano_level_set(const LevelSet&, const std::string& name) {
  throw_without_openvdb(ErrorCode::unwritable_output, name);
}
MemoryGrid sparse_grid(const SparseVolume&, const std::string& name, int64_t) {
  throw_without_openvdb(ErrorCode::unreadable_input, name);
}
std::shared_ptr<const VelocityField> read_velocity(const std::string& path, const std::string&, int64_t) {
  throw_without_openvdb(ErrorCode::unreadable_input, path);
}
std::shared_ptr<const VelocityField> velocity_of(const std::array<DenseVolume, 3>&, const std::string& name) {
  throw_without_openvdb(ErrorCode::unreadable_input, name);
}
std::vector<std::shared_ptr<const GridField>> read_grid_fields(const MeshSource& source,
                                                               const std::vector<std::string>&, const std::string&) {
  throw_without_openvdb(ErrorCode::unreadable_input, source.name());
}
std::vector<std::shared_ptr<const GridField>> read_grid_fields(const std::string& path, const std::vector<std::string>&,
                                                               int64_t) {
  throw_without_openvdb(ErrorCode::unreadable_input, path);
}
std::shared_ptr<const GridField> grid_field_of_vdb(View<const char>, const std::string& name) {
  throw_without_openvdb(ErrorCode::unreadable_input, name);
}
std::shared_ptr<const GridField> grid_field(const DenseVolume&, const std::string& name, bool, int64_t) {
  throw_without_openvdb(ErrorCode::unreadable_input, name);
}
StageFile read_stage(const MeshSource& source) { throw_without_openvdb(ErrorCode::unreadable_input, source.name()); }

}  // namespace isoshell
