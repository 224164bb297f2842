// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::plot {

/// A position on the drawing, px, y down.
struct Point {
  double x = 0, y = 0;
};

/// An area of the drawing, px.
struct Area {
  double x = 0, y = 0, width = 0, height = 0;
};

struct Stroke {
  std::string colour;
  double width = 1;
  std::string dashes = "";  ///< e.g. "4 3"
  double opacity = 1;
};

enum class Anchor { kStart, kMiddle, kEnd };

struct TextStyle {
  std::string colour = "#64727f";
  double size = 12;
  Anchor anchor = Anchor::kStart;
  bool bold = false;
  double rotation_deg = 0;
};

/// Text made safe for HTML and SVG: & < > " ' escaped, control characters replaced.
std::string escape_markup(const std::string& text);

/// Writes one SVG drawing. Shapes with coordinates that are not finite are left out, so that no bad number can spoil a
/// page.
class Svg {
 public:
  /// label: what the picture shows, for screen readers.
  Svg(double width, double height, const std::string& label);

  void line(Point from, Point to, const Stroke& stroke);
  void polyline(const std::vector<Point>& points, const Stroke& stroke);
  void polygon(const std::vector<Point>& points, const std::string& fill, double opacity = 1);
  void rect(const Area& area, const std::string& fill, double opacity = 1, double radius = 0);
  void circle(Point centre, double radius, const std::string& fill, const Stroke& outline = {"none", 0});
  /// Many round dots of one colour in one element.
  void dots(const std::vector<Point>& centres, double diameter, const std::string& colour, double opacity = 1);
  void text(Point at, const std::string& content, const TextStyle& style = {});
  /// Embeds a JPEG.
  void jpeg(const Area& area, const std::vector<unsigned char>& bytes);

  double width() const { return width_; }
  double height() const { return height_; }
  /// The drawing, scalable to the width of its container.
  std::string str() const;
  /// The drawing as a file of its own.
  std::string document() const;

 private:
  double width_, height_;
  std::string label_, body_;
};

/// RFC 4648 base64.
std::string base64(const std::vector<unsigned char>& bytes);

/// Width and height from the header of a JPEG, {0, 0} when it is none.
struct PictureSize {
  int width = 0, height = 0;
};
PictureSize jpeg_size(const std::vector<unsigned char>& bytes);

}  // namespace rtd::plot
