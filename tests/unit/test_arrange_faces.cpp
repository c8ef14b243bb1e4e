// arrange_faces: triangles cut along each other.
#include <cstring>

#include "unit/arranged_faces.h"

using namespace isoshell;
using namespace isoshell::arranged;
using shapes::box;
using shapes::together;

namespace {

TriangleSoup three_sheets() {
  TriangleSoup s;
  s.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {.5, .125, 0}, {.5, .75, 0}, {.5, .75, 1}, {.5, .125, 1}};
  s.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  return s;
}

/// Corners on a grid of whole numbers, so that most faces share corners, lines and planes; moved by up to `noise`.
TriangleSoup on_grid(uint32_t count, uint64_t most, uint64_t seed, double noise) {
  TriangleSoup s;
  uint64_t next = 0;
  const auto coordinate = [&] {
    const double whole = double(random_bits(seed, next++) % (most + 1));
    return whole + noise * (double(random_bits(seed, next++) >> 11) / 4503599627370496.0 - 1);
  };
  for (uint32_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double x = coordinate(), y = coordinate(), z = coordinate();
      s.vertices.push_back({x, y, z});
    }
    shapes::add_triangle(s, 3 * i, 3 * i + 1, 3 * i + 2);
  }
  return s;
}

template <class T>
bool are_same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

}  // namespace

TEST_CASE("arrangement: what meets nothing stays as it is, to the last bit", "[arrangement]") {
  const TriangleSoup ball = shapes::sphere({.1, .2, .3}, 1, 24);
  const auto faces = check_arranged(ball, 2);
  CHECK(faces.cut_faces() == 0);
  REQUIRE(faces.face.size() == ball.triangles.size());
  for (size_t f = 0; f < faces.face.size(); ++f)
    for (size_t i = 0; i < 3; ++i) CHECK(faces.point[faces.face[f][i]] == ball.vertices[ball.triangles[f][i]]);
}

TEST_CASE("arrangement: cubes that touch with other diagonals have the same faces where they do", "[arrangement]") {
  const auto faces = check_arranged(together(box({0, 0, 0}, {1, 1, 1}), mirrored_y(box({1, 0, 0}, {2, 1, 1}), 1)), 2);
  CHECK(count_doubled(faces) == 4);
  CHECK(std::abs(doubled_area_of(faces) - 1) < 1e-9);
  CHECK(is_closed(faces));
}

TEST_CASE("arrangement: cubes that touch off centre share the part where they do", "[arrangement]") {
  const auto faces = check_arranged(together(box({0, 0, 0}, {1, 1, 1}), box({1, .3, .2}, {2, 1.3, 1.2})), 2);
  CHECK(std::abs(doubled_area_of(faces) - .7 * .8) < 1e-6);
  CHECK(is_closed(faces));
}

TEST_CASE("arrangement: a small cube on a large one shares its bottom, to rounding too", "[arrangement]") {
  for (const double gap : {0., 4e-7, -4e-7}) {
    const auto faces = check_arranged(together(box({0, 0, 0}, {4, 4, 1}), box({1, 1 - gap, 1 + gap}, {2, 2, 2})), 4);
    CHECK(count_doubled(faces) == 2);
    CHECK(std::abs(doubled_area_of(faces) - 1) < 1e-5);
    CHECK(is_closed(faces));
    CHECK(faces.point.size() == 16);
  }
}

TEST_CASE("arrangement: three sheets meet in one line of edges", "[arrangement]") {
  const auto faces = check_arranged(three_sheets(), 1);
  std::map<std::array<uint32_t, 2>, int> count;
  for (const Corners& c : faces.face)
    for (size_t i = 0; i < 3; ++i) ++count[{std::min(c[i], c[(i + 1) % 3]), std::max(c[i], c[(i + 1) % 3])}];
  double length_of_three = 0;
  for (const auto& e : count)
    if (e.second == 3) length_of_three += length(faces.point[e.first[0]] - faces.point[e.first[1]]);
  CHECK(std::abs(length_of_three - .625) < 1e-9);
}

TEST_CASE("arrangement: a cylinder through a plate cuts both along circles", "[arrangement]") {
  const TriangleSoup plate = box({-2, -2, 0}, {2, 2, .5});
  const auto faces = check_arranged(together(plate, cylinder({0, 0, -1}, 1, 3, 24, .1)), 4);
  CHECK(is_closed(faces));
  // Faces of the plate's top and bottom in the cylinder have the area of its cross section.
  double within = 0;
  for (size_t f = 0; f < faces.face.size(); ++f) {
    const WorldPoint m = middle_of(faces.point, faces.face[f]);
    if (faces.source[f] < plate.triangles.size() && m.x * m.x + m.y * m.y < 1)
      within += area_of(faces.point, faces.face[f]);
  }
  CHECK(std::abs(within - 2 * 12 * std::sin(6.283185307179586 / 24)) < 1e-5);
}

