// See thin_cells.h.
#include "repair/regions/thin_cells.h"

#include <algorithm>
#include <map>

#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

class ThinCells {
 public:
  ThinCells(const Walls& walls, const Cells& cells) : walls_(walls), cells_(cells), area_(walls.triangle.size()) {
    for (size_t w = 0; w < area_.size(); ++w) {
      const auto& [a, b, c] = walls.triangle[w];
      area_[w] = triangle_area(walls.point[a], walls.point[b], walls.point[c]);
    }
  }

  /// Per cell whether it is thinner than that, and not the one outside.
  std::vector<uint8_t> thinner_than(double thin_world) const {
    std::vector<double> area(cells_.count(), 0);
    for (size_t w = 0; w < area_.size(); ++w)
      if (is_between(w))
        for (const uint32_t cell : cells_.of_wall[w]) area[cell] += area_[w];
    std::vector<uint8_t> is_thin(cells_.count(), 0);
    for (size_t cell = 1; cell < is_thin.size(); ++cell)
      is_thin[cell] = 2 * cells_.volume_world[cell] < thin_world * area[cell];
    return is_thin;
  }

  /// Cells beside others that are not thin take a label of these, and are not thin any more. Result: those that did.
  std::vector<uint32_t> join_layer(std::vector<uint8_t>& is_thin, std::vector<int32_t>& label) const {
    std::map<uint32_t, std::map<int32_t, double>> beside;  // per cell and label the area of the walls between them
    for (size_t w = 0; w < area_.size(); ++w) {
      const auto& [front, back] = cells_.of_wall[w];
      if (is_thin[front] && !is_thin[back]) beside[front][label[back]] += area_[w];
      if (is_thin[back] && !is_thin[front]) beside[back][label[front]] += area_[w];
    }
    std::vector<uint32_t> joined;
    for (const auto& [cell, labels] : beside) {
      const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
      label[cell] = std::max_element(labels.begin(), labels.end(), less)->first;
      joined.push_back(cell);
    }
    for (const uint32_t cell : joined) is_thin[cell] = 0;
    return joined;
  }

  WorldPoint corner_of(uint32_t cell) const {
    size_t w = 0;
    while (!is_between(w) || (cells_.of_wall[w][0] != cell && cells_.of_wall[w][1] != cell)) ++w;
    return walls_.point[walls_.triangle[w][0]];
  }

 private:
  bool is_between(size_t wall) const { return cells_.of_wall[wall][0] != cells_.of_wall[wall][1]; }

  const Walls& walls_;
  const Cells& cells_;
  std::vector<double> area_;  ///< per wall
};

/// Cells with labels that no others have stay as they are.
void keep_last_of_labels(const std::vector<int32_t>& label, std::vector<uint8_t>& is_thin) {
  const auto count = size_t(*std::max_element(label.begin(), label.end())) + 1;
  std::vector<uint8_t> has_others(count, 0);
  for (size_t cell = 0; cell < label.size(); ++cell)
    if (!is_thin[cell]) has_others[size_t(label[cell])] = 1;
  for (size_t cell = 0; cell < label.size(); ++cell)
    if (!has_others[size_t(label[cell])]) is_thin[cell] = 0;
}

}  // namespace

JoinedCells join_thin_cells(const Walls& walls, const Cells& cells, double thin_world, bool each_has_its_own,
                            std::vector<int32_t>& label) {
  JoinedCells out;
  if (thin_world <= 0) return out;
  const ThinCells thin(walls, cells);
  std::vector<uint8_t> is_thin = thin.thinner_than(thin_world);
  if (!each_has_its_own) keep_last_of_labels(label, is_thin);
  for (;;) {
    const std::vector<int32_t> before = label;
    const std::vector<uint32_t> joined = thin.join_layer(is_thin, label);
    if (joined.empty()) return out;
    for (const uint32_t cell : joined) {
      if (label[cell] == before[cell]) continue;
      if (out.count++ == 0) out.first = thin.corner_of(cell);
    }
  }
}

}  // namespace isoshell::repair
