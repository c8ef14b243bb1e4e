// A sequence as a loop of runs (see run/sequence.h).
#include "isoshell/run/sequence.h"

#include <algorithm>
#include <filesystem>

#include "core/file_format.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/io/velocity_vdb.h"
#include "isoshell/readable.h"
#include "isoshell/stages.h"

namespace isoshell {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostNamed = 5;  ///< frames in one message

/// What a surface needs to carry vertices.
TriangleSoup triangles_alone(std::vector<WorldPoint> vertices, std::vector<std::array<uint32_t, 3>> triangles) {
  TriangleSoup soup;
  soup.vertices = std::move(vertices);
  soup.triangles = std::move(triangles);
  return soup;
}

std::string name_of(int64_t frame, const std::string& path) { return "frame " + std::to_string(frame) + ", " + path; }

class Sequence {
 public:
  Sequence(const SequenceRequest& request, Context& context) : request_(request), context_(context) {
    for (int64_t f = request.frames.first; f <= request.frames.last; f += request.frames.step) frames_.push_back(f);
    check_request(request_.frame);
    check_paths();
  }

  SequenceResult result() {
    double kept_sum = 0;
    for (const int64_t frame : frames_) {
      const RunRequest one = request_of(frame);
      if (request_.resume && fs::exists(one.output.path)) {
        found_ = frame;
        ++result_.found;
        continue;
      }
      try {
        make(frame, one, kept_sum);
      } catch (const Error& error) {
        if (error.code() == ErrorCode::interrupted) throw;
        note_bad(frame, error.code(), std::string(error.what()));
      }
    }
    if (result_.followed > 0) result_.kept_edges_mean_pct = kept_sum / double(result_.followed);
    return std::move(result_);
  }

 private:
  /// What a frame hands to the next one.
  struct State {
    TriangleSoup input;  ///< positions and triangles alone
    TriangleMesh mesh;   ///< as its file has it
    std::shared_ptr<const VelocityField> velocity;
  };

  bool is_coherent() const { return request_.is_coherent && request_.frame.stop_after == StopAfter::mesh; }

  RunRequest request_of(int64_t frame) const {
    RunRequest one = request_.frame;
    for (std::string* path : {&one.input.path, &one.output.path, &one.save_shell, &one.save_voronoi, &one.statistics})
      if (!path->empty() && *path != "-") *path = path_of_frame(*path, frame);
    return one;
  }

  void check_paths() const {
    const auto refuse = [](const std::string& text) { throw Error(ErrorCode::usage, "frames", text); };
    if (request_.frame.input.path == "-" || request_.frame.output.path == "-" || request_.frame.statistics == "-")
      refuse("a sequence is read from and written to files; name them by a pattern, as mesh.####.ply");
    if (!request_.frame.report.empty()) refuse("--report shows one frame; leave out --frames, or make it of a frame");
    if (request_.resume && request_.frame.output.format != "ply")
      refuse("--resume needs PLY files, which keep the numbers of vertices and their positions exactly");
    std::vector<std::string> missing, there;
    for (const int64_t frame : frames_) {
      const RunRequest one = request_of(frame);
      if (!fs::exists(one.input.path)) missing.push_back(name_of(frame, one.input.path));
      if (!request_.resume && !one.overwrite && fs::exists(one.output.path))
        there.push_back(name_of(frame, one.output.path));
    }
    if (!missing.empty() && !request_.keep_going)
      throw Error(ErrorCode::unreadable_input, "frames",
                  counted(int64_t(missing.size()), "frame is", "frames are") + " missing: " + some_of(missing));
    if (!there.empty())
      throw Error(ErrorCode::unwritable_output, "frames",
                  counted(int64_t(there.size()), "frame exists", "frames exist") + " already: " + some_of(there) +
                      "; --force replaces them, --resume goes on after them");
  }

