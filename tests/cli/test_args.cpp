// The command line alone: what is refused, with which words, and what it turns into. No stage runs here.
#include <set>

#include "isoshell/error.h"
#include "isoshell/options/option_table.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "vdb_isomesh/args.h"

using namespace isoshell;
using namespace isoshell::tool;

namespace {

CommandLine parse(std::vector<const char*> words) {
  words.insert(words.begin(), "vdb_isomesh");
  return parse_command_line(int(words.size()), words.data());
}

Arguments arguments(std::vector<const char*> options) {
  options.insert(options.begin(), {"in.obj", "out.ply"});
  return *parse(std::move(options)).run;
}

RunOptions values(std::vector<const char*> options) { return arguments(std::move(options)).run.options.values; }

/// The message of the usage error that these words give; empty when they are accepted.
std::string refusal(std::vector<const char*> words) {
  return message_of(ErrorCode::usage, [&] { parse(std::move(words)); });
}

}  // namespace

TEST_CASE("args: several volumes are INPUTs, and the last word is OUTPUT", "[cli][args]") {
  const Arguments a = *parse({"a.vdb:piece*", "b.vdb", "c.vdb:x", "out.ply", "--union", "--quiet"}).run;
  CHECK(a.run.input.path == "a.vdb");
  CHECK(a.run.input.grid == "piece*");
  CHECK(a.run.input.also == std::vector<std::string>{"b.vdb", "c.vdb:x"});
  CHECK(a.run.input.unite);
  CHECK(a.run.output.path == "out.ply");
  const Arguments named = *parse({"a.vdb", "b.vdb", "c.vdb", "-o", "out.ply"}).run;
  CHECK(named.run.input.also == std::vector<std::string>{"b.vdb", "c.vdb"});
  CHECK(named.run.output.path == "out.ply");
  CHECK(parse({"a.vdb", "b.vdb", "-o", "out.ply"}).run->run.input.also == std::vector<std::string>{"b.vdb"});
  CHECK(contains(refusal({"a.vdb", "b.ply", "-o", "out.ply"}), "OUTPUT is given twice"));
  const Arguments dry = *parse({"a.vdb", "b.vdb", "--dry-run"}).run;
  CHECK(dry.run.input.also == std::vector<std::string>{"b.vdb"});
  CHECK(dry.run.output.path.empty());
  CHECK(parse({"a.vdb", "b.vdb", "c.ply", "--dry-run"}).run->run.output.path == "c.ply");
  CHECK(parse({"a.vdb", "b.vdb", "--dry-run", "--stop-after", "shell"}).run->run.output.path == "b.vdb");
  CHECK(arguments({"--reference", "scan.obj"}).run.input.reference == "scan.obj");
  CHECK(contains(refusal({"a.obj", "b.obj", "out.ply"}), "one argument too many: 'out.ply'"));
  CHECK(contains(refusal({"a.vdb", "b.vdb", "out.ply", "--frames", "1-2"}), "--frames takes one INPUT"));
}

TEST_CASE("args: two files are enough, and every option has a default", "[cli][args]") {
  const Arguments a = arguments({});
  CHECK(a.run.input.path == "in.obj");
  CHECK(a.run.input.format == "obj");
  CHECK(a.run.output.format == "ply");
  CHECK(a.run.options.values.vertices == 10000);
  CHECK_FALSE(a.run.options.values.resolution);
  CHECK(a.run.options.values.band_vox == 2);
  CHECK_FALSE(a.run.options.values.closing_vox);
  CHECK_FALSE(a.run.options.values.closing_world);
  CHECK(a.backend == Backend::best);
  CHECK(a.run.options.given.empty());
  CHECK_FALSE(a.run.gates.any());
}

