// What a frame hands to the next one, and by what its file says that it is that frame (see run/sequence.h).
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <map>
#include <sstream>
#include <vector>

#include "core/hash_bytes.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/options/options_json.h"
#include "isoshell/readable.h"
#include "isoshell/run/sequence.h"
#include "isoshell/version.h"
#include "progress/step.h"
#include "run/measures.h"
#include "run/outputs.h"

namespace isoshell {
namespace {

/// What a surface needs to carry vertices.
TriangleSoup triangles_alone(std::vector<WorldPoint> vertices, std::vector<std::array<uint32_t, 3>> triangles) {
  TriangleSoup soup;
  soup.vertices = std::move(vertices);
  soup.triangles = std::move(triangles);
  return soup;
}

uint64_t digest_of(const std::string& text) { return hash_bytes(text.data(), int64_t(text.size())); }

uint64_t digest_of(std::initializer_list<uint64_t> parts) {
  return hash_bytes(parts.begin(), int64_t(parts.size() * sizeof(uint64_t)));
}

template <class Row>
uint64_t digest_of(const std::vector<Row>& rows) {
  return hash_bytes(rows.data(), int64_t(rows.size() * sizeof(Row)));
}

/// By digests, each of all that it speaks of: the surface and its attributes, not where they are from.
struct FrameKey {
  uint64_t options = 0, input = 0, before = 0;  ///< before: 0 where none went before

  /// As RunRequest::made_of has it.
  std::string text() const;
};

uint64_t digest_of(const Attribute& a) {
  std::string names = a.name;
  for (const std::string& label : a.labels) names += '\n' + label;
  return digest_of({digest_of(names), uint64_t(a.type), uint64_t(a.components), uint64_t(a.domain), digest_of(a.values),
                    digest_of(a.index)});
}

uint64_t digest_of(const FaceRegions& regions) {
  std::string names = std::to_string(regions.background);
  for (const RegionName& region : regions.names) names += '\n' + std::to_string(region.label) + ' ' + region.name;
  return digest_of({digest_of(regions.labels), digest_of(regions.side), digest_of(names)});
}

uint64_t digest_of(const AttributeFiles& files) {
  std::string names = files.gltf_materials;
  for (const auto* list : {&files.materials, &files.textures}) {
    names += '\0';
    for (const std::string& name : *list) names += name + '\n';
  }
  return digest_of(names);
}

uint64_t digest_of_input(const Input& input) {
  if (input.stage)
    return digest_of({digest(input.stage->surface), input.stage->seeds ? digest(*input.stage->seeds) : 0,
                      digest_of(input.stage->info.options_json)});
  const TriangleSoup& soup = input.soup;
  uint64_t sum =
      digest_of({digest_of(soup.vertices), digest_of(soup.triangles), digest_of(soup.regions), digest_of(soup.files)});
  for (const Attribute& attribute : soup.attributes) sum = digest_of({sum, digest_of(attribute)});
  if (input.grids)
    for (const auto& grid : *input.grids) sum = digest_of({sum, grid->digest()});
  return sum;
}

/// Of files that options name, each read once.
using FileDigests = std::map<std::string, uint64_t>;

/// Throws: unreadable_input.
uint64_t digest_of_file(const std::string& path, FileDigests& known) {
  const auto found = known.find(path);
  if (found != known.end()) return found->second;
  std::error_code code;
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path, code))
    throw Error(ErrorCode::unreadable_input, "frames", path + ": cannot be read; correct its name, or restore it");
  uint64_t sum = 0;
  std::vector<char> part(1 << 20);
  while (file.read(part.data(), std::streamsize(part.size())) || file.gcount() > 0)
    sum = digest_of({sum, hash_bytes(part.data(), file.gcount())});
  return known[path] = sum;
}

