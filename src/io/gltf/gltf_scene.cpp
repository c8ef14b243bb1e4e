#include "io/gltf/gltf_scene.h"

#include <algorithm>
#include <cmath>

namespace isoshell {
namespace {

using Json = GltfDocument::Json;
constexpr double kRoundOff = 1e-6;  // of a single precision number near 1

std::string numbered(const char* array, int64_t index) {
  return std::string(array) + "[" + std::to_string(index) + "]";
}

GltfTransform operator*(const GltfTransform& a, const GltfTransform& b) {
  if (a.is_identity) return b;
  if (b.is_identity) return a;
  GltfTransform product;
  product.is_identity = false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      product.m[i][j] =
          a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0);
  return product;
}

void set_rotation(const double q[4], double m[3][4]) {
  const double x = q[0], y = q[1], z = q[2], w = q[3], square = x * x + y * y + z * z + w * w;
  const double s = square > 0 ? 2 / square : 0;  // those that are not of length 1 turn all the same
  const double rotation[3][3] = {{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
                                 {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)},
                                 {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)}};
  for (int i = 0; i < 3; ++i) std::copy(rotation[i], rotation[i] + 3, m[i]);
}

GltfTransform transform_of(const GltfDocument& document, const Json& node, const std::string& place) {
  GltfTransform t;
  double matrix[16], translation[3] = {0, 0, 0}, rotation[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
  if (document.numbers(node, "matrix", place, matrix, 16)) {
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 3; ++i) t.m[i][j] = matrix[4 * j + i];
      if (!(std::abs(matrix[4 * j + 3] - (j == 3 ? 1 : 0)) <= kRoundOff))
        document.refuse(place + ".matrix", " has another last row than 0, 0, 0, 1; write it as an affine transform");
    }
  } else {
    document.numbers(node, "translation", place, translation, 3);
    document.numbers(node, "rotation", place, rotation, 4);
    document.numbers(node, "scale", place, scale, 3);
    set_rotation(rotation, t.m);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) t.m[i][j] *= scale[j];
      t.m[i][3] = translation[i];
    }
  }
  const GltfTransform identity;
  t.is_identity = std::equal(&t.m[0][0], &t.m[0][0] + 12, &identity.m[0][0]);
  return t;
}

/// Walks down without recursion: files may nest nodes as deeply as they like.
class Walk {
 public:
  explicit Walk(const GltfDocument& document) : document_(document) {
    visited_.resize(document.list(document.json(), "nodes").size(), 0);
  }

  void from(const Json& roots, const std::string& place) {
    push(roots, place, {});
    while (!left_.empty()) {
      const Step step = left_.back();
      left_.pop_back();
      visit(step);
    }
  }
  std::vector<GltfInstance> taken() { return std::move(instances_); }

 private:
  struct Step {
    int64_t node;
    GltfTransform parent;
  };

  void push(const Json& nodes, const std::string& place, const GltfTransform& parent) {
    for (size_t i = nodes.size(); i-- > 0;) {
      if (!nodes[i].is_number_unsigned() || nodes[i].get<uint64_t>() >= visited_.size())
        document_.refuse(place + "[" + std::to_string(i) + "]",
                         " is " + nodes[i].dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, 40) +
                             "; the file has " + std::to_string(visited_.size()) + " nodes");
      left_.push_back({nodes[i].get<int64_t>(), parent});
    }
  }

  void visit(const Step& step) {
    const std::string place = numbered("nodes", step.node);
    if (visited_[size_t(step.node)]) document_.refuse(place, " is a child twice, or of its own; nodes must be trees");
    visited_[size_t(step.node)] = 1;
    const Json& node = document_.element("nodes", step.node, place);
    const GltfTransform to_world = step.parent * transform_of(document_, node, place);
    if (const auto mesh = document_.integer(node, "mesh", place)) {
      document_.element("meshes", *mesh, place + ".mesh");
      instances_.push_back({*mesh, to_world, node.contains("skin")});
    }
    push(document_.list(node, "children", place), place + ".children", to_world);
  }

  const GltfDocument& document_;
  std::vector<char> visited_;
  std::vector<Step> left_;
  std::vector<GltfInstance> instances_;
};

/// Nodes that are no child of another.
Json roots_of(const GltfDocument& document) {
  const Json& nodes = document.list(document.json(), "nodes");
  std::vector<char> is_child(nodes.size(), 0);
  for (size_t n = 0; n < nodes.size(); ++n) {
    const std::string place = numbered("nodes", int64_t(n));
    for (const Json& child : document.list(document.element("nodes", int64_t(n), place), "children", place))
      if (child.is_number_unsigned() && child.get<uint64_t>() < nodes.size()) is_child[child.get<size_t>()] = 1;
  }
  Json roots = Json::array();
  for (size_t n = 0; n < nodes.size(); ++n)
    if (!is_child[n]) roots.push_back(n);
  return roots;
}

}  // namespace

WorldPoint GltfTransform::point(const WorldPoint& p) const {
  if (is_identity) return p;
  const auto row = [&](int i) { return m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3]; };
  return {row(0), row(1), row(2)};
}

namespace {

double cofactor(const double m[3][4], int i, int j) {
  const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
  return m[a][c] * m[b][d] - m[a][d] * m[b][c];
}

}  // namespace

WorldPoint GltfTransform::normal(const WorldPoint& n) const {
  if (is_identity) return n;
  const double sign = mirrors() ? -1 : 1;
  const auto row = [&](int i) {
    return sign * (cofactor(m, i, 0) * n.x + cofactor(m, i, 1) * n.y + cofactor(m, i, 2) * n.z);
  };
  return {row(0), row(1), row(2)};
}

bool GltfTransform::mirrors() const {
  return m[0][0] * cofactor(m, 0, 0) + m[0][1] * cofactor(m, 0, 1) + m[0][2] * cofactor(m, 0, 2) < 0;
}

std::vector<GltfInstance> instances_of(const GltfDocument& document) {
  const Json& json = document.json();
  if (document.list(json, "nodes").empty()) {
    std::vector<GltfInstance> all;
    for (size_t i = 0; i < document.list(json, "meshes").size(); ++i) {
      document.element("meshes", int64_t(i), numbered("meshes", int64_t(i)));
      all.push_back({int64_t(i), {}, false});
    }
    return all;
  }
  Walk walk(document);
  const auto scene = document.integer(json, "scene", "the file");
  if (scene || !document.list(json, "scenes").empty()) {
    const std::string place = numbered("scenes", scene.value_or(0));
    walk.from(document.list(document.element("scenes", scene.value_or(0), "scene"), "nodes", place), place + ".nodes");
  } else {
    walk.from(roots_of(document), "nodes");
  }
  return walk.taken();
}

}  // namespace isoshell
