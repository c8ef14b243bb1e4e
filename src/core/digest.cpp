// Digests of the canonical arrays.
#include "isoshell/advanced/digest.h"

#include <cstdio>
#include <type_traits>
#include <vector>

#include "core/copy_product.h"
#include "core/hash_bytes.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

class Digest {
 public:
  template <class Array>
  Digest& array(const Array& values) {
    static_assert(
        std::has_unique_object_representations_v<std::remove_cv_t<std::remove_reference_t<decltype(*values.data())>>> ||
        std::is_same_v<std::remove_cv_t<std::remove_reference_t<decltype(*values.data())>>, WorldPoint>);
    return value(hash_bytes(values.data(), int64_t(values.size()) * int64_t(sizeof(*values.data()))));
  }
  Digest& value(uint64_t v) {
    h_ = mix64(h_ ^ v) + v;
    return *this;
  }
  uint64_t get() const { return h_; }

 private:
  uint64_t h_ = 0x6973687368656c6cull;
};

}  // namespace

uint64_t digest(const LatticeSurface& surface) {
  const OnHost<LatticeSurface> s(surface);
  return Digest().array(s->points).array(s->triangles).get();
}
uint64_t digest(const VoxelSet& voxels) {
  const OnHost<VoxelSet> v(voxels);
  return Digest().array(v->leaf_key).array(v->mask).get();
}
uint64_t digest(const SiteSet& s) { return digest(s.voxels); }
uint64_t digest(const SiteSamples& samples) {
  const OnHost<SiteSamples> s(samples);
  std::vector<uint64_t> packed(size_t(s->sample.size()) * 2);
  for (int64_t i = 0; i < s->sample.size(); ++i) {
    const SiteSample& p = s->sample[i];
    packed[size_t(2 * i)] = uint64_t(uint16_t(p.dx)) | uint64_t(uint16_t(p.dy)) << 16 | uint64_t(uint16_t(p.dz)) << 32;
    packed[size_t(2 * i + 1)] = uint64_t(p.triangle) | uint64_t(uint8_t(p.normal.x)) << 32 |
                                uint64_t(uint8_t(p.normal.y)) << 40 | uint64_t(uint8_t(p.normal.z)) << 48;
  }
  return Digest().array(packed).array(s->first).array(s->triangles).get();
}
uint64_t digest(const Shell& shell) {
  const OnHost<Shell> s(shell);
  return Digest()
      .value(digest(s->voxels))
      .value(uint64_t(s->band_vox))
      .array(s->closest_site)
      .array(s->distance_sq_vox)
      .get();
}
uint64_t digest(const LevelSet& level_set) {
  const OnHost<LevelSet> s(level_set);
  return Digest()
      .value(digest(s->voxels))
      .value(hash_bytes(s->distance_vox.data(), s->distance_vox.size_bytes()))
      .get();
}
uint64_t digest(const Sheet& sheet) {
  const OnHost<Sheet> s(sheet);
  Digest all;
  all.value(digest(s->corners)).array(s->position).array(s->normal).array(s->source_triangle).array(s->triangles);
  all.array(s->missed).array(s->missed_vertex);
  if (!s->lengths.at.empty()) all.array(s->lengths.at);
  return all.get();
}
uint64_t digest(const SeedSet& seeds) {
  const OnHost<SeedSet> s(seeds);
  return Digest().array(s->position).array(s->normal).array(s->home).get();
}
uint64_t digest(const VoronoiLabels& labels) {
  const OnHost<VoronoiLabels> l(labels);
  return Digest().array(l->voxel_seed).get();
}
uint64_t digest(const TriangleMesh& m) { return Digest().array(m.vertices).array(m.triangles).get(); }

std::string digest_text(uint64_t digest) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(digest));
  return text;
}

}  // namespace isoshell
