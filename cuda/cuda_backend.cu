// The CUDA backend's table, and what belongs to no stage of the device.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/device_stream.h"

namespace isoshell {

const BackendTable* cuda_backend() {
  static const CudaBackend table;
  return &table;
}

/// Its triangles lie on the host, and it is made once a run.
MadeSurface CudaBackend::make_surface_mesh(const SurfaceTriangles& from, Context& context) const {
  return cpu_backend().make_surface_mesh(from, context);
}

namespace {

/// A device's limit says nothing of the host.
class WithoutLimit {
 public:
  explicit WithoutLimit(Context& context) : context_(context), limit_bytes_(context.memory_limit_bytes) {
    context_.memory_limit_bytes = 0;
  }
  WithoutLimit(const WithoutLimit&) = delete;
  WithoutLimit& operator=(const WithoutLimit&) = delete;
  ~WithoutLimit() { context_.memory_limit_bytes = limit_bytes_; }

 private:
  Context& context_;
  int64_t limit_bytes_;
};

}  // namespace

/// Sequential by nature.
SiteSet CudaBackend::cut_false_handles(const SiteSet& sites, const SiteSamples& samples, int64_t genus,
                                       Context& context) const {
  const WithoutLimit on_host(context);
  return cpu_backend().cut_false_handles(sites, samples, genus, context);
}

void CudaBackend::finish_stages(Context& context) const { DeviceStream::of(context).synchronize(); }

}  // namespace isoshell
