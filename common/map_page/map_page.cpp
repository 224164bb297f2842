// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/map_page/map_page.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/run_record/run_record.hpp"

namespace rtd::map_page {
namespace {

using nlohmann::json;
using run_record::packed;

static_assert(std::endian::native == std::endian::little, "pages read little-endian numbers");

/// In base64.
std::size_t bytes_of(const Layer& layer, std::size_t points) {
  return points * (layer.colors.empty() ? 6 : 9) * 4 / 3;
}

/// How many of a layer's points there is room for.
std::size_t share(const Layer& layer, double scale) {
  return layer.line ? layer.points_m.size()
                    : static_cast<std::size_t>(scale * static_cast<double>(layer.points_m.size()));
}

/// The largest share of all points that fits; 1 when all do.
double fitting_scale(const Page& page, std::size_t room) {
  std::size_t lines = 0, points = 0;
  for (const Layer& layer : page.layers) (layer.line ? lines : points) += bytes_of(layer, layer.points_m.size());
  if (points == 0 || lines + points <= room) return 1;
  return static_cast<double>(room - std::min(room, lines)) / static_cast<double>(points);
}

json to_json(const Layer& layer, std::size_t wanted) {
  std::vector<std::size_t> kept;
  Eigen::AlignedBox3f box;
  const std::size_t all = layer.points_m.size();
  for (std::size_t turn = 0; turn < wanted; ++turn) {
    const std::size_t place = turn * all / wanted;
    if (!layer.points_m[place].allFinite()) continue;
    kept.push_back(place);
    box.extend(layer.points_m[place]);
  }
  const Eigen::Vector3f origin = box.isEmpty() ? Eigen::Vector3f::Zero() : Eigen::Vector3f(box.center());
  const float scale =
      std::max(1e-4F, box.isEmpty() ? 0.0F : box.sizes().maxCoeff() / 2) / std::numeric_limits<std::int16_t>::max();
  std::vector<std::int16_t> steps;
  std::vector<std::uint8_t> colors;
  for (const std::size_t place : kept) {
    const Eigen::Vector3f point = (layer.points_m[place] - origin) / scale;
    for (int axis = 0; axis < 3; ++axis) steps.push_back(static_cast<std::int16_t>(std::lround(point[axis])));
    if (!layer.colors.empty()) colors.insert(colors.end(), layer.colors[place].begin(), layer.colors[place].end());
  }
  json result = {{"name", layer.name},
                 {"shown", layer.shown},
                 {"line", layer.line},
                 {"origin", {origin.x(), origin.y(), origin.z()}},
                 {"scale", scale},
                 {"points", packed(steps)},
                 {"color", fmt::format("#{:02x}{:02x}{:02x}", layer.color[0], layer.color[1], layer.color[2])}};
  if (!layer.colors.empty()) result["colors"] = packed(colors);
  return result;
}

/// The content of a script element must not end it.
std::string harmless(std::string text) {
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return text;
}

}  // namespace

std::string html(const Page& page, std::size_t most_bytes) {
  constexpr std::size_t kTexts = 20'000;  // numbers and names around the data
  const std::string whole(html_template());
  const std::size_t used = whole.size() + kTexts;
  const double scale = fitting_scale(page, most_bytes - std::min(most_bytes, used));
  json layers = json::array();
  for (const Layer& layer : page.layers) layers.push_back(to_json(layer, share(layer, scale)));
  const json scene = {
      {"title", page.title}, {"z_up", page.z_up}, {"facts", page.facts}, {"layers", layers}, {"links", page.links}};
  return filled(whole, "@SCENE@", scene.dump(-1, ' ', false, json::error_handler_t::replace));
}

std::string filled(std::string_view page, std::string_view mark, std::string data) {
  const std::size_t at = page.find(mark);
  std::string whole(page.substr(0, at));
  return whole.append(harmless(std::move(data))).append(page.substr(at + mark.size()));
}

}  // namespace rtd::map_page