TEST_CASE("args: options reach the library with their units", "[cli][args]") {
  CHECK(values({"--vertices", "500"}).vertices == 500);
  CHECK(values({"--edge-length=0.25"}).edge_length_world == 0.25);
  CHECK(values({"--resolution", "256"}).resolution == 256);
  CHECK(values({"--voxel-size", "0.5"}).voxel_size_world == 0.5);
  CHECK(values({"--method", "shell"}).method == Method::shell);
  CHECK(values({"--fit", "surface"}).fit == Fit::surface);
  CHECK(values({}).fit == Fit::balanced);
  CHECK(values({"--uniform-area"}).uniform_area);
  CHECK(values({"--features", "30,curves.obj"}).features.degrees == 30);
  CHECK(values({"--features", "30,curves.obj"}).line_file == "curves.obj");
  CHECK(values({"--color-features"}).color_features);
  CHECK_FALSE(values({"--attributes", "all"}).attributes);
  CHECK(values({"--attributes", "none"}).attributes == std::vector<std::string>{});
  CHECK(values({"--attributes", "color,heat"}).attributes == std::vector<std::string>{"color", "heat"});
  CHECK(values({"--seed", "18446744073709551615"}).seed == 18446744073709551615ull);
  CHECK(values({"--tolerance", "0"}).tolerance == 0);
  CHECK(values({"--close-gaps", "0"}).closing_vox == 0);
  CHECK_FALSE(values({"--close-gaps", "auto"}).closing_vox);
  CHECK(values({"--close-gaps", "4vox"}).closing_vox == 2);
  CHECK(values({"--close-gaps", "5vox"}).closing_vox == 3);
  CHECK(values({"--close-gaps", "0.7"}).closing_world == 0.7);
  CHECK(arguments({"--device", "cuda:2"}).device == 2);
  CHECK(arguments({"--device", "cuda:2"}).backend == Backend::cuda);
  CHECK(arguments({"--threads", "3"}).threads == 3);
  CHECK(arguments({"--max-memory", "1.5G"}).max_memory_bytes == 1610612736);
  CHECK(arguments({"-q"}).verbosity == 0);
  CHECK(arguments({"-v"}).verbosity == 2);
}

TEST_CASE("args: gates are a list", "[cli][args]") {
  const Gates g =
      arguments(
          {"--require", "closed,manifold,no-self-intersections,genus=3,components=2,min-angle=20.5,max-deviation=0.1"})
          .run.gates;
  CHECK(g.closed);
  CHECK(g.manifold);
  CHECK(g.no_self_intersections);
  CHECK(g.genus == 3);
  CHECK(g.components == 2);
  CHECK(g.min_angle_deg == 20.5);
  CHECK(g.max_deviation_world == 0.1);
  CHECK_FALSE(g.allow_intersections);
  CHECK(arguments({"--allow-intersections"}).run.gates.allow_intersections);
  CHECK(contains(refusal({"a.obj", "b.ply", "--require", "genus"}), "genus=G"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--require", "watertight"}), "closed"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--require", "max-deviation=-1"}), "--require max-deviation"));
  CHECK(contains(refusal({"a.obj", "b.vdb", "--stop-after", "shell", "--require", "closed"}), "needs a mesh"));
}

TEST_CASE("args: a mistyped option is refused with the one that was meant", "[cli][args]") {
  CHECK(contains(refusal({"a.obj", "b.ply", "--vertces", "10"}), "did you mean --vertices?"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--vertces=10"}), "did you mean --vertices?"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--edge"}), "did you mean --edge-length?"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--xyzzy"}), "--help"));
  CHECK(contains(refusal({"a.obj", "b.ply", "c.ply"}), "'c.ply'"));
}

