// Frames of a sequence that are made of patches do without a sheet, until something fails.
#pragma once

#include <optional>

#include "pipeline/patches/patches.h"

namespace isoshell {

inline bool has_sheet(const Prepared& p) { return p.sheet.vertex_count() > 0; }

/// Whether a frame takes the first grid when its surface can be cut along curves there, whatever topology a sheet has
/// on it: it begins with the frame before, the options say nothing that only a sheet can answer, and the surface is one
/// that needs no walls grown and no gaps closed.
bool may_be_cut_at_once(const RemeshOptions& options, const InputTopology& input, bool has_caps);

/// The surface, cut along its curves on its own triangles, without sites, samples and sheet. None where it cannot be
/// cut so: the report is as before then.
std::optional<Prepared> prepare_patches_alone(LatticeSurface surface, const RemeshOptions& options,
                                              const PatchSource& source, RemeshReport& report, Context& context);

/// A prepared surface with its sheet, which is made when it is asked for first.
class SheetWhenNeeded {
 public:
  SheetWhenNeeded(const Prepared& prepared, const RemeshOptions& options, Context& context)
      : prepared_(prepared), options_(options), context_(context) {}
  /// Says what the sheet is in the report where it makes one.
  const Prepared& get(RemeshReport& report);

 private:
  const Prepared& prepared_;
  const RemeshOptions& options_;
  Context& context_;
  std::optional<Prepared> made_;
};

}  // namespace isoshell