  static std::string some_of(const std::vector<std::string>& names) {
    std::string text;
    for (size_t i = 0; i < std::min(names.size(), kMostNamed); ++i) text += (i > 0 ? "; " : "") + names[i];
    return names.size() > kMostNamed ? text + "; ..." : text;
  }

  void make(int64_t frame, RunRequest one, double& kept_sum) {
    Input input = read(one);
    TriangleSoup surface = triangles_alone(input.soup.vertices, input.soup.triangles);
    if (is_coherent() && found_) begin_with_found();
    if (is_coherent() && before_) one.options.values.previous = previous_for(surface);
    RunResult made = run(std::move(input), one, context_);
    ++result_.made;
    if (one.options.values.previous) {
      const CoherenceReport& coherence = made.record.report.coherence;
      ++result_.followed;
      result_.warm += coherence.began_warm;
      result_.born += coherence.born;
      kept_sum += coherence.kept_edges_pct;
      result_.kept_edges_worst_pct = std::min(result_.kept_edges_worst_pct, coherence.kept_edges_pct);
    }
    if (request_.after_frame) request_.after_frame(frame, made);
    if (is_coherent()) {
      round_as_in_ply(made.mesh);
      before_ =
          State{std::move(surface), {std::move(made.mesh.vertices), std::move(made.mesh.triangles)}, velocity_of(one)};
    }
    if (!made.missed_gates.empty()) note_bad(frame, ErrorCode::gate_failed, "gate failed: " + made.missed_gates[0]);
  }

  /// With --keep-going the sequence goes on, and says so in the end.
  void note_bad(int64_t frame, ErrorCode code, const std::string& message) {
    if (!request_.keep_going) throw Error(code, "frames", "frame " + std::to_string(frame) + ": " + message);
    result_.bad.push_back({frame, code, message});
  }

  Input read(const RunRequest& one) const {
    InputRequest request = one.input;
    request.creases = volume_creases(one.options.values.features);
    Input input = read_input(request, context_.memory_limit_bytes, one.tell);
    if (input.stage && is_coherent())
      throw Error(ErrorCode::usage, "frames",
                  request.path + " is a stage file, which has no surface that vertices could go with");
    return input;
  }

  std::shared_ptr<const VelocityField> velocity_of(const RunRequest& one) const {
    if (request_.velocity.empty()) return nullptr;
    return read_velocity(one.input.path, request_.velocity, context_.memory_limit_bytes);
  }

  /// The frame that is there already, as if it had been made.
  void begin_with_found() {
    const RunRequest one = request_of(*found_);
    found_.reset();
    Input input = read(one);
    TriangleSoup mesh = read_mesh(one.output.path);
    before_ = State{triangles_alone(std::move(input.soup.vertices), std::move(input.soup.triangles)),
                    {std::move(mesh.vertices), std::move(mesh.triangles)},
                    velocity_of(one)};
  }

  std::shared_ptr<const PreviousFrame> previous_for(const TriangleSoup& now) {
    auto previous = std::make_shared<PreviousFrame>();
    previous->vertices = before_->mesh.vertices;
    previous->triangles = before_->mesh.triangles;
    if (have_same_triangles(before_->input, now)) {
      previous->carried = carry_with_triangles(previous->vertices, before_->input, now, context_);
      return previous;
    }
    TriangleMesh moved = before_->mesh;
    if (before_->velocity) moved.vertices = carry_with_velocity(moved.vertices, *before_->velocity);
    previous->carried = carry_onto(moved, now, context_);
    return previous;
  }

  const SequenceRequest& request_;
  Context& context_;
  std::vector<int64_t> frames_;
  std::optional<State> before_;
  std::optional<int64_t> found_;  ///< the last frame that was there, and is not read yet
  SequenceResult result_;
};

}  // namespace

SequenceResult run_sequence(const SequenceRequest& request, Context& context) {
  return Sequence(request, context).result();
}

}  // namespace isoshell
