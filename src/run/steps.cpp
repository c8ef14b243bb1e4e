// See run/steps.h.
#include "isoshell/run/steps.h"

#include <chrono>
#include <utility>

#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/advanced/transfer_attributes.h"
#include "isoshell/error.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/io/polyline_file.h"
#include "isoshell/repair.h"
#include "progress/step.h"
#include "run/added_attributes.h"
#include "run/choose_attributes.h"
#include "run/color_features.h"
#include "run/measures.h"
#include "run/outputs.h"
#include "run/part_walls.h"
#include "run/process_memory.h"
#include "run/resume.h"
#include "run/run_progress.h"
#include "run/stage_files.h"
#include "run/warnings.h"

namespace isoshell {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void refuse_use(const char* message) { throw Error(ErrorCode::usage, "options", message); }

}  // namespace

class RunSteps::Run {
 public:
  explicit Run(RunRequest request) : request_(std::move(request)), options_(request_.options) {
    check_whole_request(request_);
    if (options_.lengths_decide()) options_.values.vertices.reset();
    record_.options = options_.values;
    record_.output = request_.output;
    record_.output.format = named_output(request_.output.path, request_.output.format, request_.stop_after).format;
    options_.values.want_shell |= !request_.save_shell.empty() || !request_.save_voronoi.empty() ||
                                  request_.stop_after == StopAfter::shell || request_.stop_after == StopAfter::voronoi;
    if (makes_level_set(request_)) options_.values.level_set_band_vox = request_.level_set.band_vox;
    options_.values.want_digests |= measures_all(request_);
  }

  /// Runs steps in a context, and says what was written before an interruption.
  template <class Work>
  std::invoke_result_t<Work> in(Context& context, Work work) {
    struct Book {
      Run& run;
      ~Book() { run.before_ms_ += ms_since(run.start_); }
    };
    context_ = &context;
    start_ = Clock::now();
    const Book book{*this};
    const Metered metered(progress_.meter, context);
    return naming_written(written_, [&]() -> std::invoke_result_t<Work> {
      if (record_.device.backend == "cpu") record_.device = device_info(context);  // no time is lost without one
      return work();
    });
  }

  void report_to(Tell tell, AroundWrite around_write, TellProgress progress) {
    request_.tell = std::move(tell);
    request_.around_write = std::move(around_write);
    progress_.meter.tell_to(std::move(progress));
  }

  void read(const std::function<Input()>& another_way = {}) {
    const auto own_way = [&] { return read_input_of(request_, *context_, teller()); };
    if (!input_) take(timed("read", another_way ? another_way : own_way));
  }

  void take(Input input) {
    input_ = std::move(input);
    record_.input = input_->facts;
    if (request_.input.samples_grids()) timed("grids", [&] { read_other_grids(request_.input, *input_, *context_); });
    if (!input_->stage) return;
    options_ = adopt_options(*input_->stage, input_->facts.path, options_);
    check_together(options_);
    possible_features(options_.values, request_);  // refuses those of the stage file
    if (input_->stage->seeds && request_.stop_after == StopAfter::shell)
      refuse_use("INPUT is past the shell already; leave out --stop-after shell");
  }

  void check_files() {
    if (!std::exchange(has_checked_files_, true)) check_outputs(request_);
  }

  const Input& input() const { return input_.value(); }
  RunEstimate estimate() {
    read();
    if (input_->stage) refuse_use("--dry-run needs a mesh as INPUT, a stage file has its grid already");
    find_surface();
    read_sizing_field();
    return estimate_run(surface(), measure_topology(surface(), *context_).topology, options_.values);
  }

