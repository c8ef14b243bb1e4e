#include "module/sequence.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <utility>

#include "isoshell/error.h"
#include "isoshell/io/velocity_vdb.h"
#include "module/watched.h"
#include "values/result.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

/// Where the surface of a source goes until the next frame: a grid of its file, or what it has in memory.
using ReadVelocity = std::function<std::shared_ptr<const VelocityField>(const RunRequest&, const Context&)>;

ReadVelocity velocity_reader(const Source& source, const std::string& grid) {
  if (!source.is_file() && !grid.empty())
    throw Error(
        ErrorCode::usage, "arguments",
        "--velocity names a grid of .vdb files, and the frame is no file; give an isoshell.Volume its velocities");
  if (!grid.empty())
    return [grid](const RunRequest& request, const Context& context) {
      return read_velocity(request.input.path, grid, context.memory_limit_bytes);
    };
  return [field = source.velocity](const RunRequest&, const Context&) { return field ? field() : nullptr; };
}

/// The chain is shared with the thread that works on it.
class Frames {
 public:
  /// Of so many frames; 0: nobody knows.
  Frames(bool is_coherent, int64_t count)
      : chain_(std::make_shared<FrameChain>(is_coherent)), progress_(std::make_shared<SequenceProgress>(count)) {}

  MadeResult run(Place& place, const Source& source, const Keywords& keywords, int64_t index, const std::string& output,
                 bool measure_all, const std::string& velocity, nb::object progress, nb::object tell) {
    RequestFromPython requested = request_from_python(source, keywords, output, std::move(progress), std::move(tell));
    if (measure_all) requested.arguments.run.measures = Measures::all;
    progress_->go_to(index);
    progress_->begin();
    requested.in_whole = [sequence = progress_](const Progress& frame) { return sequence->of(frame); };
    return work(place, source, requested,
                [chain = chain(), read = source.read, velocity_of = velocity_reader(source, velocity)](
                    const RunRequest& request, Context& context) {
                  RunResult made = chain->run(input_of_run(read, request, context), request, context);
                  chain->set_velocity(velocity_of(request, context));
                  return made_of(std::move(made));
                });
  }

  /// Empty where `output` is the frame, and else what is wrong with it.
  std::string go_on_from(Place& place, const Source& source, const Keywords& keywords, const std::string& output,
                         const std::string& velocity, nb::object tell) {
    const RequestFromPython requested = request_from_python(source, keywords, output, nb::none(), std::move(tell));
    return work(place, source, requested,
                [chain = chain(), read = source.read, velocity_of = velocity_reader(source, velocity)](
                    const RunRequest& request, Context& context) {
                  const Input input = input_of_run(read, request, context);
                  const std::string misfit = chain->go_on_from(input, request, context);
                  if (misfit.empty()) chain->set_velocity(velocity_of(request, context));
                  return misfit;
                });
  }

 private:
  const std::shared_ptr<FrameChain>& chain() const {
    if (!chain_) throw Error(ErrorCode::usage, "frames", "the sequence was interrupted; begin anew");
    return chain_;
  }

  /// What was interrupted may still be at work on its chain.
  template <class Work>
  std::invoke_result_t<Work, const RunRequest&, Context&> work(Place& place, const Source& source,
                                                               const RequestFromPython& requested, Work frame) {
    try {
      return watched(place, source, requested, std::move(frame));
    } catch (const nb::python_error&) {
      chain_.reset();
      throw;
    }
  }

  std::shared_ptr<FrameChain> chain_;
  std::shared_ptr<SequenceProgress> progress_;
};

/// The numbers of frames, when all that can be checked before they start is as it should be. `source` is a pattern, or
/// empty where frames are in memory.
std::vector<int64_t> check_frames(const Keywords& keywords, const std::string& source, const std::string& output,
                                  const std::string& frames, bool keep_going, bool resume) {
  SequenceRequest request;
  request.frame = arguments_of(keywords, output).run;
  if (!source.empty()) request.frame.input = named_input(source, std::move(request.frame.input));
  request.frames = parse_frames(frames);
  request.keep_going = keep_going;
  request.resume = resume;
  check_sequence(request);
  return frame_numbers(request.frames);
}

}  // namespace

void bind_sequence(nb::module_& m) {
  nb::class_<Frames>(m, "Frames", "Frames one after the other, each beginning with the last that was made.")
      .def(nb::init<bool, int64_t>(), nb::arg("is_coherent"), nb::arg("count"))
      .def("run", &Frames::run, nb::arg("place"), nb::arg("source"), nb::arg("keywords"), nb::arg("index"),
           nb::arg("output"), nb::arg("measure_all"), nb::arg("velocity"), nb::arg("progress").none(), nb::arg("tell"))
      .def("go_on_from", &Frames::go_on_from, nb::arg("place"), nb::arg("source"), nb::arg("keywords"),
           nb::arg("output"), nb::arg("velocity"), nb::arg("tell"));
  m.def("check_frames", check_frames, nb::arg("keywords"), nb::arg("source"), nb::arg("output"), nb::arg("frames"),
        nb::arg("keep_going"), nb::arg("resume"));
  m.def("path_of_frame", path_of_frame, nb::arg("pattern"), nb::arg("frame"));
  m.def("grid_of_frame", grid_of_frame, nb::arg("name"), nb::arg("frame"));
}

}  // namespace isoshell::python
