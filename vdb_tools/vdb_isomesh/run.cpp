// Reads, calls the library step by step, keeps what was asked for, measures, writes.
#include "vdb_isomesh/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <type_traits>

#include "isoshell/error.h"
#include "isoshell/isoshell.h"
#include "vdb_isomesh/input.h"
#include "vdb_isomesh/interrupt.h"
#include "vdb_isomesh/memory.h"
#include "vdb_isomesh/output.h"
#include "vdb_isomesh/stage_options.h"
#include "vdb_isomesh/stats.h"

namespace isoshell::tool {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kNotableOpenPart = 0.01;  // of a surface of points that no point supports
constexpr double kPoorAngleDeg = 20;       // what the post lifts almost every triangle above by far

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What the run starts from: a soup, or a stage file.
struct Source {
  TriangleSoup soup;
  std::optional<StageFile> stage;
};

class Run {
 public:
  Run(const Arguments& a, Context& context, Console& console)
      : a_(a), options_(a.remesh), sizing_(a.sizing), context_(context), console_(console) {
    choose_device();
    options_.want_shell = keeps_shell();
    options_.want_digests = !a.stats.empty();
  }

  int go() {
    try {
      return steps();
    } catch (const Error& e) {
      if (e.code() != ErrorCode::interrupted) throw;
      throw Error(e.code(), e.stage(), "interrupted; " + what_stands());
    }
  }

 private:
  int steps() {
    if (!a_.dry_run) check_outputs(a_);
    Source source = step("read", [&] { return read(); });
    read_sizing_field();
    if (a_.dry_run) {
      print_estimate(source);
      return 0;
    }
    Prepared prepared = step("prepare", [&] { return prepare_from(source); });
    warn_of_dirt();
    if (!a_.stats.empty()) step("risks", [&] { count_risks(prepared); });
    save_shell_if_asked(prepared);
    if (a_.stop_after == StopAfter::shell) return finish();
    SeedSet seeds = step("relax", [&] { return relaxed_seeds(source, prepared); });
    save_voronoi_if_asked(prepared, seeds);
    if (a_.stop_after == StopAfter::voronoi) return finish();
    const TriangleMesh mesh =
        step("triangulate", [&] { return triangulate(prepared, seeds, options_, record_.report, context_); });
    step("measure", [&] { measure(mesh); });
    if (!a_.stats.empty() || a_.gates.max_deviation_world)
      step("distance",
           [&] { record_.distance = measure_distance(mesh, to_world(to_host(prepared.surface)), context_); });
    write_step("write", a_.output, [&] { write_mesh(a_.output, mesh, {mesh_format(a_.output_format), a_.force}); });
    return finish();
  }

  /// Before anything is read: asking for a device that is not there should cost no time.
  void choose_device() {
    const DeviceInfo& d = record_.device = device_info(context_);
    const bool cuda = d.backend == "cuda";
    if (context_.memory_limit_bytes <= 0)
      context_.memory_limit_bytes = cuda ? std::max<int64_t>(d.free_bytes / 5 * 4, 1) : default_memory_limit_bytes();
    if (!cuda) return;
    console_.detail("device: cuda:" + std::to_string(d.number) + ", " + d.name + ", " + readable_bytes(d.free_bytes) +
                    " of " + readable_bytes(d.memory_bytes) + " free, driver " +
                    (d.driver_version.empty() ? "" : d.driver_version + ", ") + "CUDA " + d.cuda_version);
  }

  bool keeps_shell() const {
    return !a_.save_shell.empty() || !a_.save_voronoi.empty() || a_.stop_after != StopAfter::mesh;
  }

  template <class Work>
  std::invoke_result_t<Work> step(const char* name, Work work) {
    if (context_.cancel) throw Error(ErrorCode::interrupted, name, "interrupted");
    console_.progress(name, 0);
    struct Book {
      Run& run;
      const char* name;
      Clock::time_point start = Clock::now();
      ~Book() { run.record_.times.push_back({name, ms_since(start)}); }
    };
    Book book{*this, name};
    if constexpr (std::is_void_v<std::invoke_result_t<Work>>) {
      work();
      console_.progress(name, 1);
    } else {
      auto product = work();
      console_.progress(name, 1);
      return product;
    }
  }

