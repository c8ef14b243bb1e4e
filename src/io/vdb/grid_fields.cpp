// Names of grids that are sampled.
#include "io/vdb/grid_fields.h"

#include <utility>

#include "core/hash_bytes.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

class VectorField final : public GridField {
 public:
  VectorField(const std::string& name, uint64_t digest, std::array<std::shared_ptr<const GridField>, 3> components)
      : GridField(name, digest), components_(std::move(components)) {}

  GridValues at(const std::vector<WorldPoint>& places) const override {
    GridValues all{{name(), NumberType::f32, 3, std::vector<double>(3 * places.size())}};
    for (size_t axis = 0; axis < 3; ++axis) {
      const GridValues found = components_[axis]->at(places);
      if (found.values.components != 1)
        throw Error(ErrorCode::usage, "arguments", "a component of the grid " + name() + " has vectors; give numbers");
      for (size_t i = 0; i < places.size(); ++i) all.values.values[3 * i + axis] = found.values.values[i];
      if (axis == 0) all.outside = found.outside;
    }
    return all;
  }

 private:
  const std::array<std::shared_ptr<const GridField>, 3> components_;
};

}  // namespace

// A name may hold colons; what follows the last ".vdb:" is the grid's.
GridName grid_name_of(const std::string& text) {
  const size_t at = text.rfind(".vdb:");
  if (at == std::string::npos) return {"", text};
  return {text.substr(0, at + 4), text.substr(at + 5)};
}

std::shared_ptr<const GridField> vector_field(const std::string& name,
                                              std::array<std::shared_ptr<const GridField>, 3> components) {
  const uint64_t digests[3] = {components[0]->digest(), components[1]->digest(), components[2]->digest()};
  return std::make_shared<VectorField>(name, hash_bytes(digests, sizeof digests), std::move(components));
}

}  // namespace isoshell
