// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::plot {

/// Colours of all our pages, chosen for a white background and to stay apart for colour-blind eyes.
namespace palette {
inline constexpr const char* kInk = "#1c2733";
inline constexpr const char* kMuted = "#64727f";
inline constexpr const char* kGrid = "#e7ebef";
inline constexpr const char* kFrame = "#b9c2cb";
inline constexpr const char* kBlue = "#2367a8";
inline constexpr const char* kGreen = "#2d9c5f";
inline constexpr const char* kRed = "#d03a3f";
inline constexpr const char* kAmber = "#dd8a1d";
inline constexpr const char* kPurple = "#7a4fa3";
inline constexpr const char* kTruth = "#9aa5b1";
}  // namespace palette

/// Colour of an error on a scale from 0 (blue, good) over green and amber to 1 (red); clamped. "#rrggbb".
std::string error_colour(double fraction);

}  // namespace rtd::plot
