// What a frame hands to the next one (see run/sequence.h).
#include "isoshell/io/mesh_file.h"
#include "isoshell/run/sequence.h"
#include "run/measures.h"

namespace isoshell {
namespace {

/// What a surface needs to carry vertices.
TriangleSoup triangles_alone(std::vector<WorldPoint> vertices, std::vector<std::array<uint32_t, 3>> triangles) {
  TriangleSoup soup;
  soup.vertices = std::move(vertices);
  soup.triangles = std::move(triangles);
  return soup;
}

}  // namespace

struct FrameChain::Frame {
  TriangleSoup surface;  ///< positions and triangles alone
  TriangleMesh mesh;     ///< as its file has it
  bool had_curves = false;
  std::shared_ptr<const VelocityField> velocity;
};

FrameChain::FrameChain(bool is_coherent) : is_coherent_(is_coherent) {}
FrameChain::FrameChain(FrameChain&&) noexcept = default;
FrameChain& FrameChain::operator=(FrameChain&&) noexcept = default;
FrameChain::~FrameChain() = default;

RunResult FrameChain::run(Input input, RunRequest request, Context& context) {
  if (!is_coherent_ || request.stop_after != StopAfter::mesh) return isoshell::run(std::move(input), request, context);
  if (input.stage)
    throw Error(ErrorCode::usage, "frames",
                input.facts.path + " is a stage file, which has no surface that vertices could go with");
  TriangleSoup surface = triangles_alone(input.soup.vertices, input.soup.triangles);
  if (last_) request.options.values.previous = previous_for(surface, input.facts.kind, context);
  RunResult made = isoshell::run(std::move(input), request, context);
  TriangleMesh mesh;
  mesh.vertices = made.mesh.vertices;
  mesh.triangles = made.mesh.triangles;
  const WorldPoint offset = request.output.recenter.offset();
  mesh.vertices = positions_in_file(mesh, "ply", offset).vertices;
  move_by(offset, mesh.vertices);
  const FeatureReport& features = made.record.report.features;
  const bool had_curves = features.kept && features.on_sheet.empty();
  last_ = std::make_unique<Frame>(Frame{std::move(surface), std::move(mesh), had_curves, nullptr});
  return made;
}

void FrameChain::set_velocity(std::shared_ptr<const VelocityField> velocity) {
  if (last_) last_->velocity = std::move(velocity);
}

void FrameChain::go_on_from(TriangleSoup surface, TriangleSoup mesh) {
  if (!is_coherent_) return;
  last_ = std::make_unique<Frame>();
  last_->surface = triangles_alone(std::move(surface.vertices), std::move(surface.triangles));
  last_->mesh.vertices = std::move(mesh.vertices);
  last_->mesh.triangles = std::move(mesh.triangles);
}

std::shared_ptr<const PreviousFrame> FrameChain::previous_for(const TriangleSoup& surface, InputKind kind,
                                                              Context& context) const {
  auto previous = std::make_shared<PreviousFrame>();
  previous->vertices = last_->mesh.vertices;
  previous->triangles = last_->mesh.triangles;
  previous->had_curves = last_->had_curves;
  const bool has_same_triangles = have_same_triangles(last_->surface, surface);
  previous->has_other_faces = kind != InputKind::mesh || !has_same_triangles;
  if (has_same_triangles) {
    previous->carried = carry_with_triangles(last_->mesh, last_->surface, surface, context);
    return previous;
  }
  TriangleMesh moved = last_->mesh;
  if (last_->velocity) moved.vertices = carry_with_velocity(moved.vertices, *last_->velocity);
  previous->carried = carry_onto(moved, surface, context);
  return previous;
}

}  // namespace isoshell
