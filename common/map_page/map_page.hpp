// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rtd::map_page {

using Color = std::array<std::uint8_t, 3>;  ///< red, green, blue

/// Points or a line of the map.
struct Layer {
  std::string name;
  bool shown = true;
  bool line = false;                      ///< connected in their order
  std::vector<Eigen::Vector3f> points_m;  ///< in the map's frame; those that are not finite are left out
  std::vector<Color> colors;              ///< one for each point; empty: all as `color`
  Color color{};
};

/// What a page shows.
struct Page {
  std::string title;
  bool z_up = false;                                       ///< else y is down, as in the frame of a first camera
  std::vector<std::pair<std::string, std::string>> facts;  ///< names and values
  std::vector<Layer> layers;
  std::vector<std::pair<std::string, std::string>> links = {};  ///< names and places of other pages of the run
};

/// A map to look at in any browser without a network: one HTML file with everything inside. Layers of points are
/// thinned out evenly until the page has at most `most_bytes`.
std::string html(const Page& page, std::size_t most_bytes = 5'000'000);

/// The page without its content: `@SCENE@` marks where the scene belongs, in JSON with "<" written as an escape.
std::string_view html_template();

/// `page` with `data`, in JSON, in place of `mark` in a script element, which no text in the data can end.
std::string filled(std::string_view page, std::string_view mark, std::string data);

}  // namespace rtd::map_page
