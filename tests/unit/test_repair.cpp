// repair on shapes whose damage is known.
#include <algorithm>
#include <functional>

#include "isoshell/advanced/stages.h"
#include "isoshell/repair.h"
#include "repair/holes/open_soup.h"
#include "support/catch.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

using Corner = std::array<double, 3>;

/// What a soup is, whatever the order of its vertices and faces.
std::vector<std::array<Corner, 3>> triangles_of(const TriangleSoup& soup) {
  std::vector<std::array<Corner, 3>> all;
  for (const auto& t : soup.triangles) {
    std::array<Corner, 3> c;
    for (size_t i = 0; i < 3; ++i) c[i] = {soup.vertices[t[i]].x, soup.vertices[t[i]].y, soup.vertices[t[i]].z};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    all.push_back(c);
  }
  std::sort(all.begin(), all.end());
  return all;
}

TriangleSoup without(TriangleSoup soup, const std::function<bool(WorldPoint)>& gone) {
  const auto is_gone = [&](const std::array<uint32_t, 3>& t) {
    const WorldPoint &p = soup.vertices[t[0]], &q = soup.vertices[t[1]], &r = soup.vertices[t[2]];
    return gone({(p.x + q.x + r.x) / 3, (p.y + q.y + r.y) / 3, (p.z + q.z + r.z) / 3});
  };
  soup.triangles.erase(std::remove_if(soup.triangles.begin(), soup.triangles.end(), is_gone), soup.triangles.end());
  return soup;
}

TriangleSoup ball(uint32_t n = 32) { return shapes::sphere({0, 0, 0}, 1, n); }

struct Repaired {
  TriangleSoup soup;
  RepairReport report;
  InputTopology topology;
};

/// Repairs, and shows that the order of vertices and faces does not matter.
Repaired repaired(const TriangleSoup& soup, bool cap_loops = true) {
  Repaired m;
  m.soup = repair_soup(soup, {cap_loops}, m.report);
  RepairReport again;
  CHECK(triangles_of(repair_soup(shapes::shuffled(soup, 5), {cap_loops}, again)) == triangles_of(m.soup));
  CHECK(again.capped_loops == m.report.capped_loops);
  Context context;
  m.topology = measure_topology(m.soup, context).topology;
  return m;
}

void check_solid(const Repaired& m, double expected) {
  CHECK(m.topology.closed);
  CHECK(m.topology.oriented);
  CHECK(m.topology.genus == 0);
  CHECK(m.topology.components == 1);
  CHECK(volume(m.soup) > .9 * expected);
  CHECK(volume(m.soup) < 1.001 * expected);
}

}  // namespace

TEST_CASE("repair: a clean surface stays as it is", "[repair]") {
  const TriangleSoup torus = shapes::torus(3, 1, 20, 12);
  const Repaired m = repaired(torus);
  CHECK(m.soup.triangles == torus.triangles);
  CHECK_FALSE(m.report.changed_anything());
}

TEST_CASE("repair: holes of any number of edges are capped, the caps look outward", "[repair]") {
  const double expected = volume(ball());
  for (const double height : {.98, .95, .9}) {
    const Repaired m = repaired(without(ball(), [=](WorldPoint p) { return p.z > height; }));
    check_solid(m, expected);
    CHECK(m.report.capped_loops == 1);
    CHECK(m.report.open_loops == 0);
  }
  const Repaired large = repaired(without(ball(300), [](WorldPoint p) { return p.z > .97; }));
  check_solid(large, volume(ball(300)));
  CHECK(large.report.cap_faces == 298);
  // Four areas over the length: the diameter of the hole.
  CHECK(large.report.widest_cap_world > .4);
  CHECK(large.report.widest_cap_world < .6);
}

TEST_CASE("repair: caps are the last faces, and known as such", "[repair]") {
  const Repaired m = repaired(without(ball(), [](WorldPoint p) { return p.z > .9; }));
  CHECK(m.report.cap_faces > 0);
  CHECK(m.soup.first_cap == m.soup.triangles.size() - size_t(m.report.cap_faces));
  CHECK(repaired(ball()).soup.first_cap > m.soup.triangles.size());
}

