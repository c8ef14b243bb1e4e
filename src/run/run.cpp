// A run as a recipe of steps: reads, calls the stages, keeps what was asked for, measures, writes.
#include "isoshell/run/run.h"

#include <algorithm>
#include <chrono>
#include <type_traits>

#include "io/bytes/output_file.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/error.h"
#include "isoshell/gaps.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/io/polyline_file.h"
#include "isoshell/io/sizing_vdb.h"
#include "isoshell/transfer_attributes.h"
#include "run/choose_attributes.h"
#include "run/color_features.h"
#include "run/motion_attributes.h"
#include "run/outputs.h"
#include "run/process_memory.h"
#include "run/resume.h"
#include "run/warnings.h"

namespace isoshell {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

class Run {
 public:
  Run(const RunRequest& request, Context& context) : request_(request), options_(request.options), context_(context) {
    check_request(request_);
    record_.device = device_info(context_);  // before anything is read: to ask for one that is not there costs no time
    if (!options_.sizing.empty() && !options_.was_given("vertices")) options_.values.vertices.reset();
    record_.options = options_.values;
    record_.output = named_output(request_.output.path, request_.output.format, request_.stop_after);
    options_.values.want_shell |= !request_.save_shell.empty() || !request_.save_voronoi.empty() || stops_early();
    options_.values.want_digests |= measures_all();
  }

  RunResult from_files() {
    return saying_what_stands([&] {
      check_outputs(request_);
      return steps(read());
    });
  }

  RunResult from(Input input) {
    return saying_what_stands([&] {
      check_outputs(request_);
      take(input);
      return steps(std::move(input));
    });
  }

  RunEstimate estimate() {
    return saying_what_stands([&] { return estimate_of(read()); });
  }
  RunEstimate estimate_of(const Input& input) {
    return saying_what_stands([&] {
      read_sizing_field();
      if (input.stage)
        throw Error(ErrorCode::usage, "options", "--dry-run needs a mesh as INPUT, a stage file has its grid already");
      return estimate_run(input.soup, measure_topology(input.soup, context_).topology, options_.values);
    });
  }

 private:
  RunResult steps(Input input) {
    note_what_stage_files_leave_out(input);
    choose_attributes(input, options_.values.attributes, stops_early() ? "vdb" : record_.output.format,
                      record_.attributes, [&](MessageKind kind, const std::string& text) { tell(kind, text); });
    // A Voronoi stage file does not hold the seeds of patches: then nothing is cut along seams.
    std::vector<Attribute> attributes;
    const bool follows_seams = request_.save_voronoi.empty();
    if (!follows_seams) attributes.swap(input.soup.attributes);
    read_sizing_field();
    read_lines();
    Prepared prepared = step("prepare", [&] { return prepare_from(input); });
    if (follows_seams) attributes.swap(input.soup.attributes);
    for (const std::string& text : warnings_of_repair(record_.report, record_.input.name())) warn(text);
    if (measures_all()) step("risks", [&] { count_risks(prepared); });
    save_shell_if_asked(prepared);
    if (request_.stop_after == StopAfter::shell) return finish({});
    if (!options_.values.want_shell && options_.values.method == Method::sheet)
      prepared.samples = {};  // made the sheet, and are not read again
    SeedSet seeds = step("relax", [&] { return relaxed_seeds(input, prepared); });
    save_voronoi_if_asked(prepared, seeds);
    if (request_.stop_after == StopAfter::voronoi) return finish({});
    TriangleMesh mesh =
        step("triangulate", [&] { return triangulate(prepared, seeds, options_.values, record_.report, context_); });
    step("measure", [&] { measure(mesh); });
    if (measures_all() || request_.gates.needs_distance())
      step("distance", [&] { measure_distances(mesh, to_world(to_host(prepared.surface))); });
    if (!attributes.empty())
      mesh.attributes = step("attributes", [&] { return transfer_attributes(input.soup, attributes, mesh, context_); });
    mesh.files = std::move(input.soup.files);
    if (const auto& previous = options_.values.previous) add_motion_attributes(*previous, mesh);
    if (options_.values.color_features) show_features(mesh);
    const OutputRequest& output = record_.output;
    if (!output.path.empty())
      write_step("write", output.path, [&] {
        write_mesh(output.path, mesh, {output.format, request_.overwrite, options_.values.color_features});
      });
    return finish(std::move(mesh));
  }

  bool stops_early() const { return request_.stop_after != StopAfter::mesh; }
  bool measures_all() const {
    return request_.measures == Measures::all || !request_.statistics.empty() || !request_.report.empty();
  }

  template <class Work>
  std::invoke_result_t<Work> step(const char* name, Work work) {
    if (context_.cancel) throw Error(ErrorCode::interrupted, name, "interrupted");
    tell_progress(name, 0);
    struct Book {
      Run& run;
      const char* name;
      Clock::time_point start = Clock::now();
      ~Book() { run.record_.times.push_back({name, ms_since(start)}); }
    };
    Book book{*this, name};
    if constexpr (std::is_void_v<std::invoke_result_t<Work>>) {
      work();
      tell_progress(name, 1);
    } else {
      auto product = work();
      tell_progress(name, 1);
      return product;
    }
  }

