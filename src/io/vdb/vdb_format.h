// Names that stage files are made of, shared by the writer and the reader. docs/VDB_FORMAT.md explains them.
#pragma once

#include "isoshell/version.h"

namespace isoshell::vdb_format {

constexpr int kVersion = 1;

constexpr char kCreator[] = "vdb_isomesh " ISOSHELL_VERSION;

constexpr char kKeyStage[] = "isoshell:stage";
constexpr char kKeyVersion[] = "isoshell:version";
constexpr char kKeyOptions[] = "isoshell:options";
constexpr char kKeyFrame[] = "isoshell:frame";
constexpr char kKeyBand[] = "isoshell:band_vox";
constexpr char kKeyClosing[] = "isoshell:closing_vox";
constexpr char kKeyLeftOut[] = "isoshell:left_out";
constexpr char kKeyFirstCap[] = "isoshell:first_cap";
constexpr char kKeyTopology[] = "isoshell:input_topology";
constexpr char kKeyDigest[] = "isoshell:digest_";  // then the product's name
constexpr char kKeyCreator[] = "creator";

constexpr char kDistanceSq[] = "distance_sq_vox";
constexpr char kClosestSite[] = "closest_site";
constexpr char kSeedId[] = "seed_id";
constexpr char kSurfacePoints[] = "surface_points";
constexpr char kSurfaceTriangles[] = "surface_triangles";
constexpr char kSurfaceSource[] = "surface_source_face";
constexpr char kSeedPoints[] = "seed_points";
constexpr char kSeedNormals[] = "seed_normals";
constexpr char kSeedHomes[] = "seed_homes";

constexpr int kMaxOptionsBytes = 256 << 10;
constexpr int kMaxHeaderBytes = 1 << 20;  // header and file metadata of any stage file are shorter

}  // namespace isoshell::vdb_format
