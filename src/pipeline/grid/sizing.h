// Which edge lengths a run aims at: those of a field, shortened where the surface is curved, and bounded by what the
// grid carries and by how fast lengths may grow.
#pragma once

#include "features/angles/patch_mesh.h"
#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

inline constexpr double kSheetGapVox =
    1. / 64;  ///< between sheets of a union: rounding to the lattice leaves them apart

constexpr double kFewestCellVox = 3.5;  ///< width of a cell: narrower ones are no disks of sheet triangles

/// Whether lengths may vary.
bool wants_lengths(const RemeshOptions& options);
/// Beside which strips are narrow: 0 where lengths vary, or there are no creases.
double edge_of_strips_world(const PreparedSurface& p);

constexpr double kCellOfEdge =
    0.9306048591020996;  ///< width of a cell, the root of its area, over the edges: root of sqrt(3) / 2

/// The shortest edges that a grid carries, where cells are so wide.
double shortest_edge_world(double voxel_size, double cell_of_length);

/// Whether lengths by place or region say how many vertices there are.
bool field_decides(const RemeshOptions& options);

/// What is asked for of a surface that is cut: nothing but the growth where lengths do not vary.
RequestedLengths requested_lengths(const PreparedSurface& p, bool vary, double usual_world);

/// A field that decides the count, and has one length at all vertices of the soup, is an edge length.
RemeshOptions with_even_length(RemeshOptions options, const TriangleSoup& soup);

/// Gives the sheet its edge lengths, none when they are all equal; then p.vertices_of_lengths where the field decides
/// it. Result: warnings.
std::vector<std::string> set_lengths(PreparedSurface& p, Context& context);

/// Width of the cells where they are smallest, in voxels.
double smallest_cell_vox(const PreparedSurface& p, Context& context);

/// How long the edges of so many vertices are, over the lengths of the sheet, in lattice steps.
double edge_of_length(const Sheet& sheet, int64_t vertices, Context& context);

/// How well the edges of the result have the lengths of the surface at the homes of their ends. Those of a surface that
/// is not asked for lengths have no report, though its creases may make them vary.
void measure_edges(const Sheet& sheet, const SeedSet& seeds, const DualMesh& mesh, SizingReport& report,
                   Context& context);
void measure_edges(const CutSurface& cut, const JoinedPatches& made, SizingReport& report);

}  // namespace isoshell