  void tell_progress(const char* name, double fraction) const {
    if (context_.progress) context_.progress(name, fraction);
  }

  template <class Work>
  void write_step(const char* name, const std::string& path, Work work) {
    step(name, [&] {
      around_write(path, work);
      written_ += (written_.empty() ? "" : ", ") + path;
    });
  }

  void around_write(const std::string& path, const std::function<void()>& write) const {
    if (request_.around_write)
      request_.around_write(path, write);
    else
      write();
  }

  template <class Work>
  std::invoke_result_t<Work> saying_what_stands(Work work) {
    try {
      return work();
    } catch (const Error& e) {
      if (e.code() != ErrorCode::interrupted) throw;
      throw Error(e.code(), e.stage(),
                  "interrupted; " + (written_.empty() ? "nothing was written" : "written before: " + written_));
    }
  }

  Input read() {
    return step("read", [&] {
      InputRequest request = request_.input;
      request.creases = volume_creases(options_.values.features);
      Input input = read_input(request, context_.memory_limit_bytes,
                               [&](MessageKind kind, const std::string& text) { tell(kind, text); });
      take(input);
      return input;
    });
  }

  void take(const Input& input) {
    record_.input = input.facts;
    if (!input.stage) return;
    options_ = adopt_options(*input.stage, input.facts.path, options_);
    check_method(options_);
    possible_features(options_.values, request_);  // refuses those of the stage file
    if (input.stage->seeds && request_.stop_after == StopAfter::shell)
      throw Error(ErrorCode::usage, "options", "INPUT is past the shell already; leave out --stop-after shell");
  }

  /// Attributes are on the input as it was read, which a stage file does not hold.
  void note_what_stage_files_leave_out(const Input& input) {
    if (input.stage) {
      left_out_ = input.stage->info.left_out;
      if (!left_out_.empty())
        warn(input.facts.name() + ": the result is without " + left_out_ +
             ", and not cut along their seams: a stage file does not hold them; remesh the input itself to keep them");
      return;
    }
    const auto& asked = options_.values.attributes;
    for (const Attribute& a : input.soup.attributes)
      if (!asked || std::count(asked->begin(), asked->end(), a.name) > 0)
        left_out_ += (left_out_.empty() ? "" : ", ") + a.name;
    if (!left_out_.empty()) left_out_ += " of " + input.facts.name();
  }

  void read_sizing_field() {
    if (options_.sizing.empty()) return;
    options_.values.sizing = step("sizing", [&] { return read_sizing(options_.sizing, context_.memory_limit_bytes); });
    tell(MessageKind::note, "sizing: " + options_.sizing);
  }

  void read_lines() {
    Features& features = options_.values.features;
    if (features.line_file.empty()) return;
    features.lines = step("lines", [&] { return read_polylines(features.line_file); });
    tell(MessageKind::note, "lines to keep: " + features.line_file);
  }

  Prepared prepare_from(Input& input) {
    RemeshOptions options = options_.values;
    options.features = possible_features(options, request_);
    options.want_samples = measures_all();  // by find_risks
    if (!input.stage) return prepare(input.soup, options, record_.report, context_);
    if (input.stage->seeds) options.features = {Features::Creases::off, 0};  // they stand on the sheet
    return prepare(std::move(input.stage->surface), input.stage->info.closing_vox, options, record_.report, context_);
  }

  SeedSet relaxed_seeds(Input& input, const Prepared& prepared) {
    if (!input.stage || !input.stage->seeds) return relax(prepared, options_.values, record_.report, context_);
    SeedSet& seeds = *input.stage->seeds;
    record_.report.seeds = seeds.size();
    for (const uint32_t home : seeds.home)
      if (int64_t(home) >= prepared.sheet.vertex_count())
        throw Error(ErrorCode::unreadable_input, input.facts.path,
                    "a seed sits on vertex " + std::to_string(home) + " of a sheet that has " +
                        std::to_string(prepared.sheet.vertex_count()) +
                        "; the file's surface and seeds do not belong together: save it anew");
    return std::move(seeds);
  }

  StageWriteOptions stage_options(const Prepared& prepared) const {
    StageWriteOptions options;
    options.options_json = options_json(options_.values);
    options.closing_vox = prepared.closing_vox;
    options.overwrite = request_.overwrite;
    options.left_out = left_out_;
    if (prepared.closing_vox > 0 && !prepared.grown)
      options.bridges = bridging_voxels(prepared.sheet, find_bridges(prepared.sites, prepared.sheet));
    return options;
  }

