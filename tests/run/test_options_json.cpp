// Options to JSON and back, from text, and what of JSON is refused.
#include <nlohmann/json.hpp>

#include "isoshell/error.h"
#include "isoshell/options/option_text.h"
#include "isoshell/options/options_json.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using Json = nlohmann::ordered_json;

namespace {

/// What parsing refuses, with the code; empty when it does not.
std::string refusal(const std::string& json, ErrorCode code = ErrorCode::usage) {
  return message_of(code, [&] { parse_options_json(json); });
}

class NamedField final : public SizingField {
 public:
  explicit NamedField(std::string source) : source_(std::move(source)) {}
  std::vector<double> lengths_at(const std::vector<WorldPoint>& points) const override {
    return std::vector<double>(points.size(), 1);
  }
  std::string source() const override { return source_; }

 private:
  std::string source_;
};

}  // namespace

TEST_CASE("options json: what is not given is the number that always stood for it", "[options]") {
  CHECK(
      options_json(RemeshOptions{}) ==
      R"({"vertices":10000,"edge-length":0.0,"sizing":"","region-edge-length":"","adaptivity":0.0,)"
      R"("gradation":1.2,"resolution":0,"voxel-size":0.0,"band":2,"close-gaps":"auto","outer-only":false,)"
      R"("method":"sheet","iterations":0,"tolerance":-1.0,"step":0.0,"seed":0,"fit":"balanced","features":"auto","boundary":"close","regions":"","snap":0.0,)"
      R"("attributes":"all","uv-seams":"keep","color-features":false,"uniform-area":false})");
  const RequestedOptions back = parse_options_json(options_json(RemeshOptions{}));
  CHECK(back.values.vertices == 10000);
  CHECK_FALSE(back.values.edge_length_world);
  CHECK_FALSE(back.values.resolution);
  CHECK_FALSE(back.values.voxel_size_world);
  CHECK_FALSE(back.values.closing_vox);
  CHECK_FALSE(back.values.closing_world);
  CHECK_FALSE(back.values.max_passes);
  CHECK_FALSE(back.values.tolerance);
  CHECK_FALSE(back.values.max_step_vox);
}

TEST_CASE("options json: every option survives the way there and back", "[options]") {
  RunOptions o;
  o.vertices.reset();
  o.edge_length_world = 0.1;
  o.resolution = 77;
  o.voxel_size_world = 1e-7;
  o.snap_world = 3e-5;
  o.band_vox = 5;
  o.closing_world = 0.30000000000000004;
  o.max_passes = 9;
  o.tolerance = 0;
  o.max_step_vox = 1.5;
  o.seed = 18446744073709551615ull;
  o.sizing = std::make_shared<NamedField>("field.vdb:edge");
  o.region_edge_lengths = {{"7", 0.1}, {"left = right", 1e-9}};
  o.adaptivity = 0.25;
  o.gradation = 1.5;
  o.fit = Fit::surface;
  o.uniform_area = true;
  o.features = {Features::Creases::threshold, 33.25};
  o.line_file = "marks.obj";
  o.color_features = true;
  o.boundary = Boundary::keep;
  o.attributes = {"color", "quality"};
  o.uv_seams = UvSeams::ignore;
  o.outer_only = true;
  const RequestedOptions back = parse_options_json(options_json(o));
  const RunOptions& b = back.values;
  CHECK_FALSE(b.vertices);
  CHECK(b.edge_length_world == o.edge_length_world);
  CHECK(b.resolution == o.resolution);
  CHECK(b.voxel_size_world == o.voxel_size_world);
  CHECK(b.snap_world == o.snap_world);
  CHECK(b.band_vox == o.band_vox);
  CHECK_FALSE(b.closing_vox);
  CHECK(b.closing_world == o.closing_world);
  CHECK(b.max_passes == o.max_passes);
  CHECK(b.tolerance == o.tolerance);
  CHECK(b.max_step_vox == o.max_step_vox);
  CHECK(b.seed == o.seed);
  REQUIRE(b.region_edge_lengths.size() == 2);
  CHECK(b.region_edge_lengths[1].region == "left = right");
  CHECK(b.region_edge_lengths[1].edge_length_world == 1e-9);
  CHECK(b.adaptivity == o.adaptivity);
  CHECK(b.gradation == o.gradation);
  CHECK(b.fit == o.fit);
  CHECK(b.uniform_area);
  CHECK(b.features.creases == Features::Creases::threshold);
  CHECK(b.features.degrees == 33.25);
  CHECK(b.line_file == "marks.obj");
  CHECK(b.color_features);
  CHECK(b.boundary == Boundary::keep);
  CHECK(b.attributes == o.attributes);
  CHECK(b.uv_seams == UvSeams::ignore);
  CHECK(b.outer_only);
  CHECK(back.sizing == "field.vdb:edge");
  const Json object = Json::parse(options_json(o));
  CHECK(back.given.size() == object.size());
  for (const auto& item : object.items()) CHECK(back.was_given(item.key()));
}

