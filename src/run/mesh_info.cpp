// The certificate of a mesh: read, counted, measured, compared with what it must be.
#include "isoshell/run/mesh_info.h"

#include <utility>

#include "isoshell/error.h"
#include "progress/expected_work.h"
#include "progress/metered.h"
#include "progress/step.h"

namespace isoshell {
namespace {

constexpr int64_t kSamples = 200000;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "mesh_info", message); }

TriangleMesh mesh_of(TriangleSoup soup) {
  TriangleMesh mesh{std::move(soup.vertices), std::move(soup.triangles)};
  mesh.regions = std::move(soup.regions);
  return mesh;
}

/// Triangles or points.
double size_of(const Input& reference) { return double(reference.soup.triangles.size() + reference.points.size()); }

MeshDistance distance_of(const TriangleMesh& mesh, Input reference, Context& context) {
  if (!reference.points.empty()) return measure_distance(mesh, reference.points, context);
  return measure_distance(mesh, mesh_of(std::move(reference.soup)), context, {kSamples, true});
}

/// What gates ask of a topology, from the counts. Where no edge is wrong, fans through all edges are those of
/// manifolds.
MeshTopology topology_of(const ComplexCounts& c) {
  MeshTopology t;
  t.components = c.components;
  t.euler = c.euler;
  t.boundary_loops = c.boundary_loops;
  t.boundary_edges = c.boundary_edges;
  t.nonmanifold_edges = c.nonmanifold_edges + c.inconsistent_edges;
  t.nonmanifold_vertices = c.nonmanifold_vertices;
  t.unreferenced_vertices = c.vertices - c.referenced_vertices;
  t.degenerate_triangles = c.repeated_corners;
  t.repeated_triangles = c.duplicate_triangles;
  t.closed = c.edges > 0 && c.boundary_edges == 0;
  t.manifold = t.nonmanifold_edges == 0 && t.nonmanifold_vertices == 0 && t.repeated_triangles == 0 &&
               t.degenerate_triangles == 0;
  if (t.manifold) t.genus = (2 * t.components - t.boundary_loops - t.euler) / 2;
  return t;
}

std::vector<std::string> missed_of(const MeshInfo& info, const TriangleMesh& mesh, const Gates& gates) {
  if (!gates.any()) return {};
  const std::optional<MeshTopology> topology = topology_of(info.census.counts);
  const std::optional<MeshQuality> quality = measure_quality(mesh);
  Measured measured{topology, quality, info.distance};
  measured.self_intersections = info.census.intersecting_pairs;
  if (info.regions) measured.regions = &*info.regions;
  return missed_gates(gates, measured);
}

}  // namespace

MeshInfo mesh_info(const std::function<Input()>& read_mesh, const std::function<Input()>& read_reference,
                   const Gates& gates, Context& context, const TellProgress& progress) {
  check_gates_of_mesh(gates, bool(read_reference));
  ProgressMeter meter(progress);
  meter.expect(expected_work_of_info(0, 0));
  const Metered metered(meter, context);
  Input mesh;
  std::optional<Input> reference;
  step("read", context, meter, [&] {
    mesh = read_mesh();
    if (read_reference) reference = read_reference();
  });
  meter.expect(expected_work_of_info(double(mesh.soup.triangles.size()), reference ? size_of(*reference) : 0));
  if (mesh.facts.kind != InputKind::mesh)
    refuse(mesh.facts.name() + " is no mesh but " + kind_name(mesh.facts.kind) + "; make a mesh of it by vdb_isomesh");
  if (reference && reference->stage)
    refuse(reference->facts.name() + " is a stage file; give the surface that it is of");
  if (reference && !reference->points.empty() && gates.normal_deviation_deg)
    refuse("--require normal-deviation compares surfaces, and " + reference->facts.name() + " is points; leave it out");
  MeshInfo info;
  info.mesh = mesh.facts;
  info.dirt = mesh.soup.dirt;
  const TriangleMesh measured = mesh_of(std::move(mesh.soup));
  step("census", context, meter, [&] { info.census = take_census(measured, context, info.dirt.degenerate_faces); });
  if (!measured.regions.empty())
    step("regions", context, meter,
         [&] { info.regions = take_region_census(measured, context, info.census.intersecting_pairs); });
  if (reference) {
    info.reference = reference->facts;
    step("distance", context, meter, [&] { info.distance = distance_of(measured, std::move(*reference), context); });
  }
  info.missed_gates = missed_of(info, measured, gates);
  meter.finish();
  return info;
}

MeshInfo mesh_info(const MeshInfoRequest& request, Context& context, const Tell& tell, const TellProgress& progress) {
  std::function<Input()> read_reference;
  if (request.reference)
    read_reference = [&] {
      InputRequest reference = *request.reference;
      reference.keep_points = true;
      return read_input(reference, context, tell);
    };
  return mesh_info([&] { return read_input(request.mesh, context, tell); }, read_reference, request.gates, context,
                   progress);
}

}  // namespace isoshell