  /// Standard output cannot be left in order: a run that is stuck there may be ended.
  template <class Work>
  void write_step(const char* name, const std::string& path, Work work) {
    step(name, [&] {
      std::optional<WhileWriting> writing;
      if (path != "-") writing.emplace();
      work();
      written_ += (written_.empty() ? "" : ", ") + path;
    });
  }

  std::string what_stands() const { return written_.empty() ? "nothing was written" : "written before: " + written_; }

  Source read() {
    record_.input.kind = classify_input(a_.input, a_.input_format);
    Source source;
    switch (record_.input.kind) {
      case InputKind::mesh:
        read_soup(source.soup);
        break;
      case InputKind::stage:
        read_stage_file(source);
        break;
      case InputKind::volume:
        read_volume_file(source.soup);
        break;
      case InputKind::points:
        make_surface(read_points(a_.input, a_.input_format == "xyz" ? PointFormat::xyz : PointFormat::pcd),
                     source.soup);
        break;
      case InputKind::ply:
        read_ply_file(source.soup);
        break;
    }
    if (a_.iso && record_.input.kind != InputKind::volume)
      throw Error(ErrorCode::usage, "command line", "--iso is for volumes; leave it out");
    return source;
  }

  std::string input_name() const { return a_.input == "-" ? "standard input" : a_.input; }

  void read_ply_file(TriangleSoup& soup) {
    PlyContent content = read_ply_content(a_.input);
    record_.input.kind = content.is_points ? InputKind::points : InputKind::mesh;
    if (content.is_points) {
      if (content.unusable_faces > 0)
        warn(input_name() + ": none of its faces is usable (" + with_commas(content.unusable_faces) +
             "); it is read as a point cloud");
      make_surface(content.points, soup);
    } else {
      soup = std::move(content.mesh);
      note_soup(soup);
    }
  }

  void make_surface(const PointCloud& cloud, TriangleSoup& soup) {
    PointSurfaceInfo points;
    soup = surface_of_points(cloud, context_.memory_limit_bytes, points);
    note_soup(soup);
    record_.input.vertices = points.points;
    std::ostringstream text;
    text << input_name() << ": " << counted(points.points, "point") << ", spacing " << points.spacing_world
         << ", surface from voxels of " << points.voxel_size_world << ", normals "
         << (points.normals_given && !points.normals_ignored ? "given" : "estimated")
         << (points.normals_turned ? " and turned" : "");
    console_.detail(text.str());
    if (points.normals_ignored) warn(input_name() + ": its normals do not fit its points; others were estimated");
    if (points.outliers > 0)
      warn(input_name() + ": " + counted(points.outliers, "point") + " left out, far from all others");
    if (points.open_part < kNotableOpenPart) return;
    text.str("");
    text << input_name() << ": " << std::lround(100 * points.open_part)
         << " % of the surface has no points near it and was closed smoothly";
    warn(text.str());
  }

  void read_volume_file(TriangleSoup& soup) {
    VolumeInfo volume;
    soup = read_volume(a_.input, {a_.grid, a_.iso, context_.memory_limit_bytes}, volume);
    note_soup(soup);
    std::ostringstream text;
    text << input_name() << ": grid " << volume.grid << ", " << volume.grid_class << ", surface at " << volume.iso
         << ", voxel size " << volume.voxel_size_world << ", " << counted(volume.blocks, "block");
    console_.detail(text.str());
  }

  void read_soup(TriangleSoup& soup) {
    soup = read_mesh(a_.input, mesh_format(a_.input_format));
    note_soup(soup);
  }

  void note_soup(const TriangleSoup& soup) {
    InputFacts& facts = record_.input;
    facts.vertices = int64_t(soup.vertices.size());
    facts.faces = soup.faces_in_file;
    WorldPoint lo, hi;
    bounding_box(soup, lo, hi);
    facts.box_min = lo;
    facts.box_max = hi;
    console_.detail(input_name() + ": " + counted(facts.vertices, "vertex", "vertices") + ", " +
                    counted(facts.faces, "face"));
  }

