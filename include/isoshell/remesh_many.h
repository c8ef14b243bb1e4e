// Many surfaces, one after the other, meshed side by side. Small meshes fill a machine, or a device, only that way.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "isoshell/error.h"
#include "isoshell/remesh.h"

namespace isoshell {

/// What became of one surface.
struct ManyResult {
  int64_t index = 0;           ///< among the inputs, from 0
  RemeshResult made;           ///< empty where there is an error
  std::optional<Error> error;  ///< why there is no mesh
};

/// Both functions are called by the thread that calls remesh_many(). What they throw ends it: so who wants to stop at
/// the first error throws it from `take`.
struct ManyRequest {
  std::function<std::optional<TriangleSoup>()> next;  ///< the next surface, or nothing when there are no more
  std::function<void(ManyResult)> take;               ///< called with each result, in the order of the surfaces
  int workers = 0;                                    ///< 0: as many as fill the machine, see Workers
  int64_t most_under_way = 0;  ///< surfaces that were taken and not handed out yet; 0: four a worker
};

/// Remeshes what `next` gives, each surface as remesh() does with these options, to the same bytes. `context` says
/// where and how, as it does for Workers, and its `cancel` ends all at the next look; its memory limit is that of each
/// run. No surface is asked for before there is room for it, so memory stays bounded, however many come. For other work
/// on many inputs, as whole runs from file to file, see Workers. Result: how many there were. Throws: interrupted,
/// no_device, and what `next` and `take` throw.
int64_t remesh_many(const ManyRequest& request, const RemeshOptions& options, Context& context);

}  // namespace isoshell
