// The library's run, with messages on the console and signals held off while a file is written.
#include "vdb_isomesh/run.h"

#include <optional>
#include <sstream>

#include "isoshell/device_info.h"
#include "isoshell/error.h"
#include "isoshell/io/output_files.h"
#include "isoshell/readable.h"
#include "vdb_isomesh/interrupt.h"
#include "vdb_isomesh/memory.h"

namespace isoshell::tool {
namespace {

/// Before anything is read: asking for a device that is not there should cost no time. The run asks again for its
/// record; this answer decides how much memory the run may take.
void choose_device(Context& context, Console& console) {
  const DeviceInfo d = device_info(context);
  limit_memory(context, d);
  if (d.backend != "cuda") return;
  console.detail("device: cuda:" + std::to_string(d.number) + ", " + d.name + ", " + readable_bytes(d.free_bytes) +
                 " of " + readable_bytes(d.memory_bytes) + " free, driver " +
                 (d.driver_version.empty() ? "" : d.driver_version + ", ") + "CUDA " + d.cuda_version);
}

/// Standard output cannot be left in order: a run that is stuck there may be ended.
void write_undisturbed(const std::string& path, const std::function<void()>& write) {
  std::optional<WhileWriting> writing;
  if (path != "-") writing.emplace();
  write();
  if (path != "-") note_written(path);
}

/// A dry run writes to standard output alone.
void write_estimate(const RunRequest& request, RunEstimate e, int64_t limit_bytes, Console& console) {
  if (request.options.lengths_decide()) e.vertices = -1;  // not known
  if (request.statistics == "-")
    write_text("-", estimate_json(e, limit_bytes), false);
  else if (!request.statistics.empty())
    console.warn("a dry run writes no files, and so no " + request.statistics + "; --stats - prints the estimate");
}

void tell_estimate(const RunRequest& request, const RunEstimate& e, int64_t limit_bytes, Console& console) {
  const RequestedOptions& requested = request.options;
  std::ostringstream text;
  text << "estimate: resolution " << e.resolution << ", voxel size " << e.voxel_size_world << ", "
       << counted(e.sites, "site voxel") << ", " << counted(e.sheet_vertices, "sheet vertex", "sheet vertices") << ", "
       << (requested.lengths_decide() ? "as many vertices as the sizing asks for"
                                      : counted(e.vertices, "vertex", "vertices"))
       << " in the result, about " << readable_bytes(e.bytes) << " of " << readable_bytes(limit_bytes) << " allowed";
  if (!requested.sizing.empty() || !requested.values.region_edge_lengths.empty() || requested.values.adaptivity > 0)
    text << "; edges that vary may take a finer grid, and more";
  console.result(text.str());
  write_estimate(request, e, limit_bytes, console);
  if (limit_bytes > 0 && e.bytes > limit_bytes)
    throw Error(ErrorCode::out_of_memory, "memory", over_memory_limit(e, limit_bytes));
}

void tell_times(const RunRecord& record, Console& console) {
  for (const auto* times : {&record.times, &record.report.times})
    for (const StageTime& t : *times) {
      std::ostringstream text;
      text.precision(1);
      text << std::fixed << "  " << t.stage << " " << t.ms << " ms";
      console.detail(text.str());
    }
}

void tell_result(const RunRecord& record, Console& console) {
  std::ostringstream text;
  text.precision(1);
  text << std::fixed << (record.output.path == "-" ? "standard output" : record.output.path) << ": ";
  if (record.vertices >= 0)
    text << counted(record.vertices, "vertex", "vertices") << ", " << counted(record.triangles, "triangle") << ", ";
  else
    text << counted(record.report.grid.active_voxels, "active voxel") << ", ";
  if (record.regions) {
    text << counted(int64_t(record.regions->regions.size()), "region")
         << (record.regions->every_region_closed ? ", " : ", not all of them closed, ");
  } else if (record.topology) {
    const MeshTopology& t = *record.topology;
    text << counted(t.components, "component") << ", "
         << (t.is_closed_manifold() ? "closed 2-manifold of genus " + std::to_string(t.genus)
             : t.is_manifold_with(record.report.features.border_loops)
                 ? "2-manifold with " + counted(t.boundary_loops, "border")
                 : "not a closed 2-manifold")
         << ", ";
  }
  if (record.quality) text << "smallest angle " << record.quality->theta_min_deg << ", ";
  const FeatureReport& features = record.report.features;
  if (features.passes_over_much(record.report.input.topology.area_world))
    text << readable_length(features.passed_over_world)
         << " of sharp edges taken for noise (--features DEG keeps them), ";
  text << record.total_ms / 1000 << " s";
  console.result(text.str());
}

void tell_frame(int64_t frame, const RunResult& result, Console& console) {
  tell_times(result.record, console);
  tell_result(result.record, console);
  const RunRecord& record = result.record;
  if (!record.options.previous) return;
  const CoherenceReport& coherence = record.report.coherence;
  std::ostringstream text;
  text.precision(2);
  text << std::fixed << "frame " << frame << ": " << coherence.kept_edges_pct << " % of the edges kept, "
       << counted(coherence.born, "vertex", "vertices") << " born"
       << (coherence.began_warm ? "" : ", began cold: " + coherence.why_cold);
  console.detail(text.str());
}

void tell_sequence(const SequenceResult& result, Console& console) {
  std::ostringstream text;
  text.precision(2);
  text << std::fixed << counted(result.made, "frame") << " made";
  if (result.found > 0) text << ", " << result.found << " there already";
  if (result.followed > 0)
    text << "; " << result.warm << " began with the vertices of the frame before; edges kept "
         << result.kept_edges_mean_pct << " % on average, " << result.kept_edges_worst_pct << " % at worst; "
         << counted(result.born, "vertex", "vertices") << " born";
  console.result(text.str());
}

/// The exit status of a sequence that kept going is that of its first bad frame.
int run_frames(const Arguments& arguments, const RunRequest& frame, Context& context, Console& console) {
  SequenceRequest request;
  request.frame = frame;
  request.frames = *arguments.frames;
  request.velocity = arguments.velocity;
  request.is_coherent = arguments.is_coherent;
  request.keep_going = arguments.keep_going;
  request.resume = arguments.resume;
  request.after_frame = [&](int64_t number, const RunResult& result) { tell_frame(number, result, console); };
  const SequenceResult result = run_sequence(request, context);
  tell_sequence(result, console);
  for (const BadFrame& bad : result.bad) console.error("frame " + std::to_string(bad.frame) + ": " + bad.message);
  return result.bad.empty() ? 0 : int(result.bad.front().code);
}

}  // namespace

int run(const Arguments& arguments, Context& context, Console& console, const WriteReport& write_report) {
  choose_device(context, console);
  RunRequest request = arguments.run;
  request.tell = [&](MessageKind kind, const std::string& text) {
    kind == MessageKind::warning ? console.warn(text) : console.detail(text);
  };
  request.around_write = write_undisturbed;
  if (!arguments.dry_run) request.progress = [&](const Progress& progress) { console.progress(progress); };
  if (arguments.frames && arguments.dry_run)
    throw Error(ErrorCode::usage, "command line", "--dry-run estimates one frame; leave out --frames and name it");
  if (arguments.frames) return run_frames(arguments, request, context, console);
  if (arguments.dry_run) {
    tell_estimate(request, dry_run(request, context), context.memory_limit_bytes, console);
    return 0;
  }
  const RunResult result = isoshell::run(request, context);
  tell_times(result.record, console);
  tell_result(result.record, console);
  if (!request.report.empty()) write_report(request, result);
  for (const std::string& text : result.missed_gates) console.error("gate failed: " + text);
  return result.missed_gates.empty() ? 0 : int(ErrorCode::gate_failed);
}

}  // namespace isoshell::tool
