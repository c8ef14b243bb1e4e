// Help in one fixed shape, so that a script can turn it into a table.
#include "vdb_isomesh/help.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <vector>

#include "isoshell/version.h"
#include "vdb_isomesh/other_names.h"

namespace isoshell::tool {
namespace {

constexpr size_t kTextColumn = 32, kWidth = 100;

std::string option_names(const CLI::Option& option) {
  std::string text;
  for (const std::string& name : option.get_snames()) text += (text.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) text += (text.empty() ? "--" : ", --") + name;
  const std::string value = option.get_type_name();
  return value.empty() ? text : text + " " + value;
}

/// The words of `text`, broken at kWidth; the first line starts at kTextColumn already.
std::string wrapped(const std::string& text) {
  std::istringstream words(text);
  std::string out, word;
  size_t column = kTextColumn;
  while (words >> word) {
    if (column > kTextColumn && column + 1 + word.size() > kWidth) {
      out += "\n" + std::string(kTextColumn, ' ');
      column = kTextColumn;
    }
    if (column > kTextColumn) {
      out += " ";
      ++column;
    }
    out += word;
    column += word.size();
  }
  return out;
}

size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t changed = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string options_text(const CLI::App& app) {
  std::string text = app.get_description() + "\n";
  for (const std::string& group : app.get_groups()) {
    std::string rows;
    for (const CLI::Option* option : app.get_options()) {
      if (option->get_group() != group || option->get_positional()) continue;
      std::string names = "  " + option_names(*option);
      names += names.size() + 2 > kTextColumn ? "\n" + std::string(kTextColumn, ' ')
                                              : std::string(kTextColumn - names.size(), ' ');
      const std::string fallback = option->get_default_str();
      rows += names + wrapped(option->get_description() + (fallback.empty() ? "" : " [" + fallback + "]")) + "\n";
    }
    if (!rows.empty()) text += "\n" + group + ":\n" + rows;
  }
  return text;
}

std::string help_text(const CLI::App& app) {
  return options_text(app) +
         "\nExit status: 0 done, 1 internal error, 2 wrong usage, 3 input cannot be read, 4 output cannot be\n"
         "written, 5 nothing to mesh, 6 a requirement of --require is not met or the result intersects\n"
         "itself, 7 over the memory limit or out of memory, 8 no such device, 130 interrupted.\n";
}

std::string version_text(const std::string& program) { return program + " " ISOSHELL_VERSION "\n"; }

std::string closest_option(const CLI::App& app, const std::string& mistyped) {
  const std::string word = mistyped.substr(0, mistyped.find('='));
  const std::string bare = word.substr(std::min(word.find_first_not_of('-'), word.size()));
  std::string best = option_of_others(bare);
  if (!best.empty() && app.get_option_no_throw(best.substr(0, best.find(' ')))) return best;
  best.clear();  // vdb_meshinfo has few of them
  size_t best_distance = 1 + bare.size() / 3;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) {
      const bool begins = bare.size() > 2 && name.compare(0, bare.size(), bare) == 0;
      const size_t distance = begins ? 0 : edit_distance(bare, name);
      if (distance >= best_distance) continue;
      best_distance = distance;
      best = "--" + name;
    }
  return best;
}

}  // namespace isoshell::tool
