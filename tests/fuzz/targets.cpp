// What is fuzzed: every reader, by the name of its corpus folder.
#include "fuzz/targets.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include "io/file_formats.h"
#include "io/points/point_readers.h"
#include "io/polyline_readers.h"
#include "io/vdb/grid_kinds.h"
#include "io/vdb/stage_reader.h"
#include "io/vdb/volume_readers.h"
#include "isoshell/error.h"

namespace isoshell::fuzz {
namespace {

constexpr int64_t kVolumeMemory = 1 << 20;  // a surface that fills more takes seconds a run

/// Every vertex, corner or face has its values.
void check(const Attribute& a, const TriangleSoup& soup) {
  size_t count = a.domain == AttributeDomain::vertex ? soup.vertices.size() : soup.triangles.size();
  if (a.domain == AttributeDomain::corner) count *= 3;
  const size_t values = a.values.size() / size_t(a.components);
  if (a.values.size() != values * size_t(a.components)) std::abort();
  if (a.index.size() != (a.index.empty() ? 0 : count) || (a.index.empty() && values != count)) std::abort();
  for (const uint32_t i : a.index)
    if (i >= values) std::abort();
}

/// Every face parts two regions, or none does.
void check(const FaceRegions& regions, const TriangleSoup& soup) {
  if (!regions.empty() && regions.labels.size() != soup.triangles.size()) std::abort();
  for (const auto& [behind, front] : regions.labels)
    if (behind == regions.background || (front != regions.background && behind >= front)) std::abort();
}

void run_mesh(const char* format, View<const char> bytes) {
  const auto read = find_row(format)->read;
  const TriangleSoup soup = read(MeshSource("fuzz", bytes));
  for (const auto& t : soup.triangles)
    for (const uint32_t corner : t)
      if (corner >= soup.vertices.size()) std::abort();
  for (const Attribute& a : soup.attributes) check(a, soup);
  check(soup.regions, soup);
}

template <Polylines (*read)(const MeshSource&)>
void run_lines(View<const char> bytes) {
  const Polylines lines = read(MeshSource("fuzz", bytes));
  if (lines.segments.empty()) std::abort();
  for (const auto& segment : lines.segments)
    for (const uint32_t end : segment)
      if (end >= lines.points.size()) std::abort();
}

template <PointCloud (*read)(const MeshSource&)>
void run_points(View<const char> bytes) {
  const PointCloud cloud = read(MeshSource("fuzz", bytes));
  if (!cloud.normal.empty() && cloud.normal.size() != cloud.position.size()) std::abort();
}

void run_volume(View<const char> bytes) {
  VolumeInfo info;
  const TriangleSoup soup = read_volume(MeshSource("fuzz", bytes), {"", 0.25, kVolumeMemory}, info);
  for (const auto& t : soup.triangles)
    for (const uint32_t corner : t)
      if (corner >= soup.vertices.size()) std::abort();
}

void run_labels(View<const char> bytes) {
  const LabelVolume volume = read_label_grid(MeshSource("fuzz", bytes), {"", kVolumeMemory}).volume;
  int64_t voxels = 1;
  for (const int32_t size : volume.size_vox) voxels *= size;
  if (voxels < 1 || int64_t(volume.labels.size()) != voxels) std::abort();
}

void run_stage(View<const char> bytes) { read_stage(MeshSource("fuzz", bytes)); }

}  // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> all = {{"gltf", [](View<const char> bytes) { run_mesh("gltf", bytes); }},
                                          {"obj", [](View<const char> bytes) { run_mesh("obj", bytes); }},
                                          {"off", [](View<const char> bytes) { run_mesh("off", bytes); }},
                                          {"ply", [](View<const char> bytes) { run_mesh("ply", bytes); }},
                                          {"stl", [](View<const char> bytes) { run_mesh("stl", bytes); }},
                                          {"obj_lines", run_lines<read_obj_lines>},
                                          {"ply_edges", run_lines<read_ply_edges>},
                                          {"ply_points", run_points<read_ply_points>},
                                          {"xyz", run_points<read_xyz>},
                                          {"pcd", run_points<read_pcd>},
                                          {"volume", run_volume},
                                          {"labels", run_labels},
                                          {"stage", run_stage}};
  return all;
}

void run_or_abort(const Target& target, View<const char> bytes) {
  try {
    target.run(bytes);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::internal) return;
    std::fprintf(stderr, "%s: internal error: %s\n", target.name, error.what());
    std::abort();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: not refused but thrown: %s\n", target.name, error.what());
    std::abort();
  }
}

}  // namespace isoshell::fuzz
