// Bounds of the options of a run.
#include "pipeline/check_options.h"

#include <cmath>
#include <sstream>

#include "isoshell/error.h"
#include "isoshell/option_range.h"

namespace isoshell {
namespace {

/// All digits that a count or a bound has, where a stream would round to six.
std::string number_text(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

void check(const char* option, double value, const OptionRange& range) {
  if (!range.holds(value)) throw Error(ErrorCode::usage, "options", range.refusal(option, value));
}

/// `former` stood for an option that was not given.
template <class T>
void check(const char* option, std::optional<T>& value, const OptionRange& range, T former) {
  if (value == former) value.reset();
  if (value) check(option, double(*value), range);
}

}  // namespace

std::string OptionRange::refusal(const std::string& option, double value) const {
  std::string text =
      option + " is " + number_text(value) + "; it must be " + (above ? "more than " : "") + number_text(low);
  if (high == std::numeric_limits<double>::max())
    text += above ? "" : " or more";
  else
    text += (above ? " and at most " : " to ") + number_text(high);
  return text;
}

RemeshOptions checked(RemeshOptions o) {
  check<int64_t>("vertices", o.vertices, option_range::vertices, 0);
  check<double>("edge_length_world", o.edge_length_world, option_range::length, 0);
  check<int32_t>("resolution", o.resolution, option_range::resolution, 0);
  check<double>("voxel_size_world", o.voxel_size_world, option_range::length, 0);
  check("band_vox", o.band_vox, option_range::band);
  check<int32_t>("closing_vox", o.closing_vox, option_range::closing, -1);
  check<double>("closing_world", o.closing_world, OptionRange{}, -1);
  check<int32_t>("max_passes", o.max_passes, option_range::iterations, 0);
  check<double>("tolerance", o.tolerance, option_range::tolerance, -1);
  check<double>("max_step_vox", o.max_step_vox, option_range::step, 0);
  check("adaptivity", o.adaptivity, option_range::adaptivity);
  check("gradation", o.gradation, option_range::gradation);
  if (o.features.creases == Features::Creases::threshold)
    check("features.degrees", o.features.degrees, option_range::crease);
  if (o.method == Method::shell && (o.features.creases == Features::Creases::threshold || o.features.lines))
    throw Error(ErrorCode::usage, "options",
                "features need the method sheet: the paper's loop on the shell knows no curves");
  if (o.method == Method::shell && o.boundary == Boundary::keep)
    throw Error(ErrorCode::usage, "options",
                "borders are kept by the method sheet: the paper's loop on the shell knows none");
  if (o.method == Method::shell && o.previous)
    throw Error(ErrorCode::usage, "options",
                "frames follow one another by the method sheet: the paper's loop on the shell places its seeds anew");
  if (o.method == Method::shell && (o.sizing || o.adaptivity > 0))
    throw Error(ErrorCode::usage, "options",
                "a sizing field and adaptivity need the method sheet: the paper's loop on the shell has even cells");
  return o;
}

}  // namespace isoshell
