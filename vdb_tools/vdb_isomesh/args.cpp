// Parses and checks the command line. CLI11 does the splitting; every message is ours to keep readable.
#include "vdb_isomesh/args.h"

#include <CLI/CLI.hpp>
#include <map>

#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "vdb_isomesh/help.h"
#include "vdb_isomesh/options.h"

namespace isoshell::tool {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "command line", message); }

std::string line_of(const std::string& also) { return also.empty() ? "" : ";\n        " + also; }

std::string description(const Program& program) {
  return program.name +
         " INPUT OUTPUT [options]\n\n"
         "Turns any surface into an isotropic triangle mesh: closed, 2-manifold, well-shaped triangles.\n\n"
         "INPUT   a mesh (" +
         listed_endings(reads_mesh) + "), a point cloud (" + listed_endings(reads_points) + "),\n        a volume (" +
         listed_endings(reads_volume) +
         ": a level set, unsigned distances, or with --iso a fog volume;\n"
         "        FILE.vdb:NAME names a grid), level sets that are regions (FILE.vdb:piece*, or several\n"
         "        INPUTs), or a stage file that this command wrote (.vdb); - reads\n"
         "        standard input and needs --input-format" +
         line_of(program.also_reads) +
         "\n"
         "OUTPUT  a mesh (" +
         listed_endings(writes_mesh) +
         "), or a .vdb file with --stop-after; - writes standard\n"
         "        output and needs --output-format" +
         line_of(program.also_writes);
}

bool is_volume(const std::string& name) {
  const FileFormat* const format = find_format(named_input(name).format);
  return format && format->reads_volume;
}

/// The command as CLI11 knows it. All values are text, which the options turn into what they are.
class Parser {
 public:
  explicit Parser(const Program& program = {}) : app_(description(program)), options_(command_options()) {
    app_.set_help_flag();
    app_.allow_extras();
    app_.add_option("INPUT", input_);
    app_.add_option("OUTPUT", output_);
    for (const CommandOption& option : options_) add(option);
  }

  /// `words` are backwards, as CLI11 wants them.
  void split(std::vector<std::string> words) {
    try {
      app_.parse(std::move(words));
      if (const std::vector<std::string> left = app_.remaining(); !left.empty()) last_ = left.back();
    } catch (const CLI::ParseError& e) {
      refuse(std::string(e.what()) + "; see --help");
    }
  }

  bool has_flag(const std::string& name) const { return flags_.at(name); }
  const CLI::App& app() const { return app_; }
  const std::string& input() const { return input_; }
  /// INPUTs behind the first one: the words behind it, but OUTPUT, which is the last one or named.
  std::vector<std::string> also() const {
    std::vector<std::string> words = app_.remaining();
    if (!output_.empty()) words.insert(words.begin(), output_);
    if (texts_.at("output").empty() && !words.empty() && !has_inputs_alone()) words.pop_back();
    return words;
  }
  /// Throws: usage.
  std::string output() const {
    const std::string& named = texts_.at("output");
    if (named.empty()) return has_inputs_alone() ? "" : last_.empty() ? output_ : last_;
    if (!output_.empty() && !(is_volume(input_) && is_volume(output_)))
      refuse("OUTPUT is given twice, as '" + output_ + "' and as --output '" + named + "'; leave one out");
    return named;
  }

  void set_options(Arguments& a) const {
    for (const CommandOption& option : options_) {
      const std::string& name = option.entry.name;
      if (app_.get_option("--" + name)->count() == 0) continue;
      a.run.options.given.push_back(name);
      const bool is_flag = option.entry.value.empty();
      if (!is_flag && texts_.at(name).empty())
        refuse("--" + name + " has no value; give " + option.entry.value + ", or leave it out");
      if (!is_flag || flags_.at(name)) option.set(is_flag ? "" : texts_.at(name), a);
    }
  }

 private:
  /// Where nothing is written, the last word need not be OUTPUT; a volume is none of a run to a mesh.
  bool has_inputs_alone() const {
    const std::string& last = last_.empty() ? output_ : last_;
    return flags_.at("dry-run") && texts_.at("stop-after").empty() && !last.empty() && is_volume(input_) &&
           is_volume(last);
  }

