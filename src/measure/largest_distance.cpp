// Branch and bound: of all pieces those that may be the farthest are split, so many at a time whatever the threads.
#include "measure/largest_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kWithin = 2e-3;          ///< of the distance
constexpr double kWithinDiagonal = 1e-9;  ///< of the diagonal
constexpr size_t kMostSplits = 1000000;   ///< some seconds
constexpr size_t kAtATime = 16384;
constexpr size_t kChunk = 512;

struct Corner {
  WorldPoint at;
  double distance;
  uint32_t nearest;
};

/// A triangle, or a part of one.
struct Piece {
  std::array<Corner, 3> corners;
  double at_most;    ///< the distance of all its points
  uint32_t bounder;  ///< the triangle that says so
};

class Search {
 public:
  Search(const TriangleMesh& mesh, const TriangleGrid& to, double diagonal, const Context& context)
      : mesh_(mesh), to_(to), least_excess_(kWithinDiagonal * diagonal), context_(context) {}

  LargestDistance run() {
    std::vector<Piece> pieces = whole_triangles();
    for (size_t splits = 0; splits < kMostSplits; splits += kAtATime) {
      discard_near(pieces);
      if (pieces.empty()) break;
      const std::vector<Piece> smaller = split(take_farthest(pieces));
      pieces.insert(pieces.end(), smaller.begin(), smaller.end());
    }
    discard(pieces.begin(), pieces.end());
    return {found_, std::max(found_, most_of_discarded_)};
  }

 private:
  /// What some pieces lead to.
  struct Part {
    std::vector<Piece> pieces;
    double found = 0, most_of_discarded = 0;
  };

  Corner corner(const WorldPoint& p) const {
    const MeshPoint nearest = to_.nearest(p);
    return {p, std::sqrt(nearest.distance_sq), nearest.triangle};
  }
  static Corner none() { return {{}, 0, MeshPoint::kNoTriangle}; }

  double enough() const { return found_ + std::max(kWithin * found_, least_excess_); }

  void bound(Piece& piece, uint32_t triangle) const {
    double farthest = 0;
    for (const Corner& c : piece.corners)
      farthest = std::max(farthest, c.nearest == triangle ? c.distance : to_.distance_to(triangle, c.at));
    if (farthest < piece.at_most) {
      piece.at_most = farthest;
      piece.bounder = triangle;
    }
  }

  void add(Piece piece, Part& part) const {
    const auto& [a, b, c] = piece.corners;
    for (const uint32_t triangle : {a.nearest, b.nearest, c.nearest}) bound(piece, triangle);
    if (piece.at_most > enough())
      part.pieces.push_back(piece);
    else
      part.most_of_discarded = std::max(part.most_of_discarded, piece.at_most);
  }

  /// Of `count` things in chunks, joined in their order.
  template <class Work>
  std::vector<Piece> in_parts(size_t count, Work work) {
    std::vector<Part> parts((count + kChunk - 1) / kChunk);
    for_each_index(size_t(0), parts.size(), [&](size_t c) {
      for (size_t i = c * kChunk; i < std::min(count, (c + 1) * kChunk); ++i) {
        if (context_.cancel.load(std::memory_order_relaxed)) return;
        work(i, parts[c]);
      }
    });
    check_cancel(context_, "distance");
    size_t size = 0;
    for (const Part& part : parts) size += part.pieces.size();
    std::vector<Piece> all;
    all.reserve(size);
    for (Part& part : parts) {
      found_ = std::max(found_, part.found);
      most_of_discarded_ = std::max(most_of_discarded_, part.most_of_discarded);
      all.insert(all.end(), part.pieces.begin(), part.pieces.end());
      part.pieces = {};
    }
    return all;
  }

  std::vector<Piece> whole_triangles() {
    std::vector<uint8_t> used(mesh_.vertices.size());
    for (const auto& t : mesh_.triangles)
      for (const uint32_t v : t) used[v] = 1;
    std::vector<Corner> corners(used.size(), none());
    in_parts(used.size(), [&](size_t v, Part& part) {
      if (!used[v]) return;
      corners[v] = corner(mesh_.vertices[v]);
      part.found = std::max(part.found, corners[v].distance);
    });
    return in_parts(mesh_.triangles.size(), [&](size_t t, Part& part) {
      const auto& [a, b, c] = mesh_.triangles[t];
      const WorldPoint middle = 1. / 3 * (corners[a].at + corners[b].at + corners[c].at);
      const uint32_t nearest = to_.nearest(middle).triangle;  // corners are often as near to others
      Piece piece{{corners[a], corners[b], corners[c]}, std::numeric_limits<double>::infinity(), nearest};
      bound(piece, nearest);
      add(piece, part);
    });
  }

  void discard(std::vector<Piece>::iterator begin, std::vector<Piece>::iterator end) {
    for (; begin != end; ++begin) most_of_discarded_ = std::max(most_of_discarded_, begin->at_most);
  }
  void discard_near(std::vector<Piece>& pieces) {
    const auto near =
        std::partition(pieces.begin(), pieces.end(), [&](const Piece& p) { return p.at_most > enough(); });
    discard(near, pieces.end());
    pieces.erase(near, pieces.end());
  }
  /// Removes those that may be the farthest.
  static std::vector<Piece> take_farthest(std::vector<Piece>& pieces) {
    const auto first = pieces.end() - std::ptrdiff_t(std::min(kAtATime, pieces.size()));
    std::nth_element(pieces.begin(), first, pieces.end(),
                     [](const Piece& a, const Piece& b) { return a.at_most < b.at_most; });
    std::vector<Piece> taken(first, pieces.end());
    pieces.erase(first, pieces.end());
    return taken;
  }

  std::vector<Piece> split(const std::vector<Piece>& pieces) {
    return in_parts(pieces.size(), [&](size_t i, Part& part) {
      const auto& [a, b, c] = pieces[i].corners;
      const auto between = [&](const Corner& p, const Corner& q) {
        const Corner middle = corner(.5 * (p.at + q.at));
        part.found = std::max(part.found, middle.distance);
        return middle;
      };
      const Corner ab = between(a, b), bc = between(b, c), ca = between(c, a);
      for (const auto& corners : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
        Piece piece{corners, pieces[i].at_most, pieces[i].bounder};
        bound(piece, pieces[i].bounder);
        add(piece, part);
      }
    });
  }

  const TriangleMesh& mesh_;
  const TriangleGrid& to_;
  double least_excess_;
  const Context& context_;
  double found_ = 0, most_of_discarded_ = 0;
};

}  // namespace

LargestDistance largest_distance(const TriangleMesh& mesh, const TriangleGrid& to, double diagonal,
                                 const Context& context) {
  return Search(mesh, to, diagonal, context).run();
}

}  // namespace isoshell
