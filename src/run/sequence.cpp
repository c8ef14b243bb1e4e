// A sequence as a loop of runs (see run/sequence.h).
#include "isoshell/run/sequence.h"

#include <algorithm>
#include <filesystem>

#include "isoshell/io/velocity_vdb.h"
#include "isoshell/readable.h"
#include "progress/step.h"
#include "run/measures.h"
#include "run/outputs.h"

namespace isoshell {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostNamed = 5;  ///< frames in one message

std::string name_of(int64_t frame, const std::string& path) { return "frame " + std::to_string(frame) + ", " + path; }

std::string some_of(const std::vector<std::string>& names) {
  std::string text;
  for (size_t i = 0; i < std::min(names.size(), kMostNamed); ++i) text += (i > 0 ? "; " : "") + names[i];
  return names.size() > kMostNamed ? text + "; ..." : text;
}

class Sequence {
 public:
  Sequence(const SequenceRequest& request, Context& context)
      : request_(request),
        context_(context),
        chain_(request.is_coherent),
        numbers_(frame_numbers(request.frames)),
        progress_(int64_t(numbers_.size())) {
    check_whole_request(request_.frame);
    check_sequence(request_);
  }

  SequenceResult result() {
    double kept_sum = 0;
    for (size_t i = 0; i < numbers_.size(); ++i) {
      const int64_t frame = numbers_[i];
      RunRequest one = request_of_frame(request_, frame);
      if (one.progress) one.progress = [this](const Progress& p) { request_.frame.progress(progress_.of(p)); };
      progress_.go_to(int64_t(i));
      try {
        make(frame, one, kept_sum);
      } catch (const Error& error) {
        if (error.code() == ErrorCode::interrupted) throw;
        note_bad(frame, error.code(), std::string(error.what()));
      }
    }
    if (request_.frame.progress) request_.frame.progress({"write", 1, 1, 0});  // the last ones may have been there
    if (result_.followed > 0) result_.kept_edges_mean_pct = kept_sum / double(result_.followed);
    return std::move(result_);
  }

 private:
  void make(int64_t frame, const RunRequest& one, double& kept_sum) {
    Input input = read(one);
    if (is_there(one, input)) {
      ++result_.found;
      return set_velocity(one);
    }
    progress_.begin();
    const RunResult made = chain_.run(std::move(input), one, context_);
    ++result_.made;
    if (made.record.options.previous) {
      const CoherenceReport& coherence = made.record.report.coherence;
      ++result_.followed;
      result_.warm += coherence.began_warm;
      result_.born += coherence.born;
      kept_sum += coherence.kept_edges_pct;
      result_.kept_edges_worst_pct = std::min(result_.kept_edges_worst_pct, coherence.kept_edges_pct);
    }
    if (request_.after_frame) request_.after_frame(frame, made);
    set_velocity(one);
    if (!made.missed_gates.empty()) note_bad(frame, ErrorCode::gate_failed, "gate failed: " + made.missed_gates[0]);
  }

  /// With --keep-going the sequence goes on, and says so in the end.
  void note_bad(int64_t frame, ErrorCode code, const std::string& message) {
    if (!request_.keep_going) throw Error(code, "frames", "frame " + std::to_string(frame) + ": " + message);
    result_.bad.push_back({frame, code, message});
  }

  Input read(const RunRequest& one) const {
    if (one.progress) one.progress({"read", 0, 0, 0});
    return naming_written(chain_.written(), [&] { return read_input_of(one, context_, one.tell); });
  }

  /// Whether the frame need not be made.
  bool is_there(const RunRequest& one, const Input& input) {
    if (!request_.resume || !fs::exists(one.output.path)) return false;
    const std::string misfit = chain_.go_on_from(input, one, context_);
    if (!misfit.empty() && one.tell)
      one.tell(MessageKind::warning, one.output.path + " " + misfit + ": it is made again");
    return misfit.empty();
  }

  void set_velocity(const RunRequest& one) {
    if (!request_.velocity.empty() && request_.is_coherent)
      chain_.set_velocity(read_velocity(one.input.path, request_.velocity, context_.memory_limit_bytes));
  }

