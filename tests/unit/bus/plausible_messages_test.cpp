// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

#include "common/bus/message_screen.hpp"
#include "tests/unit/bus/message_walk.hpp"

namespace rtd::bus {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kLatest = std::numeric_limits<std::int64_t>::max();

/// What an attacker would write into a field, and whether the field may hold it all the same.
template <class T>
struct Hostile {
  T value;
  bool allowed = false;
};

template <class T>
std::vector<Hostile<T>> hostile_values(const T& good, const msg::FieldRule& rule) {
  if constexpr (std::is_same_v<T, bool>) {
    return {};
  } else if constexpr (std::is_floating_point_v<T>) {
    const bool any_size = rule.most > 1e300;
    constexpr T kMax = std::numeric_limits<T>::max();
    return {{static_cast<T>(kNan)},
            {static_cast<T>(kInfinity)},
            {-static_cast<T>(kInfinity)},
            {kMax, any_size},
            {-kMax, any_size}};
  } else if constexpr (std::is_enum_v<T>) {
    return {{static_cast<T>(~0U)}, {static_cast<T>(static_cast<std::uint32_t>(last_value(msg::TypeOf<T>())) + 1)}};
  } else if constexpr (std::is_integral_v<T>) {
    return {{std::numeric_limits<T>::max(), rule.free}};
  } else if constexpr (requires { typename T::Number; }) {
    std::vector<Hostile<T>> values;
    for (const auto& hostile : hostile_values(good.value(), rule)) values.push_back({hostile.value, hostile.allowed});
    return values;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return {{"a\nlevel=info forged", rule.text == msg::TextRule::kLines},
            {"\033[2J"},
            {"\x7f"},
            {"\xc2\x9b"
             "31m"},
            {"\xff\xfe"},
            {"\xed\xa0\x80"},
            {std::string("a\0b", 3)},
            {std::string(100'000, 'a')}};
  } else {
    T many = good;
    many.resize(msg::plausible::most_elements<typename T::value_type>(rule) + 1, good.front());
    std::vector<Hostile<T>> values;
    values.push_back({std::move(many)});
    return values;
  }
}

/// The first bad field of a message, in short; messages of the bus by what the bus compiled.
template <class T>
std::string bad_field(const T& message) {
  if constexpr (walk::kOnBus<T>) {
    return to_string(MessageScreen(MessageTraits<T>::kId).implausible_field(&message, {}));
  } else {
    return to_string(msg::implausible_field(message));
  }
}

/// Visits the fields of a message: sets each to what it must not hold. Free fields may hold it, unless the message's
/// own rule refuses it.
struct HostileValues {
  std::function<bool()> passes;
  int refused = 0;
  std::set<std::string_view> rules_of_no_field;

  template <class Leaf>
  void operator()(Leaf& leaf, const msg::FieldRule& rule, const std::string& name) {
    const Leaf good = leaf;
    for (const auto& hostile : hostile_values(good, rule)) {
      leaf = hostile.value;
      check(name, hostile.allowed);
    }
    leaf = good;
    const std::size_t point = name.find('.');
    const std::size_t place = msg::find_rule(name.substr(0, point), name.substr(point + 1));
    if (place != msg::kNoRule) rules_of_no_field.erase(msg::kFieldRules[place].field);
  }
  void check(const std::string& name, bool allowed) {
    const bool passed = passes();
    EXPECT_TRUE(!passed || allowed) << name;
    if (!passed) ++refused;
  }
};

TEST(PlausibleMessages, each_rule_is_about_a_field_and_each_field_refuses_hostile_values) {
  HostileValues values;
  for (const msg::FieldRule& rule : msg::kFieldRules)
    EXPECT_TRUE(values.rules_of_no_field.insert(rule.field).second) << rule.field;
  walk::for_each_type(walk::AllTypes(), [&]<class T>() {
    const auto message = walk::plausible_message<T>();
    values.passes = [&message] { return bad_field(*message).empty(); };
    walk::for_each_leaf(*message, values);
    if (const std::string field = bad_field(*message); !field.empty()) ADD_FAILURE() << field;
  });
  EXPECT_GT(values.refused, 1400);
  values.rules_of_no_field.erase("rtd_msgs/WireSchema.text");  // common/ros2/schema_texts.cpp has that type for itself
  for (const std::string_view field : values.rules_of_no_field) ADD_FAILURE() << "no field is called " << field;
}

TEST(PlausibleMessages, the_first_bad_field_is_named_with_its_type) {
  const auto frame = walk::plausible_message<msg::FeatureFrame>();
  frame->features[1].octave = 200;
  EXPECT_EQ(bad_field(*frame), "rtd_msgs/Feature.octave");
  frame->stamp_ns = kLatest;
  EXPECT_EQ(bad_field(*frame), "rtd_msgs/FeatureFrame.stamp_ns");
}

TEST(SequenceGuard, takes_losses_loops_and_newcomers_and_no_jump) {
  SequenceGuard guard;
  const WriterId camera{1}, other{2};
  EXPECT_TRUE(guard.continues(camera, 5'000'000)) << "a reader may come late";
  EXPECT_TRUE(guard.continues(camera, 5'000'100));
  EXPECT_FALSE(guard.continues(camera, 900'000'000));
  EXPECT_FALSE(guard.continues(camera, 900'000'001)) << "a jump is not remembered";
  EXPECT_TRUE(guard.continues(camera, 5'000'101));
  EXPECT_TRUE(guard.continues(camera, 0));
  EXPECT_TRUE(guard.continues(other, 900'000'000)) << "each writer counts for itself";
  EXPECT_FALSE(guard.continues(camera, 900'000'000));
}

TEST(SequenceGuard, forgets_the_oldest_of_many_writers) {
  SequenceGuard guard;
  for (std::uint8_t writer = 1; writer <= 1 + SequenceGuard::kMaxWriters; ++writer)
    EXPECT_TRUE(guard.continues(WriterId{writer}, 0));
  EXPECT_TRUE(guard.continues(WriterId{1}, 900'000'000));
  EXPECT_FALSE(guard.continues(WriterId{3}, 900'000'000));
}

TEST(PlausibleMessages, features_beyond_the_count_do_not_matter) {
  const auto frame = walk::plausible_message<msg::FeatureFrame>();
  frame->features[2].u_px = static_cast<float>(kNan);
  EXPECT_TRUE(msg::is_plausible(*frame));
  frame->count = 3;
  EXPECT_FALSE(msg::is_plausible(*frame));
}

/// Fields that hold their rules and do not go together.
template <class T>
std::string broken(const std::function<void(T&)>& change) {
  const auto message = walk::plausible_message<T>();
  change(*message);
  return bad_field(*message);
}

TEST(PlausibleMessages, images_that_no_camera_takes_are_refused) {
  const auto features = [](auto change) { return broken<msg::FeatureFrame>(change); };
  EXPECT_EQ(features([](auto& f) { f.width = 1; }), "rtd_msgs/FeatureFrame.width and height");
  EXPECT_EQ(features([](auto& f) { f.height = 1; }), "rtd_msgs/FeatureFrame.width and height");
  EXPECT_EQ(features([](auto& f) { f.width = f.height = 1900; }), "rtd_msgs/FeatureFrame.width and height");
  EXPECT_EQ(features([](auto& f) { f.width = 2'000'000'000; }), "rtd_msgs/FeatureFrame.width");
  EXPECT_EQ(features([](auto& f) { f.intrinsics[0] = 0; }), "rtd_msgs/FeatureFrame.intrinsics");
  EXPECT_EQ(features([](auto& f) { f.intrinsics[1] = 1e-30; }), "rtd_msgs/FeatureFrame.intrinsics");
  EXPECT_EQ(features([](auto& f) { f.intrinsics[2] = 1e12; }), "rtd_msgs/FeatureFrame.intrinsics");
  EXPECT_EQ(features([](auto& f) { f.removed = 3; }), "rtd_msgs/FeatureFrame.removed");
  const auto frame = [](auto change) { return broken<msg::RgbdFrame>(change); };
  EXPECT_EQ(frame([](auto& f) { f.width = 1000; }), "rtd_msgs/RgbdFrame.width and height") << "more than its class";
  EXPECT_EQ(frame([](auto& f) { f.height = 1; }), "rtd_msgs/RgbdFrame.width and height");
  EXPECT_EQ(frame([](auto& f) { f.intrinsics[0] = 1e300; }), "rtd_msgs/RgbdFrame.intrinsics");
  EXPECT_EQ(frame([](auto& f) { f.depth_scale_m = 0.0; }), "rtd_msgs/RgbdFrame.depth_scale_m");
}

TEST(PlausibleMessages, offsets_and_sizes_beyond_the_data_are_refused) {
  const auto cloud = [](auto change) { return broken<msg::PointCloud2>(change); };
  EXPECT_EQ(cloud([](auto& c) { c.fields[1].offset = 0xFFFFFFFC; }), "sensor_msgs/PointCloud2.fields");
  EXPECT_EQ(cloud([](auto& c) { c.fields[1].offset = 13; }), "sensor_msgs/PointCloud2.fields");
  EXPECT_EQ(cloud([](auto& c) { c.fields[1].count = 0xFFFFFFFF; }), "sensor_msgs/PointCloud2.fields");
  EXPECT_EQ(cloud([](auto& c) { c.width = 0x10000003; }), "sensor_msgs/PointCloud2.row_step") << "in 64 bits";
  EXPECT_EQ(cloud([](auto& c) { c.height = 3; }), "sensor_msgs/PointCloud2.data");
  const auto image = [](auto change) { return broken<msg::Image>(change); };
  EXPECT_EQ(image([](auto& i) { i.step = 3; }), "sensor_msgs/Image.step");
  const auto dense = [](auto& i) {
    i.step = 0;
    i.data.resize(8);
  };
  EXPECT_EQ(image(dense), "") << "4 x 2 px without bytes between rows: the step is not needed";
  EXPECT_EQ(image([](auto& i) { i.height = 3; }), "sensor_msgs/Image.data");
  EXPECT_EQ(broken<msg::OccupancyGrid>([](auto& g) { g.info.width = 2; }), "nav_msgs/OccupancyGrid.data");
  EXPECT_EQ(broken<msg::MapKeyframe>([](auto& k) { k.points_m.pop_back(); }), "rtd_msgs/MapKeyframe.points_m");
  EXPECT_EQ(broken<msg::MapUpdate>([](auto& m) { m.loop_edges.pop_back(); }), "rtd_msgs/MapUpdate.loop_edges");
}

TEST(PlausibleMessages, rotations_that_are_none_are_refused_where_they_count) {
  const std::array<double, 4> unset{}, tiny{0, 0, 0, 1e-200}, huge{0, 0, 0, 1e14};
  for (const auto& rotation : {unset, tiny, huge}) {
    EXPECT_NE(broken<msg::KeyframeEvent>([&](auto& event) {
                event.kind = msg::KeyframeEventKind::kCreated;
                event.T_world_camera.rotation_xyzw = rotation;
              }),
              "");
    EXPECT_NE(broken<msg::TrackingResult>([&](auto& result) { result.T_world_camera.rotation_xyzw = rotation; }), "");
    const bool unknown = rotation == unset;
    EXPECT_EQ(broken<msg::TrackingResult>([&](auto& result) {
                result.state = msg::TrackingState::kLost;
                result.T_world_camera.rotation_xyzw = rotation;
              }) == "",
              unknown);
    EXPECT_EQ(broken<msg::PoseStamped>([&](auto& pose) {
                pose.pose.orientation = {rotation[0], rotation[1], rotation[2], rotation[3]};
              }) == "",
              unknown);
  }
}

TEST(PlausibleMessages, names_of_services_and_metrics_are_plain) {
  const auto status = [](auto change) { return broken<msg::ServiceStatus>(change); };
  EXPECT_EQ(status([](auto& s) { s.service = ""; }), "rtd_msgs/ServiceStatus.service");
  EXPECT_EQ(status([](auto& s) { s.service = "cam;era"; }), "rtd_msgs/ServiceStatus.service");
  EXPECT_EQ(status([](auto& s) { s.service = "detector/anna-2_b.c"; }), "");
  EXPECT_EQ(status([](auto& s) { s.metrics[0].name = "topic.rt/tf.lost"; }), "");
  EXPECT_EQ(status([](auto& s) { s.metrics[0].name = "a b"; }), "rtd_msgs/Metric.name");
  EXPECT_EQ(status([](auto& s) { s.message = "no camera: \xc3\xbc \xe2\x9c\x93"; }), "") << "text of any language";
}

}  // namespace
}  // namespace rtd::bus
