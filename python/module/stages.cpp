#include "module/stages.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/error.h"
#include "isoshell/io/polyline_file.h"
#include "isoshell/io/sizing_vdb.h"
#include "isoshell/io/vdb_file.h"
#include "module/watched.h"
#include "values/arrays.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "stages", message); }

/// Everything that stages have made; shared with the thread that works on it.
struct Products {
  InputFacts facts;
  RemeshOptions options;
  RemeshReport report;
  std::optional<Prepared> prepared;
  std::optional<SeedSet> seeds;
};

RemeshOptions settled_options(const AskedOptions& asked, const Context& context) {
  RemeshOptions options = asked.values;
  options.want_shell = options.want_digests = true;
  if (!asked.sizing.empty()) {
    if (!asked.was_given("vertices")) options.vertices.reset();
    options.sizing = read_sizing(asked.sizing, context.memory_limit_bytes);
  }
  if (!options.features.line_file.empty()) options.features.lines = read_polylines(options.features.line_file);
  return options;
}

class StageRun {
 public:
  StageRun(Place& place, const Source& source, const Keywords& keywords, nb::object progress, nb::object tell)
      : place_(&place),
        source_(source),
        asked_(asked_of(source_, keywords, "", std::move(progress), std::move(tell))),
        products_(std::make_shared<Products>()) {}

  void prepare() {
    if (products().prepared) return;
    add("prepare", [products = products_, read = source_.read](const RunRequest& request, Context& context) {
      const Input input = input_of_run(read, request, context);
      if (input.stage) refuse(input.facts.name() + " is a stage file; isoshell.remesh resumes from it");
      products->facts = input.facts;
      products->options = settled_options(request.options, context);
      products->prepared = isoshell::prepare(input.soup, products->options, products->report, context);
      products->report.digests["shell"] = digest_text(digest(products->prepared->shell));
      return true;
    });
  }

  void relax() {
    prepare();
    if (products().seeds) return;
    add("relax", [products = products_](const RunRequest&, Context& context) {
      products->seeds = isoshell::relax(*products->prepared, products->options, products->report, context);
      return true;
    });
  }

  RunResult triangulate() {
    relax();
    return work("triangulate", [products = products_](const RunRequest&, Context& context) {
      RunResult result;
      SeedSet seeds = to_host(*products->seeds);  // they change, and may be looked at afterwards
      RemeshReport report = products->report;
      result.mesh = isoshell::triangulate(*products->prepared, seeds, products->options, report, context);
      result.record.options = products->options;
      result.record.input = products->facts;
      result.record.report = std::move(report);
      result.record.topology = check_mesh(result.mesh);
      result.record.quality = measure_quality(result.mesh);
      result.record.vertices = int64_t(result.mesh.vertices.size());
      result.record.triangles = int64_t(result.mesh.triangles.size());
      result.record.device = device_info(context);
      return result;
    });
  }

  void save_shell(const std::string& path, bool overwrite) {
    prepare();
    work("save-shell", [products = products_, path, overwrite](const RunRequest& request, Context&) {
      const Prepared& p = *products->prepared;
      request.around_write(path, [&] {
        isoshell::save_shell(path, p.surface, p.samples, p.shell, write_options(*products, overwrite));
      });
      return true;
    });
  }

  void save_voronoi(const std::string& path, bool overwrite) {
    relax();
    if (products().prepared->cut)
      refuse(
          "a Voronoi stage file does not hold the seeds of creases, borders and lines; give --features off and "
          "--boundary close, or save the shell");
    work("save-voronoi", [products = products_, path, overwrite](const RunRequest& request, Context& context) {
      const Prepared& p = *products->prepared;
      const VoronoiLabels labels = flood_shell(p.shell, *products->seeds, context);
      request.around_write(path, [&] {
        isoshell::save_voronoi(path, p.surface, p.samples, p.shell, *products->seeds, labels,
                               write_options(*products, overwrite));
      });
      return true;
    });
  }

  std::map<std::string, std::string> digests() const { return products().report.digests; }