  void read_stage_file(Source& source) {
    source.stage = isoshell::read_stage(a_.input);
    sizing_ = adopt_options(*source.stage, a_, options_);
    check_method(options_, sizing_);
    if (source.stage->seeds && a_.stop_after == StopAfter::shell)
      throw Error(ErrorCode::usage, "command line", "INPUT is past the shell already; leave out --stop-after shell");
    console_.detail(a_.input + ": stage " + source.stage->info.stage + ", " +
                    counted(source.stage->shell.voxels.voxel_count(), "active voxel"));
  }

  void read_sizing_field() {
    if (sizing_.empty()) return;
    options_.sizing = step("sizing", [&] { return read_sizing(sizing_, context_.memory_limit_bytes); });
    console_.detail("sizing: " + sizing_);
  }

  Prepared prepare_from(Source& source) {
    if (!source.stage) return prepare(source.soup, options_, record_.report, context_);
    return prepare(std::move(source.stage->surface), source.stage->info.closing_vox, options_, record_.report,
                   context_);
  }

  SeedSet relaxed_seeds(Source& source, const Prepared& prepared) {
    if (!source.stage || !source.stage->seeds) return isoshell::relax(prepared, options_, record_.report, context_);
    record_.report.seeds = source.stage->seeds->size();
    for (const uint32_t home : source.stage->seeds->home)
      if (int64_t(home) >= prepared.sheet.vertex_count())
        throw Error(ErrorCode::unreadable_input, a_.input,
                    "a seed sits on vertex " + std::to_string(home) + " of a sheet that has " +
                        std::to_string(prepared.sheet.vertex_count()) +
                        "; the file's surface and seeds do not belong together: save it anew");
    return std::move(*source.stage->seeds);
  }

  StageWriteOptions stage_options(const Prepared& prepared) const {
    StageWriteOptions options;
    options.options_json = options_json(options_);
    options.closing_vox = prepared.closing_vox;
    options.overwrite = a_.force;
    if (prepared.closing_vox > 0 && prepared.grown_vox == 0)
      options.bridges = bridging_voxels(prepared.sheet, find_bridges(prepared.sites, prepared.sheet));
    return options;
  }

  void save_shell_if_asked(const Prepared& p) {
    for (const std::string& path : {a_.save_shell, a_.stop_after == StopAfter::shell ? a_.output : std::string()})
      if (!path.empty())
        write_step("save-shell", path, [&] { save_shell(path, p.surface, p.samples, p.shell, stage_options(p)); });
  }

  void save_voronoi_if_asked(const Prepared& p, const SeedSet& seeds) {
    if (a_.save_voronoi.empty() && a_.stop_after != StopAfter::voronoi) return;
    const VoronoiLabels labels = step("flood", [&] { return flood_shell(p.shell, seeds, context_); });
    if (options_.want_digests) record_.report.digests["labels"] = digest_text(digest(labels));
    for (const std::string& path : {a_.save_voronoi, a_.stop_after == StopAfter::voronoi ? a_.output : std::string()})
      if (!path.empty())
        write_step("save-voronoi", path, [&] {
          save_voronoi(path, p.surface, p.samples, p.shell, seeds, labels, stage_options(p));
          save_preview(preview_path(path), p.surface.frame, p.shell, labels, stage_options(p));
        });
  }

  /// On the triangles alone: no stage's word is taken for it.
  void measure(const TriangleMesh& mesh) {
    record_.vertices = int64_t(mesh.vertices.size());
    record_.triangles = int64_t(mesh.triangles.size());
    if (a_.stats.empty() && !a_.gates.any() && a_.verbosity == 0) return;
    record_.topology = check_mesh(mesh);
    if (!record_.topology->is_closed_manifold() && record_.report.dual.failed_cells == 0)
      warn("the result is not a closed 2-manifold, which should not be: please report the input");
    record_.quality = measure_quality(mesh);
    if (record_.quality->theta_min_deg < kPoorAngleDeg) warn_of_angle(mesh, *record_.quality);
  }