/// A field in memory by the lengths that it gives the input, one of a file by the file and the grid's name, an
/// attribute by its name, and a grid in memory by its values.
uint64_t digest_of_options(const RunRequest& request, const Input& input, FileDigests& files) {
  const RequestedOptions& options = request.options;
  std::string text = std::string(ISOSHELL_VERSION) + options_json(options.values) +
                     (options.lengths_decide() ? " lengths decide" : "");
  const std::string& sizing = options.sizing;
  if (!sizing.empty()) text += " sizing " + sizing.substr(file_of_sizing(sizing).size());
  for (const std::string& name : request.input.grids) text += " grid " + grid_name_of(name).grid;
  for (const auto& grid : request.input.given_grids)
    text += " grid " + grid->name() + " " + digest_text(grid->digest());
  if (!request.level_set.path.empty())
    text += " level set " + std::to_string(request.level_set.band_vox) + (request.level_set.as_half ? " halves" : "") +
            (request.level_set.of == LevelSetOf::result ? " of result" : "");
  const std::vector<WorldPoint> offset = {request.output.recenter.offset()};
  uint64_t sum = digest_of({digest_of(text), uint64_t(request.stop_after), digest_of(offset)});
  for (const NamedFile& file : inputs_of(request))
    if (file.what != kInput && !file.path.empty()) sum = digest_of({sum, digest_of_file(file.path, files)});
  if (options.values.sizing) sum = digest_of({sum, digest_of(options.values.sizing->lengths_at(input.soup.vertices))});
  return sum;
}

uint64_t digest_of_previous(const PreviousFrame& previous) {
  return digest_of({digest_of(previous.vertices), digest_of(previous.triangles), digest_of(previous.carried)});
}

std::string FrameKey::text() const {
  return digest_text(options) + " " + digest_text(input) + " " + digest_text(before);
}

/// Of a frame that begins with `request.options.values.previous`. Throws: unreadable_input for a sizing field or lines.
FrameKey key_of_frame(const RunRequest& request, const Input& input, FileDigests& files) {
  const auto& previous = request.options.values.previous;
  return {digest_of_options(request, input, files), digest_of_input(input),
          previous ? digest_of_previous(*previous) : 0};
}

/// Whether the mesh has a place for the key. One in memory may be written later.
bool may_be_ply(const RunRequest& request) {
  if (request.stop_after != StopAfter::mesh) return false;
  const OutputRequest& output = request.output;
  return output.path.empty() || named_output(output.path, output.format, request.stop_after).format == "ply";
}

/// What is another in the key that a file has, as "was made with other options"; empty where they are the same.
std::string misfit_of(const FrameKey& key, const std::string& found) {
  std::istringstream words(found);
  std::string options, input, before;
  if (!(words >> options >> input >> before)) return "does not say that a sequence made it";
  if (options != digest_text(key.options)) return "was made with other options or by another version";
  if (input != digest_text(key.input)) return "was made of another input";
  if (before != digest_text(key.before)) return "follows another frame than the one that is before it now";
  return "";
}

/// What reading a file says is wrong with it, and that it cannot be read where that is so. Throws: what is no fault of
/// the file, as out_of_memory.
template <class Read>
std::string misfit_of_file(Read read) {
  try {
    return read();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unreadable_input && error.code() != ErrorCode::nothing_to_mesh) throw;
    return std::string("cannot be read (") + error.what() + ")";
  }
}

}  // namespace

struct FrameChain::Frame {
  TriangleSoup surface;  ///< positions and triangles alone
  TriangleMesh mesh;     ///< as its file has it
  bool had_curves = false;
  std::shared_ptr<const VelocityField> velocity;
};

/// What there is of frames beside the last one.
struct FrameChain::Written {
  std::string first, last;  ///< files
  int64_t count = 0;
  std::map<std::string, uint64_t> digests;
};

FrameChain::FrameChain(bool is_coherent) : is_coherent_(is_coherent), written_(std::make_unique<Written>()) {}
FrameChain::FrameChain(FrameChain&&) noexcept = default;
FrameChain& FrameChain::operator=(FrameChain&&) noexcept = default;
FrameChain::~FrameChain() = default;