TEST_CASE("arrangement: a peg in a hole of other sides crosses its walls many times", "[arrangement]") {
  for (const uint32_t sides : {24u, 30u})
    for (const double turned : {.05, .1309, .21}) {
      const TriangleSoup hole = cylinder({0, 0, 0}, 1, 1, sides, .1, true);
      check_arranged(together(hole, cylinder({0, 0, 0}, 1, 1, 24, turned)), 2);
      check_arranged(together(hole, cylinder({0, 0, -.5}, 1, 2, 24, turned)), 2);
    }
}

TEST_CASE("arrangement: a plate with a peg that ends in its planes", "[arrangement]") {
  const TriangleSoup peg = cylinder({.1, .05, 0}, 1, .5, 24, .1);
  const auto faces = check_arranged(together(box({-2, -2, 0}, {2, 2, .5}), peg), 4);
  CHECK(std::abs(doubled_area_of(faces) - 2 * 12 * std::sin(6.283185307179586 / 24)) < 1e-5);
  CHECK(is_closed(faces));
}

TEST_CASE("arrangement: triangles given twice stay two, and those without area go", "[arrangement]") {
  const TriangleSoup cube = box({0, 0, 0}, {1, 1, 1});
  TriangleSoup soup = together(cube, shapes::inside_out(cube));
  const uint32_t n = uint32_t(soup.vertices.size());
  soup.vertices.push_back({.5, 0, 0});
  soup.triangles.push_back({0, 1, n});
  soup.triangles.push_back({3, 3, 5});
  const auto faces = check_arranged(soup, 1);
  CHECK(count_doubled(faces) == int64_t(faces.face.size()) / 2);
  CHECK(faces.source.back() < 24);
}

TEST_CASE("arrangement: corners nearly on faces and edges of others are on them", "[arrangement]") {
  TriangleSoup s;
  s.vertices = {{0, 0, 0}, {4, 0, 0},        {0, 4, 0},  {1, 1, 2e-7}, {1, 1, 2},
                {2, 1, 2}, {2, -1e-7, 1e-7}, {2, -1, 1}, {3, -1, 1}};
  s.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  const auto faces = check_arranged(s, 4);
  CHECK(faces.point.size() == s.vertices.size());
  CHECK(faces.cut_faces() == 1);
  const auto of_first = std::count(faces.source.begin(), faces.source.end(), 0u);
  CHECK(of_first == 4);
}

TEST_CASE("arrangement: soups of random triangles are cut right, as a look at all pairs says", "[arrangement]") {
  for (uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    check_arranged(shapes::random_soup(24, 1, 1, seed), 2);
  }
}

TEST_CASE("arrangement: triangles on a small grid, which share lines and planes, are cut right", "[arrangement]") {
  for (uint64_t seed = 0; seed < 40; ++seed)
    for (const double noise : {0., 3e-7}) {
      CAPTURE(seed, noise);
      check_arranged(on_grid(12, 3, seed, noise), 3);
    }
}

TEST_CASE("arrangement: triangles that cross at small angles are cut", "[arrangement]") {
  for (uint64_t seed = 0; seed < 6; ++seed)
    for (const double flatness : {1e-2, 1e-4, 1e-6, 1e-8}) {
      CAPTURE(seed, flatness);
      TriangleSoup flat = shapes::random_soup(8, 0, 1, seed);
      for (WorldPoint& p : flat.vertices) p.z *= flatness;
      check_arranged(flat, 1);
    }
}

TEST_CASE("arrangement: more triangles nearly in one plane than can be cut are given up", "[arrangement]") {
  TriangleSoup flat = shapes::random_soup(200, 0, 1, 5);
  for (WorldPoint& p : flat.vertices) p.z *= 1e-4;
  WorldPoint at[2] = {{9, 9, 9}, {9, 9, 9}};
  for (const int threads : {1, 4}) {
    Context context;
    context.threads = threads;
    CHECK_FALSE(repair::arrange_faces(flat, at[threads / 4], context));
  }
  CHECK((at[0].x == at[1].x && at[0].y == at[1].y && at[0].z == at[1].z));
  CHECK((at[0].x > 0 && at[0].x < 1));
}

TEST_CASE("arrangement: a result is independent of threads", "[arrangement]") {
  const TriangleSoup balls = together(shapes::sphere({0, 0, 0}, 1, 48),
                                      together(shapes::sphere({.7, .3, .1}, 1, 48), on_grid(20, 2, 1, 1e-7)));
  const auto one = arrange(balls, 1), four = arrange(balls, 4);
  CHECK(are_same_bytes(one.point, four.point));
  CHECK(are_same_bytes(one.face, four.face));
  CHECK(are_same_bytes(one.source, four.source));
  CHECK(one.cut_faces() == four.cut_faces());
}
