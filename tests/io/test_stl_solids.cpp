// The solids of a text STL file are groups of its faces, unless there is one only.
#include "isoshell/io/mesh_file.h"
#include "support/mesh_files.h"
#include "support/refusals.h"

using namespace isoshell;

namespace {

using Names = std::vector<std::string>;
using Values = std::vector<double>;

std::string facet(int x) {
  const std::string at = std::to_string(x);
  return "facet normal 0 0 1\nouter loop\nvertex " + at + " 0 0\nvertex " + at + " 1 0\nvertex " + at +
         " 0 1\nendloop\nendfacet\n";
}

std::string solid(const std::string& name, int first, int last) {
  std::string text = "solid" + (name.empty() ? "" : " " + name) + "\n";
  for (int x = first; x < last; ++x) text += facet(x);
  return text + "endsolid" + (name.empty() ? "" : " " + name) + "\n";
}

Attribute group_of(const std::string& text) {
  const TriangleSoup soup = read_text_as("stl", text);
  REQUIRE(soup.attributes.size() == 1);
  const Attribute& group = soup.attributes[0];
  CHECK(means(group, kGroupName));
  CHECK(group.values.size() == soup.triangles.size());
  return group;
}

}  // namespace

TEST_CASE("STL solids: their names are groups of the faces, with those that repeat once", "[mesh_file][unit]") {
  const Attribute group = group_of(solid("inlet", 0, 2) + solid("the wall", 2, 3) + solid("inlet", 3, 4));
  CHECK(group.domain == AttributeDomain::face);
  CHECK(group.labels == Names{"inlet", "the wall"});
  CHECK(group.values == Values{0, 0, 1, 0});
}

TEST_CASE("STL solids: facets without a name are of no group", "[mesh_file][unit]") {
  const Attribute group = group_of(solid("", 0, 1) + solid("a", 1, 2) + facet(2) + solid("", 3, 4));
  CHECK(group.labels == Names{"a"});
  CHECK(group.values == Values{-1, 0, -1, -1});
}

TEST_CASE("STL solids: one name of all facets is no group", "[mesh_file][unit]") {
  for (const std::string& text :
       {solid("a", 0, 3), solid("", 0, 2) + solid("", 2, 3), solid("a", 0, 2) + solid("a", 2, 3),
        solid("empty", 0, 0) + solid("a", 0, 3) + solid("as well", 0, 0), "solid b\n" + solid("a", 0, 3)})
    CHECK(read_text_as("stl", text).attributes.empty());
}

TEST_CASE("STL solids: names are lines without the blanks around them, in any encoding and of any length",
          "[mesh_file][unit]") {
  const std::string latin = "gr\xfc\xdf", utf8 = "gr\xc3\xbc\xc3\x9f", keyword = "facet normal", large(100000, 'x');
  const Attribute group = group_of(solid(" \t" + latin + " \r", 0, 1) + solid(utf8, 1, 2) + solid(keyword, 2, 3) +
                                   solid(large, 3, 4) + solid("\x01 \x7f", 4, 5));
  CHECK(group.labels == Names{latin, utf8, keyword, large, "\x01 \x7f"});
  CHECK(group.values == Values{0, 1, 2, 3, 4});
}

TEST_CASE("STL solids: thousands of them are told apart wherever the text is cut for threads", "[mesh_file][unit]") {
  constexpr int kSolids = 3000;
  std::string text;
  Names names;
  Values expected;
  for (int i = 0, x = 0; i < kSolids; ++i) {
    const int facets = 1 + i % 7;
    names.push_back("part " + std::to_string(i));
    text += solid(names.back(), x, x + facets);
    expected.insert(expected.end(), size_t(facets), i);
    x += facets;
  }
  const Attribute group = group_of(text);
  CHECK(group.labels == names);
  CHECK(group.values == expected);
}

TEST_CASE("STL solids: faces that are dropped or split keep the groups of the others right", "[mesh_file][unit]") {
  const std::string flat = "facet\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n";
  const std::string quad =
      "facet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const Attribute group = group_of("solid a\n" + flat + facet(1) + "endsolid\nsolid b\n" + quad + flat +
                                   "endsolid\nsolid c\n" + facet(2) + "endsolid\n");
  CHECK(group.labels == Names{"a", "b", "c"});
  CHECK(group.values == Values{0, 1, 1, 2});
}
