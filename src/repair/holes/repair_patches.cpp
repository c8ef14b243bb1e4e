#include "repair/holes/repair_patches.h"

#include <algorithm>

#include "core/buckets.h"
#include "core/index_sets.h"
#include "repair/holes/repair_junctions.h"

namespace isoshell::repair {
namespace {

constexpr double kLargestFin = .005;  // of the whole area
constexpr double kLargestIsland = .01;
constexpr double kFinsTogether = .1;  // more than this is no dirt on a surface, it is the surface
constexpr double kIslandsTogether = .05;

/// Calls with every half-edge of a face whose edge has two faces, and its twin.
template <class Visit>
void for_each_neighbour(const RepairMesh& mesh, uint32_t f, Visit visit) {
  for (uint32_t h = 3 * f; h < 3 * f + 3; ++h)
    if (mesh.faces_at(mesh.edge_of(h)) == 2) visit(h, mesh.twin(h));
}

/// Per patch the area of all that joins lead to from it.
std::vector<double> areas_of_joined(const Patches& patches, const std::vector<std::array<uint32_t, 2>>& joins,
                                    std::vector<double> area) {
  IndexSets sets(patches.count);
  for (const auto& [f, g] : joins) sets.unite(patches.of[f], patches.of[g]);
  std::vector<double> together(patches.count, 0);
  for (uint32_t p = 0; p < patches.count; ++p) together[sets.root(p)] += area[p];
  for (uint32_t p = 0; p < patches.count; ++p) area[p] = together[sets.root(p)];
  return area;
}

/// The faces of the patches in a list, patch by patch.
class PatchFaces {
 public:
  PatchFaces(const Patches& patches, const std::vector<uint32_t>& listed) {
    std::vector<uint32_t> place(patches.count, kNoFace);
    for (uint32_t i = 0; i < listed.size(); ++i) place[listed[i]] = i;
    faces_ = sort_into_buckets<uint32_t>(int64_t(listed.size()), int64_t(patches.of.size()), [&](int64_t f, auto put) {
      const uint32_t patch = patches.of[size_t(f)];
      if (patch != kNoFace && place[patch] != kNoFace) put(place[patch], uint32_t(f));
    });
  }
  const uint32_t* begin(size_t i) const { return faces_.in(int64_t(i)).begin(); }
  const uint32_t* end(size_t i) const { return faces_.in(int64_t(i)).end(); }

 private:
  Buckets<uint32_t> faces_;
};

/// Whether a patch ends in the open and on edges of more than two faces, and none of those opens without it.
bool is_fin(const RepairMesh& mesh, const uint32_t* begin, const uint32_t* end) {
  std::vector<uint32_t> rim;
  for (const uint32_t* f = begin; f != end; ++f)
    for (uint32_t h = 3 * *f; h < 3 * *f + 3; ++h)
      if (mesh.faces_at(mesh.edge_of(h)) != 2) rim.push_back(mesh.edge_of(h));
  std::sort(rim.begin(), rim.end());
  bool in_the_open = false, on_others = false;
  for (size_t i = 0, stop; i < rim.size(); i = stop) {
    for (stop = i; stop < rim.size() && rim[stop] == rim[i];) ++stop;
    const uint32_t left = mesh.faces_at(rim[i]) - uint32_t(stop - i);
    if (left == 1) return false;
    (left == 0 ? in_the_open : on_others) = true;
  }
  return in_the_open && on_others;
}

bool drop_fins_once(RepairMesh& mesh, RepairReport& report) {
  const Patches patches = find_patches(mesh);
  const std::vector<double> area = patch_areas(mesh, patches);
  const double whole = live_area(mesh);
  std::vector<uint32_t> small;
  for (uint32_t p = 0; p < patches.count; ++p)
    if (area[p] < kLargestFin * whole) small.push_back(p);
  std::sort(small.begin(), small.end(),
            [&](uint32_t p, uint32_t q) { return area[p] != area[q] ? area[p] < area[q] : p < q; });
  const PatchFaces faces(patches, small);
  std::vector<size_t> fins;
  double together = 0;
  for (size_t i = 0; i < small.size(); ++i)
    if (is_fin(mesh, faces.begin(i), faces.end(i))) {
      fins.push_back(i);
      together += area[small[i]];
    }
  if (together > kFinsTogether * whole) return false;
  bool dropped = false;
  for (size_t i : fins) {
    if (!is_fin(mesh, faces.begin(i), faces.end(i))) continue;  // those before it may have freed its edges
    std::for_each(faces.begin(i), faces.end(i), [&](uint32_t f) { mesh.drop(f); });
    ++report.fins;
    report.fin_faces += faces.end(i) - faces.begin(i);
    dropped = true;
  }
  return dropped;
}

}  // namespace

std::vector<double> patch_areas(const RepairMesh& mesh, const Patches& patches) {
  std::vector<double> area(patches.count, 0);
  for (uint32_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.is_live(f)) area[patches.of[f]] += mesh.area(f);
  return area;
}

Patches find_patches(const RepairMesh& mesh) {
  Patches patches;
  patches.of.assign(size_t(mesh.face_count()), kNoFace);
  std::vector<uint32_t> stack;
  for (uint32_t seed = 0; seed < mesh.face_count(); ++seed) {
    if (!mesh.is_live(seed) || patches.of[seed] != kNoFace) continue;
    patches.of[seed] = patches.count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const uint32_t f = stack.back();
      stack.pop_back();
      for_each_neighbour(mesh, f, [&](uint32_t, uint32_t twin) {
        if (patches.of[twin / 3] != kNoFace) return;
        patches.of[twin / 3] = patches.count;
        stack.push_back(twin / 3);
      });
    }
    ++patches.count;
  }
  return patches;
}

