// Digests of the canonical arrays: a 64-bit hash of 8-byte words, by fixed chunks so that threads cannot matter.
#include "isoshell/digest.h"

#include <tbb/parallel_for.h>

#include <cstdio>
#include <cstring>
#include <vector>

#include "voxel/random.h"

namespace isoshell {
namespace {

uint64_t hash_chunk(const unsigned char* data, int64_t bytes) {
  uint64_t h = mix64(uint64_t(bytes) + 1);
  int64_t i = 0;
  for (; i + 8 <= bytes; i += 8) {
    uint64_t w;
    std::memcpy(&w, data + i, 8);
    h = mix64(h ^ w) + w;
  }
  uint64_t tail = 0;
  if (i < bytes) std::memcpy(&tail, data + i, size_t(bytes - i));
  return mix64(h ^ tail);
}

class Digest {
 public:
  template <class Array>
  Digest& array(const Array& values) {
    static_assert(std::has_unique_object_representations_v<std::remove_cv_t<std::remove_reference_t<decltype(*values.data())>>> ||
                  std::is_same_v<std::remove_cv_t<std::remove_reference_t<decltype(*values.data())>>, WorldPoint>);
    constexpr int64_t kChunk = 1 << 16;
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    const int64_t size = int64_t(values.size()) * int64_t(sizeof(*values.data()));
    const int64_t chunks = (size + kChunk - 1) / kChunk;
    std::vector<uint64_t> part(size_t(chunks) + 1);
    tbb::parallel_for(int64_t(0), chunks, [&](int64_t c) {
      part[size_t(c)] = hash_chunk(bytes + c * kChunk, std::min(kChunk, size - c * kChunk));
    });
    part[size_t(chunks)] = uint64_t(size);
    return value(hash_chunk(reinterpret_cast<const unsigned char*>(part.data()), int64_t(part.size() * 8)));
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

uint64_t digest(const LatticeSurface& s) { return Digest().array(s.points).array(s.triangles).get(); }
uint64_t digest(const VoxelSet& v) { return Digest().array(v.leaf_key).array(v.mask).get(); }
uint64_t digest(const SiteSet& s) { return digest(s.voxels); }
uint64_t digest(const SiteSamples& s) {
  std::vector<uint64_t> packed(size_t(s.sample.size()) * 2);
  for (int64_t i = 0; i < s.sample.size(); ++i) {
    const SiteSample& p = s.sample[i];
    packed[size_t(2 * i)] = uint64_t(uint16_t(p.dx)) | uint64_t(uint16_t(p.dy)) << 16 | uint64_t(uint16_t(p.dz)) << 32;
    packed[size_t(2 * i + 1)] = uint64_t(p.triangle) | uint64_t(uint8_t(p.normal.x)) << 32 |
                                uint64_t(uint8_t(p.normal.y)) << 40 | uint64_t(uint8_t(p.normal.z)) << 48;
  }
  return Digest().array(packed).array(s.first).array(s.triangles).get();
}
uint64_t digest(const Shell& s) {
  return Digest().value(digest(s.voxels)).value(uint64_t(s.band_vox)).array(s.closest_site).array(s.distance_sq_vox).get();
}
uint64_t digest(const Sheet& s) {
  return Digest().value(digest(s.corners)).array(s.position).array(s.normal).array(s.source_triangle).array(s.triangles).get();
}
uint64_t digest(const SeedSet& s) { return Digest().array(s.position).array(s.normal).array(s.home).get(); }
uint64_t digest(const VoronoiLabels& l) { return Digest().array(l.voxel_seed).get(); }
uint64_t digest(const TriangleMesh& m) { return Digest().array(m.vertices).array(m.triangles).get(); }

std::string digest_text(uint64_t digest) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(digest));
  return text;
}

}  // namespace isoshell