TEST_CASE("repair: boundaries a hair apart are one, boundaries farther apart are capped", "[repair]") {
  const auto halves = [](double apart) {
    TriangleSoup upper = without(ball(), [](WorldPoint p) { return p.z < .1; });
    for (WorldPoint& p : upper.vertices) p.z += apart;
    return shapes::together(upper, without(ball(), [](WorldPoint p) { return p.z > .1; }));
  };
  const Repaired joined = repaired(halves(1e-6));
  check_solid(joined, volume(ball()));
  CHECK(joined.report.joined_vertices == 64);
  CHECK(joined.report.capped_loops == 0);
  const Repaired apart = repaired(halves(1e-3));
  CHECK(apart.report.joined_vertices == 0);
  CHECK(apart.report.capped_loops + apart.report.open_loops == 2);
}

TEST_CASE("repair: a bowl's rim and a sheet's are no holes", "[repair]") {
  for (const TriangleSoup& soup :
       {without(ball(), [](WorldPoint p) { return p.z > 0; }), shapes::two_sheets(3, 1), shapes::two_sheets(3, .01)}) {
    const Repaired m = repaired(soup);
    CHECK(m.report.capped_loops == 0);
    CHECK(m.report.open_loops == m.topology.boundary_loops);
    CHECK_FALSE(m.topology.closed);
  }
}

TEST_CASE("repair: holes stay when caps are not wanted", "[repair]") {
  const Repaired m = repaired(without(ball(), [](WorldPoint p) { return p.z > .9 || p.x > .9; }), false);
  CHECK(m.report.capped_loops == 0);
  CHECK(m.report.open_loops == 2);
}

TEST_CASE("repair: of a surface that stays open only narrow loops are closed, and small parts stay", "[repair]") {
  const auto gone = [](WorldPoint p) { return p.z < -.3 || p.z > .97; };
  const TriangleSoup bowl = without(ball(), gone);
  TriangleSoup speck = bowl;
  speck.vertices.insert(speck.vertices.end(), {{3, 0, 0}, {3.01, 0, 0}, {3, .01, 0}});
  const auto last = uint32_t(speck.vertices.size());
  shapes::add_triangle(speck, last - 3, last - 2, last - 1);
  RepairReport report;
  const TriangleSoup same = repair::repair_open_soup(speck, 0, report);
  CHECK(triangles_of(same) == triangles_of(speck));
  CHECK(report.open_loops == 3);
  repair::repair_open_soup(bowl, .6, report);
  CHECK(report.capped_loops == 1);
  CHECK(report.open_loops == 1);
  repair::repair_open_soup(bowl, 10, report);  // rims are loops like any
  CHECK(report.capped_loops == 2);
}

TEST_CASE("repair: holes that touch in a vertex, and a face between them, are closed around it", "[repair]") {
  TriangleSoup soup = ball(24);
  // The fan around the north pole: every other face, then all but one.
  const uint32_t pole = uint32_t(soup.vertices.size() - 1);
  std::vector<size_t> fan;
  for (size_t i = 0; i < soup.triangles.size(); ++i)
    if (soup.triangles[i][0] == pole) fan.push_back(i);
  for (const size_t kept_of : {2, 24}) {
    TriangleSoup cut = soup;
    cut.triangles.clear();
    for (size_t i = 0, k = 0; i < soup.triangles.size(); ++i) {
      const bool in_fan = std::find(fan.begin(), fan.end(), i) != fan.end();
      if (!in_fan || k++ % kept_of == 0) cut.triangles.push_back(soup.triangles[i]);
    }
    check_solid(repaired(cut), volume(soup));
  }
}

TEST_CASE("repair: every third face gone at random leaves holes of all kinds, and all are closed", "[repair]") {
  TriangleSoup soup = ball(40);
  const double expected = volume(soup);
  for (const uint64_t tenths : {1, 2, 3}) {
    TriangleSoup cut = soup;
    cut.triangles.clear();
    for (size_t i = 0; i < soup.triangles.size(); ++i)
      if (random_bits(tenths, i) % 10 >= tenths) cut.triangles.push_back(soup.triangles[i]);
    const Repaired m = repaired(cut);
    CHECK(m.topology.boundary_loops == 0);
    CHECK(m.report.open_loops == 0);
    CHECK(volume(m.soup) > .9 * expected);
  }
}

