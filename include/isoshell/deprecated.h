// Names of 0.1 that changed, for one release.
#pragma once

#include "isoshell/boolean_union.h"
#include "isoshell/repair.h"
#include "isoshell/stages.h"

namespace isoshell {

using PostOptions [[deprecated("OptimizeOptions")]] = OptimizeOptions;
using PostReport [[deprecated("OptimizeReport")]] = OptimizeReport;
using MendOptions [[deprecated("RepairOptions")]] = RepairOptions;
using MendReport [[deprecated("RepairReport")]] = RepairReport;
using UniteOptions [[deprecated("UnionOptions")]] = UnionOptions;
using UniteReport [[deprecated("UnionReport")]] = UnionReport;

[[deprecated("optimize_mesh")]] inline OptimizeReport improve_mesh(const SurfaceMesh& surface,
                                                                   const OptimizeOptions& options, SeedSet& seeds,
                                                                   DualMesh& mesh, Context& context) {
  return optimize_mesh(surface, options, seeds, mesh, context);
}
[[deprecated("build_proxy")]] inline Sheet build_outline(const SiteSet& sites, const LatticeFrame& frame,
                                                         const SheetOptions& options, Context& context) {
  return build_proxy(sites, frame, options, context);
}
[[deprecated("repair_soup")]] inline TriangleSoup mend(const TriangleSoup& soup, const RepairOptions& options,
                                                       RepairReport& report) {
  return repair_soup(soup, options, report);
}
[[deprecated("boolean_union")]] inline TriangleSoup unite(const TriangleSoup& soup, const UnionOptions& options,
                                                          UnionReport& report, const Context& context) {
  return boolean_union(soup, options, report, context);
}

}  // namespace isoshell