  const Prepared& prepare() {
    if (prepared_) return *prepared_;
    check_files();
    read();
    find_surface();
    progress_.expect(surface(), options_.values, *context_);
    const bool has_regions = !surface().regions.empty();  // then distances are from these walls
    if (has_regions) refuse_level_set_of_regions(request_);
    region_files_ = checked_region_files(request_, surface().regions);
    left_out_ = left_out_of_stage_files(*input_, options_.values.attributes);
    if (input_->stage && !left_out_.empty())
      warn(input_->facts.name() + ": the result is without " + left_out_ +
           ", and not cut along their seams: a stage file does not hold them; remesh the input itself to keep them");
    read_sizing_field();  // may be an attribute, whether it is kept or not
    const std::string format = request_.stop_after == StopAfter::mesh ? record_.output.format : "vdb";
    choose_attributes(*input_, options_.values.attributes, format, has_regions, record_.attributes, teller());
    // A Voronoi stage file does not hold the seeds of patches: then nothing is cut along seams.
    std::vector<Attribute> attributes;
    if (!request_.save_voronoi.empty()) attributes.swap(input_->soup.attributes);
    read_lines();
    prepared_ = timed("prepare", [&] { return prepared_from(*input_); });
    progress_.expect(*prepared_);
    if (!attributes.empty()) input_->soup.attributes = std::move(attributes);
    if (input_->soup.attributes.empty() && !(has_regions && measures_distance(request_)))
      free_all_but_files(input_->soup);
    record_.report = prepared_->report();
    for (const std::string& text : warnings_of_repair(record_.report, record_.input.name(), has_regions)) warn(text);
    if (measures_all(request_) && !has_regions)
      timed("risks", [&] { record_.risky_sites = count_risky_sites(*prepared_, *context_); });
    return *prepared_;
  }

  const Relaxed& relax() {
    if (relaxed_) return *relaxed_;
    if (is_over_) refuse_use("the seeds went into the mesh; keep them by finish(context, true)");
    prepare();
    if (!options_.values.want_shell && options_.values.method == Method::sheet)
      prepared_->free_samples();  // made the sheet, and are not read again
    const bool has_seeds = input_->stage && input_->stage->seeds;
    relaxed_ = timed("relax", [&] {
      return has_seeds ? seeds_of_stage(*input_, *prepared_) : isoshell::relax(*prepared_, *context_);
    });
    record_.report = relaxed_->report;
    return *relaxed_;
  }

  RunResult finish(bool keeps_seeds) {
    if (is_over_) refuse_use("the run is over; begin another");
    prepare();
    for (const std::string& path : stage_files(request_, request_.save_shell, StopAfter::shell))
      save_shell(path, request_.overwrite);
    write_level_set(made_level_set(LevelSetOf::input, {}));
    if (request_.stop_after == StopAfter::shell || request_.stop_after == StopAfter::level_set) return result({});
    relax();
    const std::vector<std::string> voronoi = stage_files(request_, request_.save_voronoi, StopAfter::voronoi);
    if (!voronoi.empty()) save_voronoi(voronoi, request_.overwrite);
    if (request_.stop_after == StopAfter::voronoi) return result({});
    TriangleMesh mesh = timed("triangulate", [&] { return triangulated(keeps_seeds); });
    std::vector<WorldPoint> positions = put_as_in_file(mesh, record_);
    timed("measure", [&] { measure(mesh, positions); });
    if (measures_distance(request_))
      timed("distance", [&] { measure_distances(*prepared_, surface(), mesh, record_, *context_); });
    if (is_coarse(record_)) mesh.vertices = std::move(positions);
    TriangleSoup& soup = input_->soup;
    if (!soup.attributes.empty())
      mesh.attributes =
          timed("attributes", [&] { return transfer_attributes(soup, soup.attributes, mesh, *context_); });
    mesh.files = std::move(soup.files);
    if (input_->grids)
      timed("sample", [&] { add_grid_attributes(*input_, record_.output.format, mesh, record_.attributes, teller()); });
    if (const auto& previous = options_.values.previous) add_motion_attributes(*previous, mesh);
    if (options_.values.color_features) color_features(mesh, record_.attributes, teller());
    const std::shared_ptr<const LevelSet> of_result = made_level_set(LevelSetOf::result, mesh);  // may refuse the mesh
    if (const std::string& path = record_.output.path; !path.empty())
      write_step("write", path,
                 [&] { write_output(mesh, request_, options_.values.color_features, record_.files.front()); });
    for (const RegionFile& file : files_of_kept(region_files_, mesh, [&](const std::string& text) { warn(text); }))
      write_step("write", file.path, [&] { write_region(file, mesh, request_.overwrite, record_); });
    for (const std::string& text : warnings_of_files(record_.files, offset_to_origin(mesh))) warn(text);
    write_level_set(of_result);
    return result(std::move(mesh));
  }

  void save_shell(const std::string& path, bool overwrite) {
    check_shell_is_wanted();
    const Prepared& p = prepare();
    write_step("save-shell", path,
               [&] { isoshell::save_shell(path, p.surface(), p.samples(), p.shell(), stage_options(overwrite)); });
  }

