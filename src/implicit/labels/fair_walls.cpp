// fair_walls (see fair_walls.h).
#include "implicit/labels/fair_walls.h"

#include <utility>

#include "implicit/labels/elastic_net.h"
#include "implicit/labels/keep_volumes.h"
#include "implicit/labels/part_crossing.h"
#include "implicit/labels/read_progress.h"

namespace isoshell {
namespace {

constexpr double kFirstShare = 0.25;  ///< of the way: the first step parts walls, which do not cross then
constexpr int kSoftSteps = 28, kStiffSteps = 38;
constexpr double kSoft = 0.02, kStiff = 1;  ///< curves first go where walls lead them, and then get straight
constexpr int kMostOffsets = 5;          ///< thin regions need them, as vertices go no farther than a part of a voxel
constexpr double kLeastOffset_q8 = 0.5;  ///< less is lost when positions are rounded

struct FairedWalls {
  std::vector<PointQ8> parted, position;  ///< after the first step, and after all of them
};

FairedWalls fair_in_steps(const LabelWalls& walls, const Buckets<uint32_t>& faces_at, double smoothing_vox,
                          const Context& context) {
  ElasticNet net(walls, faces_at, smoothing_vox);
  net.step(kFirstShare);
  FairedWalls out;
  out.parted = net.rounded();
  net.find_normals(faces_at);
  net.unbend(kSoftSteps, kSoft,
             [&](int step) { tell_read(context, kWallsFound + (kCurvesLed - kWallsFound) * step / kSoftSteps); });
  net.find_normals(faces_at);
  net.unbend(kStiffSteps, kStiff,
             [&](int step) { tell_read(context, kCurvesLed + (kUnbent - kCurvesLed) * step / kStiffSteps); });
  out.position = net.rounded();
  VolumeKeeper volumes(walls, faces_at);
  for (int i = 0; i < kMostOffsets && volumes.find_offsets(out.position) > kLeastOffset_q8; ++i) {
    tell_read(context, kUnbent + (kFaired - kUnbent) * i / kMostOffsets);
    net.move([&](size_t v) { return volumes.way_of(v, out.position); });
    out.position = net.rounded();
  }
  return out;
}

}  // namespace

std::vector<PointQ8> fair_walls(const LabelWalls& walls, double smoothing_vox, const Context& context) {
  const Buckets<uint32_t> faces_at = faces_at_vertices(walls);
  FairedWalls faired = fair_in_steps(walls, faces_at, smoothing_vox, context);
  tell_read(context, kFaired);
  part_crossing(walls, faces_at, faired.parted, faired.position, context);
  return std::move(faired.position);
}

}  // namespace isoshell
