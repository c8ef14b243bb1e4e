// are_sheets_in_order, keeps_sheets_in_order (see sheet_order.h).
#include "features/walls/sheet_order.h"

#include <algorithm>
#include <cmath>

namespace isoshell {
namespace {

constexpr double kOnEachOther = 1e-9;  ///< radians

/// Of a triangle at an edge: the way that it leaves it, around it, and the regions at its sides, the second one where
/// angles are larger.
struct Sheet {
  double angle;
  int32_t before, behind;
};

class EdgeSheets {
 public:
  EdgeSheets(const EditableMesh& mesh, const MeshChange& change, const PatchLabels& labels)
      : mesh_(mesh), change_(change), labels_(labels) {}

  bool are_in_order(uint32_t u, uint32_t v) {
    u_ = u, v_ = v;
    sheets_.clear();
    const WorldPoint along = normalised(mesh_.at(v) - mesh_.at(u));
    const std::array<double, 3> size{std::abs(along.x), std::abs(along.y), std::abs(along.z)};
    const size_t least = size_t(std::min_element(size.begin(), size.end()) - size.begin());
    const WorldPoint axis{least == 0 ? 1. : 0., least == 1 ? 1. : 0., least == 2 ? 1. : 0.};
    x_ = normalised(cross(along, axis)), y_ = cross(along, x_);
    for (const RegionTriangle& t : change_.made) add(t);
    mesh_.for_each_around(u, [&](uint32_t t) {
      if (std::find(change_.replaced.begin(), change_.replaced.end(), t) == change_.replaced.end())
        add(mesh_.triangles()[t]);
    });
    if (sheets_.size() < 3) return true;
    std::sort(sheets_.begin(), sheets_.end(), [](const Sheet& a, const Sheet& b) { return a.angle < b.angle; });
    // Of sheets that lie on each other the next one is any that follows; a sheet that lies on no other comes first.
    const size_t count = sheets_.size();
    size_t first = 0;
    while (first < count && (is_tie(first) || is_tie((first + count - 1) % count))) ++first;
    if (first == count) return true;
    std::rotate(sheets_.begin(), sheets_.begin() + int64_t(first), sheets_.end());
    for (Sheet& sheet : sheets_)
      if (sheet.angle < sheets_[0].angle) sheet.angle += 2 * std::acos(-1.);
    for (size_t i = 1; i < count; ++i) {
      for (size_t j = i; sheets_[i].before != sheets_[i - 1].behind && j + 1 < count && is_tie(j); ++j)
        std::swap(sheets_[i], sheets_[j + 1]);
      if (sheets_[i].before != sheets_[i - 1].behind) return false;
    }
    return sheets_.back().behind == sheets_.front().before;
  }

 private:
  /// Whether a sheet lies on the next one.
  bool is_tie(size_t i) const {
    const bool is_last = i + 1 == sheets_.size();
    const double next = is_last ? sheets_.front().angle + 2 * std::acos(-1.) : sheets_[i + 1].angle;
    return next - sheets_[i].angle <= kOnEachOther;
  }
  void add(const RegionTriangle& t) {
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = t.corner[i], b = t.corner[(i + 1) % 3];
      if ((a != u_ || b != v_) && (a != v_ || b != u_)) continue;
      const WorldPoint way = mesh_.at(t.corner[(i + 2) % 3]) - mesh_.at(u_);
      const auto& [inside, outside] = labels_[t.patch];
      const bool is_along = a == u_;
      sheets_.push_back(
          {std::atan2(dot(way, y_), dot(way, x_)), is_along ? inside : outside, is_along ? outside : inside});
    }
  }

  const EditableMesh& mesh_;
  const MeshChange& change_;
  const PatchLabels& labels_;
  uint32_t u_ = 0, v_ = 0;
  WorldPoint x_{0, 0, 0}, y_{0, 0, 0};
  std::vector<Sheet> sheets_;
};

}  // namespace

bool are_sheets_in_order(const EditableMesh& mesh, const MeshChange& change, const PatchLabels& labels) {
  if (labels.empty()) return true;
  EdgeSheets sheets(mesh, change, labels);
  for (const RegionTriangle& t : change.made)
    for (size_t i = 0; i < 3; ++i)
      if (t.curve[i] != kNone && !sheets.are_in_order(t.corner[i], t.corner[(i + 1) % 3])) return false;
  return true;
}

bool keeps_sheets_in_order(const EditableMesh& mesh, const MeshChange& change, const PatchLabels& labels) {
  if (are_sheets_in_order(mesh, change, labels)) return true;
  MeshChange nothing;
  for (const uint32_t t : change.replaced) nothing.made.push_back(mesh.triangles()[t]);
  nothing.replaced = change.replaced;
  return !are_sheets_in_order(mesh, nothing, labels);
}

}  // namespace isoshell