double live_area(const RepairMesh& mesh) {
  double area = 0;
  for (uint32_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.is_live(f)) area += mesh.area(f);
  return area;
}

void drop_fins(RepairMesh& mesh, RepairReport& report) {
  const std::vector<uint32_t> junctions = edges_at_junctions(mesh);
  for (uint32_t edge : junctions) mesh.add_flat_face(edge);
  while (drop_fins_once(mesh, report)) {
  }
  for (uint32_t edge : junctions) mesh.drop_flat_face(edge);
}

void orient_patches(RepairMesh& mesh) {
  std::vector<uint8_t> turn(size_t(mesh.face_count()), 0), seen(turn);
  std::vector<uint32_t> patch;
  for (uint32_t seed = 0; seed < mesh.face_count(); ++seed) {
    if (!mesh.is_live(seed) || seen[seed]) continue;
    patch.assign(1, seed);
    seen[seed] = 1;
    size_t turns = 0;
    for (size_t i = 0; i < patch.size(); ++i)
      for_each_neighbour(mesh, patch[i], [&](uint32_t h, uint32_t twin) {
        const uint32_t g = twin / 3;
        if (seen[g]) return;
        seen[g] = 1;
        turn[g] = turn[h / 3] ^ (mesh.agrees(h) ? 0 : 1);
        turns += turn[g];
        patch.push_back(g);
      });
    const uint8_t others = 2 * turns > patch.size();
    for (uint32_t f : patch) turn[f] ^= others;
  }
  for (uint32_t f = 0; f < mesh.face_count(); ++f)
    if (turn[f]) mesh.turn(f);
}

void drop_islands(RepairMesh& mesh, const std::vector<std::array<uint32_t, 2>>& joins, RepairReport& report) {
  const Patches patches = find_patches(mesh);
  const std::vector<double> area = areas_of_joined(patches, joins, patch_areas(mesh, patches));
  const double whole = live_area(mesh);
  std::vector<uint8_t> open(patches.count, 0), touched(patches.count, 0);
  std::vector<uint32_t> patch_at(mesh.position.size(), kNoFace);
  for (uint32_t h = 0; h < 3 * mesh.face_count(); ++h) {
    if (!mesh.is_live(h / 3)) continue;
    const uint32_t patch = patches.of[h / 3];
    open[patch] |= mesh.faces_at(mesh.edge_of(h)) == 1;
    uint32_t& there = patch_at[mesh.from(h)];
    if (there == kNoFace) there = patch;
    if (there != patch) touched[there] = touched[patch] = 1;
  }
  double together = 0;
  std::vector<uint8_t> is_island(patches.count, 0);
  for (uint32_t p = 0; p < patches.count; ++p) {
    is_island[p] = open[p] && !touched[p] && area[p] < kLargestIsland * whole;
    if (is_island[p]) together += area[p];
  }
  if (!(together < kIslandsTogether * whole)) return;
  for (uint8_t island : is_island) report.islands += island;
  for (uint32_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.is_live(f) && is_island[patches.of[f]]) {
      mesh.drop(f);
      ++report.island_faces;
    }
}

}  // namespace isoshell::repair