RunResult FrameChain::run(Input input, RunRequest request, Context& context) {
  if (follows(request) && input.stage)
    throw Error(ErrorCode::usage, "frames",
                input.facts.path + " is a stage file, which has no surface that vertices could go with");
  if (follows(request) && last_) request.options.values.previous = previous_for(input, context);
  if (may_be_ply(request)) request.made_of = key_of_frame(request, input, written_->digests).text();
  request.written_before = written();
  TriangleSoup surface;
  if (follows(request)) surface = triangles_alone(input.soup.vertices, input.soup.triangles);
  RunResult made = isoshell::run(std::move(input), request, context);
  if (const std::string& path = request.output.path; !path.empty()) {
    if (written_->count++ == 0) written_->first = path;
    written_->last = path;
  }
  if (!follows(request)) return made;
  TriangleMesh mesh;
  mesh.vertices = made.mesh.vertices;
  mesh.triangles = made.mesh.triangles;
  const WorldPoint offset = request.output.recenter.offset();
  mesh.vertices = positions_in_file(mesh, "ply", offset).vertices;
  move_by(offset, mesh.vertices);
  const FeatureReport& features = made.record.report.features;
  remember(std::move(surface), std::move(mesh), features.kept && features.on_sheet.empty());
  return made;
}

void FrameChain::set_velocity(std::shared_ptr<const VelocityField> velocity) {
  if (last_) last_->velocity = std::move(velocity);
}

std::string FrameChain::go_on_from(const Input& input, const RunRequest& request, Context& context) {
  for (const NamedFile& file : outputs_of(request))
    if (!file.path.empty() && !std::filesystem::exists(file.path)) return "is there without " + file.path;
  RunRequest one = request;
  if (follows(request) && last_) one.options.values.previous = previous_for(input, context);
  const FrameKey key = key_of_frame(one, input, written_->digests);
  TriangleSoup there;
  const std::string misfit = misfit_of_file([&] {
    const std::string& path = request.output.path;
    const std::string made_of = made_of_in_ply(path, context.memory_limit_bytes);
    if (const std::string other = misfit_of(key, made_of); !other.empty()) return other;
    there = read_mesh(path, "ply", context.memory_limit_bytes);
    return std::string(there.faces_in_file == int64_t(there.triangles.size()) ? "" : "has faces that are none");
  });
  if (!misfit.empty() || !follows(request)) return misfit;
  TriangleMesh mesh;
  mesh.vertices = std::move(there.vertices);
  move_by(request.output.recenter.offset(), mesh.vertices);
  mesh.triangles = std::move(there.triangles);
  remember(triangles_alone(input.soup.vertices, input.soup.triangles), std::move(mesh), false);
  return "";
}

std::string FrameChain::written() const {
  if (written_->count <= 1) return written_->last;
  return written_->first + " to " + written_->last + ", " + counted(written_->count, "frame");
}

bool FrameChain::follows(const RunRequest& request) const {
  return is_coherent_ && request.stop_after == StopAfter::mesh;
}

void FrameChain::remember(TriangleSoup surface, TriangleMesh mesh, bool had_curves) {
  last_ = std::make_unique<Frame>(Frame{std::move(surface), std::move(mesh), had_curves, nullptr});
}

std::shared_ptr<const PreviousFrame> FrameChain::previous_for(const Input& input, Context& context) const {
  const TriangleSoup& surface = input.soup;
  auto previous = std::make_shared<PreviousFrame>();
  previous->vertices = last_->mesh.vertices;
  previous->triangles = last_->mesh.triangles;
  previous->had_curves = last_->had_curves;
  const bool has_same_triangles = have_same_triangles(last_->surface, surface);
  previous->has_other_faces = input.facts.kind != InputKind::mesh || !has_same_triangles;
  previous->carried = naming_written(written(), [&] {
    if (has_same_triangles) return carry_with_triangles(last_->mesh, last_->surface, surface, context);
    TriangleMesh moved = last_->mesh;
    if (last_->velocity) moved.vertices = carry_with_velocity(moved.vertices, *last_->velocity);
    return carry_onto(moved, surface, context);
  });
  return previous;
}

}  // namespace isoshell
