// See lay_on_sheet.h.
#include "pipeline/patches/lay_on_sheet.h"

#include "core/copy_product.h"
#include "core/watched.h"
#include "pipeline/patches/new_crossings.h"

namespace isoshell {
namespace {

constexpr int kMostRounds = 5;

/// Result: whether any of the vertices was elsewhere.
bool take_back(const TrianglePairs& pairs, LaidCurves& laid) {
  bool any = false;
  for (const auto& pair : pairs)
    for (const uint32_t t : pair)
      for (const uint32_t v : laid.mesh.triangles[t]) any |= laid.take_back(v);
  return any;
}

}  // namespace

LaidCurves lay_on_sheet(const FeatureMesh& mesh, const CurveNetwork& network, const PreparedSurface& p,
                        Context& context) {
  const UntangledSheet sheet = untangle_sheet(host_copy(p.sheet), {}, context);
  LaidCurves laid = run_with_threads(context, [&] {
    LaidCurves all = lay_curves(mesh, network, *OnHost(sheet.sheet));
    for (int round = 0; round < kMostRounds; ++round) {
      if (!take_back(crossings_of(all.mesh, p.sheet.frame, context), all)) break;
      all.take_back_turned();
    }
    return all;
  });
  check_cancel(context, "features");
  return laid;
}

}  // namespace isoshell
