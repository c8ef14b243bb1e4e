// Writing stage files. Every grid is made and compressed on its own, several at a time, and they are joined behind one
// header: OpenVDB by itself keeps all grids in memory and compresses one leaf after the other.

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "core/copy_product.h"
#include "io/openvdb/key_values.h"
#include "io/openvdb/shell_values.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/shell_sites.h"
#include "io/vdb/vdb_format.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "isoshell/gaps.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/version.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

using namespace vdb_format;
using GridMaker = std::function<openvdb::GridBase::Ptr()>;

void check_fits(int64_t have, int64_t want, const char* what) {
  if (have != want)
    throw Error(ErrorCode::usage, "write",
                std::string(what) + " has " + std::to_string(have) + " values; it must have " + std::to_string(want) +
                    ", one for each of what it belongs to");
}

std::string frame_text(const LatticeFrame& f) {
  return KeyValueWriter()
      .add("origin_x", f.origin.x)
      .add("origin_y", f.origin.y)
      .add("origin_z", f.origin.z)
      .add("voxel_size", f.voxel_size)
      .add("resolution", f.resolution)
      .add("extent_x", f.extent_vox[0])
      .add("extent_y", f.extent_vox[1])
      .add("extent_z", f.extent_vox[2])
      .text();
}

std::string topology_text(const InputTopology& t) {
  return KeyValueWriter()
      .add("closed", t.closed)
      .add("oriented", t.oriented)
      .add("components", t.components)
      .add("boundary_loops", t.boundary_loops)
      .add("euler", t.euler)
      .add("genus", t.genus)
      .add("area_world", t.area_world)
      .text();
}

/// The grids and the metadata of a file that is being put together.
class StageWriter {
 public:
  StageWriter(const LatticeFrame& frame, const char* stage, const StageWriteOptions& options) : frame_(frame) {
    if (options.options_json.size() > size_t(kMaxOptionsBytes))
      throw Error(ErrorCode::usage, "write",
                  "options_json has " + std::to_string(options.options_json.size()) + " bytes; it must have at most " +
                      std::to_string(kMaxOptionsBytes));
    text(kKeyCreator, kCreator);
    text(kKeyFrame, frame_text(frame));
    text(kKeyOptions, options.options_json);
    if (options.closing_vox >= 0) text(kKeyClosing, std::to_string(options.closing_vox));
    if (!options.left_out.empty()) text(kKeyLeftOut, options.left_out);
    if (stage) {
      stage_ = stage;
      text(kKeyStage, stage_);
      text(kKeyVersion, std::to_string(kVersion));
    }
  }

  void text(const std::string& key, const std::string& value) { meta_.insertMeta(key, openvdb::StringMetadata(value)); }
  template <class Product>
  void digest_of(const char* name, const Product& product) {
    text(kKeyDigest + std::string(name), digest_text(digest(product)));
  }

  template <class GridT, class ValueAt>
  void voxels(const char* name, const VoxelSet& set, typename GridT::ValueType background, ValueAt value_at,
              openvdb::GridClass grid_class = openvdb::GRID_UNKNOWN,
              openvdb::VecType vector_type = openvdb::VEC_INVARIANT) {
    makers_.push_back([this, name, &set, background, value_at, grid_class, vector_type]() -> openvdb::GridBase::Ptr {
      auto grid = make_voxel_grid<GridT>(name, background, set, value_at);
      grid->setTransform(lattice_transform(frame_));
      grid->setGridClass(grid_class);
      grid->setVectorType(vector_type);
      describe(*grid);
      return grid;
    });
  }

  /// 1 in voxels whose closest site has the flag, and in `more`, which the shell need not hold. No grid without any.
  void flags(const char* name, const Shell& shell, const std::vector<uint8_t>& flag, std::vector<Voxel> more) {
    if (more.empty() && std::find(flag.begin(), flag.end(), 1) == flag.end()) return;
    makers_.push_back([this, name, &shell, &flag, more = std::move(more)]() -> openvdb::GridBase::Ptr {
      const auto flag_at = [&flag, site = shell.closest_site.view()](int64_t, int, int64_t i) {
        return float(flag[site[i]]);
      };
      auto grid = make_voxel_grid<VdbFloatGrid>(name, 0.f, shell.voxels, flag_at);
      auto values = grid->getAccessor();
      for (const Voxel v : more) values.setValueOn({v.x, v.y, v.z}, 1.f);
      grid->setTransform(lattice_transform(frame_));
      describe(*grid);
      return grid;
    });
  }