  const SequenceRequest& request_;
  Context& context_;
  FrameChain chain_;
  const std::vector<int64_t> numbers_;
  SequenceProgress progress_;
  SequenceResult result_;
};

}  // namespace

void SequenceProgress::go_to(int64_t index) {
  index_ = index;
  if (begun_ == 0) start_ = Clock::now();
}

Progress SequenceProgress::of(const Progress& frame) const {
  if (frames_ == 0) return frame;
  Progress whole = frame;
  whole.fraction = (double(index_) + frame.fraction) / double(frames_);
  const double till_next = std::chrono::duration<double>(Clock::now() - start_).count() + frame.seconds_left;
  whole.seconds_left += till_next / double(std::max<int64_t>(begun_, 1)) * double(frames_ - 1 - index_);
  return whole;
}

std::vector<int64_t> frame_numbers(const FrameRange& frames) {
  std::vector<int64_t> numbers;
  for (int64_t f = frames.first; f <= frames.last; f += frames.step) numbers.push_back(f);
  return numbers;
}

RunRequest request_of_frame(const SequenceRequest& request, int64_t frame) {
  RunRequest one = request.frame;
  for (std::string* path :
       {&one.input.path, &one.output.path, &one.save_shell, &one.save_voronoi, &one.level_set.path, &one.statistics})
    if (!path->empty() && *path != "-") *path = path_of_frame(*path, frame);
  for (std::string& name : one.input.grids) name = grid_of_frame(name, frame);
  one.overwrite |= request.resume;  // what is there and does not fit, and what a frame that was not ended has left
  return one;
}

void check_sequence(const SequenceRequest& request) {
  const auto refuse = [](const std::string& text) { throw Error(ErrorCode::usage, "frames", text); };
  const RunRequest& every = request.frame;
  const std::vector<NamedFile> written = outputs_of(every);
  const auto is_pipe = [](const NamedFile& file) { return file.path == "-"; };
  if (every.input.path == "-" || std::any_of(written.begin(), written.end(), is_pipe))
    refuse("a sequence is read from and written to files; name them by a pattern, as mesh.####.ply");
  if (!every.report.empty()) refuse("--report shows one frame; leave out --frames, or make it of a frame");
  if (!every.split_regions.empty()) refuse("--split-regions is for one frame; leave out --frames");
  if (request.resume && every.output.format != "ply")
    refuse("--resume needs PLY files, which keep the numbers of vertices and their positions exactly");
  if (every.output.recenter.is_asked && !every.output.recenter.offset_world)
    refuse("--recenter auto takes an offset for each frame; give one for all of them, as --recenter 500000,0,0");
  std::vector<std::string> missing, there;
  std::vector<NamedFile> outputs, inputs;
  for (const int64_t frame : frame_numbers(request.frames)) {
    const RunRequest one = request_of_frame(request, frame);
    const std::string &from = one.input.path, &to = one.output.path;
    if (!from.empty() && !fs::exists(from)) missing.push_back(name_of(frame, from));
    if (!one.overwrite && fs::exists(to)) there.push_back(name_of(frame, to));
    for (const NamedFile& file : outputs_of(one)) outputs.push_back({file.what, file.path});  // replacing no input
    for (const NamedFile& file : inputs_of(one)) inputs.push_back(file);
  }
  if (!missing.empty() && !request.keep_going)
    throw Error(ErrorCode::unreadable_input, "frames",
                counted(int64_t(missing.size()), "frame is", "frames are") + " missing: " + some_of(missing));
  if (!there.empty())
    throw Error(ErrorCode::unwritable_output, "frames",
                counted(int64_t(there.size()), "frame exists", "frames exist") + " already: " + some_of(there) +
                    "; --force replaces them, --resume goes on after them");
  check_output_files(outputs, inputs, every.overwrite || request.resume);
}

SequenceResult run_sequence(const SequenceRequest& request, Context& context) {
  return Sequence(request, context).result();
}

}  // namespace isoshell
