#include "player/render/slice_columns.h"

#include <array>
#include <limits>

namespace tet4d::render {
namespace {

// Where a key's slice vertex lies: lambda of the way from vertex a to b.
struct Place {
  std::size_t a, b;
  float lambda;
};

Place placeOf(const dyntri::PageView& page, std::uint32_t key, float t) {
  const std::size_t edges = page.edges.size();
  if (key >= edges) return {key - edges, key - edges, 0};
  const auto [a, b] = page.edges[key];
  return {a, b, (t - page.vertices[a].t) / (page.vertices[b].t - page.vertices[a].t)};
}

float between(float a, float b, float lambda) {
  if (lambda == 0) return a;
  return lambda == 1 ? b : a + lambda * (b - a);
}

}  // namespace

std::vector<float> sliceValues(const dyntri::PageView& page, std::span<const std::uint32_t> keys, float t,
                               const scene::DrawColumn& column, std::span<const float> rows) {
  const std::size_t n = column.components;
  if (rows.size() < n * page.vertices.size())
    return std::vector<float>(keys.size(), std::numeric_limits<float>::quiet_NaN());
  std::vector<float> values(keys.size());
  std::array<float, 4> row{};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Place place = placeOf(page, keys[i], t);
    for (std::size_t c = 0; c < n; ++c) row[c] = between(rows[n * place.a + c], rows[n * place.b + c], place.lambda);
    values[i] = scene::columnValue(column, std::span(row).first(n));
  }
  return values;
}

std::vector<Vec3f> sliceVectors(const dyntri::PageView& page, std::span<const std::uint32_t> keys, float t,
                                std::span<const float> rows) {
  std::vector<Vec3f> vectors(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Place place = placeOf(page, keys[i], t);
    const auto at = [&](std::size_t c) { return between(rows[3 * place.a + c], rows[3 * place.b + c], place.lambda); };
    vectors[i] = {at(0), at(1), at(2)};
  }
  return vectors;
}

}  // namespace tet4d::render