  template <class GridT, class T>
  void table(const char* name, View<const T> elements) {
    makers_.push_back([this, name, elements]() -> openvdb::GridBase::Ptr {
      auto grid = make_table_grid<GridT>(name, elements);
      grid->setGridClass(openvdb::GRID_UNKNOWN);
      describe(*grid);
      return grid;
    });
  }

  void write(const std::string& path, bool overwrite) { write_vdb_file(path, makers_, meta_, overwrite); }

 private:
  void describe(openvdb::GridBase& grid) const {
    grid.setCreator(kCreator);
    if (stage_.empty()) return;
    grid.insertMeta(kKeyStage, openvdb::StringMetadata(stage_));
    grid.insertMeta(kKeyVersion, openvdb::StringMetadata(std::to_string(kVersion)));
  }

  const LatticeFrame& frame_;
  std::string stage_;
  openvdb::MetaMap meta_;
  std::vector<GridMaker> makers_;
};

/// From a voxel's centre to the sample of its closest site, world units.
struct ClosestOffset {
  VoxelSetView voxels;
  View<const Voxel> sites;
  View<const SiteSample> samples;
  View<const uint32_t> closest_site;
  double step_world;  // of 1/256 voxel

  openvdb::Vec3f operator()(int64_t leaf, int offset, int64_t i) const {
    const Voxel v = voxel_at(leaf_of_key(voxels.leaf_key[leaf]), offset), s = sites[closest_site[i]];
    const SiteSample& p = samples[closest_site[i]];
    return openvdb::Vec3f(float(((s.x - v.x) * kOneVoxelQ8 + p.dx) * step_world),
                          float(((s.y - v.y) * kOneVoxelQ8 + p.dy) * step_world),
                          float(((s.z - v.z) * kOneVoxelQ8 + p.dz) * step_world));
  }
};

void add_surface(StageWriter& file, const LatticeSurface& surface) {
  file.text(kKeyTopology, topology_text(surface.topology));
  if (surface.first_cap != kNone) file.text(kKeyFirstCap, std::to_string(surface.first_cap));
  file.digest_of("surface", surface);
  file.table<VdbVec3iGrid>(kSurfacePoints, surface.points.view());
  file.table<VdbVec3iGrid>(kSurfaceTriangles, surface.triangles.view());
  file.table<VdbIntGrid>(kSurfaceSource, surface.source_face.view());
}

/// What grids are made of that no product holds; lives as long as the writer.
struct ShellScratch {
  Buffer<Voxel> sites;
  std::vector<uint8_t> gap, risk;  ///< per site
};

std::vector<uint8_t> sites_on_caps(const LatticeSurface& surface, const SiteSamples& samples) {
  std::vector<uint8_t> gap(size_t(samples.sample.size()));
  for (size_t site = 0; site < gap.size(); ++site)
    gap[site] = surface.source_face[samples.sample[int64_t(site)].triangle] >= surface.first_cap;
  return gap;
}

void add_shell(StageWriter& file, const LatticeSurface& surface, const SiteSamples& samples, const Shell& shell,
               ShellScratch& scratch, const StageWriteOptions& options) {
  const LatticeFrame& frame = surface.frame;
  const SiteSet site_set = sites_of_shell(shell, frame);
  check_fits(samples.sample.size(), site_set.voxels.voxel_count(), "SiteSamples::sample");
  file.text(kKeyBand, std::to_string(shell.band_vox));
  file.digest_of("sites", site_set);
  file.digest_of("shell", shell);
  const VoxelSet& set = shell.voxels;
  if (options.view_grids) {
    scratch.sites = list_voxels(site_set.voxels);
    file.voxels<VdbFloatGrid>(kShellDistance, set, shell_background(shell, frame), shell_distances(shell, frame));
    file.voxels<VdbVec3fGrid>("closest_offset", set, openvdb::Vec3f(0),
                              ClosestOffset{set.view(), scratch.sites.view(), samples.sample.view(),
                                            shell.closest_site.view(), frame.voxel_size / kOneVoxelQ8},
                              openvdb::GRID_UNKNOWN, openvdb::VEC_CONTRAVARIANT_RELATIVE);
    scratch.gap = sites_on_caps(surface, samples);
    file.flags("gap", shell, scratch.gap, options.bridges);
    scratch.risk = find_risks(surface, samples);
    file.flags("risk", shell, scratch.risk, {});
  }
  file.voxels<VdbIntGrid>(kClosestSite, set, -1, closest_sites(shell));
  file.voxels<VdbIntGrid>(kDistanceSq, set, -1, squared_distances(shell));
}

void check_shell(const Shell& shell) {
  check_fits(shell.closest_site.size(), shell.voxels.voxel_count(), "Shell::closest_site");
  check_fits(shell.distance_sq_vox.size(), shell.voxels.voxel_count(), "Shell::distance_sq_vox");
}

