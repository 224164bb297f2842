// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/ros_images.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <string_view>
#include <vector>

#include "common/camera/depth_figures.hpp"
#include "common/camera/depth_formats.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/lens_models.hpp"
#include "common/camera/recording/color_encodings.hpp"
#include "common/camera/recording/rvl.hpp"
#include "common/io/printable.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::camera {
namespace {

constexpr const char* kDepthTransport = "compressedDepth";

/// depth = a / (pixel - b), 0 = no measurement.
cv::Mat from_inverse(const cv::Mat& pixels, float a, float b) {
  cv::Mat depth_m(pixels.size(), CV_32FC1);
  for (int row = 0; row < pixels.rows; ++row) {
    for (int column = 0; column < pixels.cols; ++column) {
      const std::uint16_t pixel = pixels.at<std::uint16_t>(row, column);
      depth_m.at<float>(row, column) = pixel == 0 ? 0.0F : a / (static_cast<float>(pixel) - b);
    }
  }
  return depth_m;
}

constexpr const char* kDepthCodecs = "compressedDepth (PNG, RVL)";

/// The 16-bit image behind the header of compressedDepth. A format that names no codec is PNG, as in ROS 1.
ImageRead decode_depth_codec(const std::string& format, ros::Bytes bytes, const std::string& name) {
  const std::string codec = format.substr(format.find(kDepthTransport) + std::string_view(kDepthTransport).size());
  if (codec.find("rvl") != std::string::npos || codec.find("RVL") != std::string::npos) return {decode_rvl(bytes), {}};
  if (codec.find_first_not_of(' ') == std::string::npos || codec.find("png") != std::string::npos) {
    return decode_depth(bytes, name);
  }
  throw SourceError(name + " is encoded as '" + io::abridged(format) +
                    "', which cannot be read; readable: " + kDepthCodecs);
}

/// From ROS's compressed_depth_image_transport: 12 bytes (a code of the format, quantisation parameters a and b), then
/// a 16-bit image; of floats it holds a / depth + b (inverse depth). Throws SourceError for an unknown codec.
ImageRead decode_compressed_depth(const msg::CompressedImage& image, const std::string& name, double float_unit_m) {
  ros::ByteCursor cursor(image.data);
  cursor.read<std::int32_t>();  // the driver's own code of the format; the text says more
  const auto a = cursor.read<float>(), b = cursor.read<float>();
  ImageRead result = decode_depth_codec(image.format, cursor.take(cursor.remaining()), name);
  if (result.problem) return result;
  if (image.format.starts_with("32FC1")) result.image = quantize_depth(from_inverse(result.image, a, b), float_unit_m);
  drop_saturated(result.image);
  return result;
}

const std::map<std::string, int> kDepthTypes = {
    {"16UC1", CV_16UC1}, {"mono16", CV_16UC1}, {"z16", CV_16UC1}, {"32FC1", CV_32FC1}};

constexpr const char *kCompressed = "sensor_msgs/CompressedImage", *kJpeg = "mjpg";  // of Orbbec's SDK

SourceError unsupported(const RecordedMessage& message, const std::string& encoding, const std::string& known) {
  return SourceError(message.topic + " is encoded as '" + io::abridged(encoding) +
                     "', which cannot be read; readable: " + known);
}

ImageRead refuse(SkipReason reason, const RecordedMessage& message, const std::string& cause) {
  return {{}, SkippedInput{reason, name_of(message) + ": " + cause}};
}

std::size_t row_bytes(const msg::Image& image, int type) {
  return std::size_t{image.width} * static_cast<std::size_t>(CV_ELEM_SIZE(type));
}

bool fits_its_step(const msg::Image& image, int type) {
  return image.step >= row_bytes(image, type) && image.step > 0 && image.data.size() / image.step >= image.height;
}

/// Several simulators and drivers leave the length of a row at 0.
bool is_dense(const msg::Image& image, int type) {
  return image.data.size() == row_bytes(image, type) * image.height;
}

/// The pixels where they lie in the message. Throws ros::WireError when the message holds fewer than it claims.
cv::Mat view_of(msg::Image& image, int type) {
  const bool by_step = fits_its_step(image, type);
  if (image.width == 0 || image.height == 0 || (!by_step && !is_dense(image, type))) {
    throw ros::WireError(std::to_string(image.width) + " x " + std::to_string(image.height) + " px of " +
                         image.encoding + " in rows of " + std::to_string(image.step) + " bytes do not fit into " +
                         std::to_string(image.data.size()) + " bytes");
  }
  const std::size_t step = by_step ? image.step : row_bytes(image, type);
  return {static_cast<int>(image.height), static_cast<int>(image.width), type, image.data.data(), step};
}

std::string remark_on(const RecordedMessage& message, const msg::Image& image, int type) {
  if (fits_its_step(image, type)) return {};
  return message.topic + ": the field 'step' is " + std::to_string(image.step) + ", not " +
         std::to_string(row_bytes(image, type)) + ": rows without gaps are read";
}

bool is_grey16(const RecordedMessage& message, const msg::Image& image) {
  return image.encoding == "mono16" || (image.encoding == "16UC1" && !named_as_depth(message.topic));
}

ImageRead raw_color(const RecordedMessage& message, msg::Image image, int grey_bits) {
  if (image.encoding == kJpeg) return decode_color(image.data, name_of(message));
  const ColorEncoding* const encoding = find_color_encoding(image.encoding);
  if (encoding == nullptr || (encoding->name == "16UC1" && !is_grey16(message, image)))
    throw unsupported(message, image.encoding, known_color_encodings() + ", JPEG, PNG");
  if (image.is_bigendian != 0 && CV_MAT_DEPTH(encoding->type) != CV_8U) {
    throw unsupported(message, image.encoding + ", big endian", "little endian");
  }
  image.height = encoding->rows(image.height);
  const cv::Mat pixels = view_of(image, encoding->type);
  if (const std::string defect = size_defect(*encoding, pixels.size()); !defect.empty()) {
    throw ros::WireError("an image of " + size_text(pixels.size()) + " px in " + image.encoding + ": " + defect);
  }
  return {to_bgr(*encoding, pixels, grey_bits), {}, remark_on(message, image, encoding->type)};
}

int depth_type(const RecordedMessage& message, const msg::Image& image) {
  const auto type = kDepthTypes.find(image.encoding);
  if (type == kDepthTypes.end()) {
    throw unsupported(message, image.encoding,
                      std::string("16UC1 (mm), mono16 (mm), 32FC1 (m), 16-bit PNG, ") + kDepthCodecs);
  }
  if (image.is_bigendian != 0) throw unsupported(message, image.encoding + ", big endian", "little endian");
  return type->second;
}

ImageRead raw_depth(const RecordedMessage& message, msg::Image image, double float_unit_m) {
  const int type = depth_type(message, image);
  const cv::Mat pixels = view_of(image, type);
  ImageRead result{
      type == CV_32FC1 ? quantize_depth(pixels, float_unit_m) : pixels.clone(), {}, remark_on(message, image, type)};
  drop_saturated(result.image);
  return result;
}

/// From ROS's zstd_image_transport, which writes gzip: the fields of the raw image, then its pixels packed.
msg::Image unpacked(const msg::CompressedImage& packed) {
  ros::ByteCursor cursor(packed.data);
  msg::Image image;
  image.header = packed.header;
  image.height = cursor.read<std::uint32_t>();
  image.width = cursor.read<std::uint32_t>();
  image.is_bigendian = cursor.read<std::uint8_t>();
  image.step = cursor.read<std::uint32_t>();
  const auto length = cursor.read<std::uint32_t>();
  image.encoding = ros::to_text(cursor.take(length));
  const std::uint64_t size = std::uint64_t{image.step} * image.height;
  if (size > kMaxRecordedPixels * sizeof(float))
    throw ros::WireError("zstd: an image of " + std::to_string(size) + " bytes");
  const ros::Bytes pixels = cursor.take(cursor.remaining());
  image.data = inflate_at_most(pixels, size);
  if (image.data.size() != size) throw ros::WireError("zstd: the pixels are damaged");
  return image;
}

/// nv12, nv21 and nv24 have more rows than they say, and JPEG has none, which other images must not.
msg::Image plain_image(const RecordedMessage& message) {
  try {
    return ros::decode<msg::Image>(message.wire, message.bytes);
  } catch (const ros::WireError&) {
    msg::Image image;
    message.wire == ros::Wire::kCdr ? ros::WireReader<ros::Wire::kCdr>(message.bytes)(image)
                                    : ros::WireReader<ros::Wire::kRos1>(message.bytes)(image);
    if (image.encoding == kJpeg) return image;
    const auto* encoding = image.encoding.starts_with("nv") ? find_color_encoding(image.encoding) : nullptr;
    if (encoding == nullptr || image.data.size() != std::uint64_t{image.step} * encoding->rows(image.height)) throw;
    return image;
  }
}

/// The image of such a topic, or of a raw one; empty for JPEG, PNG and compressedDepth.
std::optional<msg::Image> raw_image(const RecordedMessage& message) {
  if (message.type != kCompressed) return plain_image(message);
  if (!message.topic.ends_with("/zstd")) return std::nullopt;
  return unpacked(ros::decode<msg::CompressedImage>(message.wire, message.bytes));
}

ImageRead compressed_depth(const RecordedMessage& message, double float_unit_m) {
  const auto image = ros::decode<msg::CompressedImage>(message.wire, message.bytes);
  if (image.format.find(kDepthTransport) == std::string::npos) return decode_depth(image.data, name_of(message));
  return decode_compressed_depth(image, name_of(message), float_unit_m);
}

constexpr const char* kFix = "; give a calibration of your own: ?calibration=FILE";

constexpr const char* kFisheyeModel = "equidistant";  // ROS's name

/// Throws SourceError for a lens that no model here fits; one of zeros needs none, unless it is a fisheye lens.
geometry::CameraModel::Parameters with_distortion(const msg::CameraInfo& info, const std::string& origin,
                                                  geometry::CameraModel::Parameters parameters) {
  const auto is_zero = [](double value) { return value == 0; };
  const LensModel model = lens_model(info.distortion_model);
  if (model == LensModel::kNone || (model != LensModel::kFisheye && std::ranges::all_of(info.d, is_zero)))
    return parameters;
  const std::size_t most = model == LensModel::kFisheye ? 4 : parameters.distortion.size();
  const std::size_t known = std::min(most, info.d.size());
  if (model == LensModel::kUnknown || !std::ranges::all_of(std::span(info.d).subspan(known), is_zero)) {
    throw SourceError(fmt::format("{}: distortion model '{}' with {} values: {}{}", origin,
                                  io::abridged(info.distortion_model), info.d.size(),
                                  no_such_lens(info.distortion_model), kFix));
  }
  std::copy_n(info.d.begin(), known, parameters.distortion.begin());
  return with_lens(parameters, model, origin);
}

/// ROS's name of the distortion and the number of its coefficients.
std::pair<const char*, std::ptrdiff_t> ros_distortion(const geometry::CameraModel::Parameters& p) {
  if (p.lens == geometry::Lens::kFisheye) return {kFisheyeModel, 4};
  const bool rational = p.distortion[5] != 0 || p.distortion[6] != 0 || p.distortion[7] != 0;
  return rational ? std::pair("rational_polynomial", std::ptrdiff_t{8}) : std::pair("plumb_bob", std::ptrdiff_t{5});
}

}  // namespace

