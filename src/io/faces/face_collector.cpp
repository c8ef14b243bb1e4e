// Faces of a file into triangles, one collector a chunk; then all chunks into one soup.
#include "io/faces/face_collector.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <numeric>

#include "core/parallel_ranges.h"

namespace isoshell {
namespace {

constexpr int64_t kGrain = 1 << 14;
constexpr int64_t kSplittingBytes = 200;  // of a corner of the largest polygon, while its ears are clipped

template <class Test>
int64_t count_where(int64_t count, Test test) {
  return sum_over_ranges(count, kGrain, [&](int64_t begin, int64_t end) {
    int64_t sum = 0;
    for (int64_t i = begin; i < end; ++i) sum += test(i) ? 1 : 0;
    return sum;
  });
}

int64_t count_unreferenced(const std::vector<WorldPoint>& points, const std::vector<Triangle>& triangles) {
  const int64_t count = int64_t(points.size());
  std::unique_ptr<std::atomic<uint8_t>[]> used(new std::atomic<uint8_t>[points.size()]());
  for_ranges(int64_t(triangles.size()), kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t t = begin; t < end; ++t)
      for (const uint32_t corner : triangles[size_t(t)]) used[corner].store(1, std::memory_order_relaxed);
  });
  return count_where(count, [&](int64_t i) { return !used[size_t(i)].load(std::memory_order_relaxed); });
}

std::string nothing_left(const TriangleSoup& soup) {
  const auto number = [](int64_t n) { return std::to_string(n); };
  if (soup.faces_in_file == 0)
    return "holds " + number(int64_t(soup.vertices.size())) + " vertices and no face; give a file with faces";
  return "none of its " + number(soup.faces_in_file) + " faces is usable: " + number(soup.dirt.short_faces) +
         " with fewer than three corners, " + number(soup.dirt.degenerate_faces) + " with repeated corners, " +
         number(soup.dirt.dropped_faces_nonfinite) + " at vertices that are not finite; repair the file";
}

}  // namespace

VertexTable::VertexTable(const MeshSource& from, int64_t count) : source(&from) {
  if (count > kMaxSoupVertices)
    from.refuse("holds " + std::to_string(count) + " vertices; at most " + std::to_string(kMaxSoupVertices) +
                " can be read, split the file");
  resize_counted(from, points, size_t(count));
}

void VertexTable::count_nonfinite() {
  nonfinite = count_where(int64_t(points.size()), [&](int64_t i) { return !is_finite(points[size_t(i)]); });
}

void FaceCollector::add_polygon(const uint32_t* corners, int64_t count) {
  if (count == 3) return add_triangle(corners[0], corners[1], corners[2]);
  ++faces_;
  if (count < 3) {
    ++dirt_.short_faces;
    return;
  }
  if (vertices_->nonfinite && !std::all_of(corners, corners + count, [&](uint32_t i) { return finite(i); })) {
    ++dirt_.dropped_faces_nonfinite;
    return;
  }
  reserve(count - 2);
  if (count > int64_t(corners_.capacity()))
    vertices_->source->take((count - int64_t(corners_.capacity())) * kSplittingBytes);
  corners_.assign(corners, corners + count);
  corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
  while (corners_.size() > 1 && corners_.back() == corners_.front()) corners_.pop_back();
  const size_t before = triangles_.size();
  if (corners_.size() >= 3)
    splitter_.split(vertices_->points.data(), corners_.data(), int64_t(corners_.size()), triangles_);
  if (triangles_.size() == before) ++dirt_.degenerate_faces;
  if (keeps_faces_) face_of_.resize(triangles_.size(), uint32_t(faces_ - 1));
}

void FaceCollector::adopt(std::vector<Triangle> triangles) {
  const int64_t dirty = count_where(int64_t(triangles.size()), [&](int64_t i) {
    const auto [a, b, c] = triangles[size_t(i)];
    return a == b || b == c || c == a || (vertices_->nonfinite && !(finite(a) && finite(b) && finite(c)));
  });
  if (dirty == 0) {
    faces_ += int64_t(triangles.size());
    triangles_ = std::move(triangles);
    if (keeps_faces_) {
      resize_counted(*vertices_->source, face_of_, triangles_.size());
      std::iota(face_of_.begin(), face_of_.end(), 0);
    }
  } else {
    for (const auto& [a, b, c] : triangles) add_triangle(a, b, c);
  }
}

void FaceCollector::add_strip(const uint32_t* corners, int64_t count) {
  ++faces_;
  if (count < 3) ++dirt_.short_faces;
  for (int64_t i = 2; i < count; ++i) {
    const uint32_t a = corners[i - 2], b = corners[i - 1], c = corners[i];
    if (a == b || b == c || c == a) continue;
    if (vertices_->nonfinite && !(finite(a) && finite(b) && finite(c))) {
      ++dirt_.dropped_faces_nonfinite;
    } else if (i % 2 == 0) {
      push({a, b, c});
    } else {
      push({b, a, c});
    }
  }
  if (keeps_faces_) resize_counted(*vertices_->source, face_of_, triangles_.size(), uint32_t(faces_ - 1));
}

TriangleSoup join_parts(VertexTable vertices, std::vector<FaceCollector>& parts) {
  const MeshSource& source = *vertices.source;
  TriangleSoup soup;
  std::vector<size_t> start(parts.size() + 1, 0);
  for (size_t i = 0; i < parts.size(); ++i) {
    const FaceCollector& part = parts[i];
    start[i + 1] = start[i] + part.triangles_.size();
    soup.faces_in_file += part.faces_;
    soup.dirt.short_faces += part.dirt_.short_faces;
    soup.dirt.degenerate_faces += part.dirt_.degenerate_faces;
    soup.dirt.dropped_faces_nonfinite += part.dirt_.dropped_faces_nonfinite;
  }
  soup.vertices = std::move(vertices.points);
  if (parts.size() == 1) {
    soup.triangles = std::move(parts[0].triangles_);
  } else {
    resize_counted(source, soup.triangles, start.back());
    for_each_index(size_t(0), parts.size(), [&](size_t i) {
      std::copy(parts[i].triangles_.begin(), parts[i].triangles_.end(), soup.triangles.begin() + int64_t(start[i]));
      release(source, parts[i].triangles_);
    });
  }
  soup.dirt.nonfinite_vertices = vertices.nonfinite;
  const HeldBytes flags(source, int64_t(soup.vertices.size()));
  soup.dirt.unreferenced_vertices = count_unreferenced(soup.vertices, soup.triangles) - vertices.nonfinite;
  return soup;
}

void require_triangles(const MeshSource& source, const TriangleSoup& soup) {
  if (soup.triangles.empty()) source.nothing_to_mesh(nothing_left(soup));
}

TriangleSoup join_soup(const MeshSource& source, VertexTable vertices, std::vector<FaceCollector>& parts) {
  TriangleSoup soup = join_parts(std::move(vertices), parts);
  require_triangles(source, soup);
  return soup;
}

}  // namespace isoshell