  /// Null where none is asked for.
  std::shared_ptr<const LevelSet> made_level_set(LevelSetOf of, const TriangleMesh& mesh) {
    if (!makes_level_set_of(request_, of)) return nullptr;
    const auto set = std::make_shared<const LevelSet>(
        timed("level-set", [&] { return level_set_of_run(request_, *prepared_, mesh, *context_); }));
    if (request_.stop_after == StopAfter::level_set) record_.report.grid.active_voxels = set->voxels.voxel_count();
    return set;
  }

  void write_level_set(const std::shared_ptr<const LevelSet>& set) {
    if (!set) return;
    for (const std::string& path : level_set_files(request_))
      write_step("save-level-set", path, [&] { save_level_set(path, *set, level_set_write_options(request_)); });
    if (request_.level_set.keep) set_ = set;
  }

  void save_voronoi(const std::vector<std::string>& paths, bool overwrite) {
    check_shell_is_wanted();
    const SeedSet& seeds = relax().seeds;
    const Prepared& p = *prepared_;
    refuse_seeds_of_patches(p);
    const VoronoiLabels labels = timed("flood", [&] { return flood_shell(p.shell(), seeds, *context_); });
    if (options_.values.want_digests)
      record_.report.digests["labels"] = relaxed_->report.digests["labels"] = digest_text(digest(labels));
    const StageWriteOptions options = stage_options(overwrite);
    for (const std::string& path : paths)
      write_step("save-voronoi", path, [&] { save_with_preview(path, p, seeds, labels, options); });
  }

 private:
  void check_shell_is_wanted() const {
    if (!options_.values.want_shell) refuse_use("a stage file has the shell, and want_shell did not ask for it");
  }

  const TriangleSoup& surface() const { return walls_ ? *walls_ : input_->soup; }

  template <class Work>
  std::invoke_result_t<Work> timed(const char* name, Work work) {
    struct Book {
      Run& run;
      const char* name;
      Clock::time_point start = Clock::now();
      ~Book() { run.record_.times.push_back({name, ms_since(start)}); }
    };
    return step(name, *context_, progress_.meter, [&] {
      Book book{*this, name};
      return work();
    });
  }

  template <class Work>
  void write_step(const char* name, const std::string& path, Work work) {
    timed(name, [&] {
      around_write(path, work);
      written_ += (written_.empty() ? "" : ", ") + path;
    });
  }

  void around_write(const std::string& path, const std::function<void()>& write) const {
    request_.around_write ? request_.around_write(path, write) : write();
  }

  /// That is meshed, and measured from: the input without far vertices, or the walls of its parts.
  void find_surface() {
    if (std::optional<TriangleSoup> pulled = pull_back_far_vertices(input_->soup, options_.values, *context_))
      input_->soup = std::move(*pulled);
    if (const RemeshOptions& options = options_.values; !options.regions.empty() && !walls_)
      walls_ = timed("regions", [&] { return walls_of_parts(*input_, options, teller(), record_.input, *context_); });
  }

  void read_sizing_field() {
    if (options_.sizing.empty() || options_.values.sizing) return;  // there is none, or it was read
    options_.values.sizing = timed("sizing", [&] { return sizing_of_input(*input_, options_.sizing, *context_); });
    tell(MessageKind::note, "sizing: " + options_.sizing);
  }

  void read_lines() {
    const std::string& file = options_.values.line_file;
    if (file.empty()) return;
    options_.values.features.lines = timed("lines", [&] { return read_polylines(file, context_->memory_limit_bytes); });
    tell(MessageKind::note, "lines to keep: " + file);
  }

  Prepared prepared_from(Input& input) {
    RemeshOptions options = options_.values;
    options.features = possible_features(options_.values, request_);
    options.want_samples = measures_all(request_);  // by find_risks
    options.regions.clear();                        // surface() has them
    options.snap_world.reset();
    if (!input.stage) return isoshell::prepare(surface(), options, *context_);
    if (input.stage->seeds) options.features = {Features::Creases::off, 0};  // they stand on the sheet
    return isoshell::prepare(std::move(input.stage->surface), input.stage->info.closing_vox, options, *context_);
  }

  TriangleMesh triangulated(bool keeps_seeds) {
    Relaxed relaxed = keeps_seeds ? Relaxed{to_host(relaxed_->seeds), relaxed_->report} : std::move(*relaxed_);
    if (!keeps_seeds) relaxed_.reset();
    RemeshResult made = triangulate(*prepared_, std::move(relaxed), *context_);
    record_.report = std::move(made.report);
    return std::move(made.mesh);
  }

