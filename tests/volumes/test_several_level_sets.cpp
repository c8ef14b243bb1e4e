// Several level sets of .vdb files: which are read, and what is refused.
#include <filesystem>
#include <fstream>

#include "io/level_sets.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/temporary_file.h"
#include "volumes/level_sets.h"

using namespace isoshell;

TEST_CASE("level sets: those too far apart for one box are refused by name, with or without a limit",
          "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  for (const int far : {20'000, 4'200'000, 130'000'000}) {
    write(file.path, {small_ball_at("a", 0), small_ball_at("b", far)});
    for (const bool unite : {false, true}) {
      InputRequest request = request_for(file.path + ":*");
      request.unite = unite;
      const Error error = error_of([&] { read(request); });
      CHECK(error.code() == ErrorCode::out_of_memory);
      CHECK(says(error, "voxels along x, from \"a\" to \"b\""));
    }
  }
  write(file.path, {small_ball_at("a", 0), small_ball_at("b", 16'000)});
  CHECK(says(error_of([&] { read_input(request_for(file.path + ":*"), int64_t(1'000'000)); }), "raise --max-memory"));
}

TEST_CASE("level sets: those of several files are regions, by the names of grids or of files", "[regions][vdb]") {
  const TemporaryFile one("one.vdb"), other("other.vdb");
  write(one.path, {level_set("surface", ball(-.3, .4))});
  write(other.path, {level_set("surface", ball(.3, .4)), level_set("more", ball(.3, .1))});
  InputRequest request = request_for(one.path);
  request.also = {other.path + ":surface"};
  const Input input = read(request);
  REQUIRE(input.soup.regions.names.size() == 2);
  CHECK(contains(input.soup.regions.names[0].name, "one:surface"));
  CHECK(contains(input.soup.regions.names[1].name, "other:surface"));
  request.also = {other.path};
  CHECK(says(error_of([&] { read(request); }), "holds several grids, name one as"));
}

TEST_CASE("level sets: files of one name in two folders are told apart, and no grid is given twice", "[regions][vdb]") {
  const TemporaryFile one("folder1"), other("folder2");
  const std::string paths[2] = {one.path + "/piece.vdb", other.path + "/piece.vdb"};
  for (const std::string& folder : {one.path, other.path}) std::filesystem::create_directory(folder);
  write(paths[0], {level_set("surface", ball(-.3, .4))});
  write(paths[1], {level_set("surface", ball(.3, .4)), level_set("more", ball(.3, .1))});
  InputRequest request = request_for(paths[0]);
  request.also = {paths[1] + ":surface"};
  const Input input = read(request);
  REQUIRE(input.soup.regions.names.size() == 2);
  for (size_t i = 0; i < 2; ++i) CHECK(input.soup.regions.names[i].name == paths[i] + ":surface");
  CHECK(input.facts.also == request.also);
  request.also = {paths[0]};
  CHECK(says(error_of([&] { read(request); }), "piece.vdb:surface is given twice; leave one of them out"));
  request.also = {one.path + "/./piece.vdb"};
  const Error again = error_of([&] { read(request); });
  CHECK(says(again, "/./piece.vdb:surface is given twice, also as " + paths[0] + ":surface; leave one of them out"));
  for (const std::string& folder : {one.path, other.path}) std::filesystem::remove_all(folder);
}

TEST_CASE("level sets: a reference takes its part of the limit of memory", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  write(file.path, {level_set("a", ball(-.3, .4)), level_set("b", ball(.3, .4))});
  ReadingBudget budget(0);
  const MeshSource source(file.path, budget);
  const int64_t limit_bytes = 100'000'000;
  CHECK(read_level_sets({{&source, "*"}}, limit_bytes).blocks.size() == 2);
  const Error error = error_of([&] { read_level_sets({{&source, "*"}}, limit_bytes, limit_bytes - 1000); });
  CHECK(error.code() == ErrorCode::out_of_memory);
}

TEST_CASE("level sets: a reference that cannot be read is refused before they are", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb"), damaged("damaged.vdb");
  write(file.path, {level_set("a", ball(-.3, .4)), level_set("b", ball(.3, .4))});
  std::ofstream(damaged.path, std::ios::binary) << "no grid of any kind";
  const auto told_before = [&](const std::string& reference, const std::string& words) {
    InputRequest request = request_for(file.path + ":*");
    request.reference = reference;
    bool has_read = false;
    const Error error = error_of([&] {
      read_input(request, 0, [&](MessageKind, const std::string& text) { has_read |= contains(text, "level sets"); });
    });
    CHECK(says(error, words));
    CHECK_FALSE(has_read);
  };
  told_before("none.ply", "none.ply: no such file");
  told_before(damaged.path, "damaged.vdb");
  told_before("none.txt", "none.txt");
}

TEST_CASE("level sets: other transforms, other classes and names that nothing has are refused", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  const auto refusal = [&](const openvdb::GridPtrVec& grids, const std::string& pattern) {
    write(file.path, grids);
    return error_of([&] { read(request_for(file.path + ":" + pattern)); });
  };
  const Error shifted = refusal({level_set("a", ball(0, .5)), level_set("b", ball(.2, .5), .01)}, "*");
  CHECK(shifted.code() == ErrorCode::usage);
  CHECK(says(shifted, "grid \"b\" has another transform than"));
  CHECK(says(shifted, "its voxel (0, 0, 0) lies at x = 0.01, not at 0"));
  CHECK(says(refusal({level_set("a", ball(0, .5))}, "piece*"),
             "no level set has a name like \"piece*\"; it holds \"a\""));
  InputRequest request = request_for(file.path + ":*");
  request.labels.background = 3;
  CHECK(says(error_of([&] { read(request); }), "--background is for volumes of labels"));
  auto fog = level_set("a", ball(0, .5));
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  write(file.path, {fog, level_set("b", ball(.2, .5))});
  request = request_for(file.path + ":a");
  request.also = {file.path + ":b"};
  CHECK(says(error_of([&] { read(request); }), "where all of them are level sets"));
}

TEST_CASE("level sets: those of a pattern that are flawed are refused, and other volumes named", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  auto other = level_set("piece2", ball(.5, .4));
  other->setGridClass(openvdb::GRID_UNKNOWN);
  write(file.path, {level_set("piece1", ball(-.5, .4)), other});
  CHECK(contains(warnings_of(request_for(file.path + ":piece*")), "\"piece*\": \"piece2\" (float, unknown)"));
  auto flawed = openvdb::Int32Grid::create(3);
  flawed->setName("piece2");
  flawed->setGridClass(openvdb::GRID_LEVEL_SET);
  flawed->tree().setValue({0, 0, 0}, -1);
  write(file.path, {level_set("piece1", ball(-.5, .4)), flawed});
  CHECK(says(error_of([&] { read(request_for(file.path + ":piece*")); }),
             "level set \"piece2\" (int32, level set) has a name like \"piece*\", but holds integers"));
}

TEST_CASE("level sets: files of other formats are refused with a remedy", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb"), mesh("mesh.obj"), packed("packed.nvdb");
  write(file.path, {level_set("a", ball(0, .5))});
  std::ofstream(mesh.path) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(packed.path, std::ios::binary) << "NanoVDB0 and more bytes of what no reader comes to";
  const auto refusal = [&](const std::string& name, const std::string& also) {
    InputRequest request = request_for(name);
    if (!also.empty()) request.also = {also};
    return error_of([&] { read(request); });
  };
  CHECK(says(refusal(file.path, mesh.path), "are read of .vdb and .nvdb files; this is none by"));
  CHECK(says(refusal(mesh.path, file.path), "are read of .vdb and .nvdb files; this is none by"));
  CHECK(says(refusal(packed.path + ":*", ""), "packed.nvdb"));  // it is damaged
  CHECK(says(refusal(file.path, packed.path), "packed.nvdb"));
}

TEST_CASE("level sets: one that holds its band alone is refused with a remedy, one that was clipped is not",
          "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  const double band = 3 * kVoxel;
  const Distance whole = ball(0, .6);
  const auto alone = level_set("a", [&](const WorldPoint& p) { return whole(p) > -band ? whole(p) : band; });
  write(file.path, {alone, level_set("b", ball(.9, .3))});
  for (const bool unite : {false, true}) {
    InputRequest request = request_for(file.path + ":*");
    request.unite = unite;
    CHECK(says(error_of([&] { read(request); }), "grid \"a\" has the value of the outside, 0.15"));
  }
  write(file.path, {level_set("a", [&](const WorldPoint& p) { return p.x < 0 ? whole(p) : band; }),
                    level_set("thin", [](const WorldPoint& p) { return p.y < 0 ? ball(.9, .12)(p) : .15; })});
  CHECK(read(request_for(file.path + ":*")).soup.regions.names.size() == 2);
}

TEST_CASE("level sets: a limit of memory is for all of them, as they are read one by one", "[regions][vdb]") {
  const TemporaryFile file("pieces.vdb");
  openvdb::GridPtrVec grids;
  for (int i = 0; i < 12; ++i) grids.push_back(level_set("piece" + std::to_string(i), ball(.01 * i, .6)));
  write(file.path, grids);
  for (const int64_t limit_bytes : {int64_t(500'000), int64_t(1'000'000), int64_t(2'000'000)}) {
    const Error error = error_of([&] { read_input(request_for(file.path + ":*"), limit_bytes); });
    CHECK(error.code() == ErrorCode::out_of_memory);
    CHECK(says(error, "raise --max-memory"));
  }
}

TEST_CASE("level sets: patterns stand for names as a shell's do", "[vdb][unit]") {
  CHECK(fits("piece_1", "piece*"));
  CHECK(fits("piece_1", "*_?"));
  CHECK(fits("", "*"));
  CHECK(fits("abcabd", "*ab?"));
  CHECK_FALSE(fits("piece_1", "piece"));
  CHECK_FALSE(fits("piece_10", "piece_?"));
  CHECK_FALSE(fits("", "?"));
}
