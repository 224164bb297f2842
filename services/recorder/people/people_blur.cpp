// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/people/people_blur.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <utility>

#include "common/bus/robot.hpp"
#include "common/bus/topics.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/camera/recording/ros_images.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/stamps.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::recorder {
namespace {

namespace topics = bus::topics;

constexpr std::string_view kDetections = "vision_msgs/Detection2DArray", kImage = "sensor_msgs/Image",
                           kCompressed = "sensor_msgs/CompressedImage", kCloud = "sensor_msgs/PointCloud2";
constexpr std::size_t kCdrHeaderBytes = 4;

/// Calls visit.operator()<Frame>() for a type of our frames; false for other types.
bool for_frame_type(const std::string& type, auto&& visit) {
  bool found = false;
  msg::for_each_frame_type([&]<class Frame>() {
    if (type != msg::type_name(msg::TypeOf<Frame>())) return;
    found = true;
    visit.template operator()<Frame>();
  });
  return found;
}

/// The frame in bytes that it lies in as in memory. Throws ros::WireError when they are no frame.
template <class Frame>
Frame* frame_in(std::vector<std::uint8_t>& cdr) {
  if (cdr.size() < kCdrHeaderBytes + sizeof(Frame)) throw ros::WireError("a frame is cut");
  auto* const frame = reinterpret_cast<Frame*>(cdr.data() + kCdrHeaderBytes);
  if (!msg::fits(frame->width, frame->height, Frame::kPixels)) throw ros::WireError("a frame has no size");
  return frame;
}

bool is_one_of(const std::string& name, auto... topics) {
  return ((name == topics.name) || ...);
}

/// Other types that may hold pictures, by their names: packets of video, RGBDImage, ...
bool may_hold_pictures(const std::string& type) {
  return std::ranges::any_of(std::array{"Image", "Video", "Packet", "RGBD"},
                             [&](const char* word) { return type.find(word) != std::string::npos; });
}

bool is_depth(const std::string& topic, const msg::Image& image) {
  const bool in_depths = image.encoding == "16UC1" || image.encoding == "32FC1" || image.encoding == "z16";
  return camera::named_as_depth(topic) || (in_depths && !camera::named_as_infrared(topic));
}

bool is_depth(const std::string& topic, const msg::CompressedImage& image) {
  return camera::named_as_depth(topic) || image.format.find("compressedDepth") != std::string::npos;
}

void put(const cv::Mat& pixels, msg::Image& message) {
  message.encoding = "bgr8";
  message.is_bigendian = 0;
  message.width = static_cast<std::uint32_t>(pixels.cols);
  message.height = static_cast<std::uint32_t>(pixels.rows);
  message.step = 3 * message.width;
  message.data.assign(pixels.datastart, pixels.dataend);
}

void put(const cv::Mat& pixels, msg::CompressedImage& message) {
  const bool png = vision::format_of(message.data) == vision::ImageFormat::kPng;
  message.format = png ? "bgr8; png compressed bgr8" : "bgr8; jpeg compressed bgr8";
  message.data = png ? vision::encode_png(pixels) : vision::encode_jpeg(pixels);
}

/// Squares of their mean colour where the mask says so. Squares of an image lie where they lie in every image.
void pixelate_under(const People& people, cv::Mat& pixels) {
  const cv::Size blocks((pixels.cols + people.block_px - 1) / people.block_px,
                        (pixels.rows + people.block_px - 1) / people.block_px);
  cv::Mat few, squares;
  cv::resize(pixels, few, blocks, 0, 0, cv::INTER_AREA);
  cv::resize(few, squares, pixels.size(), 0, 0, cv::INTER_NEAREST);
  squares.copyTo(pixels, people.mask);
}

/// All of an image: a person who fills it has six squares along the longer side.
People everywhere(cv::Size image_px) {
  constexpr int kSquares = 6;
  return {cv::Mat(image_px, CV_8UC1, cv::Scalar(255)), std::max(image_px.width, image_px.height) / kSquares + 1};
}

}  // namespace

struct PeopleBlur::Image {
  std::int64_t stamp_ns = 0;
  const std::string* frame_id = nullptr;  ///< null: an image that the detector gets
  cv::Mat pixels;                         ///< BGR, changed in place
};

const PeopleRegions* PeopleBlur::regions_of(const BlurTopic& topic) const {
  const auto regions = regions_.find(bus::split_robot(topic.name).robot);
  return regions == regions_.end() ? nullptr : &regions->second;
}

void PeopleBlur::learn(const BlurTopic& topic, ros::Bytes cdr) {
  const auto [robot, name] = bus::split_robot(topic.name);
  const auto regions = [&]() -> PeopleRegions& { return regions_.try_emplace(robot, most_).first->second; };
  try {
    if (topic.type == kDetections && name == topics::kDetections.name)
      regions().add(ros::decode<msg::Detection2DArray>(ros::Wire::kCdr, cdr));
    if (topic.type == kImage && name == topics::kPersonMasks.name)
      regions().add_masks(ros::decode<msg::Image>(ros::Wire::kCdr, cdr));
    for_frame_type(topic.type, [&]<class Frame>() {
      ros::ByteCursor cursor(cdr);
      cursor.take(kCdrHeaderBytes + offsetof(Frame, width));
      const auto width = cursor.read<std::uint32_t>(), height = cursor.read<std::uint32_t>();
      if (msg::fits(width, height, Frame::kPixels)) regions().saw({static_cast<int>(width), static_cast<int>(height)});
    });
  } catch (const ros::WireError&) {
    return;  // what cannot be read says nothing: images are then hidden
  }
}