  StageWriteOptions stage_options(bool overwrite) const {
    return stage_write_options(*prepared_, options_json(options_.values), left_out_, overwrite);
  }

  void measure(TriangleMesh& mesh, std::vector<WorldPoint>& exact) {
    const bool is_asked = request_.measures != Measures::none || measures_all(request_) || request_.gates.any();
    for (const std::string& text : measure_mesh(mesh, exact, is_asked, record_, *context_)) warn(text);
  }

  Tell teller() {
    return [this](MessageKind kind, const std::string& text) { tell(kind, text); };
  }
  void warn(const std::string& text) { tell(MessageKind::warning, text); }
  void tell(MessageKind kind, const std::string& text) {
    if (kind == MessageKind::warning) record_.warnings.push_back(text);
    if (request_.tell) request_.tell(kind, text);
  }

  RunResult result(TriangleMesh mesh) {
    is_over_ = true;
    RunRecord record = std::move(record_);
    record.total_ms = before_ms_ + ms_since(start_);
    record.host_peak_bytes = process_peak_bytes();
    record.device_peak_bytes = device_memory_peak_bytes(context_->device);
    for (const std::string& text : record.report.warnings) {
      record.warnings.push_back(text);
      if (request_.tell) request_.tell(MessageKind::warning, text);
    }
    if (!request_.statistics.empty())
      around_write(request_.statistics,
                   [&] { write_text(request_.statistics, statistics_json(record), request_.overwrite); });
    std::vector<std::string> missed = missed_gates(request_.gates, record);
    progress_.meter.finish();
    return {std::move(mesh), std::move(record), request_.gates.requested, std::move(missed), request_.made_of, set_};
  }

  RunRequest request_;
  RunProgress progress_{request_};
  RequestedOptions options_;  ///< of the request, or of the stage file's run where the request leaves them open
  Context* context_ = nullptr;
  bool has_checked_files_ = false, is_over_ = false;
  std::optional<Input> input_;
  std::optional<TriangleSoup> walls_;  ///< that are meshed in place of the input's faces
  std::optional<Prepared> prepared_;
  std::optional<Relaxed> relaxed_;
  RunRecord record_;
  std::shared_ptr<const LevelSet> set_;  ///< where it is kept
  std::vector<RegionFile> region_files_;
  std::string left_out_;                           ///< of the input, by stage files
  std::string written_ = request_.written_before;  ///< files that are whole, for who interrupts
  Clock::time_point start_;                        ///< of the steps that go on
  double before_ms_ = 0;                           ///< of those before them
};

RunSteps::RunSteps(RunRequest request) : run_(std::make_unique<Run>(std::move(request))) {}
RunSteps::RunSteps(RunSteps&&) noexcept = default;
RunSteps& RunSteps::operator=(RunSteps&&) noexcept = default;
RunSteps::~RunSteps() = default;

void RunSteps::read(Context& context, const std::function<Input()>& another_way) {
  run_->in(context, [&] {
    run_->check_files();
    run_->read(another_way);
  });
}

void RunSteps::take(Input input, Context& context) {
  run_->in(context, [&] { run_->take(std::move(input)); });
}

const Input& RunSteps::input() const { return run_->input(); }

RunEstimate RunSteps::estimate(Context& context) {
  return run_->in(context, [&] { return run_->estimate(); });
}

const Prepared& RunSteps::prepare(Context& context) {
  return run_->in(context, [&]() -> const Prepared& { return run_->prepare(); });
}

const Relaxed& RunSteps::relax(Context& context) {
  return run_->in(context, [&]() -> const Relaxed& { return run_->relax(); });
}

void RunSteps::save_shell(const std::string& path, bool overwrite, Context& context) {
  run_->in(context, [&] { run_->save_shell(path, overwrite); });
}

void RunSteps::save_voronoi(const std::string& path, bool overwrite, Context& context) {
  run_->in(context, [&] { run_->save_voronoi({path}, overwrite); });
}

RunResult RunSteps::finish(Context& context, bool keeps_seeds) {
  return run_->in(context, [&] { return run_->finish(keeps_seeds); });
}

void RunSteps::report_to(Tell tell, AroundWrite around_write, TellProgress progress) {
  run_->report_to(std::move(tell), std::move(around_write), std::move(progress));
}

}  // namespace isoshell
