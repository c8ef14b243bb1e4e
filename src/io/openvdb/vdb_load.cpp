// Reading stage files: layout and checksum first, then each grid, whose values are held to their range and the products
// to their digests.

#include <tbb/parallel_invoke.h>

#include <cmath>
#include <exception>
#include <functional>
#include <vector>

#include "core/parallel_ranges.h"
#include "core/voxel_set.h"
#include "io/openvdb/key_values.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/shell_sites.h"
#include "io/vdb/stage_reader.h"
#include "io/vdb/vdb_cursor.h"
#include "io/vdb/vdb_format.h"
#include "io/vdb/vdb_layout.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"

namespace isoshell {
namespace {

using namespace vdb_format;

constexpr int64_t kMostOfAMesh = int64_t(1) << 36;  // of anything: indices have 32 bits

/// One stage file in memory; the source outlives it.
class StageReader {
 public:
  explicit StageReader(const MeshSource& source)
      : path_(source.name()), bytes_{source.begin(), source.size()}, layout_(read_vdb_layout(path_, bytes_)) {
    if (is_checksum_tag(layout_.tag) && layout_.tag != vdb_checksum_tag(bytes_))
      fail("its content does not agree with its checksum " + layout_.tag + ": the file is damaged");
  }

  [[noreturn]] void fail(const std::string& what) const { throw_unreadable_vdb(path_, what); }
  void require(bool holds, const char* grid, int64_t element, const char* what) const {
    if (!holds) fail("grid \"" + std::string(grid) + "\", element " + std::to_string(element) + ": " + what);
  }

  bool has(const std::string& key) const { return layout_.texts.count(key) > 0; }
  std::string text(const std::string& key, bool required = true) const {
    const auto found = layout_.texts.find(key);
    if (found != layout_.texts.end()) return found->second;
    if (required) fail("metadata \"" + key + "\" is missing; it is not a complete stage file");
    return {};
  }
  int32_t number(const std::string& key, int32_t lowest, int32_t highest) const {
    int32_t value = lowest - 1;
    const std::string content = text(key);
    if (!KeyValueReader("v=" + content).get("v", value).ok() || value < lowest || value > highest)
      fail("metadata \"" + key + "\" is " + content + "; it must be " + std::to_string(lowest) + " to " +
           std::to_string(highest));
    return value;
  }

  template <class GridT>
  typename GridT::ConstPtr grid(const char* name) const {
    for (const VdbGridSpan& span : layout_.grids) {
      if (span.name != name) continue;
      if (span.type != GridT::gridType() || span.instance)
        fail("grid \"" + std::string(name) + "\" has type " + span.type + "; it must be a " + GridT::gridType() +
             " of its own");
      return std::static_pointer_cast<const GridT>(parse(span));
    }
    fail("grid \"" + std::string(name) + "\" is missing; it is not a complete stage file");
  }

  template <class Product>
  void check_digest(const char* name, const Product& product) const {
    const std::string is = digest_text(digest(product)), said = text(kKeyDigest + std::string(name));
    if (is != said)
      fail(std::string(name) + " has digest " + is + " where the file says " + said + ": it was changed or damaged");
  }

  const std::map<std::string, std::string>& texts() const { return layout_.texts; }

 private:
  openvdb::GridBase::Ptr parse(const VdbGridSpan& span) const {
    try {
      return read_vdb_grid(path_, bytes_, span);
    } catch (const std::bad_alloc&) {
      if (is_checksum_tag(layout_.tag)) throw Error(ErrorCode::out_of_memory, "read", path_ + ": out of memory");
      fail("grid \"" + span.name + "\" asks for more memory than there is: the file is damaged");
    }
  }

