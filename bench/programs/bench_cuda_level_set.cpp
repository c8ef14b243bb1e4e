// Level sets on a device, from a prepared surface to signed distances in its memory, beside those of the CPU.
//   bench_cuda_level_set MESH... [--resolutions 512,2048] [--band D] [--repeats N] [--device-only]
// JSON on standard output: medians over the repeats, by the host's clock until the device has done all; the copy to the
// host alone; the CPU's time with all threads, once; and whether both have the same bytes.
#include <cstdio>

#include "bench/programs/program.h"
#include "isoshell/advanced/level_set.h"
#include "isoshell/isoshell.h"

using namespace isoshell;
using nlohmann::json;

namespace {

struct Arguments {
  std::vector<std::string> meshes;
  std::vector<int> resolutions = {512, 2048};
  int32_t band_vox = 3, repeats = 10;
  bool device_only = false;
};

Prepared prepared_on(const TriangleSoup& soup, int32_t resolution, Context& context) {
  RemeshOptions options;
  options.vertices = 4000;
  options.resolution = resolution;
  options.features = {Features::Creases::off, 0};
  options.level_set_band_vox = 3;
  options.want_samples = false;
  return prepare(soup, options, context);
}

json measure(const TriangleSoup& soup, int32_t resolution, const Arguments& args) {
  bench::BackendContext device(Backend::cuda), host(Backend::cpu);
  const Prepared prepared = prepared_on(soup, resolution, device);
  std::vector<double> ms, copy_ms;
  json row = {{"resolution", resolution}};
  uint64_t bytes_on_device = 0;
  for (int i = -1; i < args.repeats; ++i) {
    finish_stages(device);
    const bench::Watch watch;
    const LevelSet set = level_set(prepared, args.band_vox, device);
    finish_stages(device);
    const double made_ms = watch.ms();
    const LevelSet here = to_host(set);
    if (i < 0) {
      bytes_on_device = digest(here);
      row["active"] = here.voxels.voxel_count();
      row["device_first_ms"] = made_ms;
    } else {
      ms.push_back(made_ms), copy_ms.push_back(watch.ms() - made_ms);
    }
  }
  bench::add_spread(row, "device_ms", bench::spread_of(ms));
  bench::add_spread(row, "to_host_ms", bench::spread_of(copy_ms));
  if (args.device_only) return row;
  const Prepared on_host = prepared_on(soup, resolution, host);
  LevelSet set;
  row["cpu_ms"] = bench::ms_of([&] { set = level_set(on_host, args.band_vox, host); });
  row["same_bytes"] = digest(set) == bytes_on_device;
  return row;
}

}  // namespace

int main(int argc, char** argv) try {
  Arguments args;
  args.meshes = bench::read_arguments(argc, argv, "bench_cuda_level_set MESH...", 1,
                                      {{"--resolutions", "LIST", &args.resolutions},
                                       {"--band", "D", &args.band_vox},
                                       {"--repeats", "N", &args.repeats},
                                       {"--device-only", "", &args.device_only}});
  json rows = json::array();
  for (const std::string& mesh : args.meshes) {
    const TriangleSoup soup = read_mesh(mesh);
    for (const int resolution : args.resolutions) {
      json row = measure(soup, resolution, args);
      row["mesh"] = bench::file_name(mesh);
      std::fprintf(stderr, "%s\n", row.dump().c_str());
      rows.push_back(row);
    }
  }
  bench::print_result({{"bench", "cuda_level_set"}, {"repeats", args.repeats}, {"rows", rows}});
  return 0;
} catch (const std::exception& e) {
  return bench::failed(argv[0], e);
}