  void warn_of_angle(const TriangleMesh& mesh, const MeshQuality& quality) {
    WorldPoint middle{0, 0, 0};
    for (const uint32_t v : mesh.triangles[size_t(quality.theta_min_at)]) {
      const WorldPoint& p = mesh.vertices[v];
      middle = {middle.x + p.x / 3, middle.y + p.y / 3, middle.z + p.z / 3};
    }
    std::ostringstream text;
    text << "an angle of " << quality.theta_min_deg << " degrees near " << middle.x << ' ' << middle.y << ' '
         << middle.z
         << ": the surface may be narrower there than edges are long; more --vertices make better triangles";
    warn(text.str());
  }

  void warn(const std::string& text) {
    record_.warnings.push_back(text);
    console_.warn(text);
  }

  void warn_of_dirt() {
    const DirtCounts& d = record_.report.dirt;
    const auto note = [&](int64_t count, const char* what) {
      if (count > 0) warn(input_name() + ": " + with_commas(count) + " " + what);
    };
    note(d.long_rows, "rows with values behind their last declared property, which were left out");
    note(d.surplus_rows, "rows left out behind the last that the header promises");
    note(d.surplus_bytes, "bytes left out behind the last row that the header promises");
    note(d.nonfinite_vertices, "vertices that are not finite");
    note(d.dropped_faces_nonfinite, "faces dropped, they use vertices that are not finite");
    note(d.short_faces, "faces of fewer than three corners dropped");
    note(d.degenerate_faces, "faces without area");
    note(d.duplicate_faces, "repeated faces");
    note(d.unreferenced_vertices, "vertices that no face uses");
    note(d.nonmanifold_edges, "edges that more than two faces share");
    note(d.inconsistent_edges, "edges whose two faces disagree about the orientation");
    const RepairReport& m = record_.report.mend;
    note(m.joined_vertices, "vertices of boundaries joined over cracks");
    note(m.fins, "fins dropped: small patches that hang on edges of more than two faces");
    note(m.islands, "islands dropped: small open patches apart from the rest");
    note(m.turned_faces, "faces turned to agree with their neighbours");
    std::ostringstream caps;
    caps << "holes closed by new faces, up to " << m.widest_cap_world << " wide";
    note(m.capped_loops, caps.str().c_str());
    note(m.tubes, "pairs of them joined: they face each other like the ends of a tube");
    const UnionReport& u = record_.report.unite;
    note(u.turned_components, "closed components turned outward");
    note(u.swallowed_components, "closed components dropped, they lie inside of others");
    note(u.cut_faces, "faces cut where closed components pass through each other; the result is their union");
    note(u.inner_surfaces, "inner surfaces kept, they bound hollows; --outer-only drops them");
    note(u.dropped_inner, "inner components dropped, only outer ones are wanted");
    note(m.open_loops, "open boundaries that are no holes; the result closes them or follows both sides");
  }

  void count_risks(const Prepared& p) {
    record_.risky_sites = 0;
    for (const uint8_t risky : find_risks(p.surface, p.samples)) record_.risky_sites += risky;
  }

  void print_estimate(const Source& source) {
    if (source.stage)
      throw Error(ErrorCode::usage, "command line",
                  "--dry-run needs a mesh as INPUT, a stage file has its grid already");
    DirtCounts dirt;
    const int64_t limit = context_.memory_limit_bytes;
    const RunEstimate e = estimate_run(source.soup, measure_topology(source.soup, dirt, context_), options_);
    const bool by_sizing = options_.sizing && options_.vertices == 0;
    std::ostringstream text;
    text << "estimate: resolution " << e.resolution << ", voxel size " << e.voxel_size_world << ", "
         << counted(e.sites, "site voxel") << ", " << counted(e.sheet_vertices, "sheet vertex", "sheet vertices")
         << ", " << (by_sizing ? "as many vertices as the sizing asks for" : counted(e.vertices, "vertex", "vertices"))
         << " in the result, about " << readable_bytes(e.bytes) << " of " << readable_bytes(limit) << " allowed";
    if (options_.sizing || options_.adaptivity > 0) text << "; edges that vary may take a finer grid, and more";
    console_.result(text.str());
    if (limit > 0 && e.bytes > limit)
      throw Error(ErrorCode::out_of_memory, "memory",
                  "the run needs about " + readable_bytes(e.bytes) + ", more than the limit of " +
                      readable_bytes(limit) + "; lower --resolution or raise --max-memory");
  }

