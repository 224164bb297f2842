// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/frame_topics.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/camera/frame_source.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/msg/camera_frame.hpp"
#include "services/camera/core/auxiliary_topics.hpp"

namespace rtd::camera {

/// Encodes images as JPEG and publishes them in its own thread that yields to everything else of the pipeline, so
/// that a reader of the JPEG topic delays no pose. offer(): one thread.
class JpegPublisher {
 public:
  /// Makes the image (8-bit BGR) in the publisher's thread.
  using Draw = std::function<cv::Mat()>;
  /// `overflow`: what happens to an image while two others wait to be encoded. `on_matched`: as FramePublisher's.
  JpegPublisher(bus::Bus& bus, int quality, concurrency::Overflow overflow,
                const std::function<void()>& on_matched = {},
                const bus::Topic<msg::CompressedImage>& topic = bus::topics::kColorJpeg);
  /// Publishes what still waits.
  ~JpegPublisher();
  JpegPublisher(const JpegPublisher&) = delete;
  JpegPublisher& operator=(const JpegPublisher&) = delete;

  /// Takes an image if the topic has readers; what `draw` holds is not to be changed any more.
  void offer(Draw draw, std::int64_t stamp_ns, const std::string& frame_id = msg::kCameraFrame);
  /// An image that is drawn already, shared.
  void offer(const cv::Mat& color_bgr, std::int64_t stamp_ns, const std::string& frame_id = msg::kCameraFrame) {
    offer([color_bgr] { return color_bgr; }, stamp_ns, frame_id);
  }
  /// Images beyond this rate, by their stamps, are left out from now on; 0 = no limit. The thread of offer().
  void limit_rate(double max_hz) { max_hz_ = max_hz; }
  int readers() const { return writer_.matched(); }
  std::uint64_t encoded() const { return encoded_; }
  /// Images that a newer one has replaced.
  std::uint64_t dropped() const { return waiting_.dropped(); }
  std::size_t waiting() const { return waiting_.size(); }

 private:
  struct Waiting {
    Draw draw;
    msg::Header header;
  };
  void publish(const Waiting& image);

  bus::Writer<msg::CompressedImage> writer_;
  int quality_;
  double max_hz_ = 0;
  std::int64_t offered_ns_ =
      std::numeric_limits<std::int64_t>::min() / 2;  ///< stamp of the last image that was not left out
  std::atomic<std::uint64_t> encoded_{0};
  concurrency::BoundedQueue<Waiting> waiting_;
  std::thread thread_;
};

/// Names of coordinate frames on the wire.
struct MotionFrames {
  std::string camera, odom, base;
};

/// Publishes what IMU and wheels of a source measured, on topics that only raw readers need (common/msg/imu.hpp), over
/// its own connection. One thread.
class MotionPublisher {
 public:
  /// Throws BusError when the bus refuses.
  MotionPublisher(const bus::BusOptions& options, const SourceInfo& info, MotionFrames names);
  /// Readings later than `after_ns`. To be called before the frame itself is published: who waits for samples up to its
  /// stamp then seldom waits.
  void publish(const SourceFrame& frame, std::int64_t after_ns);

 private:
  const MotionFrames names_;
  std::shared_ptr<bus::RawBus> bus_;
  std::unique_ptr<bus::RawWriter> imu_, wheels_;
};

/// Publishes messages of a recording with its frames, as their topics are named in it. One thread.
class AuxiliaryPublisher {
 public:
  /// `topics`: ROS names; "/tf_static" stands for the transforms that last. Throws SourceError when the recording does
  /// not have one, or the source is none; BusError when the bus refuses.
  AuxiliaryPublisher(const bus::BusOptions& options, bus::Bus& bus, const std::string& source_uri,
                     const std::vector<std::string>& topics);
  /// Before the frame, as MotionPublisher's.
  void publish(const SourceFrame& frame);
  /// Leaves out what belongs to the frames up to this stamp.
  void pass_over(std::int64_t stamp_ns) { messages_->until(stamp_ns); }

 private:
  /// Opens the writer of a topic and gives its name in the recording.
  std::string open(const recordings::Reader& recording, const std::string& topic);

  std::shared_ptr<bus::RawBus> bus_;
  std::map<std::string, std::unique_ptr<bus::RawWriter>> writers_;  ///< by name in the recording
  bus::Writer<msg::TFMessage> transforms_;
  std::unique_ptr<AuxiliaryTopics> messages_;
};

/// Copies the rows packed and clears the rest of the `size` bytes of a message.
void copy_packed(const cv::Mat& image, std::uint8_t* bytes, std::size_t size);

/// Fills every field of a loaned frame, which has room for the image.
template <std::uint32_t kWidth, std::uint32_t kHeight>
void fill_frame(const vision::RgbdImage& image, std::uint64_t source_id, std::int64_t published_ns,
                msg::SizedFrame<kWidth, kHeight>& frame) {
  const auto& p = image.camera.parameters();
  frame.seq = image.seq;
  frame.stamp_ns = image.stamp_ns;
  frame.published_ns = published_ns;
  frame.intrinsics = {p.fx, p.fy, p.cx, p.cy};
  frame.distortion = msg::unaligned(p.distortion);
  frame.depth_scale_m = image.depth_scale_m;
  frame.readout_s = image.readout_s;
  frame.depth_offset_s = image.depth_offset_s;
  frame.width = static_cast<std::uint32_t>(image.color_bgr.cols);
  frame.height = static_cast<std::uint32_t>(image.color_bgr.rows);
  frame.lens = static_cast<std::uint32_t>(p.lens);
  frame.reserved = 0;
  frame.source_id = source_id;
  copy_packed(image.color_bgr, frame.color_bgr.data(), sizeof frame.color_bgr);
  copy_packed(image.depth, reinterpret_cast<std::uint8_t*>(frame.depth.data()), sizeof frame.depth);
}

/// Publishes frames: raw by loan, colour and a picture of the depth as JPEG while these topics have readers (in other
/// threads, a little later), and the camera's calibration. One thread.
class FramePublisher {
 public:
  /// `jpeg_overflow`: what happens when JPEGs are wanted faster than they can be encoded. `on_matched` is called on a
  /// bus thread when readers of the frame come or go. `source_id`: of the frames; 0: a random one.
  FramePublisher(bus::Bus& bus, int jpeg_quality, concurrency::Overflow jpeg_overflow, std::function<void()> on_matched,
                 std::uint64_t source_id = 0);

  /// Chooses the frame topic for images of this size, before the first frame. Throws bus::BusError when images are too
  /// large.
  void open(cv::Size size_px);
  /// Of the images, on the wire; before the first frame.
  void name_frame(std::string frame_id) { frame_id_ = std::move(frame_id); }
  /// False when the bus did not take the raw frame. A frame of another size opens its topic, as a source of its own.
  bool publish(const vision::RgbdImage& image);
  /// Readers of the raw frame and of the JPEG topic.
  int frame_readers() const { return frames_.matched(); }
  int jpeg_readers() const { return jpegs_.readers(); }
  const JpegPublisher& jpegs() const { return jpegs_; }
  /// JPEGs a second at most, 0 = every frame's; of the depth no more than 10 in any case.
  void limit_jpeg_rate(double max_hz);

 private:
  bus::Bus& bus_;
  std::function<void()> on_matched_;
  std::uint64_t source_id_;
  std::string frame_id_;
  bus::FrameWriter frames_;
  bus::Writer<msg::CameraInfo> infos_;
  bool info_sent_ = false;
  cv::Size size_px_;
  JpegPublisher jpegs_, depths_;
};

}  // namespace rtd::camera