TEST_CASE("args: values outside their range are named with the range", "[cli][args]") {
  CHECK(contains(refusal({"a.obj", "b.ply", "--vertices", "3"}), "--vertices is 3; it must be 4 to"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--resolution", "8193"}), "8 to 8192"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--band", "0"}), "1 to 20"));
  CHECK(refusal({"a.obj", "b.ply", "--vertices", "3000000000"}) ==
        "--vertices is 3000000000; it must be 4 to 2147483647");
  CHECK(refusal({"a.obj", "b.ply", "--step", "0"}) == "--step is 0; it must be 0.00390625 to 1000");
  CHECK(contains(refusal({"a.obj", "b.ply", "--edge-length", "-1"}), "more than 0"));
  for (const char* growth : {"0.5", "1", "11", "nan"})
    CHECK(contains(refusal({"a.obj", "b.ply", "--gradation", growth}), "it must be more than 1 and at most 10"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--voxel-size", "nan"}), "voxel-size"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--vertices", "many"}), "vertices"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--close-gaps", "31vox"}), "0 to 30"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--close-gaps", "wide"}), "must be a number"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--device", "gpu"}), "auto, cpu, cuda"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--device", "cuda:x"}), "number"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--max-memory", "4X"}), "unit"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--max-memory", "0"}), "more than 0"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--method", "best"}), "sheet, shell"));
}

TEST_CASE("args: what is no number is refused by name, with what it must be", "[cli][args]") {
  CHECK(refusal({"a.obj", "b.ply", "--vertices", "nan"}) == "--vertices is 'nan'; it must be a whole number");
  CHECK(refusal({"a.obj", "b.ply", "--band", "1.5"}) == "--band is '1.5'; it must be a whole number");
  CHECK(refusal({"a.obj", "b.ply", "--step", "far"}) == "--step is 'far'; it must be a number");
  CHECK(refusal({"a.obj", "b.ply", "--iso", "abc"}) == "--iso is 'abc'; it must be a number");
  CHECK(contains(refusal({"a.obj", "b.ply", "--edge-length", "nan"}), "--edge-length is nan; it must be more than 0"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--tolerance", "nan"}), "0 to 1"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--step", "-1"}), "--step is -1; it must be"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--close-gaps", "nan"}), "must be a number"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--require", "min-angle=nan"}), "must be a number"));
  for (const char* seed : {"-1", "1.5", "18446744073709551616", "nan"})
    CHECK(
        contains(refusal({"a.obj", "b.ply", "--seed", seed}), "it must be a whole number, 0 to 18446744073709551615"));
}

