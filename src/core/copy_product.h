// Copies of products from memory to memory: the one list of the arrays that each product has.
#pragma once

#include "isoshell/advanced/level_set.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

// `copy` makes a Buffer<T> of a const Buffer<T>&.

template <class Copy>
VoxelSet copy_product(const VoxelSet& v, Copy copy) {
  VoxelSet out;
  for (int axis = 0; axis < 3; ++axis) out.block_dims[axis] = v.block_dims[axis];
  out.block_table = copy(v.block_table);
  out.blocks = copy(v.blocks);
  out.leaf_key = copy(v.leaf_key);
  out.mask = copy(v.mask);
  out.first = copy(v.first);
  out.active = v.active;
  return out;
}
template <class Copy>
LatticeSurface copy_product(const LatticeSurface& s, Copy copy) {
  return {s.frame, copy(s.points), copy(s.triangles), copy(s.source_face), s.topology, s.first_cap};
}
template <class Copy>
SiteSet copy_product(const SiteSet& s, Copy copy) {
  return {copy_product(s.voxels, copy), copy(s.hollows)};
}
template <class Copy>
SiteSamples copy_product(const SiteSamples& s, Copy copy) {
  return {copy(s.sample), copy(s.first), copy(s.triangles)};
}
template <class Copy>
Shell copy_product(const Shell& s, Copy copy) {
  return {copy_product(s.voxels, copy), s.band_vox, copy(s.closest_site), copy(s.distance_sq_vox)};
}
template <class Copy>
LevelSetSurface copy_product(const LevelSetSurface& s, Copy copy) {
  return {copy(s.corner), s.first_of_sheet};
}
template <class Copy>
LevelSet copy_product(const LevelSet& s, Copy copy) {
  return {s.frame, copy_product(s.voxels, copy), copy(s.distance_vox), s.band_vox};
}
template <class Copy>
SurfaceMesh copy_product(const SurfaceMesh& s, Copy copy) {
  return {{s.extent_vox[0], s.extent_vox[1], s.extent_vox[2]},
          copy(s.position),
          copy(s.normal),
          copy(s.triangles),
          copy(s.vertex_first),
          copy(s.vertex_triangles),
          copy(s.border_before),
          {copy(s.blocks.first), copy(s.blocks.centre)},
          {copy(s.chains.first), copy(s.chains.vertex), copy(s.chains.kind), copy(s.chains.is_loop)},
          copy(s.patch),
          {copy(s.lengths.at), s.lengths.least, s.lengths.largest},
          copy(s.missed),
          copy(s.missed_vertex)};
}
template <class Copy>
Sheet copy_product(const Sheet& s, Copy copy) {
  return {copy_product(static_cast<const SurfaceMesh&>(s), copy), s.frame, copy_product(s.corners, copy),
          copy(s.source_triangle), s.topology};
}
template <class Copy>
SeedSet copy_product(const SeedSet& s, Copy copy) {
  return {
      copy(s.position), copy(s.normal), copy(s.home), {s.fixed.count, copy(s.fixed.of_vertex), copy(s.fixed.joined)}};
}
template <class Copy>
VoronoiLabels copy_product(const VoronoiLabels& l, Copy copy) {
  return {copy(l.voxel_seed)};
}
template <class Copy>
DualMesh copy_product(const DualMesh& m, Copy copy) {
  return {copy(m.position), copy(m.triangles)};
}

/// Where the arrays of a product lie.
inline Memory& memory_of(const VoxelSet& v) { return v.leaf_key.memory(); }
inline Memory& memory_of(const LevelSetSurface& s) { return s.corner.memory(); }
inline Memory& memory_of(const LevelSet& s) { return memory_of(s.voxels); }
inline Memory& memory_of(const LatticeSurface& s) { return s.points.memory(); }
inline Memory& memory_of(const SiteSet& s) { return memory_of(s.voxels); }
inline Memory& memory_of(const SiteSamples& s) { return s.sample.memory(); }
inline Memory& memory_of(const Shell& s) { return memory_of(s.voxels); }
inline Memory& memory_of(const SurfaceMesh& s) { return s.position.memory(); }
inline Memory& memory_of(const SeedSet& s) { return s.position.memory(); }
inline Memory& memory_of(const VoronoiLabels& l) { return l.voxel_seed.memory(); }
inline Memory& memory_of(const DualMesh& m) { return m.position.memory(); }

/// Whether all arrays of a product lie in a memory that `is_here` is true of.
template <class Product, class IsHere>
bool lies_where(const Product& product, IsHere is_here) {
  return is_here(memory_of(product));
}
/// The surface of a sheet and its lattice may lie apart: what changes the surface brings only that over.
template <class IsHere>
bool lies_where(const Sheet& sheet, IsHere is_here) {
  return is_here(memory_of(static_cast<const SurfaceMesh&>(sheet))) && is_here(memory_of(sheet.corners));
}
template <class Product>
bool lies_on_host(const Product& product) {
  return lies_where(product, [](const Memory& memory) { return memory.space() == MemorySpace::host; });
}

template <class Product>
Product host_copy(const Product& product) {
  return copy_product(product, [](const auto& buffer) { return buffer.to_host(); });
}

/// Brings a product that a stage changes to the host.
template <class Product>
Product& on_host(Product& product) {
  if (!lies_on_host(product)) product = host_copy(product);
  return product;
}

/// A product where the host can read it: itself, or a copy that lives as long as this.
template <class Product>
class OnHost {
 public:
  explicit OnHost(const Product& product) : product_(&product) {
    if (lies_on_host(product)) return;
    copy_ = host_copy(product);
    product_ = &copy_;
  }
  OnHost(const OnHost&) = delete;
  const Product& operator*() const { return *product_; }
  const Product* operator->() const { return product_; }

 private:
  const Product* product_;
  Product copy_;
};

}  // namespace isoshell
