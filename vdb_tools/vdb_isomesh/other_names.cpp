#include "vdb_isomesh/other_names.h"

#include <algorithm>
#include <vector>

namespace isoshell::tool {
namespace {

struct OtherNames {
  const char* ours;
  std::vector<std::string> theirs;  ///< lower case, without what is between their words
};

/// Of MeshLab, PyMeshLab, trimesh, pyacvd, gmsh, CGAL, Instant Meshes, gpytoolbox, Blender, Houdini and vdb_tool.
const std::vector<OtherNames>& table() {
  static const std::vector<OtherNames> all = {
      {"--vertices (a closed mesh has about two faces a vertex)",
       {"faces", "face", "facecount", "nfaces", "numfaces", "targetfaces", "targetfacecount", "targetfacenum",
        "triangles", "ntriangles", "numtriangles", "targettriangles", "targetnumfaces"}},
      {"--vertices",
       {"nvertices", "numvertices", "vertexcount", "targetvertices", "targetvertexcount", "targetvertexnum",
        "numberofvertices", "npoints", "numpoints", "points", "nclus", "clusters", "nverts", "verts", "count"}},
      {"--edge-length",
       {"targetedgelength", "targetlength", "targetlen", "edgelen", "edgesize", "targetsize", "meshsize", "length",
        "size", "h", "lc", "maxedge", "maxedgelength", "edge", "targetedgelen"}},
      {"--sizing", {"sizefield", "sizingfield", "sizefunction", "meshsizefield", "metric"}},
      {"--features",
       {"featureangle", "featuredeg", "creaseangle", "crease", "creases", "sharpangle", "sharp", "sharpedges",
        "preservefeatures", "angle"}},
      {"--iso", {"isovalue", "isolevel", "level", "threshold", "isosurface"}},
      {"--close-gaps", {"closeholes", "fillholes", "maxholesize", "holesize"}},
      {"--boundary", {"boundaries", "preserveboundary", "keepboundary", "border", "borders"}},
      {"--adaptivity", {"adaptive", "curvature"}},
      {"--voxel-size", {"pitch"}},
      {"--resolution", {"depth", "octreedepth", "dim", "dims", "dimension"}},
      {"--level-set-band",
       {"width", "halfwidth", "exteriorband", "interiorband", "exteriorbandwidth", "interiorbandwidth"}},
      {"--stop-after level-set", {"levelset", "sdf", "mesh2ls", "meshtovolume"}},
      {"--threads", {"nthreads", "numthreads", "njobs", "jobs"}},
      {"--device", {"gpu", "cuda", "backend"}},
      {"--force", {"overwrite"}},
      {"--seed", {"randomstate", "randomseed"}},
  };
  return all;
}

}  // namespace

std::string option_of_others(const std::string& name) {
  std::string bare;
  for (const char c : name)
    if (c != '-' && c != '_') bare += char(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  for (const OtherNames& row : table())
    if (std::find(row.theirs.begin(), row.theirs.end(), bare) != row.theirs.end()) return row.ours;
  return {};
}

}  // namespace isoshell::tool
