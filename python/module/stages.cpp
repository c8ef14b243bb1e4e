#include "module/stages.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <memory>
#include <type_traits>
#include <utility>

#include "isoshell/advanced/to_host.h"
#include "isoshell/error.h"
#include "isoshell/run/steps.h"
#include "module/watched.h"
#include "values/arrays.h"
#include "values/result.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "stages", message); }

RunRequest request_of_stages(RunRequest request) {
  request.options.values.want_shell = request.options.values.want_digests = true;
  return request;
}

TriangleMesh in_world(const Buffer<PointQ8>& points, const LatticeFrame& frame) {
  TriangleMesh mesh;
  for (const PointQ8& q : points) mesh.vertices.push_back(frame.to_world(q));
  return mesh;
}

class StageRun {
 public:
  StageRun(Place& place, const Source& source, const Keywords& keywords, nb::object progress, nb::object tell)
      : place_(&place),
        source_(source),
        requested_(request_from_python(source_, keywords, "", std::move(progress), std::move(tell))),
        steps_(std::make_shared<RunSteps>(request_of_stages(requested_.arguments.run))) {}

  const Prepared& prepare() {
    if (!prepared_)
      prepared_ = add([read = source_.read](RunSteps& steps, const RunRequest& request, Context& context) {
        std::function<Input()> from_memory;
        if (read) from_memory = [&] { return read(request, context); };
        steps.read(context, from_memory);
        if (steps.input().stage)
          refuse(steps.input().facts.name() + " is a stage file; isoshell.remesh resumes from it");
        return &steps.prepare(context);
      });
    return *prepared_;
  }

  const Relaxed& relax() {
    prepare();
    if (!relaxed_)
      relaxed_ = add([](RunSteps& steps, const RunRequest&, Context& context) { return &steps.relax(context); });
    return *relaxed_;
  }

  MadeResult triangulate() {
    relax();
    return add(
        [](RunSteps& steps, const RunRequest&, Context& context) { return made_of(steps.finish(context, true)); });
  }

  void save_shell(const std::string& path, bool overwrite) {
    prepare();
    work([path, overwrite](RunSteps& steps, const RunRequest&, Context& context) {
      steps.save_shell(path, overwrite, context);
      return true;
    });
  }

  void save_voronoi(const std::string& path, bool overwrite) {
    relax();
    work([path, overwrite](RunSteps& steps, const RunRequest&, Context& context) {
      steps.save_voronoi(path, overwrite, context);
      return true;
    });
  }

  std::map<std::string, std::string> digests() const {
    check_goes_on();
    if (relaxed_) return relaxed_->report.digests;
    return prepared_ ? prepared_->report().digests : std::map<std::string, std::string>();
  }

  nb::tuple sheet() {
    const SurfaceMesh sheet = to_host(prepare().sheet());
    TriangleMesh mesh = in_world(sheet.position, prepared_->surface().frame);
    for (const TriangleIndices& t : sheet.triangles) mesh.triangles.push_back({t.a, t.b, t.c});
    const nb::object owner = nb::cast(std::move(mesh));
    const auto& kept = nb::cast<const TriangleMesh&>(owner);
    return nb::make_tuple(rows_of(kept.vertices, owner), rows_of(kept.triangles, owner));
  }

  nb::object seeds() {
    const Buffer<PointQ8> position = relax().seeds.position.to_host();
    const nb::object owner = nb::cast(in_world(position, prepared_->surface().frame));
    return nb::cast(rows_of(nb::cast<const TriangleMesh&>(owner).vertices, owner));
  }

  nb::dict frame() {
    const LatticeFrame& f = prepare().surface().frame;
    nb::dict dict;
    dict["origin"] = nb::make_tuple(f.origin.x, f.origin.y, f.origin.z);
    dict["voxel_size"] = f.voxel_size;
    dict["resolution"] = f.resolution;
    dict["extent"] = nb::make_tuple(f.extent_vox[0], f.extent_vox[1], f.extent_vox[2]);
    return dict;
  }

 private:
  template <class Work>
  using Made = std::invoke_result_t<Work, RunSteps&, const RunRequest&, Context&>;

  void check_goes_on() const {
    if (!steps_) refuse("these stages were interrupted or failed; begin anew");
  }

  void end() {
    steps_.reset();
    prepared_ = nullptr;
    relaxed_ = nullptr;
  }

  /// What was interrupted may still be at work.
  template <class Work>
  Made<Work> work(Work stage) {
    check_goes_on();
    try {
      return done_by_steps(std::move(stage));
    } catch (const nb::python_error&) {
      end();
      throw;
    }
  }

  template <class Work>
  Made<Work> done_by_steps(Work stage) {
    return watched(*place_, source_, requested_, [steps = steps_, stage](const RunRequest& request, Context& context) {
      steps->report_to(request.tell, request.around_write, request.progress);
      return stage(*steps, request, context);
    });
  }

  /// What a stage that adds to the products leaves behind when it fails may be anything: then nothing is left.
  template <class Work>
  Made<Work> add(Work stage) {
    try {
      return work(std::move(stage));
    } catch (...) {
      end();
      throw;
    }
  }

  Place* place_;  // kept alive by the Python object around it
  Source source_;
  RequestFromPython requested_;
  std::shared_ptr<RunSteps> steps_;     ///< shared with the thread that works on it
  const Prepared* prepared_ = nullptr;  ///< of the steps, once it is there
  const Relaxed* relaxed_ = nullptr;
};

}  // namespace

void bind_stages(nb::module_& m) {
  [[maybe_unused]] const nb::class_<TriangleMesh> owned(m, "OwnedMesh", "Owns the memory of arrays.");
  nb::class_<StageRun>(m, "StageRun", "The stages of one run.")
      .def(nb::init<Place&, const Source&, const Keywords&, nb::object, nb::object>(), nb::arg("place"),
           nb::arg("source"), nb::arg("keywords"), nb::arg("progress").none(), nb::arg("tell"), nb::keep_alive<1, 2>())
      .def("prepare", [](StageRun& run) { run.prepare(); })
      .def("relax", [](StageRun& run) { run.relax(); })
      .def("triangulate", &StageRun::triangulate)
      .def("save_shell", &StageRun::save_shell, nb::arg("path"), nb::arg("overwrite"))
      .def("save_voronoi", &StageRun::save_voronoi, nb::arg("path"), nb::arg("overwrite"))
      .def("sheet", &StageRun::sheet, nb::sig("def sheet(self) -> tuple[typing.Any, typing.Any]"))
      .def("seeds", &StageRun::seeds, nb::sig("def seeds(self) -> typing.Any"))
      .def("frame", &StageRun::frame, nb::sig("def frame(self) -> dict[str, typing.Any]"))
      .def("digests", &StageRun::digests);
}

}  // namespace isoshell::python