  /// Files that keep this stage: one on the way, and the output of a run that stops there.
  std::vector<std::string> stage_files(const std::string& saved, StopAfter stage) const {
    std::vector<std::string> files;
    if (!saved.empty()) files.push_back(saved);
    if (request_.stop_after == stage && !request_.output.path.empty()) files.push_back(request_.output.path);
    return files;
  }

  void save_shell_if_asked(const Prepared& p) {
    for (const std::string& path : stage_files(request_.save_shell, StopAfter::shell))
      write_step("save-shell", path, [&] { save_shell(path, p.surface, p.samples, p.shell, stage_options(p)); });
  }

  void save_voronoi_if_asked(const Prepared& p, const SeedSet& seeds) {
    const std::vector<std::string> files = stage_files(request_.save_voronoi, StopAfter::voronoi);
    if (files.empty()) return;
    const VoronoiLabels labels = step("flood", [&] { return flood_shell(p.shell, seeds, context_); });
    if (options_.values.want_digests) record_.report.digests["labels"] = digest_text(digest(labels));
    for (const std::string& path : files)
      write_step("save-voronoi", path, [&] {
        save_voronoi(path, p.surface, p.samples, p.shell, seeds, labels, stage_options(p));
        save_preview(preview_path(path), p.surface.frame, p.shell, labels, stage_options(p));
      });
  }

  /// On the triangles alone: no stage's word is taken for it.
  void measure(const TriangleMesh& mesh) {
    record_.vertices = int64_t(mesh.vertices.size());
    record_.triangles = int64_t(mesh.triangles.size());
    if (request_.measures == Measures::none && !measures_all() && !request_.gates.any()) return;
    record_.topology = check_mesh(mesh);
    const int64_t borders = record_.report.features.border_loops;
    if (!record_.topology->is_manifold_with(borders) && record_.report.dual.failed_cells == 0)
      warn(std::string("the result is not a ") + (borders > 0 ? "" : "closed ") +
           "2-manifold, which should not be: please report the input");
    record_.quality = measure_quality(mesh);
    for (const std::string& text : warnings_of_quality(*record_.quality)) warn(text);
  }

  void measure_distances(const TriangleMesh& mesh, const TriangleMesh& input) {
    record_.distance = measure_distance(mesh, input, context_);
    if (record_.report.features.border_loops > 0) record_.borders = measure_borders(mesh, input, context_);
  }

  void show_features(TriangleMesh& mesh) {
    if (mesh.features.patch.empty()) warn("the result has no curves that colours could show");
    color_features(mesh, record_.attributes);
  }

  void count_risks(const Prepared& p) {
    const bool has_sites = p.sites.voxels.voxel_count() > 0;  // a frame of a sequence may have done without
    const SiteSamples made =
        has_sites ? SiteSamples{} : sample_sites(p.surface, voxelize(p.surface, context_), context_);
    record_.risky_sites = 0;
    for (const uint8_t risky : find_risks(p.surface, has_sites ? p.samples : made)) record_.risky_sites += risky;
  }

  void warn(const std::string& text) { tell(MessageKind::warning, text); }
  void tell(MessageKind kind, const std::string& text) {
    if (kind == MessageKind::warning) record_.warnings.push_back(text);
    if (request_.tell) request_.tell(kind, text);
  }

  RunResult finish(TriangleMesh mesh) {
    record_.total_ms = ms_since(start_);
    record_.host_peak_bytes = process_peak_bytes();
    record_.device_peak_bytes = device_memory_peak_bytes(context_.device);
    for (const std::string& text : record_.report.warnings) warn(text);
    if (!request_.statistics.empty()) around_write(request_.statistics, [&] { write_statistics(); });
    std::vector<std::string> missed = missed_gates(request_.gates, record_);
    return {std::move(mesh), std::move(record_), request_.gates.asked, std::move(missed)};
  }

  void write_statistics() const {
    OutputFile file(request_.statistics, true);  // check_outputs has refused what may not be replaced
    file.write(statistics_json(record_));
    file.commit();
  }

  const RunRequest& request_;
  AskedOptions options_;  ///< of the request, or of the stage file's run where the request leaves them open
  Context& context_;
  RunRecord record_;
  std::string left_out_;  ///< of the input, by stage files
  std::string written_;   ///< files that are whole, for who interrupts
  Clock::time_point start_ = Clock::now();
};

}  // namespace

RunResult run(const RunRequest& request, Context& context) { return Run(request, context).from_files(); }

RunResult run(Input input, const RunRequest& request, Context& context) {
  return Run(request, context).from(std::move(input));
}

RunEstimate dry_run(const RunRequest& request, Context& context) { return Run(request, context).estimate(); }

RunEstimate dry_run(const Input& input, const RunRequest& request, Context& context) {
  return Run(request, context).estimate_of(input);
}

VolumeCreases volume_creases(const Features& features) {
  if (features.creases == Features::Creases::off) return VolumeCreases::none;
  return features.creases == Features::Creases::automatic ? VolumeCreases::of_sharp_bodies : VolumeCreases::all;
}

}  // namespace isoshell