TEST_CASE("options json: every value of the widths of gaps survives", "[options]") {
  for (const char* width : {"auto", "0vox", "4vox", "30vox"}) {
    RemeshOptions o;
    set_gap_width("close-gaps", width, o);
    const std::string json = options_json(o);
    CHECK(Json::parse(json)["close-gaps"] == width);
    CHECK(parse_options_json(json).values.closing_vox == o.closing_vox);
  }
  CHECK(parse_options_json(R"({"close-gaps": 0.5})").values.closing_world == 0.5);
  CHECK(parse_options_json(R"({"close-gaps": "0.5"})").values.closing_world == 0.5);
  CHECK(parse_options_json(R"({"close-gaps": 0})").values.closing_vox == 0);
}

TEST_CASE("options json: an object may hold few options, and null is none", "[options]") {
  const RequestedOptions few = parse_options_json(R"({"edge-length": 2, "tolerance": null, "seed": 3})");
  CHECK(few.values.edge_length_world == 2);
  CHECK(few.values.vertices == 10000);
  CHECK_FALSE(few.values.tolerance);
  CHECK(few.given == std::vector<std::string>{"edge-length", "seed"});
  CHECK_FALSE(few.was_given("tolerance"));
}

TEST_CASE("options json: options that a stage file of 7334733 keeps are read", "[options]") {
  const RequestedOptions kept = parse_options_json(
      R"({"vertices":0,"edge-length":1.5,"band":3,"outer-only":true,"method":"sheet","iterations":9,"tolerance":-1.0,)"
      R"("step":0.0,"seed":7,"fit":"surface","uniform-area":false,"adaptivity":0.0,"gradation":1.3,"sizing":""})");
  CHECK_FALSE(kept.values.vertices);
  CHECK(kept.values.edge_length_world == 1.5);
  CHECK(kept.values.max_passes == 9);
  CHECK_FALSE(kept.values.tolerance);
  CHECK_FALSE(kept.was_given("close-gaps"));
}

TEST_CASE("options json: whole numbers may be written with a point", "[options]") {
  const RequestedOptions requested =
      parse_options_json(R"({"vertices": 500.0, "band": 3.0, "iterations": 0.0, "seed": 7.0})");
  CHECK(requested.values.vertices == 500);
  CHECK(requested.values.band_vox == 3);
  CHECK_FALSE(requested.values.max_passes);
  CHECK(requested.values.seed == 7);
  CHECK(contains(refusal(R"({"seed": 7.5})"), "seed is 7.5; it must be a whole number"));
  CHECK(contains(refusal(R"({"seed": -1.0})"), "it must be a whole number"));
  CHECK(contains(refusal(R"({"seed": 18446744073709551616})"), "it must be a whole number"));
  CHECK(contains(refusal(R"({"vertices": 1e300})"), "it must be 4 to 2147483647"));
}

TEST_CASE("options json: a sizing field whose name is not UTF-8 is written all the same", "[options]") {
  RemeshOptions o;
  o.sizing = std::make_shared<NamedField>("f\xff.vdb");
  CHECK(parse_options_json(options_json(o)).sizing == "f\xEF\xBF\xBD.vdb");
  CHECK(requested_options(o).was_given("sizing"));
}

