// Kernel sets: bodies run the kernels of the set that their executor names, and every set gives the same products.
#include <type_traits>

#include "cpu/label_lanes.h"
#include "isoshell/stages.h"
#include "stages/dual_body.h"
#include "support/catch.h"
#include "support/relax_sheets.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

/// The plain kernels, and how often one of them ran.
struct CountingKernels : PlainKernels {
  static inline int calls = 0;
  struct LabelSheet {
    template <class... Arguments>
    static void run(Arguments&&... arguments) {
      ++calls;
      PlainKernels::LabelSheet::run(arguments...);
    }
  };
};
using CountingExecutor = TbbExecutorWith<CountingKernels>;

template <class Exec>
std::vector<uint32_t> labels_of_partition(const Sheet& sheet, const SeedSet& seeds, TestContext& context) {
  Exec exec(context, "dual");
  SeedSet here = to_host(seeds);
  DualReport report;
  dual::Partition<Exec> cells(exec, sheet, here, {}, report);
  return {cells.label().begin(), cells.label().end()};
}

}  // namespace

// The kernels were once chosen by what a source file included: the same partition labelled in lanes in one of them and
// plainly in another, in one executable.
static_assert(!std::is_same_v<dual::Partition<CpuExecutor>, dual::Partition<PlainExecutor>>);

TEST_CASE("kernels: bodies of different sets live side by side, each with its own kernels", "[kernels]") {
  TestContext context;
  const Sheet sheet = plate_sheet();
  const SeedSet seeds = place_seeds(sheet, {200, 3}, context);
  CountingKernels::calls = 0;
  const std::vector<uint32_t> counted = labels_of_partition<CountingExecutor>(sheet, seeds, context);
  CHECK(CountingKernels::calls == 1);
  CHECK(labels_of_partition<CpuExecutor>(sheet, seeds, context) == counted);
  CHECK(labels_of_partition<PlainExecutor>(sheet, seeds, context) == counted);
  CHECK(CountingKernels::calls == 1);
}