TEST_CASE("repair: a T-junction closes without area", "[repair]") {
  TriangleSoup soup = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto t = soup.triangles[3];
  const WorldPoint &p = soup.vertices[t[0]], &q = soup.vertices[t[1]];
  soup.vertices.push_back({(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2});
  const uint32_t middle = uint32_t(soup.vertices.size() - 1);
  soup.triangles[3] = {t[0], middle, t[2]};
  shapes::add_triangle(soup, middle, t[1], t[2]);
  const Repaired m = repaired(soup);
  check_solid(m, 1);
  CHECK(m.report.capped_loops == 1);
  CHECK(m.report.cap_area_world < 1e-12);
}

TEST_CASE("repair: fins are dropped, one on another too, and a second body that stands on an edge stays", "[repair]") {
  TriangleSoup soup = ball(64);
  const auto add_fin = [&](uint32_t a, uint32_t b) {
    const WorldPoint &p = soup.vertices[a], &q = soup.vertices[b];
    soup.vertices.push_back({(p.x + q.x) * .51, (p.y + q.y) * .51, (p.z + q.z) * .51});
    const uint32_t tip = uint32_t(soup.vertices.size() - 1);
    shapes::add_triangle(soup, a, b, tip);
    return tip;
  };
  const double expected = volume(soup);
  const auto face = soup.triangles[500], other = soup.triangles[900];
  const uint32_t tip = add_fin(face[0], face[1]);
  add_fin(other[1], other[2]);
  add_fin(face[0], tip);
  soup.triangles.push_back(soup.triangles[100]);
  soup.triangles.push_back({soup.triangles[200][0], soup.triangles[200][2], soup.triangles[200][1]});
  const Repaired m = repaired(soup);
  check_solid(m, expected);
  CHECK(m.report.fins == 2);  // the third is joined to the first
  CHECK(m.report.fin_faces == 3);
  CHECK(m.report.repeated_faces == 2);

  const TriangleSoup boxes = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 1, 0}, {2, 2, 1}));
  CHECK_FALSE(repaired(boxes).report.changed_anything());
}

TEST_CASE("repair: fins stand on the undivided sides of T-junctions, and the face between them stays", "[repair]") {
  for (const bool reversed : {false, true}) {
    TriangleSoup soup = ball(64);
    const double expected = volume(soup);
    const auto face = soup.triangles[500];  // all its neighbours are split, and two of its edges have fins
    const auto split = [&](uint32_t a, uint32_t b, const std::vector<double>& places) {
      for (size_t i = 0; i < soup.triangles.size(); ++i)
        for (size_t k = 0; k < 3; ++k) {
          const auto t = soup.triangles[i];
          if (t[k] != b || t[(k + 1) % 3] != a) continue;
          uint32_t last = b;
          const WorldPoint p = soup.vertices[b], q = soup.vertices[a];
          for (const double u : places) {
            soup.vertices.push_back({p.x + u * (q.x - p.x), p.y + u * (q.y - p.y), p.z + u * (q.z - p.z)});
            const uint32_t middle = uint32_t(soup.vertices.size() - 1);
            shapes::add_triangle(soup, last, middle, t[(k + 2) % 3]);
            last = middle;
          }
          soup.triangles[i] = {last, a, t[(k + 2) % 3]};
          return;
        }
    };
    split(face[0], face[1], {.5});
    split(face[1], face[2], {.3, .6});
    split(face[2], face[0], {.4});
    if (reversed) std::reverse(soup.triangles.begin(), soup.triangles.end());
    for (const auto& [a, b] : {std::pair{face[0], face[1]}, std::pair{face[1], face[2]}}) {
      const WorldPoint &p = soup.vertices[a], &q = soup.vertices[b];
      soup.vertices.push_back({(p.x + q.x) * .51, (p.y + q.y) * .51, (p.z + q.z) * .51});
      shapes::add_triangle(soup, a, b, uint32_t(soup.vertices.size() - 1));
    }
    const Repaired m = repaired(soup);
    check_solid(m, expected);
    CHECK(m.report.fin_faces == 2);
    CHECK(m.report.capped_loops == 3);
    CHECK(m.report.cap_area_world < 1e-9);
  }
}

