// Formats that only the Python module reads or writes, by packages of Python.
#pragma once

#include <string>
#include <vector>

namespace isoshell {

struct PythonFormat {
  std::string name;   ///< lower case, and how names of such files end
  std::string extra;  ///< pip install 'isoshell[extra]'
  bool reads = false, writes = false;
};

const std::vector<PythonFormat>& python_formats();

/// Null for a path that does not end as one of them; "nii.gz" is one ending.
const PythonFormat* find_python_format(const std::string& path);

/// What a refusal of the path says of them, beginning with "; "; empty where they do not read it, or write it.
std::string python_remedy(const std::string& path, bool writes);

}  // namespace isoshell