  const std::string path_;
  const View<const char> bytes_;
  const VdbLayout layout_;
};

LatticeFrame read_frame(const StageReader& file) {
  LatticeFrame f;
  const std::string text = file.text(kKeyFrame);
  KeyValueReader in(text);
  in.get("origin_x", f.origin.x)
      .get("origin_y", f.origin.y)
      .get("origin_z", f.origin.z)
      .get("voxel_size", f.voxel_size);
  in.get("resolution", f.resolution);
  in.get("extent_x", f.extent_vox[0]).get("extent_y", f.extent_vox[1]).get("extent_z", f.extent_vox[2]);
  bool good = in.ok() && std::isfinite(f.origin.x) && std::isfinite(f.origin.y) && std::isfinite(f.origin.z) &&
              std::isfinite(f.voxel_size) && f.voxel_size > 0 && f.resolution >= 1 && f.resolution <= kMaxResolution;
  for (const int32_t extent : f.extent_vox) good = good && extent > 0 && extent % 8 == 0 && extent <= kMaxExtentVox;
  if (!good) file.fail("metadata \"" + std::string(kKeyFrame) + "\" is not a lattice: " + text);
  return f;
}

InputTopology read_topology(const StageReader& file) {
  InputTopology t;
  const std::string text = file.text(kKeyTopology);
  KeyValueReader in(text);
  in.get("closed", t.closed).get("oriented", t.oriented).get("components", t.components);
  in.get("boundary_loops", t.boundary_loops)
      .get("euler", t.euler)
      .get("genus", t.genus)
      .get("area_world", t.area_world);
  const auto holds = [](int64_t count, int64_t least) { return count >= least && count <= kMostOfAMesh; };
  if (!in.ok() || !holds(t.components, 0) || !holds(t.boundary_loops, 0) || !holds(t.euler, -kMostOfAMesh) ||
      !holds(t.genus, -1) || !std::isfinite(t.area_world) || t.area_world < 0)
    file.fail("metadata \"" + std::string(kKeyTopology) + "\" is not the topology of a mesh: " + text);
  return t;
}

/// Runs the parts beside each other, each to its end, and throws the error of the first one that failed. Where a part
/// of tbb::parallel_invoke throws, the others' loops end early without a word and leave values that were never written.
void run_all(const std::vector<std::function<void()>>& parts) {
  std::vector<std::exception_ptr> errors(parts.size());
  for_each_index(size_t(0), parts.size(), [&](size_t i) {
    try {
      parts[i]();
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

/// Leaves in the order of the tree, which is the order of leaf keys. Tiles are refused: a stage file has none.
template <class GridT>
std::vector<const VdbLeaf<GridT>*> leaves_of(const StageReader& file, const char* name, const GridT& grid) {
  using Root = typename GridT::TreeType::RootNodeType;
  using Upper = typename Root::ChildNodeType;
  for (auto tile = grid.tree().root().cbeginValueOn(); tile; ++tile) file.require(false, name, 0, "is an active tile");
  std::vector<const Upper*> uppers;
  std::vector<const typename Upper::ChildNodeType*> lowers;
  std::vector<const VdbLeaf<GridT>*> leaves;
  grid.tree().getNodes(uppers);
  for (const auto* node : uppers) file.require(node->getValueMask().isOff(), name, 0, "is an active tile");
  grid.tree().getNodes(lowers);
  for (const auto* node : lowers) file.require(node->getValueMask().isOff(), name, 0, "is an active tile");
  grid.tree().getNodes(leaves);
  return leaves;
}

template <class Leaf>
LeafMask mask_of(const Leaf& leaf) {
  LeafMask mask;
  for (openvdb::Index w = 0; w < 8; ++w) mask.word[w] = leaf.getValueMask().template getWord<openvdb::Index64>(w);
  return mask;
}

/// The active voxels of a grid as a VoxelSet inside the lattice.
template <class GridT>
VoxelSet voxels_of(const StageReader& file, const char* name, const GridT& grid, const LatticeFrame& frame) {
  const auto leaves = leaves_of(file, name, grid);
  const int64_t count = int64_t(leaves.size());
  file.require(count > 0, name, 0, "there is no voxel");
  VoxelSet set;
  set.leaf_key = Buffer<uint64_t>(count);
  set.mask = Buffer<LeafMask>(count);
  for (int64_t l = 0; l < count; ++l) {
    const openvdb::Coord at = leaves[size_t(l)]->origin();
    for (int axis = 0; axis < 3; ++axis)
      file.require(at[axis] >= 0 && at[axis] < frame.extent_vox[axis], name, l, "lies outside the lattice");
    set.leaf_key[l] = leaf_key({at.x() >> 3, at.y() >> 3, at.z() >> 3});
    set.mask[l] = mask_of(*leaves[size_t(l)]);
    file.require(!leaves[size_t(l)]->getValueMask().isOff(), name, l, "is a leaf without active voxels");
    file.require(l == 0 || set.leaf_key[l - 1] < set.leaf_key[l], name, l, "is not in the order of leaf keys");
  }
  index_host_leaves(set, frame.extent_vox);
  return set;
}

/// Values of the active voxels, which must be those of `set`, in canonical order.
template <class T, class GridT>
Buffer<T> values_of(const StageReader& file, const char* name, const GridT& grid, const VoxelSet& set) {
  const auto leaves = leaves_of(file, name, grid);
  file.require(int64_t(leaves.size()) == set.leaf_count(), name, int64_t(leaves.size()),
               "has other voxels than the shell");
  const VoxelSetView view = set.view();
  Buffer<T> values(set.voxel_count());
  for_each_index(int64_t(0), set.leaf_count(), [&](int64_t l) {
    const auto& leaf = *leaves[size_t(l)];
    const Voxel at = leaf_of_key(view.leaf_key[l]);
    const LeafMask mask = mask_of(leaf);
    file.require(leaf.origin() == openvdb::Coord(at.x * 8, at.y * 8, at.z * 8) &&
                     std::memcmp(&mask, &view.mask[l], sizeof mask) == 0,
                 name, l, "has other voxels than the shell");
    const auto* data = leaf.buffer().data();
    for_each_active(view, l, [&](int offset, int64_t i) { values[i] = T(data[offset]); });
  });
  return values;
}

/// The array that make_table_grid stored; it must fill its leaves without a gap.
template <class T, class GridT>
Buffer<T> table_of(const StageReader& file, const char* name) {
  const auto grid = file.grid<GridT>(name);
  const auto leaves = leaves_of(file, name, *grid);
  const int64_t count = int64_t(leaves.size());
  const int64_t last = count == 0 ? 0 : int64_t(leaves.back()->getValueMask().countOn());
  Buffer<T> elements(count == 0 ? 0 : (count - 1) * 512 + last);
  for_each_index(int64_t(0), count, [&](int64_t l) {
    const auto& leaf = *leaves[size_t(l)];
    const Voxel at = leaf_of_key(uint64_t(l));
    const int64_t here = l + 1 < count ? 512 : last;
    const LeafMask mask = mask_of(leaf);
    bool dense = leaf.origin() == openvdb::Coord(at.x * 8, at.y * 8, at.z * 8) && here > 0;
    for (int64_t offset = 0; offset < 512; ++offset) dense = dense && is_on(mask, int(offset)) == (offset < here);
    file.require(dense, name, l, "is a leaf with gaps; tables have none");
    std::memcpy(static_cast<void*>(elements.data() + l * 512), leaf.buffer().data(), size_t(here) * sizeof(T));
  });
  return elements;
}

/// Calls check(i) for every element; check throws.
template <class Check>
void check_all(int64_t count, Check check) {
  for_ranges(count, 4096, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) check(i);
  });
}

void check_points(const StageReader& file, const char* name, View<const PointQ8> points, const LatticeFrame& frame) {
  const int32_t* extent = frame.extent_vox;
  check_all(points.size, [&](int64_t i) {
    const PointQ8 p = points[i];
    file.require(p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x <= extent[0] * kOneVoxelQ8 && p.y <= extent[1] * kOneVoxelQ8 &&
                     p.z <= extent[2] * kOneVoxelQ8,
                 name, i, "lies outside the lattice");
  });
}

void read_surface(const StageReader& file, LatticeSurface& surface) {
  run_all({[&] { surface.points = table_of<PointQ8, VdbVec3iGrid>(file, kSurfacePoints); },
           [&] { surface.triangles = table_of<TriangleIndices, VdbVec3iGrid>(file, kSurfaceTriangles); },
           [&] { surface.source_face = table_of<uint32_t, VdbIntGrid>(file, kSurfaceSource); }});
  check_points(file, kSurfacePoints, surface.points.view(), surface.frame);
  const int64_t points = surface.points.size();
  check_all(surface.triangles.size(), [&](int64_t i) {
    const TriangleIndices t = surface.triangles[i];
    file.require(t.a < points && t.b < points && t.c < points, kSurfaceTriangles, i, "names a point that is not there");
  });
  file.require(surface.source_face.size() == surface.triangles.size(), kSurfaceSource, surface.source_face.size(),
               "has another count than the triangles");
  if (file.has(kKeyFirstCap)) surface.first_cap = uint32_t(file.number(kKeyFirstCap, 0, INT32_MAX));
  file.check_digest("surface", surface);
}

/// Every value must be what the site it names gives.
void check_shell(const StageReader& file, const Shell& shell, const SiteSet& sites) {
  const Buffer<Voxel> site = list_voxels(sites.voxels);
  const VoxelSetView view = shell.voxels.view();
  for_each_index(int64_t(0), shell.voxels.leaf_count(), [&](int64_t l) {
    const Voxel leaf = leaf_of_key(view.leaf_key[l]);
    for_each_active(view, l, [&](int offset, int64_t i) {
      const int64_t id = shell.closest_site[i];
      file.require(id < site.size(), kClosestSite, i, "names a site that is not there");
      const Voxel v = voxel_at(leaf, offset);
      const int64_t dx = v.x - site[id].x, dy = v.y - site[id].y, dz = v.z - site[id].z;
      file.require(dx * dx + dy * dy + dz * dz == shell.distance_sq_vox[i], kDistanceSq, i,
                   "is not the distance to its site");
    });
  });
}

void read_shell(const StageReader& file, const LatticeFrame& frame, Shell& shell, SiteSet& sites) {
  shell.band_vox = file.number(kKeyBand, 1, kMaxBandVox);
  const auto distance_grid = file.grid<VdbIntGrid>(kDistanceSq);
  shell.voxels = voxels_of(file, kDistanceSq, *distance_grid, frame);
  const Buffer<int32_t> distance_sq = values_of<int32_t>(file, kDistanceSq, *distance_grid, shell.voxels);
  shell.distance_sq_vox = Buffer<uint16_t>(distance_sq.size());
  check_all(distance_sq.size(), [&](int64_t i) {
    file.require(distance_sq[i] >= 0 && distance_sq[i] <= shell.band_vox * shell.band_vox, kDistanceSq, i,
                 "is outside the band");
    shell.distance_sq_vox[i] = uint16_t(distance_sq[i]);
  });
  shell.closest_site = values_of<uint32_t>(file, kClosestSite, *file.grid<VdbIntGrid>(kClosestSite), shell.voxels);
  sites = sites_of_shell(shell, frame);
  check_shell(file, shell, sites);
  file.check_digest("sites", sites);
  file.check_digest("shell", shell);
}

SeedSet read_seeds(const StageReader& file, const LatticeFrame& frame) {
  SeedSet seeds;
  seeds.position = table_of<PointQ8, VdbVec3iGrid>(file, kSeedPoints);
  seeds.home = table_of<uint32_t, VdbIntGrid>(file, kSeedHomes);
  const Buffer<PointQ8> normal = table_of<PointQ8, VdbVec3iGrid>(file, kSeedNormals);
  file.require(normal.size() == seeds.size(), kSeedNormals, normal.size(), "has another count than the seeds");
  file.require(seeds.home.size() == seeds.size(), kSeedHomes, seeds.home.size(), "has another count than the seeds");
  check_points(file, kSeedPoints, seeds.position.view(), frame);
  seeds.normal = Buffer<Normal8>(seeds.size());
  check_all(seeds.size(), [&](int64_t i) {
    const PointQ8 n = normal[i];
    file.require(std::max({n.x, n.y, n.z}) <= 127 && std::min({n.x, n.y, n.z}) >= -127, kSeedNormals, i,
                 "has a component outside -127 to 127");
    seeds.normal[i] = {int8_t(n.x), int8_t(n.y), int8_t(n.z)};
  });
  file.check_digest("seeds", seeds);
  return seeds;
}

VoronoiLabels read_labels(const StageReader& file, const Shell& shell, int64_t seeds) {
  VoronoiLabels labels;
  labels.voxel_seed = values_of<uint32_t>(file, kSeedId, *file.grid<VdbIntGrid>(kSeedId), shell.voxels);
  check_all(labels.voxel_seed.size(), [&](int64_t i) {
    file.require(labels.voxel_seed[i] < seeds || labels.voxel_seed[i] == kNone, kSeedId, i,
                 "names a seed that is not there");
  });
  file.check_digest("labels", labels);
  return labels;
}

StageInfo read_info(const StageReader& file) {
  StageInfo info;
  info.stage = file.text(kKeyStage);
  if (info.stage != "shell" && info.stage != "voronoi")
    file.fail("metadata \"" + std::string(kKeyStage) + "\" is \"" + info.stage + "\"; it must be shell or voronoi");
  info.format_version = file.number(kKeyVersion, 1, kVersion);
  info.creator = file.text(kKeyCreator, false);
  info.options_json = file.text(kKeyOptions, false);
  if (file.has(kKeyClosing)) info.closing_vox = file.number(kKeyClosing, 0, kMaxClosingVox);
  info.left_out = file.text(kKeyLeftOut, false);
  const std::string prefix = kKeyDigest;
  for (const auto& [key, value] : file.texts())
    if (key.compare(0, prefix.size(), prefix) == 0) info.digests[key.substr(prefix.size())] = value;
  return info;
}

}  // namespace

StageFile read_stage(const MeshSource& source) {
  initialize_openvdb();
  const StageReader file(source);
  StageFile stage;
  stage.info = read_info(file);
  stage.surface.frame = read_frame(file);
  stage.surface.topology = read_topology(file);
  const LatticeFrame& frame = stage.surface.frame;
  run_all({[&] { read_shell(file, frame, stage.shell, stage.sites); }, [&] { read_surface(file, stage.surface); },
           [&] {
             if (stage.info.stage == "voronoi") stage.seeds = read_seeds(file, frame);
           }});
  if (stage.seeds) stage.labels = read_labels(file, stage.shell, stage.seeds->size());
  return stage;
}

}  // namespace isoshell
