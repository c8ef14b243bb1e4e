// See find_contacts.h.
#include "repair/arrangement/find_contacts.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "measure/box_tree.h"
#include "repair/arrangement/insert_contacts.h"
#include "repair/arrangement/meet_faces.h"

namespace isoshell::repair {
namespace {

constexpr size_t kGroupsOfTask = 128, kFacesOfTask = 4096;

BoxQ8 reach_of(const LatticeFaces& faces, uint32_t f) {
  const Corners& c = faces.face[f];
  return coarse(widened(box_of(faces.point[c[0]], faces.point[c[1]], faces.point[c[2]]), int64_t(faces.weld_steps())));
}

size_t tasks_of(size_t count, size_t of_task) { return (count + of_task - 1) / of_task; }

}  // namespace

Contacts find_contacts(const LatticeFaces& faces, int64_t most_work, const Context& context) {
  Contacts all;
  // What is too low to be a triangle vanishes before its neighbours are looked at.
  std::vector<uint32_t> unsettled;
  for (uint32_t f = 0; f < faces.face.size(); ++f) {
    if (!faces.is_unsettled[f]) continue;
    const bool stays = faces.leaves_near && has_area(faces, f);
    if (stays || !meet_itself(faces, f, all)) unsettled.push_back(f);
  }
  std::vector<BoxQ8> boxes(unsettled.size());
  for (size_t i = 0; i < boxes.size(); ++i) boxes[i] = reach_of(faces, unsettled[i]);
  const BoxTree tree(boxes);
  std::vector<FacePlanes> planes(unsettled.size());
  for_each_index(size_t(0), planes.size(), [&](size_t i) { planes[i] = planes_of(faces, unsettled[i]); });
  const size_t first_tasks = tasks_of(tree.groups(), kGroupsOfTask);
  const size_t second_tasks = unsettled.size() == faces.face.size() ? 0 : tasks_of(faces.face.size(), kFacesOfTask);
  std::vector<Contacts> parts(first_tasks + second_tasks);
  std::atomic<int64_t> work{0};
  // The first part is always whole, so that it says the same of a place, whichever threads run ahead.
  const auto is_too_much = [&](size_t p) { return p > 0 && work.load(std::memory_order_relaxed) > most_work; };
  for_each_index(size_t(0), parts.size(), [&](size_t p) {
    check_cancel(context, "regions");
    Contacts& part = parts[p];
    if (p < first_tasks) {
      for (size_t g = p * kGroupsOfTask; g < std::min(tree.groups(), (p + 1) * kGroupsOfTask); ++g) {
        if (is_too_much(p)) return;
        const int64_t before = part.work();
        tree.for_pairs_of(g, [&](uint32_t s, uint32_t t) { meet_faces(faces, planes[s], planes[t], part); });
        work.fetch_add(part.work() - before, std::memory_order_relaxed);
      }
      return;
    }
    const size_t begin = (p - first_tasks) * kFacesOfTask;
    for (size_t f = begin; f < std::min(faces.face.size(), begin + kFacesOfTask); ++f) {
      if (faces.is_unsettled[f]) continue;
      if (is_too_much(p)) return;
      const int64_t before = part.work();
      std::optional<FacePlanes> own;
      tree.for_all_meeting(reach_of(faces, uint32_t(f)), [&](uint32_t s) {
        if (!own) own = planes_of(faces, uint32_t(f));
        meet_faces(faces, *own, planes[s], part);
        return true;
      });
      work.fetch_add(part.work() - before, std::memory_order_relaxed);
    }
  });
  if (work > most_work) {
    parts.resize(1);
    all.pairs = most_work + 1;
  }
  for (const Contacts& part : parts) {
    all.found.insert(all.found.end(), part.found.begin(), part.found.end());
    all.close.insert(all.close.end(), part.close.begin(), part.close.end());
    all.near_close.insert(all.near_close.end(), part.near_close.begin(), part.near_close.end());
    all.crossing.insert(all.crossing.end(), part.crossing.begin(), part.crossing.end());
    all.pairs += part.pairs;
  }
  return all;
}

void unsettle_crossing(LatticeFaces& faces, const Context& context) {
  faces.leaves_near = true;
  faces.reach_steps = kLateReachSteps;
  unsettle_named(faces, find_contacts(faces, std::numeric_limits<int64_t>::max(), context));
}

}  // namespace isoshell::repair