  nb::tuple sheet() {
    prepare();
    const Prepared& p = *products().prepared;
    const SurfaceMesh sheet = to_host(p.sheet);
    TriangleMesh mesh;
    for (const PointQ8& q : sheet.position) mesh.vertices.push_back(p.surface.frame.to_world(q));
    for (const TriangleIndices& t : sheet.triangles) mesh.triangles.push_back({t.a, t.b, t.c});
    const nb::object owner = nb::cast(std::move(mesh));
    const auto& kept = nb::cast<const TriangleMesh&>(owner);
    return nb::make_tuple(rows_of(kept.vertices, owner), rows_of(kept.triangles, owner));
  }

  nb::object seeds() {
    relax();
    const SeedSet seeds = to_host(*products().seeds);
    TriangleMesh mesh;
    for (const PointQ8& q : seeds.position) mesh.vertices.push_back(products().prepared->surface.frame.to_world(q));
    const nb::object owner = nb::cast(std::move(mesh));
    return nb::cast(rows_of(nb::cast<const TriangleMesh&>(owner).vertices, owner));
  }

  nb::dict frame() {
    prepare();
    const LatticeFrame& f = products().prepared->surface.frame;
    nb::dict dict;
    dict["origin"] = nb::make_tuple(f.origin.x, f.origin.y, f.origin.z);
    dict["voxel_size"] = f.voxel_size;
    dict["resolution"] = f.resolution;
    dict["extent"] = nb::make_tuple(f.extent_vox[0], f.extent_vox[1], f.extent_vox[2]);
    return dict;
  }

 private:
  static StageWriteOptions write_options(const Products& products, bool overwrite) {
    StageWriteOptions options;
    options.options_json = options_json(products.options);
    options.closing_vox = products.prepared->closing_vox;
    options.overwrite = overwrite;
    return options;
  }

  Products& products() const {
    if (!products_) refuse("these stages were interrupted or failed; begin anew");
    return *products_;
  }

  template <class Work>
  std::invoke_result_t<Work, const RunRequest&, Context&> work(const char* name, Work stage) {
    return watched(*place_, source_, asked_, [name, stage](const RunRequest& request, Context& context) {
      const auto tell_progress = [&](double fraction) {
        if (context.progress) context.progress(name, fraction);
      };
      tell_progress(0);
      auto made = stage(request, context);
      tell_progress(1);
      return made;
    });
  }

  /// What a stage that adds to the products leaves behind when it fails may be anything: then nothing is left.
  template <class Work>
  void add(const char* name, Work stage) {
    try {
      work(name, std::move(stage));
    } catch (...) {
      products_.reset();
      throw;
    }
  }

  Place* place_;  // kept alive by the Python object around it
  Source source_;
  Asked asked_;
  std::shared_ptr<Products> products_;
};

}  // namespace

void bind_stages(nb::module_& m) {
  [[maybe_unused]] const nb::class_<TriangleMesh> owned(m, "OwnedMesh", "Owns the memory of arrays.");
  nb::class_<StageRun>(m, "StageRun", "The stages of one run.")
      .def(nb::init<Place&, const Source&, const Keywords&, nb::object, nb::object>(), nb::arg("place"),
           nb::arg("source"), nb::arg("keywords"), nb::arg("progress").none(), nb::arg("tell"), nb::keep_alive<1, 2>())
      .def("prepare", &StageRun::prepare)
      .def("relax", &StageRun::relax)
      .def("triangulate", &StageRun::triangulate)
      .def("save_shell", &StageRun::save_shell, nb::arg("path"), nb::arg("overwrite"))
      .def("save_voronoi", &StageRun::save_voronoi, nb::arg("path"), nb::arg("overwrite"))
      .def("sheet", &StageRun::sheet, nb::sig("def sheet(self) -> tuple[typing.Any, typing.Any]"))
      .def("seeds", &StageRun::seeds, nb::sig("def seeds(self) -> typing.Any"))
      .def("frame", &StageRun::frame, nb::sig("def frame(self) -> dict[str, typing.Any]"))
      .def("digests", &StageRun::digests);
}

}  // namespace isoshell::python
