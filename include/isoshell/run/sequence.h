// Runs over the frames of a sequence: what run() does, frame by frame, each beginning with the one before.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/error.h"
#include "isoshell/run/run.h"

namespace isoshell {

/// Numbers first, first + step, ... up to last.
struct FrameRange {
  int64_t first = 0, last = 0, step = 1;
};

/// From "1-240", "1-240x2" or "7", at most ten million. Throws: usage.
FrameRange parse_frames(const std::string& text);

/// The path of a frame: "cache.####.obj" and "cache.%04d.obj" are cache.0007.obj in frame 7; longer numbers take more
/// digits. Throws: usage when there is no place for a number, or more than one.
std::string path_of_frame(const std::string& pattern, int64_t frame);

/// A grid as --grids names it, in a frame: with its number where the name of a file has a place for it.
std::string grid_of_frame(const std::string& name, int64_t frame);

/// Frames one after the other, each beginning with the last that was made.
class FrameChain {
 public:
  explicit FrameChain(bool is_coherent = true);  ///< else every frame begins cold
  FrameChain(FrameChain&&) noexcept;
  FrameChain& operator=(FrameChain&&) noexcept;
  ~FrameChain();

  /// run() of the next frame. The vertices of the one before go to where they are in this one: with their triangles
  /// where both have the same, else along the velocities, if there are any, and to the nearest place that faces their
  /// way. Its PLY file says what it was made of. Throws: as run() does, and then the next frame begins with what this
  /// one would have begun with; an interruption names the frames that were written before; usage for a stage file,
  /// which has no surface.
  RunResult run(Input input, RunRequest request, Context& context);
  /// The surface of the last frame goes along these until the next.
  void set_velocity(std::shared_ptr<const VelocityField> velocity);
  /// The next frame is the one that its output holds already, if that is what run() would make. Result: empty then,
  /// else what is wrong with the file, as "was made of another input": it is the next one to run. Throws: as reading
  /// what the options name does; interrupted.
  std::string go_on_from(const Input& input, const RunRequest& request, Context& context);
  /// As an interruption names the frames that were written: "a.1.ply to a.7.ply, 7 frames"; empty: none.
  std::string written() const;

 private:
  struct Frame;
  struct Written;
  bool follows(const RunRequest& request) const;
  std::shared_ptr<const PreviousFrame> previous_for(const Input& input, Context& context) const;
  void remember(TriangleSoup surface, TriangleMesh mesh, bool had_curves);

  bool is_coherent_;
  std::unique_ptr<Frame> last_;
  std::unique_ptr<Written> written_;
};

/// How far a sequence is, from how far its frame is.
class SequenceProgress {
 public:
  /// Of so many frames; 0: nobody knows, and then each frame is all that there is.
  explicit SequenceProgress(int64_t frames) : frames_(frames) {}

  /// A frame that may be there already; 0 is the first of all.
  void go_to(int64_t index);
  /// It is made: the time that a frame takes is the mean over such ones.
  void begin() { ++begun_; }
  Progress of(const Progress& frame) const;

 private:
  using Clock = std::chrono::steady_clock;

  int64_t frames_, index_ = 0, begun_ = 0;
  Clock::time_point start_ = Clock::now();  ///< of the first that is made
};

/// A frame that is not as it should be.
struct BadFrame {
  int64_t frame = 0;
  ErrorCode code = ErrorCode::internal;
  std::string message;
};

struct SequenceRequest {
  RunRequest
      frame;  ///< of every frame; its paths are patterns, but for the sizing field and lines; files of grids may be
  FrameRange frames;
  std::string velocity;     ///< grid of a volume's file, world units a frame; empty: none
  bool is_coherent = true;  ///< else every frame begins cold
  bool keep_going = false;  ///< past frames that cannot be read or meshed, or miss a gate
  /// Frames whose output is there, whole and as this sequence makes it, are not made again; others replace what is
  /// there. Needs PLY.
  bool resume = false;
  /// Called after each frame that was made.
  std::function<void(int64_t frame, const RunResult& result)> after_frame;
};

struct SequenceResult {
  int64_t made = 0, found = 0;  ///< frames; found: that a sequence which resumes had already
  int64_t warm = 0;             ///< of those made: began with the vertices of the frame before
  double kept_edges_mean_pct = 0, kept_edges_worst_pct = 100;  ///< over the frames that had one before
  int64_t followed = 0;                                        ///< frames that had one before
  int64_t born = 0;
  std::vector<BadFrame> bad;
};

/// The numbers of the frames, in their order.
std::vector<int64_t> frame_numbers(const FrameRange& frames);

/// The request of one frame, with its number in the paths.
RunRequest request_of_frame(const SequenceRequest& request, int64_t frame);

/// What can be told before anything starts; an input without a path is in memory. Throws: usage for files that cannot
/// be those of a sequence; unreadable_input with every missing frame, unless it is to keep going; unwritable_output
/// with every frame that is there and may neither be replaced nor left out; and as check_output_files() does.
void check_sequence(const SequenceRequest& request);

/// A chain of frames that are files, checked before it starts. A frame has the vertex properties `born`, and vx, vy,
/// vz, world units a frame, when it follows another. Result: the same files whether it was done in one go or resumed.
/// Throws: as check_sequence() does, and as run() does for the first frame that is not as it should be, named, unless
/// it is to keep going; an interruption names the frames that were written.
SequenceResult run_sequence(const SequenceRequest& request, Context& context);

}  // namespace isoshell