  void add(const CommandOption& option) {
    const OptionEntry& entry = option.entry;
    const std::string names = (option.short_name.empty() ? "" : "-" + option.short_name + ",") + "--" + entry.name;
    CLI::Option* added =
        entry.value.empty() ? app_.add_flag(names, flags_[entry.name]) : app_.add_option(names, texts_[entry.name]);
    added->description(entry.text)->group(entry.group)->type_name(entry.value)->default_str(entry.fallback);
    if (entry.repeats) added->join();
    if (!option.instead_of.empty()) added->excludes(app_.get_option("--" + option.instead_of));
  }

  CLI::App app_;
  std::vector<CommandOption> options_;
  std::map<std::string, std::string> texts_;  ///< of options with a value, by name
  std::map<std::string, bool> flags_;         ///< --force=false is none
  std::string input_, output_, last_;
};

void check_sequence(const Arguments& a) {
  for (const char* name : {"velocity", "no-coherence", "keep-going", "resume"})
    if (!a.frames && a.run.options.was_given(name)) refuse(std::string("--") + name + " needs --frames");
}

/// All but where the run reads from, which a front may have in memory.
Arguments checked_arguments(const Parser& parser, const std::string& output) {
  Arguments a;
  RunRequest& run = a.run;
  parser.set_options(a);
  check_sequence(a);
  if (parser.has_flag("verbose") && parser.has_flag("quiet")) refuse("--verbose and --quiet exclude each other");
  if (a.verbosity == 0) run.measures = Measures::none;
  run.output.path = output;
  check_request(run);
  run.output.format = named_output(output, run.output.format, run.stop_after).format;
  return a;
}

/// Words that are neither options nor files: several INPUTs are volumes.
void refuse_leftovers(const CLI::App& app, const std::string& input) {
  for (const std::string& left : app.remaining()) {
    if (left.size() < 2 || left[0] != '-') continue;
    const std::string hint = closest_option(app, left);
    refuse("unknown option " + left + (hint.empty() ? "; see --help" : "; did you mean " + hint + "?"));
  }
  if (!app.remaining().empty() && (input.empty() || !is_volume(input)))
    refuse("one argument too many: '" + app.remaining()[0] +
           "'; there is one INPUT, or several level sets, and one OUTPUT, which are patterns as 'mesh.####.ply' with "
           "--frames");
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv, const Program& program) {
  Parser parser(program);
  std::vector<std::string> words;
  for (int i = argc - 1; i > 0; --i) {
    std::string word = argv[i];
    if (word == "-help" || word == "-version") word.insert(0, "-");
    words.push_back(word);
  }
  parser.split(std::move(words));
  if (parser.has_flag("help")) return {std::nullopt, help_text(parser.app())};
  if (parser.has_flag("version")) return {std::nullopt, version_text(program.name)};
  refuse_leftovers(parser.app(), parser.input());
  Arguments a = checked_arguments(parser, parser.output());
  if (parser.input().empty()) refuse("INPUT is missing; see --help");
  if (parser.output().empty() && !a.dry_run) refuse("OUTPUT is missing; see --help");
  a.run.input.also = parser.also();
  if (a.frames && !a.run.input.also.empty()) refuse("--frames takes one INPUT; name its level sets as FILE.####.vdb:*");
  a.run.input = named_input(parser.input(), std::move(a.run.input));
  return {std::move(a), ""};
}

Arguments parse_given_options(const std::vector<GivenOption>& given, const std::string& output) {
  Parser parser;
  std::vector<std::string> words;
  for (const GivenOption& option : given)
    words.push_back("--" + option.name + (option.value ? "=" + *option.value : ""));
  parser.split(std::move(words));
  refuse_leftovers(parser.app(), "");
  return checked_arguments(parser, output);
}

std::vector<OptionEntry> option_table() {
  std::vector<OptionEntry> table;
  for (CommandOption& option : command_options()) table.push_back(std::move(option.entry));
  return table;
}

}  // namespace isoshell::tool
