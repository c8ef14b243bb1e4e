// Differences and products of points.
#pragma once

#include "isoshell/surface_source.h"

namespace isoshell::mending {

inline WorldPoint minus(const WorldPoint& p, const WorldPoint& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
inline WorldPoint plus(const WorldPoint& p, const WorldPoint& q) { return {p.x + q.x, p.y + q.y, p.z + q.z}; }
inline WorldPoint scaled(double s, const WorldPoint& p) { return {s * p.x, s * p.y, s * p.z}; }
inline double dot(const WorldPoint& p, const WorldPoint& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
inline WorldPoint cross(const WorldPoint& p, const WorldPoint& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

}  // namespace isoshell::mending
