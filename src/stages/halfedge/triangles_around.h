// The triangles around each vertex of a surface, on the host.
#pragma once

#include <utility>

#include "core/buckets.h"
#include "isoshell/advanced/surface_mesh.h"

namespace isoshell {

inline void list_triangles_around(SurfaceMesh& surface) {
  Buckets<uint32_t, uint32_t> around =
      sort_into_buckets<uint32_t, uint32_t>(surface.vertex_count(), surface.triangles.size(), [&](int64_t t, auto put) {
        const TriangleIndices i = surface.triangles[t];
        for (const uint32_t v : {i.a, i.b, i.c}) put(v, uint32_t(t));
      });
  surface.vertex_first = std::move(around.first);
  surface.vertex_triangles = std::move(around.items);
}

}  // namespace isoshell
