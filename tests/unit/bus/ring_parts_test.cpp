// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/bus/fastdds/screening/ring_claims.hpp"
#include "common/bus/host/ring_folder.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::bus {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

constexpr std::uint8_t kData = 0x15, kDataFrag = 0x16, kOfReaders = 4, kOfParticipants = 1;

Bytes operator+(Bytes one, const Bytes& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

Bytes octets(std::initializer_list<unsigned> values) {
  Bytes bytes;
  for (const unsigned value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

const Bytes kId = octets({1, 2, 3, 4, 5, 6, 7, 8}), kNoId = octets({0, 0, 0, 0, 0, 0, 0, 0});

/// A GUID with the file "fast_datasharing_01.0f.00...00_0.0.1.LAST" (hexadecimal), as a parameter.
Bytes guid(unsigned last) {
  return octets({0x5a, 0, 16, 0, 1, 0x0f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, last});
}

Bytes submessage(std::uint8_t kind, std::uint8_t writers, const Bytes& content) {
  const Bytes body = octets({0, 0, 16, 0, 0, 0, 0, 0, 0, 0, writers, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0}) + content;
  return octets({kind, 1, static_cast<unsigned>(body.size()), 0}) + body;
}

Bytes message_of(const Bytes& submessages) {
  return octets({'R', 'T', 'P', 'S', 2, 3, 1, 15, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}) + submessages;
}

class RingClaimsTest : public testing::Test {
 protected:
  void SetUp() override { folder_.write("fast_datasharing_01.0f.00.00.00.00.00.00.00.00.00.00_0.0.1.1c", ""); }

  const rtd::test::TemporaryFolder folder_;
  const RingClaims claims_{folder_.path(), 0x0807060504030201};
};

TEST_F(RingClaimsTest, of_an_endpoint_with_a_file_in_the_folder_stay) {
  EXPECT_EQ(claims_.checked(message_of(submessage(kData, kOfReaders, guid(0x1c) + kId))), Bytes());
}

TEST_F(RingClaimsTest, of_others_are_taken_out_in_both_byte_orders_wherever_they_are) {
  const Bytes reversed(kId.rbegin(), kId.rend()), honest = submessage(kData, kOfReaders, guid(0x1c) + kId);
  for (const Bytes& id : {kId, reversed}) {
    EXPECT_EQ(claims_.checked(message_of(honest + submessage(kData, kOfReaders, id + guid(0x2c) + id))),
              message_of(honest + submessage(kData, kOfReaders, kNoId + guid(0x2c) + kNoId)));
  }
  EXPECT_EQ(claims_.checked(message_of(submessage(kData, kOfReaders, guid(0x1c) + guid(0x2c) + kId))),
            message_of(submessage(kData, kOfReaders, guid(0x1c) + guid(0x2c) + kNoId)))
      << "of two names";
  const Bytes decoy = octets({0}) + guid(0x1c) + octets({0, 0, 0});
  EXPECT_EQ(claims_.checked(message_of(submessage(kData, kOfReaders, decoy + guid(0x2c) + kId))),
            message_of(submessage(kData, kOfReaders, decoy + guid(0x2c) + kNoId)))
      << "beside a name that is not a parameter";
  EXPECT_EQ(claims_.checked(message_of(submessage(kData, kOfReaders, kId))),
            message_of(submessage(kData, kOfReaders, kNoId)))
      << "without a name";
}

TEST_F(RingClaimsTest, in_parts_are_refused) {
  EXPECT_EQ(claims_.checked(message_of(submessage(kDataFrag, kOfReaders, guid(0x1c)))), std::nullopt);
}

TEST_F(RingClaimsTest, are_looked_for_in_announcements_of_endpoints_alone) {
  EXPECT_EQ(claims_.checked(message_of(submessage(kData, kOfParticipants, guid(0x2c) + kId))), Bytes());
  EXPECT_EQ(claims_.checked(message_of(submessage(kData, kOfReaders, guid(0x2c)))), Bytes());
  EXPECT_EQ(RingClaims("", 0x0807060504030201).checked(message_of(submessage(kDataFrag, kOfReaders, kId))), Bytes())
      << "no rings";
}

TEST_F(RingClaimsTest, a_message_that_is_cut_off_is_read_to_its_end) {
  const Bytes whole = message_of(submessage(kData, kOfReaders, guid(0x2c) + kId));
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) claims_.checked(std::span(whole).first(bytes));
}

namespace fs = std::filesystem;

class RingFolder : public testing::Test {
 protected:
  const rtd::test::TemporaryFolder scratch_;
  const std::string asked_ = scratch_ / "rings";
};

TEST_F(RingFolder, is_made_for_its_user_alone_and_found_again) {
  EXPECT_EQ(ring_folder(asked_), asked_);
  EXPECT_EQ(fs::status(asked_).permissions(), fs::perms::owner_all);
  EXPECT_EQ(ring_folder(asked_), asked_);
}

TEST_F(RingFolder, is_none_where_another_user_may_write_or_has_made_it) {
  fs::create_directory(asked_);
  fs::permissions(asked_, fs::perms::owner_all | fs::perms::group_write);
  EXPECT_EQ(ring_folder(asked_), "");
  fs::permissions(asked_, fs::perms::owner_all);
  EXPECT_EQ(ring_folder(asked_), asked_);
  if (chown(asked_.c_str(), 65534, 65534) != 0) GTEST_SKIP() << "needs root, to give it to another user";
  EXPECT_EQ(ring_folder(asked_), "");
}

TEST_F(RingFolder, is_no_link_and_no_file) {
  fs::create_directory(scratch_ / "elsewhere");
  fs::permissions(scratch_ / "elsewhere", fs::perms::owner_all);
  fs::create_symlink(scratch_ / "elsewhere", asked_);
  EXPECT_EQ(ring_folder(asked_), "");
  fs::remove(asked_);
  std::ofstream(asked_) << "a file";
  EXPECT_EQ(ring_folder(asked_), "");
}

TEST_F(RingFolder, is_one_for_each_user_where_none_is_asked_for) {
  EXPECT_EQ(ring_folder(""), "/dev/shm/rtd_rings_" + std::to_string(geteuid()));
}

TEST_F(RingFolder, of_a_run_is_in_the_environment_of_its_services_and_goes_with_it) {
  std::string first;
  {
    const RingsOfRun run;
    first = std::getenv(kRingsVariable);
    EXPECT_EQ(ring_folder(first), first);
    EXPECT_NE(first, ring_folder(""));
    std::ofstream(first + "/fast_datasharing_01.0f.aa_0.0.3.3") << "of a service that was killed";
  }
  EXPECT_EQ(std::getenv(kRingsVariable), nullptr);
  EXPECT_FALSE(fs::exists(first));
}

}  // namespace
}  // namespace rtd::bus
