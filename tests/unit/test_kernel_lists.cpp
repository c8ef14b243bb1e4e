// Kernel sets: each names every kernel, and only declares it, so that no body compiles without the header of a kernel.
#include <type_traits>

#include "cpu/cpu_kernels.h"
#include "cuda/cuda_kernels.h"
#include "stages/plain_kernels.h"
#include "support/catch.h"

using namespace isoshell;

namespace {

template <class T, class = void>
constexpr bool kIsComplete = false;
template <class T>
constexpr bool kIsComplete<T, std::void_t<decltype(sizeof(T))>> = true;

template <class... Kernels>
constexpr int declared_only() {
  return (int(!kIsComplete<Kernels>) + ...);
}
template <class Set>
constexpr int kernels_of() {
  return declared_only<typename Set::ListSiteTriangles, typename Set::LeafPasses, typename Set::Dilate,
                       typename Set::BuildShell, typename Set::FindOutside, typename Set::JoinComponents,
                       typename Set::ProjectVertices, typename Set::ListTrianglesAround, typename Set::SortKeys,
                       typename Set::LabelSheet, typename Set::Walks, typename Set::PassWork, typename Set::SplitCells,
                       typename Set::StepWork, typename Set::FlipEdges, typename Set::UndoHarm,
                       typename Set::SearchPositions, typename Set::MeshPasses>();
}

}  // namespace

TEST_CASE("kernels: every set names all of them, and its list includes none", "[kernels][unit]") {
  CHECK(kernels_of<PlainKernels>() == 18);
  CHECK(kernels_of<CpuKernels>() == 18);
  CHECK(kernels_of<CudaKernels>() == 18);
}