  std::vector<std::string> failed_gates() const {
    std::vector<std::string> failed;
    const Gates& g = a_.gates;
    if (!g.any()) return failed;
    const MeshTopology& t = *record_.topology;
    const auto gate = [&](bool passed, const std::string& text) {
      if (!passed) failed.push_back(text);
    };
    if (g.closed)
      gate(t.closed, "closed: the mesh has " + counted(t.boundary_loops, "open boundary", "open boundaries"));
    if (g.manifold) gate(t.is_closed_manifold(), "manifold: the mesh is not a closed 2-manifold");
    if (g.no_self_intersections)
      gate(record_.report.post_done && record_.report.post.self_intersections == 0,
           "no-self-intersections: " +
               (record_.report.post_done
                    ? counted(record_.report.post.self_intersections, "pair", "pairs") + " intersect"
                    : std::string("the mesh is no closed 2-manifold and was not tested")));
    if (g.genus)
      gate(t.genus == *g.genus, "genus=" + std::to_string(*g.genus) + ": the mesh has " +
                                    (t.genus < 0 ? "none, it is no closed 2-manifold" : std::to_string(t.genus)));
    if (g.components)
      gate(t.components == *g.components,
           "components=" + std::to_string(*g.components) + ": the mesh has " + std::to_string(t.components));
    if (g.min_angle_deg) {
      std::ostringstream text;
      text << "min-angle=" << *g.min_angle_deg << ": the smallest angle is " << record_.quality->theta_min_deg;
      gate(record_.quality->theta_min_deg >= *g.min_angle_deg, text.str());
    }
    if (g.max_deviation_world) {
      std::ostringstream text;
      text << "max-deviation=" << *g.max_deviation_world << ": the result is up to "
           << record_.distance->to_reference.max << " from the input, the input up to "
           << record_.distance->from_reference.max << " from the result";
      gate(record_.distance->largest() <= *g.max_deviation_world, text.str());
    }
    return failed;
  }

  void tell_result() {
    for (const auto* times : {&record_.times, &record_.report.times})
      for (const StageTime& t : *times) {
        std::ostringstream text;
        text.precision(1);
        text << std::fixed << "  " << t.stage << " " << t.ms << " ms";
        console_.detail(text.str());
      }
    std::ostringstream text;
    text.precision(1);
    text << std::fixed << (a_.output == "-" ? "standard output" : a_.output) << ": ";
    if (record_.vertices >= 0)
      text << counted(record_.vertices, "vertex", "vertices") << ", " << counted(record_.triangles, "triangle") << ", ";
    else
      text << counted(record_.report.active_voxels, "active voxel") << ", ";
    if (record_.topology) {
      const MeshTopology& t = *record_.topology;
      text << counted(t.components, "component") << ", "
           << (t.is_closed_manifold() ? "closed 2-manifold of genus " + std::to_string(t.genus)
                                      : "not a closed 2-manifold")
           << ", ";
    }
    if (record_.quality) text << "smallest angle " << record_.quality->theta_min_deg << ", ";
    text << record_.total_ms / 1000 << " s";
    console_.result(text.str());
  }

  int finish() {
    record_.total_ms = ms_since(start_);
    record_.host_peak_bytes = process_peak_bytes();
    record_.device_peak_bytes = device_memory_peak_bytes(context_.device);
    for (const std::string& text : record_.report.warnings) warn(text);
    if (!a_.stats.empty()) write_text(a_.stats, stats_json(a_, record_));
    tell_result();
    const std::vector<std::string> failed = failed_gates();
    for (const std::string& text : failed) console_.error("gate failed: " + text);
    return failed.empty() ? 0 : int(ErrorCode::gate_failed);
  }

  const Arguments& a_;
  RemeshOptions options_;
  std::string sizing_;  ///< where the field is that was asked for, or that the stage file's run had
  Context& context_;
  Console& console_;
  RunRecord record_;
  std::string written_;  ///< files that are whole, for who interrupts
  Clock::time_point start_ = Clock::now();
};

}  // namespace

int run(const Arguments& arguments, Context& context, Console& console) {
  return Run(arguments, context, console).go();
}

}  // namespace isoshell::tool
