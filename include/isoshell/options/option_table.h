// The options of a run, a row each, and what is done with any of them: the command, JSON, stage files, checks, Python
// and Blender are loops over this table.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "isoshell/options/option_range.h"
#include "isoshell/options/requested_options.h"

namespace isoshell {

/// The value of an option, whichever it is; none: the run chooses.
using OptionValue = std::variant<std::monostate, bool, int64_t, uint64_t, double, std::string>;

/// An option that people write as text, of values of its own.
struct TextOption {
  /// What it may be in JSON beside text.
  enum class Number {
    refused,
    read,     ///< a number is read as its text
    written,  ///< and text that is a number is written as one
  };
  void (*parse)(const std::string& shown_name, const std::string& text, RequestedOptions& to);  ///< throws usage
  std::string (*text)(const RequestedOptions& from);  ///< which parse() makes the same value of
  Number number = Number::refused;
  void (*check)(RemeshOptions& values) = nullptr;  ///< of what was set in C++; throws usage
  bool repeats = false;                            ///< its text has a line for each time that it is given
};

/// What of RunOptions holds the value; flags are bool.
using OptionMember =
    std::variant<bool RunOptions::*, int32_t RunOptions::*, uint64_t RunOptions::*, double RunOptions::*,
                 std::optional<int32_t> RunOptions::*, std::optional<int64_t> RunOptions::*,
                 std::optional<double> RunOptions::*, TextOption>;

/// Where a run from a stage file takes an option from.
enum class OnResume {
  of_shell,  ///< the file, whose shell was made with it
  of_seeds,  ///< the file when it has seeds; the file of a shell unless it is given
  of_file,   ///< the file unless it is given
  of_run,    ///< the run alone
};

struct OptionRow {
  const char *group, *name;  ///< the name without dashes, as in JSON
  const char* value_name;    ///< what stands for its value, as K; empty: a flag
  const char* text;
  const char* fallback;     ///< what holds without it, for people
  const char* member_name;  ///< of RunOptions
  OptionMember member;
  OnResume on_resume;
  OptionRange range = {};
  double former = 0;            ///< the number that means no value in JSON, and meant it in C++ once
  const char* instead_of = "";  ///< the option that cannot be given beside it

  bool is_flag() const { return *value_name == '\0'; }
  bool repeats() const;  ///< it may be given more than once
  bool is_text() const { return std::holds_alternative<TextOption>(member); }
  bool is_seed() const { return std::holds_alternative<uint64_t RunOptions::*>(member); }  ///< of all 64 bits
  bool is_real() const;      ///< any number, not only whole ones
  bool may_be_open() const;  ///< it may have no value
};

/// In the order of the help.
const std::vector<OptionRow>& option_rows();

/// None for the row's former number, too.
OptionValue value_of(const OptionRow& row, const RequestedOptions& options);
/// Throws: usage for a value out of range, under `shown_name`.
void set_value(const OptionRow& row, const std::string& shown_name, const OptionValue& value,
               RequestedOptions& options);
/// From a command line or keyword; a flag's text is empty. Throws: usage.
void set_from_text(const OptionRow& row, const std::string& shown_name, const std::string& text,
                   RequestedOptions& options);
/// As a person would give it; "not given" of a flag that is off and of what has no value.
std::string shown_value(const OptionRow& row, const RequestedOptions& options);

}  // namespace isoshell
