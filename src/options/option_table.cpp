#include "isoshell/options/option_table.h"

#include <algorithm>
#include <limits>

#include "isoshell/error.h"
#include "isoshell/options/option_text.h"

namespace isoshell {
namespace {

constexpr double kMostVertices = std::numeric_limits<int32_t>::max();

/// Names of the values of a member of RunOptions, which one function reads and another writes.
template <auto Member, auto Parse, auto Name>
TextOption named(TextOption::Number number = TextOption::Number::refused, void (*check)(RemeshOptions&) = nullptr) {
  return {[](const std::string& shown, const std::string& text, RequestedOptions& to) {
            to.values.*Member = Parse(shown, text);
          },
          [](const RequestedOptions& from) -> std::string { return Name(from.values.*Member); }, number, check};
}

void check_features(RemeshOptions& o) {
  if (o.features.creases == Features::Creases::threshold)
    check_range("features.degrees", o.features.degrees, kCreaseDegrees);
}

/// Behind a comma stands the file of lines.
void parse_features_and_lines(const std::string& shown, const std::string& text, RequestedOptions& to) {
  const size_t comma = std::min(text.find(','), text.size());
  const std::string file = text.substr(std::min(comma + 1, text.size()));
  if (comma < text.size() && file.empty())
    throw Error(ErrorCode::usage, "options", shown + " is '" + text + "'; behind the comma stands a file of lines");
  to.values.features = parse_features(shown, text.substr(0, comma));
  to.values.line_file = file;
}

std::string features_and_lines_text(const RequestedOptions& from) {
  const std::string &file = from.values.line_file, creases = features_text(from.values.features);
  return file.empty() ? creases : creases + "," + file;
}

TextOption gap_option() {
  return {[](const std::string& shown, const std::string& text, RequestedOptions& to) {
            set_gap_width(shown, text, to.values);
          },
          [](const RequestedOptions& from) { return gap_width_text(from.values); }, TextOption::Number::written,
          [](RemeshOptions& o) {  // -1 stood for no value
            if (o.closing_vox == -1) o.closing_vox.reset();
            if (o.closing_world == -1.) o.closing_world.reset();
            if (o.closing_vox) check_range("closing_vox", *o.closing_vox, {0, kMaxClosingVox});
            if (o.closing_world) check_range("closing_world", *o.closing_world, {});
          }};
}

TextOption sizing_option() {
  return {[](const std::string&, const std::string& text, RequestedOptions& to) { to.sizing = text; },
          [](const RequestedOptions& from) {
            return from.sizing.empty() && from.values.sizing ? from.values.sizing->source() : from.sizing;
          }};
}

TextOption region_edge_length_option() {
  TextOption option = named<&RemeshOptions::region_edge_lengths, parse_region_edge_lengths, region_edge_lengths_text>(
      TextOption::Number::refused, [](RemeshOptions& o) {
        for (const RegionEdgeLength& l : o.region_edge_lengths)
          check_range("region_edge_lengths of region " + l.region, l.edge_length_world, kLengths);
      });
  option.repeats = true;
  return option;
}

TextOption regions_option() {
  return {[](const std::string&, const std::string& text, RequestedOptions& to) { to.values.regions = text; },
          [](const RequestedOptions& from) { return from.values.regions; }};
}

std::vector<OptionRow> size_rows() {
  const char* group = "Size of the result";
  return {
      {group,
       "vertices",
       "K",
       "number of vertices of the result",
       "10000",
       "vertices",
       &RemeshOptions::vertices,
       OnResume::of_seeds,
       {4, kMostVertices}},
      {group, "edge-length", "L", "target edge length in world units, instead of --vertices", "", "edge_length_world",
       &RemeshOptions::edge_length_world, OnResume::of_seeds, kLengths, 0, "vertices"},
      {group, "sizing", "F.vdb[:GRID]|NAME",
       "target edge lengths in world units: a float grid, or the attribute of the input's vertices of that name; "
       "without "
       "--vertices it also decides the number of vertices",
       "", "sizing", sizing_option(), OnResume::of_seeds},
      {group, "region-edge-length", "REGION=L",
       "edge length in world units on the walls of a region, a label or a name; may be given for each region; without "
       "--vertices it also decides the number of vertices",
       "", "region_edge_lengths", region_edge_length_option(), OnResume::of_seeds},
      {group,
       "adaptivity",
       "A",
       "fraction of the vertices, 0 to 1, distributed by curvature instead of area",
       "0",
       "adaptivity",
       &RemeshOptions::adaptivity,
       OnResume::of_seeds,
       {0, 1}},
      {group,
       "gradation",
       "G",
       "maximum ratio of neighbouring edge lengths, above 1 and at most 10",
       "1.2",
       "gradation",
       &RemeshOptions::gradation,
       OnResume::of_seeds,
       {1, 10, true}},
  };
}

std::vector<OptionRow> grid_rows() {
  const char* group = "Grid";
  return {
      {group,
       "resolution",
       "R",
       "voxels along the longest side, 8 to 8192",
       "cells are 4.5 to 5.5 voxels wide",
       "resolution",
       &RemeshOptions::resolution,
       OnResume::of_shell,
       {8, kMaxResolution}},
      {group, "voxel-size", "S",
       "voxel size in world units, instead of --resolution; voxels have their centres at multiples of it", "",
       "voxel_size_world", &RemeshOptions::voxel_size_world, OnResume::of_shell, kLengths, 0, "resolution"},
      {group,
       "band",
       "D",
       "thickness of the shell in voxels, 1 to 20",
       "2",
       "band_vox",
       &RemeshOptions::band_vox,
       OnResume::of_shell,
       {1, kMaxBandVox}},
      {group, "close-gaps", "W", "maximum width of the gaps to bridge: W in world units, voxels as 4vox, 0, or auto",
       "auto", "closing_world", gap_option(), OnResume::of_shell},
      {group, "outer-only", "", "drop what lies inside of closed surfaces (default: keep hollows)", "", "outer_only",
       &RemeshOptions::outer_only, OnResume::of_shell},
  };
}

std::vector<OptionRow> relaxation_rows() {
  const char* group = "Relaxation";
  return {
      {group, "method", "sheet|shell",
       "sheet: exact clipped Voronoi cells on the closed sheet; shell: the paper's iteration on voxels of the shell",
       "sheet", "method", named<&RemeshOptions::method, parse_method, method_name>(), OnResume::of_seeds},
      {group,
       "iterations",
       "N",
       "maximum number of relaxation passes on the finest level of seeds",
       "the method's own",
       "max_passes",
       &RemeshOptions::max_passes,
       OnResume::of_seeds,
       {1, 1000000}},
      {group,
       "tolerance",
       "E",
       "stop when the energy falls by less than this fraction per pass",
       "the method's own",
       "tolerance",
       &RemeshOptions::tolerance,
       OnResume::of_seeds,
       {0, 1},
       -1},
      {group,
       "step",
       "U",
       "maximum movement of a seed per pass, in voxels",
       "the method's own",
       "max_step_vox",
       &RemeshOptions::max_step_vox,
       OnResume::of_seeds,
       {1. / kOneVoxelQ8, 1000}},
      {group, "seed", "N", "seed of the random number generator", "0", "seed", &RemeshOptions::seed,
       OnResume::of_seeds},
  };
}

std::vector<OptionRow> shape_rows() {
  const char* group = "Shape of the result";
  return {
      {group, "fit", "balanced|surface",
       "balanced: vertices where the mesh is closest to the surface; surface: vertices on the surface", "balanced",
       "fit", named<&RemeshOptions::fit, parse_fit, fit_name>(), OnResume::of_file},
      {group, "features", "auto|off|DEG[,FILE]",
       "sharp edges of the input that stay: auto: those of crisp parts; DEG: all whose faces turn by so many degrees "
       "or more; off: none; and the lines of FILE, OBJ (l) or PLY (edges), as auto,curves.obj",
       "auto", "features",
       TextOption{parse_features_and_lines, features_and_lines_text, TextOption::Number::read, check_features},
       OnResume::of_seeds, kCreaseDegrees},
      {group, "boundary", "close|keep",
       "borders of a surface that is not closed: close: the result is closed; keep: those wider than the gaps of "
       "--close-gaps are borders of the result",
       "close", "boundary", named<&RemeshOptions::boundary, parse_boundary, boundary_name>(), OnResume::of_shell},
      {group, "regions", "components|groups|cells|NAME",
       "one mesh of all regions of a mesh, with shared walls: its connected components, its groups or objects, "
       "whatever "
       "its faces enclose, or what has the same value of an attribute of faces",
       "", "regions", regions_option(), OnResume::of_run},
      {group, "snap", "W",
       "of --regions: faces nearer than that, in world units, are one wall; at least two steps of the grid, at most a "
       "20th of the longest side",
       "two steps of the grid", "snap_world", &RemeshOptions::snap_world, OnResume::of_run, kLengths, 0},
      {group, "attributes", "all|none|LIST",
       "what a mesh has beside its positions and the result keeps: names separated by commas, such as color, uv, "
       "normal, material, group",
       "all", "attributes", named<&RunOptions::attributes, parse_attributes, attributes_text>(), OnResume::of_run},
      {group, "uv-seams", "keep|ignore",
       "places where texture coordinates jump: keep: they are edges of the result; ignore: triangles lie across them, "
       "each with the texture coordinates of one chart",
       "keep", "uv_seams", named<&RemeshOptions::uv_seams, parse_uv_seams, uv_seams_name>(), OnResume::of_run},
      {group, "color-features", "",
       "colour faces by patch and vertices by curve and corner, and write the edges of curves; in PLY", "",
       "color_features", &RunOptions::color_features, OnResume::of_file},
      {group, "uniform-area", "", "prefer triangles of equal area to triangles of the best shape", "", "uniform_area",
       &RemeshOptions::uniform_area, OnResume::of_file},
  };
}

}  // namespace

const std::vector<OptionRow>& option_rows() {
  static const std::vector<OptionRow> rows = [] {
    std::vector<OptionRow> all;
    for (const std::vector<OptionRow>& part : {size_rows(), grid_rows(), relaxation_rows(), shape_rows()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return rows;
}

}  // namespace isoshell