std::string name_of(const RecordedMessage& message) {
  return message.topic + " recorded at " + std::to_string(message.recorded_ns) + " ns";
}

int grey_bits(const RecordedMessage& message) {
  try {
    std::optional<msg::Image> image = raw_image(message);
    if (!image || !is_grey16(message, *image)) return 16;
    const cv::Mat pixels = view_of(*image, CV_16UC1);
    std::vector<std::uint16_t> values(pixels.begin<std::uint16_t>(), pixels.end<std::uint16_t>());
    const auto bright = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
    std::ranges::nth_element(values, bright);
    return std::max(8, static_cast<int>(std::bit_width(*bright)));
  } catch (const ros::WireError&) {
    return 16;  // decode_color() reports it
  }
}

ImageRead decode_color(const RecordedMessage& message, int grey_bits) {
  try {
    if (auto raw = raw_image(message)) return raw_color(message, std::move(*raw), grey_bits);
    const auto image = ros::decode<msg::CompressedImage>(message.wire, message.bytes);
    return decode_color(image.data, name_of(message));
  } catch (const ros::WireError& error) {
    return refuse(SkipReason::kColorUnreadable, message, error.what());
  }
}

ImageRead decode_depth(const RecordedMessage& message, double float_unit_m) {
  try {
    if (auto raw = raw_image(message)) return raw_depth(message, std::move(*raw), float_unit_m);
    return compressed_depth(message, float_unit_m);
  } catch (const ros::WireError& error) {
    return refuse(SkipReason::kDepthUnreadable, message, error.what());
  }
}