float seed_rand(uint32_t seed) { return float((mix64(seed + uint64_t(1)) >> 40) + 1) / float(1 << 24); }

openvdb::Vec3f seed_color(uint32_t seed) {
  const uint64_t bits = random_bits(1, seed);
  const auto part = [&](int shift) { return 0.2f + 0.8f * float((bits >> shift) & 255) / 255.0f; };
  return openvdb::Vec3f(part(0), part(8), part(16));
}

void write_shell(const std::string& path, const LatticeSurface& surface, const SiteSamples& samples, const Shell& shell,
                 const StageWriteOptions& options) {
  check_shell(shell);
  initialize_openvdb();
  StageWriter file(surface.frame, "shell", options);
  ShellScratch scratch;
  add_shell(file, surface, samples, shell, scratch, options);
  add_surface(file, surface);
  file.write(path, options.overwrite);
}

void write_voronoi(const std::string& path, const LatticeSurface& surface, const SiteSamples& samples,
                   const Shell& shell, const SeedSet& seeds, const VoronoiLabels& labels,
                   const StageWriteOptions& options) {
  check_shell(shell);
  check_fits(labels.voxel_seed.size(), shell.voxels.voxel_count(), "VoronoiLabels::voxel_seed");
  check_fits(seeds.normal.size(), seeds.size(), "SeedSet::normal");
  check_fits(seeds.home.size(), seeds.size(), "SeedSet::home");
  initialize_openvdb();
  StageWriter file(surface.frame, "voronoi", options);
  file.digest_of("seeds", seeds);
  file.digest_of("labels", labels);
  file.voxels<VdbIntGrid>(kSeedId, shell.voxels, -1,
                          [seed = labels.voxel_seed.view()](int64_t, int, int64_t i) { return int32_t(seed[i]); });
  ShellScratch scratch;
  add_shell(file, surface, samples, shell, scratch, options);
  add_surface(file, surface);
  Buffer<PointQ8> normals(seeds.size());
  for (int64_t i = 0; i < seeds.size(); ++i) normals[i] = {seeds.normal[i].x, seeds.normal[i].y, seeds.normal[i].z};
  file.table<VdbVec3iGrid>(kSeedPoints, seeds.position.view());
  file.table<VdbVec3iGrid>(kSeedNormals, View<const PointQ8>(normals.view()));
  file.table<VdbIntGrid>(kSeedHomes, seeds.home.view());
  file.write(path, options.overwrite);
}

void write_preview(const std::string& path, const LatticeFrame& frame, const Shell& shell, const VoronoiLabels& labels,
                   const StageWriteOptions& options) {
  const VoxelSet& set = shell.voxels;
  initialize_openvdb();
  StageWriter file(frame, nullptr, options);
  file.voxels<VdbFloatGrid>(
      "density", set, 0.0f, [](int64_t, int, int64_t) { return 1.0f; }, openvdb::GRID_FOG_VOLUME);
  if (!labels.voxel_seed.empty()) {
    check_fits(labels.voxel_seed.size(), set.voxel_count(), "VoronoiLabels::voxel_seed");
    const View<const uint32_t> seed = labels.voxel_seed.view();
    file.voxels<VdbFloatGrid>("seed_rand", set, 0.0f,
                              [seed](int64_t, int, int64_t i) { return seed[i] == kNone ? 0.0f : seed_rand(seed[i]); });
    file.voxels<VdbVec3fGrid>("color", set, openvdb::Vec3f(0), [seed](int64_t, int, int64_t i) {
      return seed[i] == kNone ? openvdb::Vec3f(0) : seed_color(seed[i]);
    });
  }
  file.write(path, options.overwrite);
}

}  // namespace

bool can_write_vdb() { return true; }

void save_shell(const std::string& path, const LatticeSurface& surface, const SiteSamples& samples, const Shell& shell,
                const StageWriteOptions& options) {
  write_shell(path, *OnHost(surface), *OnHost(samples), *OnHost(shell), options);
}

void save_voronoi(const std::string& path, const LatticeSurface& surface, const SiteSamples& samples,
                  const Shell& shell, const SeedSet& seeds, const VoronoiLabels& labels,
                  const StageWriteOptions& options) {
  write_voronoi(path, *OnHost(surface), *OnHost(samples), *OnHost(shell), *OnHost(seeds), *OnHost(labels), options);
}

void save_preview(const std::string& path, const LatticeFrame& frame, const Shell& shell, const VoronoiLabels& labels,
                  const StageWriteOptions& options) {
  write_preview(path, frame, *OnHost(shell), *OnHost(labels), options);
}

}  // namespace isoshell