TEST_CASE("args: what excludes each other is refused", "[cli][args]") {
  CHECK_FALSE(refusal({"a.obj", "b.ply", "--vertices", "10", "--edge-length", "1"}).empty());
  CHECK_FALSE(refusal({"a.obj", "b.ply", "--resolution", "64", "--voxel-size", "1"}).empty());
  CHECK_FALSE(refusal({"a.obj", "b.ply", "-v", "-q"}).empty());
  CHECK(contains(refusal({"a.obj", "-", "--output-format", "ply", "--stats", "-"}), "standard output"));
  for (const char* save : {"--save-shell", "--save-voronoi"})
    CHECK(contains(refusal({"a.obj", "-", "--output-format", "ply", save, "-"}), "cannot both be standard output"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--method", "shell", "--adaptivity", "1"}), "--method sheet"));
}

TEST_CASE("args: a report needs a mesh and a file", "[cli][args]") {
  CHECK(arguments({"--report", "page.html"}).run.report == "page.html");
  CHECK(contains(refusal({"in.obj", "out.vdb", "--stop-after", "shell", "--report", "page.html"}),
                 "leave out --stop-after"));
  CHECK(contains(refusal({"in.obj", "out.ply", "--report", "-"}), "name a file"));
}

TEST_CASE("args: files must say what they are", "[cli][args]") {
  CHECK(contains(refusal({}), "INPUT is missing"));
  CHECK(contains(refusal({"a.obj"}), "OUTPUT is missing"));
  CHECK(contains(refusal({"-", "b.ply"}), "--input-format"));
  CHECK(contains(refusal({"a.obj", "-"}), "--output-format"));
  CHECK(contains(refusal({"a.obj", "b.fbx"}), "ply, obj, stl, off"));
  CHECK(contains(refusal({"a.obj", "b"}), "ply, obj, stl, off"));
  CHECK(contains(refusal({"a.obj", "b.vdb"}), "ply, obj, stl, off"));
  CHECK(contains(refusal({"a.1.obj", "a.2.obj", "a.3.obj", "b.ply"}), "'mesh.####.ply' with --frames"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--stop-after", "shell"}), ".vdb"));
  CHECK(parse({"-", "-", "--input-format", "OBJ", "--output-format", ".STL"}).run->run.output.format == "stl");
  CHECK(parse({"a.obj", "--dry-run"}).run->dry_run);
  CHECK(parse({"dir.x/a.OBJ", "b.Ply"}).run->run.input.format == "obj");
}

TEST_CASE("args: OUTPUT may be an option, but not both", "[cli][args]") {
  for (const std::vector<const char*>& words :
       {std::vector<const char*>{"in.obj", "-o", "b.stl"}, {"-ob.stl", "in.obj"}, {"in.obj", "--output=b.stl"}}) {
    const Arguments a = *parse(words).run;
    CHECK(a.run.input.path == "in.obj");
    CHECK(a.run.output.path == "b.stl");
    CHECK(a.run.output.format == "stl");
  }
  CHECK(parse({"-", "--input-format", "obj", "-o", "-", "--output-format", "ply"}).run->run.output.path == "-");
  CHECK(refusal({"in.obj", "a.ply", "-o", "b.ply"}) ==
        "OUTPUT is given twice, as 'a.ply' and as --output 'b.ply'; leave one out");
}

TEST_CASE("args: help, version and refusals call the program as it was called", "[cli][args]") {
  const Program program{"isoshell remesh", "or a stage (.usd)", "or a pile (.pile)"};
  const char* help[] = {"isoshell remesh", "--help"};
  const std::string text = parse_command_line(2, help, program).text;
  CHECK(text.find("isoshell remesh INPUT OUTPUT [options]\n") == 0);
  CHECK(text.find(";\n        or a stage (.usd)\nOUTPUT ") != std::string::npos);
  CHECK(text.find(";\n        or a pile (.pile)\n\n") != std::string::npos);
  CHECK(text.find("vdb_isomesh") == std::string::npos);
  const char* version[] = {"isoshell remesh", "-V"};
  CHECK(parse_command_line(2, version, program).text.find("isoshell remesh ") == 0);
}

TEST_CASE("args: help and version answer under every name", "[cli][args]") {
  for (const char* name : {"--help", "-help", "-h"}) CHECK(contains(parse({name}).text, "--close-gaps W"));
  for (const char* name : {"-V", "--version", "-version"}) CHECK(parse({name}).text.find("vdb_isomesh ") == 0);
}

TEST_CASE("args: options by name mean what they mean on the command line", "[cli][args]") {
  const Arguments a =
      parse_given_options({{"vertices", "123"}, {"outer-only", {}}, {"features", "off"}, {"iso", "-2"}}, "");
  CHECK(a.run.options.values.vertices == 123);
  CHECK(a.run.options.values.outer_only);
  CHECK(a.run.options.values.features.creases == Features::Creases::off);
  CHECK(a.run.options.given == std::vector<std::string>{"vertices", "outer-only", "features", "iso"});
  CHECK(a.run.input.iso == -2.);
  const LabelReading labels = parse({"a.vdb:seg", "b.ply", "--background=-3", "--smallest-island", "0", "--smoothing",
                                     ".25", "--periodic", "z,x"})
                                  .run->run.input.labels;
  CHECK(labels.background == -3);
  CHECK(labels.smallest_island_vox == 0);
  CHECK(labels.smoothing_vox == .25);
  CHECK(labels.is_periodic == std::array{true, false, true});
  const RequestedOptions sized =
      parse({"a.vdb", "b.ply", "--region-edge-length", "7=.5", "--region-edge-length", "a=b=2"}).run->run.options;
  REQUIRE(sized.values.region_edge_lengths.size() == 2);
  CHECK(sized.values.region_edge_lengths[1].region == "a=b");
  CHECK(sized.values.region_edge_lengths[1].edge_length_world == 2);
  CHECK(sized.lengths_decide());
  CHECK(parse({"a.obj", "b.ply", "--regions", "groups", "--snap", ".02"}).run->run.options.values.snap_world == .02);
  CHECK(contains(refusal({"a.obj", "b.ply", "--snap", ".02"}), "--snap is for the parts of a mesh"));
  CHECK(contains(refusal({"a.vdb", "b.ply", "--region-edge-length", "7"}), "as 7=0.5"));
  CHECK(
      contains(refusal({"a.vdb", "b.ply", "--region-edge-length", "7=0"}), "of region 7 is 0; it must be more than 0"));
  CHECK(contains(refusal({"a.vdb", "b.ply", "--smallest-island=-1"}), "--smallest-island is -1; it must be 0 to"));
  CHECK(contains(refusal({"a.vdb", "b.ply", "--smoothing", "1.5"}), "--smoothing is 1.5; it must be 0 to 1"));
  CHECK(parse({"a.vdb", "b.ply", "--grids", "v,o.vdb:Cd"}).run->run.input.grids ==
        std::vector<std::string>{"v", "o.vdb:Cd"});
  CHECK(contains(refusal({"a.vdb", "b.ply", "--grids", "v,,Cd"}), "it must be all, or names separated by commas"));
  CHECK(contains(refusal({"a.vdb", "b.ply", "--periodic", "x,w"}), "--periodic is 'x,w'; give axes, x, y or z"));
  CHECK(a.run.output.path.empty());
  CHECK(parse_given_options({}, "out.ply").run.output.format == "ply");
}

TEST_CASE("args: an option by a name that does not exist is refused with the nearest", "[cli][args]") {
  const auto given_refusal = [](const std::string& name, const std::string& value) {
    return message_of(ErrorCode::usage, [&] { parse_given_options({{name, value}}, ""); });
  };
  CHECK(contains(given_refusal("verticse", "7"), "did you mean --vertices?"));
  CHECK(contains(given_refusal("vertices", "x"), "--vertices is 'x'"));
}

TEST_CASE("args: an option whose value is empty is refused, whichever it is", "[cli][args]") {
  for (const OptionEntry& option : option_table())
    if (!option.value.empty())
      CHECK(contains(refusal({"a.obj", "b.ply", ("--" + option.name).c_str(), ""}),
                     "--" + option.name + " has no value"));
}

TEST_CASE("args: what is for sequences needs frames", "[cli][args]") {
  const Arguments a = *parse({"in.####.obj", "out.####.ply", "--frames", "3-9x2", "--velocity", "v", "--resume"}).run;
  REQUIRE(a.frames);
  CHECK((a.frames->first == 3 && a.frames->last == 9 && a.frames->step == 2));
  CHECK(a.velocity == "v");
  CHECK((a.is_coherent && a.resume && !a.keep_going));
  for (const char* flag : {"--no-coherence", "--keep-going", "--resume"})
    CHECK(contains(refusal({"a.obj", "b.ply", flag}), std::string(flag) + " needs --frames"));
  CHECK(contains(refusal({"a.obj", "b.ply", "--frames", "9-3"}), "the last frame comes before the first"));
}

TEST_CASE("args: the table of options has them all, with what stands for their values", "[cli][args]") {
  const std::vector<OptionEntry> table = option_table();
  const auto entry = [&](const std::string& name) {
    for (const OptionEntry& option : table)
      if (option.name == name) return option;
    return OptionEntry{};
  };
  std::set<std::string> names;
  for (const OptionEntry& option : table) CHECK(names.insert(option.name).second);
  for (const OptionRow& row : option_rows()) CHECK(entry(row.name).text == row.text);
  for (const char* name : {"iso", "save-shell", "stats", "report", "force", "frames", "require", "device", "help"})
    CHECK(names.count(name) == 1);
  CHECK(entry("vertices").value == "K");
  CHECK(entry("vertices").fallback == "10000");
  CHECK_FALSE(entry("vertices").real);
  CHECK(entry("edge-length").real);
  CHECK(entry("outer-only").value.empty());
  CHECK(entry("outer-only").group == "Grid");
}