double depth_unit_m(const RecordedMessage& message, double float_unit_m) {
  const std::optional<msg::Image> raw = raw_image(message);
  const bool floats = raw ? depth_type(message, *raw) == CV_32FC1
                          : ros::decode<msg::CompressedImage>(message.wire, message.bytes).format.starts_with("32FC1");
  return floats ? float_unit_m : kMillimetre;
}

bool has_float_depth(const RecordedMessage& message) {
  constexpr double kOfFloats = -1;
  return depth_unit_m(message, kOfFloats) == kOfFloats;
}

double float_step(const RecordedMessage& message, double float_unit_m) {
  constexpr double kMillimetresPerMetre = 1000;
  if (!has_float_depth(message)) return float_unit_m;
  cv::Mat whole_values;
  decode_depth(message, 1.0).image.convertTo(whole_values, CV_32F);
  return floats_are_millimetres(whole_values) ? kMillimetresPerMetre * float_unit_m : float_unit_m;
}

msg::CameraInfo to_camera_info(const geometry::CameraModel& camera, std::int64_t stamp_ns,
                               const std::string& frame_id) {
  const auto& p = camera.parameters();
  msg::CameraInfo info;
  info.header = {msg::to_time(stamp_ns), frame_id};
  info.width = static_cast<std::uint32_t>(p.width);
  info.height = static_cast<std::uint32_t>(p.height);
  const auto [model, coefficients] = ros_distortion(p);
  info.distortion_model = model;
  info.d.assign(p.distortion.begin(), p.distortion.begin() + coefficients);
  info.k = {p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {p.fx, 0, p.cx, 0, 0, p.fy, p.cy, 0, 0, 0, 1, 0};
  return info;
}

/// CameraInfo is that of the whole sensor: of it the image shows a region, then with several pixels as one (REP 104).
/// Some drivers give that of the image all the same.
void crop_and_bin(const msg::CameraInfo& info, cv::Size image_px, geometry::CameraModel::Parameters& p) {
  if (image_px == cv::Size(p.width, p.height)) return;
  const auto& roi = info.roi;
  if (roi.width > 0 && roi.height > 0 && roi.width <= info.width && roi.height <= info.height) {
    p.cx -= roi.x_offset;
    p.cy -= roi.y_offset;
    p.width = static_cast<int>(roi.width);
    p.height = static_cast<int>(roi.height);
  }
  const auto bin = [](std::uint32_t pixels, double& f, double& c, int& side) {
    if (pixels < 2 || pixels > 16) return;
    f /= pixels;
    c /= pixels;
    side /= static_cast<int>(pixels);
  };
  bin(info.binning_x, p.fx, p.cx, p.width);
  bin(info.binning_y, p.fy, p.cy, p.height);
}

geometry::CameraModel to_camera_model(const msg::CameraInfo& info, const std::string& color_topic,
                                      const std::string& origin, cv::Size image_px) {
  geometry::CameraModel::Parameters p;
  p.width = static_cast<int>(info.width);
  p.height = static_cast<int>(info.height);
  if (color_topic.find("image_rect") != std::string::npos && info.p[0] > 0) {
    p.fx = info.p[0];
    p.fy = info.p[5];
    p.cx = info.p[2];
    p.cy = info.p[6];
  } else {
    p.fx = info.k[0];
    p.fy = info.k[4];
    p.cx = info.k[2];
    p.cy = info.k[5];
    p = with_distortion(info, origin, p);
  }
  crop_and_bin(info, image_px, p);
  const double sum = std::accumulate(p.distortion.begin(), p.distortion.end(), p.fx + p.fy + p.cx + p.cy);
  if (!(p.fx > 0) || !(p.fy > 0) || !std::isfinite(sum)) {
    throw SourceError(origin + ": fx is " + std::to_string(p.fx) + ", fy " + std::to_string(p.fy) +
                      ": the camera was not calibrated" + kFix);
  }
  return geometry::CameraModel(p);
}

}  // namespace rtd::camera
