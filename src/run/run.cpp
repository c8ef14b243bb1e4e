// A run is all of its steps (see run/steps.h).
#include "isoshell/run/run.h"

#include <utility>

#include "isoshell/run/steps.h"

namespace isoshell {

RunResult run(const RunRequest& request, Context& context) { return RunSteps(request).finish(context); }

RunResult run(Input input, const RunRequest& request, Context& context) {
  RunSteps steps(request);
  steps.take(std::move(input), context);
  return steps.finish(context);
}

RunEstimate dry_run(const RunRequest& request, Context& context) { return RunSteps(request).estimate(context); }

RunEstimate dry_run(Input input, const RunRequest& request, Context& context) {
  RunSteps steps(request);
  steps.take(std::move(input), context);
  return steps.estimate(context);
}

VolumeCreases volume_creases(const Features& features) {
  if (features.creases == Features::Creases::off) return VolumeCreases::none;
  return features.creases == Features::Creases::automatic ? VolumeCreases::of_sharp_bodies : VolumeCreases::all;
}

InputRequest input_request_of(const RunRequest& request) {
  InputRequest input = request.input;
  input.creases = volume_creases(request.options.values.features);
  input.keep_open = request.options.values.boundary == Boundary::keep;
  return input;
}

Input read_input_of(const RunRequest& request, const Context& context, const Tell& tell) {
  return read_input(input_request_of(request), context, tell);
}

}  // namespace isoshell
