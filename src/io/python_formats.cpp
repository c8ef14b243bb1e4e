// Formats that only the Python module has, by packages of Python: it takes this table, and errors name it.
#include "isoshell/io/python_formats.h"

#include "core/file_format.h"

namespace isoshell {

const std::vector<PythonFormat>& python_formats() {
  static const std::vector<PythonFormat> all = {
      // ending, extra, reads, writes
      {"vtk", "pyvista", true, true},  {"vtp", "pyvista", true, true},     {"vti", "pyvista", true, false},
      {"vtu", "meshio", true, true},   {"msh", "meshio", true, true},      {"med", "meshio", true, true},
      {"xdmf", "meshio", true, true},  {"xmf", "meshio", true, true},      {"inp", "meshio", true, true},
      {"nii", "nibabel", true, false}, {"nii.gz", "nibabel", true, false}, {"3mf", "trimesh", true, true},
      {"usd", "usd", true, true},      {"usda", "usd", true, true},        {"usdc", "usd", true, true},
      {"usdz", "usd", true, true},
  };
  return all;
}

const PythonFormat* find_python_format(const std::string& path) {
  const std::string name = lower_case(path);
  for (const PythonFormat& format : python_formats()) {
    const std::string ending = "." + format.name;
    if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
      return &format;
  }
  return nullptr;
}

std::string python_remedy(const std::string& path, bool writes) {
  const PythonFormat* const format = find_python_format(path);
  if (!format || !(writes ? format->writes : format->reads)) return "";
  return "; the Python module " + std::string(writes ? "writes" : "reads") + " ." + format->name +
         " files: pip install 'isoshell[" + format->extra + "]', then python -m isoshell remesh" +
         (writes ? "" : ", or info where it is measured") + ", with the same arguments";
}

}  // namespace isoshell