bool PeopleBlur::knows_people() const {
  return std::ranges::any_of(regions_, [](const auto& robot) { return !robot.second.empty(); });
}

bool PeopleBlur::settled(const BlurTopic& topic, ros::Bytes cdr) const {
  const PeopleRegions* const regions = regions_of(topic);
  const auto known = [&](std::int64_t stamp_ns) { return regions != nullptr && regions->settled(stamp_ns); };
  try {
    bool result = true;
    const bool frame = for_frame_type(topic.type, [&]<class Frame>() {
      ros::ByteCursor cursor(cdr);
      cursor.take(kCdrHeaderBytes + offsetof(Frame, stamp_ns));
      result = known(cursor.read<std::int64_t>());
    });
    if (frame || (topic.type != kImage && topic.type != kCompressed)) return result;
    return known(msg::to_ns(ros::decode<msg::Header>(ros::Wire::kCdr, cdr).stamp));
  } catch (const ros::WireError&) {
    return true;
  }
}

PeopleBlur::Result PeopleBlur::apply(const BlurTopic& topic, ros::Bytes cdr) {
  Result result{Fate::kWithheld};
  try {
    result = fate_of(topic, cdr);
  } catch (const ros::WireError&) {
    result = {Fate::kWithheld};
  } catch (const camera::SourceError&) {
    result = {Fate::kWithheld};  // an encoding that cannot be read
  }
  ++counts_[static_cast<std::size_t>(result.fate)];
  return result;
}

std::map<std::string, std::uint64_t> PeopleBlur::counts() const {
  const auto of = [this](Fate fate) { return counts_[static_cast<std::size_t>(fate)]; };
  return {{"blurred", of(Fate::kBlurred)}, {"hidden", of(Fate::kHidden)}, {"withheld", of(Fate::kWithheld)}};
}

PeopleBlur::Result PeopleBlur::fate_of(const BlurTopic& topic, ros::Bytes cdr) const {
  const std::string name = bus::split_robot(topic.name).topic;
  if (is_one_of(name, topics::kPersonMasks, topics::kDynamicMask, topics::kDepthJpeg)) return {};
  if (topic.type == kImage) return image<msg::Image>(topic, cdr);
  if (topic.type == kCompressed) return image<msg::CompressedImage>(topic, cdr);
  if (topic.type == kCloud) {
    if (is_one_of(name, topics::kDensePoints, topics::kMovingPoints, topics::kMapPoints)) return {};
    const auto cloud = ros::decode<msg::PointCloud2>(ros::Wire::kCdr, cdr);
    const bool colored =
        std::ranges::any_of(cloud.fields, [](const msg::PointField& field) { return field.name.starts_with("rgb"); });
    return {colored ? Fate::kWithheld : Fate::kKept};
  }
  Result result;
  const bool is_frame = for_frame_type(topic.type, [&]<class Frame>() {
    result.cdr.assign(cdr.begin(), cdr.end());
    Frame* const frame = frame_in<Frame>(result.cdr);
    const cv::Mat pixels(static_cast<int>(frame->height), static_cast<int>(frame->width), CV_8UC3,
                         frame->color_bgr.data());
    result.fate = pixelate(topic, {frame->stamp_ns, nullptr, pixels});
  });
  if (!is_frame && may_hold_pictures(topic.type)) result.fate = Fate::kWithheld;
  return result;
}

template <class Message>
PeopleBlur::Result PeopleBlur::image(const BlurTopic& topic, ros::Bytes cdr) const {
  const camera::RecordedMessage recorded{topic.name, 0, ros::Wire::kCdr, {cdr.begin(), cdr.end()}, topic.type};
  Message message;
  ros::WireReader<ros::Wire::kCdr>{cdr}(message);
  if (is_depth(topic.name, message)) return {};
  const bool own = bus::split_robot(topic.name).topic == topics::kColorJpeg.name;
  camera::ImageRead read = camera::decode_color(recorded, camera::grey_bits(recorded));
  if (read.problem || topic.name.ends_with("/zstd")) return {Fate::kWithheld};
  const Fate fate =
      pixelate(topic, {msg::to_ns(message.header.stamp), own ? nullptr : &message.header.frame_id, read.image});
  if (fate == Fate::kKept) return {};
  put(read.image, message);
  return {fate, ros::encode<ros::Wire::kCdr>(message)};
}

Fate PeopleBlur::pixelate(const BlurTopic& topic, const Image& image) const {
  cv::Mat pixels = image.pixels;
  const PeopleRegions* const regions = regions_of(topic);
  const bool seen =
      regions != nullptr && (image.frame_id == nullptr || regions->concern(*image.frame_id, pixels.size()));
  const std::optional<People> people = seen ? regions->at(image.stamp_ns, pixels.size()) : std::nullopt;
  if (people && people->mask.empty()) return Fate::kKept;
  pixelate_under(people ? *people : everywhere(pixels.size()), pixels);
  return people ? Fate::kBlurred : Fate::kHidden;
}

}  // namespace rtd::recorder