TEST_CASE("repair: what a hole cuts through is joined again, and its cut off end is no island", "[repair]") {
  const auto is_cut = [](WorldPoint p) { return p.x > 0 && std::abs(p.y) < .8; };
  const TriangleSoup ring = shapes::torus(3, .5, 80, 24);
  const Repaired m = repaired(without(ring, is_cut));
  CHECK(m.topology.closed);
  CHECK(m.topology.oriented);
  CHECK(m.topology.components == 1);
  CHECK(m.topology.genus == 1);
  CHECK(m.report.tubes == 1);
  CHECK(m.report.capped_loops == 2);
  CHECK(volume(m.soup) > .99 * volume(ring));
  CHECK(volume(m.soup) < volume(ring));

  TriangleSoup cigar = ball(120);
  for (WorldPoint& p : cigar.vertices) p.z *= 8;
  const Repaired tip = repaired(without(cigar, [](WorldPoint p) { return p.z > 7 && p.z < 7.5; }));
  check_solid(tip, volume(cigar));
  CHECK(tip.report.tubes == 1);
  CHECK(tip.report.islands == 0);
}

TEST_CASE("repair: ends of a pipe, and holes that face each other across a gap, are closed one by one", "[repair]") {
  TriangleSoup pipe = ball();
  for (WorldPoint& p : pipe.vertices) p.z *= 5;
  check_solid(repaired(without(pipe, [](WorldPoint p) { return std::abs(p.z) > 4.5; })), volume(pipe));
  TriangleSoup upper = ball();
  for (WorldPoint& p : upper.vertices) p.z += 2.2;
  const Repaired two = repaired(shapes::together(without(ball(), [](WorldPoint p) { return p.z > .9; }),
                                                 without(upper, [](WorldPoint p) { return p.z < 1.3; })));
  CHECK(two.report.tubes == 0);
  CHECK(two.report.capped_loops == 2);
  CHECK(two.topology.components == 2);
  const Repaired pipes = repaired(without(pipe, [](WorldPoint p) { return std::abs(p.z) < 2; }));
  CHECK(pipes.report.tubes == 0);
  CHECK(pipes.topology.components == 2);
  const Repaired capped = repaired(without(pipe, [](WorldPoint p) { return p.z > 1 && p.z < 4.3; }));
  CHECK(capped.report.tubes == 0);
  CHECK(capped.topology.components == 2);
}

TEST_CASE("repair: turned faces are turned back, whole surfaces that look inward stay", "[repair]") {
  TriangleSoup soup = ball();
  const double expected = volume(soup);
  for (size_t i = 0; i < soup.triangles.size(); ++i)
    if (random_bits(3, i) % 10 < 6) std::swap(soup.triangles[i][1], soup.triangles[i][2]);
  check_solid(repaired(soup), expected);

  TriangleSoup inward = ball();
  for (auto& t : inward.triangles) std::swap(t[1], t[2]);
  const Repaired m = repaired(without(inward, [](WorldPoint p) { return p.z > .9; }));
  CHECK(m.report.turned_faces == 0);
  CHECK(m.topology.oriented);
  CHECK(volume(m.soup) < -.9 * expected);
}

TEST_CASE("repair: scattered faces beside a surface are dropped, but not when they are the surface", "[repair]") {
  const TriangleSoup dust = shapes::random_soup(20, 4, .05, 11);
  const Repaired m = repaired(shapes::together(ball(), dust));
  check_solid(m, volume(ball()));
  CHECK(m.report.islands == 20);
  CHECK(repaired(shapes::random_soup(400, 4, .05, 11)).report.islands == 0);
}
