// See motion_attributes.h.
#include "run/motion_attributes.h"

#include <algorithm>

namespace isoshell {
namespace {

constexpr const char* kBornName = "born";
constexpr const char* kMotionNames[3] = {"vx", "vy", "vz"};

bool is_name_of_motion(const Attribute& attribute) {
  const auto is_it = [&](const char* name) { return attribute.name == name; };
  return is_it(kBornName) || std::any_of(std::begin(kMotionNames), std::end(kMotionNames), is_it);
}

}  // namespace

void add_motion_attributes(const PreviousFrame& previous, TriangleMesh& mesh) {
  std::vector<Attribute>& all = mesh.attributes;
  all.erase(std::remove_if(all.begin(), all.end(), is_name_of_motion), all.end());
  const std::vector<uint8_t> born = born_vertices(previous, mesh);
  all.push_back({kBornName, NumberType::u8, 1, std::vector<double>(born.begin(), born.end())});
  for (int axis = 0; axis < 3; ++axis) {
    const auto along = [=](const WorldPoint& p) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; };
    std::vector<double> motion(mesh.vertices.size(), 0);
    for (size_t v = 0; v < motion.size(); ++v)
      if (!born[v]) motion[v] = along(mesh.vertices[v]) - along(previous.vertices[v]);
    all.push_back({kMotionNames[axis], NumberType::f32, 1, std::move(motion)});
  }
}

}  // namespace isoshell
