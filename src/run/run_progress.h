// How far a run is: its meter, which expects more and more exactly what the run takes.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <thread>

#include "isoshell/run/run.h"
#include "progress/expected_work.h"
#include "progress/metered.h"
#include "run/measures.h"

namespace isoshell {

class RunProgress {
 public:
  /// By the size of the input's file and the options.
  explicit RunProgress(const RunRequest& request) : meter(request.progress) {
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(request.input.path, unknown);
    if (!unknown) size_.faces = double(bytes) / kBytesPerFace;
    const RemeshOptions& options = request.options.values;
    size_.vertices = double(options.vertices.value_or(kUsualVertices));
    size_.surface_voxels = kVoxelsPerVertex * size_.vertices;
    size_.measures_distance = measures_distance(request);
    meter.expect(expected_work(size_));
  }

  /// By the surface that is meshed, and where.
  void expect(const TriangleSoup& surface, const RemeshOptions& options, const Context& context) {
    const int threads = context.threads > 0 ? context.threads : int(std::thread::hardware_concurrency());
    size_.speed = std::string(backend_name(context)) == "cuda" ? kSpeedOfDevice : std::pow(threads, kGainOfThreads);
    size_.faces = double(surface.triangles.size());
    size_.has_regions = !surface.regions.empty();
    size_.are_of_voxels = surface.regions.are_of_voxels;
    if (options.resolution) size_.surface_voxels = kVoxelsOfCube * *options.resolution * *options.resolution;
    meter.expect(expected_work(size_));
  }

  /// By what was made of it.
  void expect(const Prepared& prepared) {
    size_.surface_voxels = double(prepared.sites().voxels.voxel_count());
    size_.has_curves = prepared.is_in_patches();
    meter.expect(expected_work(size_));
  }

  ProgressMeter meter;

 private:
  static constexpr double kBytesPerFace = 35;  ///< of a file
  static constexpr int64_t kUsualVertices = 10000;
  static constexpr double kVoxelsPerVertex = 27;  ///< of a grid that the run chooses
  static constexpr double kVoxelsOfCube = 3;      ///< on its surface, over the square of its side

  static constexpr double kSpeedOfDevice = 8, kGainOfThreads = .7;

  RunSize size_;
};

}  // namespace isoshell