TEST_CASE("options json: of options set in C++ those are given that differ from the defaults", "[options]") {
  CHECK(requested_options({}).given.empty());
  RemeshOptions o;
  o.vertices = 500;
  o.tolerance = 0;
  o.closing_vox = 0;
  o.outer_only = true;
  o.want_digests = true;
  const RequestedOptions requested = requested_options(o, "f.vdb");
  CHECK(requested.given == std::vector<std::string>{"vertices", "sizing", "close-gaps", "outer-only", "tolerance"});
  CHECK(requested.sizing == "f.vdb");
  CHECK(requested.values.vertices == 500);
  CHECK(requested.values.want_digests);
}

TEST_CASE("options json: what cannot be taken is refused by name, value and limit", "[options]") {
  CHECK(refusal(R"({"vertices": 3})") == "vertices is 3; it must be 4 to 2147483647");
  CHECK(refusal(R"({"vertices": 10.5})") == "vertices is 10.5; it must be a whole number");
  CHECK(refusal(R"({"vertices": "many"})") == "vertices is \"many\"; it must be a whole number");
  CHECK(refusal(R"({"edge-length": -1})") == "edge-length is -1; it must be more than 0");
  CHECK(refusal(R"({"seed": -1})") == "seed is -1; it must be a whole number, 0 to 18446744073709551615");
  CHECK(refusal(R"({"outer-only": 1})") == "outer-only is 1; it must be true or false");
  CHECK(refusal(R"({"method": "best"})") == "method is 'best'; it must be one of sheet, shell");
  CHECK(refusal(R"({"fit": 1})") == "fit is 1; it must be text");
  CHECK(contains(refusal(R"({"gradation": 1})"), "gradation is 1; it must be more than 1"));
  CHECK(contains(refusal(R"({"close-gaps": "31vox"})"), "0 to 30"));
  CHECK(refusal(R"({"vertces": 10})") == "there is no option 'vertces'");
  CHECK(parse_options_json(R"({"vertces": 10})", UnknownOptions::pass_over).given.empty());
  CHECK_FALSE(refusal("", ErrorCode::unreadable_input).empty());
  CHECK_FALSE(refusal("[1]", ErrorCode::unreadable_input).empty());
}

TEST_CASE("options: the numbers that stood for what is not given are still none", "[options]") {
  RemeshOptions o;
  o.vertices = 0;
  o.edge_length_world = 0;
  o.resolution = 0;
  o.voxel_size_world = 0;
  o.closing_vox = -1;
  o.closing_world = -1;
  o.max_passes = 0;
  o.tolerance = -1;
  o.max_step_vox = 0;
  CHECK(Json::parse(options_json(o))["vertices"] == 0);
  const RequestedOptions back = parse_options_json(options_json(o));
  CHECK_FALSE(back.values.vertices);
  CHECK_FALSE(back.values.closing_vox);
  CHECK_FALSE(back.values.tolerance);
}

TEST_CASE("options json: a file of lines stands behind a comma, and the edges that are kept before it", "[options]") {
  const RunOptions lines = parse_options_json(R"({"features": "off,a,b.obj"})").values;
  CHECK(lines.features.creases == Features::Creases::off);
  CHECK(lines.line_file == "a,b.obj");
  CHECK(parse_options_json(R"({"features": 30})").values.line_file.empty());
  CHECK(refusal(R"({"features": "30,"})") == "features is '30,'; behind the comma stands a file of lines");
  CHECK(contains(refusal(R"({"features": ",a.obj"})"), "neither off nor auto"));
}

TEST_CASE("options json: attributes are all, none, or names between commas", "[options]") {
  using Names = std::vector<std::string>;
  CHECK_FALSE(parse_options_json(R"({"attributes": "all"})").values.attributes);
  CHECK(parse_options_json(R"({"attributes": "none"})").values.attributes == Names{});
  CHECK(parse_options_json(R"({"attributes": "color,my heat"})").values.attributes == Names{"color", "my heat"});
  for (const char* text : {"", ",", "a,", "a,,b"})
    CHECK(contains(refusal(Json{{"attributes", text}}.dump()), "must be all, none, or names separated by commas"));
  CHECK(contains(refusal(R"({"attributes": 3})"), "it must be text"));
  for (const char* text : {"all", "none", "a,b"}) CHECK(attributes_text(parse_attributes("attributes", text)) == text);
}
