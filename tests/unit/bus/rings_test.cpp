// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/participant.hpp"
#include "common/bus/fastdds/qos_mapping.hpp"
#include "common/bus/host/ring_folder.hpp"
#include "tests/support/eventually.hpp"

namespace rtd::bus::fastdds {
namespace {

using test_support::eventually;
using ::testing::IsEmpty;

constexpr int kRingsDomain = 95;

/// The rings of frames that this process has mapped, once for each endpoint that did so.
std::multiset<std::string> mapped_rings() {
  std::ifstream maps("/proc/self/maps");
  std::multiset<std::string> rings;
  for (std::string line; std::getline(maps, line);) {
    if (line.find("fast_datasharing") != std::string::npos) rings.insert(line.substr(line.find('/')));
  }
  return rings;
}

std::size_t shared_rings() {
  const std::multiset<std::string> all = mapped_rings();
  return all.size() - std::set<std::string>(all.begin(), all.end()).size();
}

/// Our reader of frames, and writers and readers that share rings by a policy of their own.
class Rings : public testing::Test {
 protected:
  BusOptions options() const {
    BusOptions options;
    options.domain = kRingsDomain;
    options.rings = folder_;
    return options;
  }
  static dds::DataSharingQosPolicy rings_in(const std::string& folder) {
    dds::DataSharingQosPolicy policy;
    place_ring(policy, folder);
    return policy;
  }
  /// What a stranger can learn of a policy: its id.
  static dds::DataSharingQosPolicy announced(const dds::DataSharingQosPolicy& policy) {
    dds::DataSharingQosPolicy copied;
    copied.automatic();
    for (const std::uint64_t id : policy.domain_ids()) copied.add_domain_id(id);
    return copied;
  }
  dds::DataReader& reader(Participant& participant, const dds::DataSharingQosPolicy& policy) {
    dds::DataReaderQos qos = reader_qos(qos_settings(QosProfile::kRawFrame), true);
    qos.data_sharing() = policy;
    return *participant.subscriber("rtd/frame").create_datareader(participant.topic("rtd/frame", *codec_), qos);
  }
  dds::DataWriter& writer(Participant& participant, const dds::DataSharingQosPolicy& policy) {
    dds::DataWriterQos qos = writer_qos(qos_settings(QosProfile::kRawFrame), true);
    qos.data_sharing() = policy;
    return *participant.publisher("rtd/frame").create_datawriter(participant.topic("rtd/frame", *codec_), qos);
  }
  static int matched(dds::DataReader& reader) {
    dds::SubscriptionMatchedStatus status;
    reader.get_subscription_matched_status(status);
    return status.current_count;
  }
  static int matched(dds::DataWriter& writer) {
    dds::PublicationMatchedStatus status;
    writer.get_publication_matched_status(status);
    return status.current_count;
  }
  bool receives_from(dds::DataReader& reader, dds::DataWriter& writer) {
    EXPECT_TRUE(eventually([&] { return matched(reader) > 0 && matched(writer) > 0; }));
    EXPECT_TRUE(codec_->write(writer, std::make_unique<msg::RgbdFrame>().get()));
    return eventually([&] {
      const TakenSample taken = codec_->take(reader, {});
      return taken.kind == TakenSample::Kind::kMessage && taken.writer == to_writer_id(writer.guid());
    });
  }

  const std::unique_ptr<Codec> codec_ = create_codec(MessageTraits<msg::RgbdFrame>::kId);
  const RingsOfRun run_;
  const std::string folder_ = std::getenv(kRingsVariable);
  Participant ours_{options(), read_host_limits()}, other_{options(), read_host_limits()};
};

TEST_F(Rings, are_shared_by_those_that_have_them_in_one_folder) {
  EXPECT_TRUE(receives_from(reader(ours_, rings_in(folder_)), writer(other_, rings_in(folder_))));
  EXPECT_GT(shared_rings(), 0U);
}

/// Another version of Fast DDS would end a process of ours by sharing a ring with it.
TEST_F(Rings, of_those_that_share_them_with_all_of_the_host_are_not_mapped) {
  EXPECT_TRUE(receives_from(reader(ours_, rings_in(folder_)), writer(other_, {})));
  EXPECT_EQ(shared_rings(), 0U);
}

TEST_F(Rings, are_not_shared_with_services_beside_the_run_which_receive_frames_without) {
  EXPECT_TRUE(receives_from(reader(other_, rings_in(ring_folder(""))), writer(ours_, rings_in(folder_))));
  EXPECT_EQ(shared_rings(), 0U);
}

TEST_F(Rings, of_a_writer_that_only_announces_to_share_them_are_not_mapped) {
  const dds::DataSharingQosPolicy rings = rings_in(folder_);
  dds::DataReader& reading = reader(ours_, rings);
  writer(other_, announced(rings));  // its own Fast DDS would never end to look for our reader
  EXPECT_TRUE(eventually([&] { return matched(reading) == 1; }));
  EXPECT_EQ(shared_rings(), 0U);
}

TEST_F(Rings, a_reader_that_only_announces_to_share_them_disturbs_no_other) {
  const dds::DataSharingQosPolicy rings = rings_in(folder_);
  dds::DataWriter& writing = writer(ours_, rings);
  reader(other_, announced(rings));
  dds::DataReader& honest = reader(ours_, rings);
  ASSERT_TRUE(eventually([&] { return matched(writing) == 2; })) << matched(writing) << matched(honest);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(receives_from(honest, writing));
}

TEST_F(Rings, need_no_working_directory_that_can_be_written_to) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers' own open() does not know of it";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // in another process, which has no ring yet
  const auto shares_a_ring = [&] {
    if (chdir("/proc") != 0) std::_Exit(2);
    const bool receives = receives_from(reader(ours_, rings_in(folder_)), writer(other_, rings_in(folder_)));
    std::_Exit(receives && shared_rings() > 0 ? 0 : 1);
  };
  EXPECT_EXIT(shares_a_ring(), testing::ExitedWithCode(0), "");
}

TEST_F(Rings, there_are_none_without_a_folder) {
  EXPECT_TRUE(receives_from(reader(ours_, rings_in("")), writer(other_, rings_in(""))));
  EXPECT_THAT(mapped_rings(), IsEmpty());
}

}  // namespace
}  // namespace rtd::bus::fastdds
