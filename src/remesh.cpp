// Algorithm 1 of the paper, readable as such.
#include "isoshell/remesh.h"

#include "isoshell/error.h"

namespace isoshell {

RemeshResult remesh(const TriangleSoup&, const RemeshOptions&, Context&) {
  throw Error(ErrorCode::internal, "remesh", "remesh is missing");
}

}  // namespace isoshell
