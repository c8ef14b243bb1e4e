// From triangles on the device to sites, shell with exact closest sites, and NanoVDB index grid, all in its memory.
//   bench_cuda_shell MESH [--resolutions 512,1024,...] [--bands 1,3,...] [--triangles N] [--repeats N] [--digests]
// The longest side is nine tenths of a resolution; faces are split at the middles of their edges until there are N.
// JSON on standard output: medians over the repeats, by events in the stream that the stages use. With --digests the
// host computes sites and shell, too, and the digests of both are compared.
#include <cuda_runtime_api.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <unordered_map>
#include <vector>

#include "bench/programs/program.h"
#include "cuda/runtime/device_stream.h"
#include "isoshell/isoshell.h"

using namespace isoshell;
using nlohmann::json;

namespace {

struct Arguments {
  std::string mesh;
  std::vector<int> resolutions = {512, 1024, 2048, 4096, 8192}, bands = {3, 9};
  int64_t triangles = 200000;
  int repeats = 20;
  bool digests = false;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.mesh = bench::read_arguments(argc, argv, "bench_cuda_shell MESH", 1,
                                 {{"--resolutions", "LIST", &a.resolutions},
                                  {"--bands", "LIST", &a.bands},
                                  {"--triangles", "N", &a.triangles},
                                  {"--repeats", "N", &a.repeats},
                                  {"--digests", "", &a.digests}})[0];
  return a;
}

/// Four triangles for each, with new vertices in the middle of the edges.
TriangleSoup split(const TriangleSoup& soup) {
  TriangleSoup out;
  out.vertices = soup.vertices;
  std::unordered_map<uint64_t, uint32_t> middles;
  const auto middle = [&](uint32_t a, uint32_t b) {
    const auto [at, fresh] = middles.try_emplace(uint64_t(std::min(a, b)) << 32 | std::max(a, b), 0);
    if (fresh) {
      const WorldPoint p = soup.vertices[a], q = soup.vertices[b];
      at->second = uint32_t(out.vertices.size());
      out.vertices.push_back({(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2});
    }
    return at->second;
  };
  for (const auto& t : soup.triangles) {
    const uint32_t ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    out.triangles.push_back({t[0], ab, ca});
    out.triangles.push_back({ab, t[1], bc});
    out.triangles.push_back({ca, bc, t[2]});
    out.triangles.push_back({ab, bc, ca});
  }
  return out;
}

template <class T>
Buffer<T> on_device(const Buffer<T>& host, DeviceStream& stream) {
  Buffer<T> out(host.size(), stream);
  stream.copy_to_device(out.data(), host.data(), host.size_bytes());
  stream.synchronize();
  return out;
}

/// Points in the stream's time.
class Laps {
 public:
  explicit Laps(cudaStream_t stream) : stream_(stream) {
    for (cudaEvent_t& e : events_) require_success(cudaEventCreate(&e), "cudaEventCreate");
  }
  ~Laps() {
    for (cudaEvent_t e : events_) cudaEventDestroy(e);
  }
  Laps(const Laps&) = delete;
  void mark(int i) { require_success(cudaEventRecord(events_[i], stream_), "cudaEventRecord"); }
  double ms(int from, int to) const {
    float ms = 0;
    require_success(cudaEventElapsedTime(&ms, events_[from], events_[to]), "cudaEventElapsedTime");
    return ms;
  }

 private:
  cudaStream_t stream_;
  cudaEvent_t events_[4];
};

json measure(const LatticeSurface& surface, int band_vox, int repeats, Context& context) {
  DeviceStream& stream = DeviceStream::of(context);
  Laps laps(stream.stream());
  std::vector<double> ms[4];
  json row;
  for (int i = -2; i < repeats; ++i) {
    stream.synchronize();
    reset_device_memory_peak(context.device);
    const int64_t before = device_memory_peak_bytes(context.device);
    laps.mark(0);
    const SiteSet sites = voxelize(surface, context);
    laps.mark(1);
    const Shell shell = build_shell(sites, {band_vox}, context);
    laps.mark(2);
    const Buffer<std::byte> grid = nano_index_grid(shell.voxels, surface.frame, "shell", context);
    laps.mark(3);
    stream.synchronize();
    if (i < 0) continue;
    for (int lap = 0; lap < 3; ++lap) ms[lap].push_back(laps.ms(lap, lap + 1));
    ms[3].push_back(laps.ms(0, 3));
    const int64_t active = shell.voxels.voxel_count(), peak = device_memory_peak_bytes(context.device) - before;
    row = {{"sites", sites.voxels.voxel_count()},
           {"site_leaves", sites.voxels.leaf_count()},
           {"active_voxels", active},
           {"leaves", shell.voxels.leaf_count()},
           {"grid_bytes", grid.size_bytes()},
           {"peak_bytes", peak},
           {"peak_bytes_per_active", double(peak) / double(std::max<int64_t>(active, 1))}};
  }
  row["voxelize_ms"] = bench::spread_of(ms[0]).median;
  row["shell_ms"] = bench::spread_of(ms[1]).median;
  row["grid_ms"] = bench::spread_of(ms[2]).median;
  const bench::Spread total = bench::spread_of(ms[3]);
  row["total_ms"] = total.median;
  row["total_ms_min"] = total.least;
  return row;
}

/// Digests and counts of the products on both sides; the device's go first and are gone before the host's are made.
json compare(const LatticeSurface& on_host, const LatticeSurface& on_device, int band_vox, Context& host,
             Context& device) {
  json row;
  const auto describe = [&](const char* side, const LatticeSurface& surface, Context& context) {
    const bench::Watch watch;
    const SiteSet sites = to_host(voxelize(surface, context));
    const Shell shell = to_host(build_shell(sites, {band_vox}, context));
    row[side] = {{"seconds", watch.ms() / 1000},
                 {"sites", sites.voxels.voxel_count()},
                 {"active_voxels", shell.voxels.voxel_count()},
                 {"site_digest", digest_text(digest(sites))},
                 {"shell_digest", digest_text(digest(shell))}};
  };
  describe("device", on_device, device);
  describe("host", on_host, host);
  bool equal = true;
  for (const char* key : {"sites", "active_voxels", "site_digest", "shell_digest"})
    equal = equal && row["device"][key] == row["host"][key];
  row["equal"] = equal;
  return row;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments args = parse(argc, argv);
  bench::BackendContext host(Backend::cpu), device(Backend::cuda);
  TriangleSoup soup = read_mesh(args.mesh);
  while (int64_t(soup.triangles.size()) < args.triangles) soup = split(soup);
  json rows = json::array();
  for (const int resolution : args.resolutions) {
    const LatticeFrame frame = bench::frame_of(soup, resolution * 9 / 10);
    const LatticeSurface snapped = snap_surface(soup, frame, host);
    DeviceStream& stream = DeviceStream::of(device);
    LatticeSurface surface;
    surface.frame = snapped.frame;
    surface.points = on_device(snapped.points, stream);
    surface.triangles = on_device(snapped.triangles, stream);
    for (const int band_vox : args.bands) {
      json row = {{"resolution", resolution}, {"band_vox", band_vox}, {"triangles", surface.triangles.size()}};
      row.update(measure(surface, band_vox, args.repeats, device));
      std::fprintf(stderr, "%5d d %2d: %8.3f + %8.3f + %7.3f = %8.3f ms, %.2f B a voxel\n", resolution, band_vox,
                   row["voxelize_ms"].get<double>(), row["shell_ms"].get<double>(), row["grid_ms"].get<double>(),
                   row["total_ms"].get<double>(), row["peak_bytes_per_active"].get<double>());
      if (args.digests) {
        row["digests"] = compare(snapped, surface, band_vox, host, device);
        std::fprintf(stderr, "%s\n", row["digests"].dump().c_str());
      }
      rows.push_back(row);
    }
  }
  bench::print_result(
      {{"bench", "cuda_shell"}, {"mesh", bench::file_name(args.mesh)}, {"repeats", args.repeats}, {"rows", rows}});
} catch (const std::exception& e) {
  return bench::failed(argv[0], e);
}
