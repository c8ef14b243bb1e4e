// A kernel for every band.
#include "cuda/shell/reach_kernel.cuh"
#include "cuda/shell/shell_masks.h"

namespace isoshell {
namespace {

template <int kBand>
closest::Transform growth(CudaExecutor& exec, int32_t band_vox) {
  if constexpr (kBand < kMaxBandVox)
    if (band_vox > kBand) return growth<kBand + 1>(exec, band_vox);
  constexpr int kWarps = reach::kWarps<kBand>;
  return transform_of(exec, reach::grow_sites<kBand>, kWarps, kWarps * sizeof(reach::Shared<kBand>));
}

}  // namespace

void find_shell_masks(CudaExecutor& exec, const closest::Arguments& arguments) {
  growth<1>(exec, arguments.in.band_vox).run(exec, arguments, "shell masks");
}

}  // namespace isoshell
