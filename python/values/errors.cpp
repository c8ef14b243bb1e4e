#include "values/errors.h"

#include <algorithm>
#include <exception>
#include <new>
#include <regex>

#include "isoshell/error.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

void raise(ErrorCode code, const std::string& stage, const std::string& message) {
  const nb::object error = nb::module_::import_("isoshell._errors").attr("Error")(in_keywords(message), code, stage);
  PyErr_SetObject(error.type().ptr(), error.ptr());
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& e) {
    raise(e.code(), e.stage(), e.what());
  } catch (const std::bad_alloc&) {
    raise(ErrorCode::out_of_memory, "memory", "out of memory; lower --resolution");
  }
}

}  // namespace

Error error_of(const nb::python_error& raised) {
  const nb::object ours = nb::module_::import_("isoshell._errors").attr("Error");
  if (!raised.matches(ours)) return {ErrorCode::internal, "Python", raised.what()};
  const nb::handle error = raised.value();
  return {nb::cast<ErrorCode>(error.attr("code")), nb::cast<std::string>(error.attr("stage")),
          nb::cast<std::string>(nb::str(error))};
}

std::string in_keywords(const std::string& message) {
  // An option stands by itself: "--iso", not what a file may be called, "a--iso.ply" or "--iso.ply".
  static const std::regex option("(^|[\\s('\"])--([a-z][a-z-]*[a-z])(?![-\\w]|\\.\\w)");
  std::string text;
  auto rest = message.cbegin();
  for (std::sregex_iterator it(message.begin(), message.end(), option), end; it != end; ++it) {
    const std::smatch& found = *it;
    std::string name = found[2];
    std::replace(name.begin(), name.end(), '-', '_');
    text.append(rest, found[0].first);
    text += found[1].str() + (name == "help" ? "help(isoshell.Options)" : name);
    rest = found[0].second;
  }
  return text.append(rest, message.cend());
}

void bind_errors(nb::module_& m) {
  nb::enum_<ErrorCode>(m, "ErrorCode", nb::is_arithmetic(), "What went wrong: the exit status of the command.")
      .value("INTERNAL", ErrorCode::internal, "A defect of isoshell.")
      .value("USAGE", ErrorCode::usage, "An argument that cannot be.")
      .value("UNREADABLE_INPUT", ErrorCode::unreadable_input, "The source cannot be read, or holds what cannot be.")
      .value("UNWRITABLE_OUTPUT", ErrorCode::unwritable_output, "A file cannot be written.")
      .value("NOTHING_TO_MESH", ErrorCode::nothing_to_mesh, "The source has no surface.")
      .value("GATE_FAILED", ErrorCode::gate_failed, "The result does not meet a requirement, or intersects itself.")
      .value("OUT_OF_MEMORY", ErrorCode::out_of_memory, "The run needs more memory than it may take.")
      .value("NO_DEVICE", ErrorCode::no_device, "There is no such device.")
      .value("INTERRUPTED", ErrorCode::interrupted, "Context.cancel() was called.");
  m.def("in_keywords", in_keywords, nb::arg("message"));
  nb::register_exception_translator(translate);
}

}  // namespace isoshell::python
