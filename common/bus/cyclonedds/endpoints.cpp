// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/endpoints.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/socket.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/cyclonedds/qos_mapping.hpp"
#include "common/bus/cyclonedds/samples.hpp"
#include "common/bus/fastdds/screening/rtps_screen.hpp"

namespace rtd::bus::cyclonedds {
namespace {

StatusReporter& status(void* reporter) {
  return *static_cast<StatusReporter*>(reporter);
}

/// `reporter` gets all but new data and matches.
Listener reader_listener(StatusReporter& reporter) {
  Listener listener(dds_create_listener(&reporter));
  dds_listener_t* const l = listener.get();
  dds_lset_requested_deadline_missed(l, [](dds_entity_t, dds_requested_deadline_missed_status_t, void* self) {
    status(self).report_deadline_missed();
  });
  dds_lset_liveliness_changed(l, [](dds_entity_t, dds_liveliness_changed_status_t changed, void* self) {
    status(self).report_liveliness(static_cast<int>(changed.alive_count));
  });
  dds_lset_requested_incompatible_qos(l, [](dds_entity_t, dds_requested_incompatible_qos_status_t refused, void* self) {
    status(self).report_incompatible_qos(name_of(refused.last_policy_id));
  });
  dds_lset_sample_rejected(l, [](dds_entity_t, dds_sample_rejected_status_t rejected, void* self) {
    status(self).report_rejected(static_cast<int>(rejected.total_count));
  });
  return listener;
}

std::set<WriterId> matched_writers(dds_entity_t reader) {
  constexpr std::size_t kFirstGuess = 16;
  std::vector<dds_instance_handle_t> handles(kFirstGuess);
  const dds_return_t count = dds_get_matched_publications(reader, handles.data(), handles.size());
  if (count > static_cast<dds_return_t>(handles.size())) {
    handles.resize(static_cast<std::size_t>(count));
    dds_get_matched_publications(reader, handles.data(), handles.size());
  }
  handles.resize(std::min(handles.size(), static_cast<std::size_t>(std::max(0, count))));
  std::set<WriterId> writers;
  for (const dds_instance_handle_t handle : handles) {
    dds_builtintopic_endpoint_t* const writer = dds_get_matched_publication_data(reader, handle);
    if (writer == nullptr) continue;
    WriterId id{};
    std::copy_n(writer->key.v, id.size(), id.begin());
    writers.insert(id);
    dds_builtintopic_free_endpoint(writer);
  }
  return writers;
}

Listener writer_listener(StatusReporter& reporter) {
  Listener listener(dds_create_listener(&reporter));
  dds_listener_t* const l = listener.get();
  dds_lset_publication_matched(l, [](dds_entity_t, dds_publication_matched_status_t matched, void* self) {
    status(self).report_matched(static_cast<int>(matched.current_count));
  });
  dds_lset_offered_deadline_missed(
      l, [](dds_entity_t, dds_offered_deadline_missed_status_t, void* self) { status(self).report_deadline_missed(); });
  dds_lset_offered_incompatible_qos(l, [](dds_entity_t, dds_offered_incompatible_qos_status_t refused, void* self) {
    status(self).report_incompatible_qos(name_of(refused.last_policy_id));
  });
  return listener;
}

}  // namespace

SampleLimits& SampleLimits::of_process() {
  static SampleLimits limits;
  return limits;
}

void SampleLimits::note(const void* reader, const std::set<WriterId>& writers, std::size_t largest) {
  const std::lock_guard lock(mutex_);
  for (auto& [writer, readers] : largest_)
    if (!writers.contains(writer)) readers.erase(reader);
  std::erase_if(largest_, [](const auto& entry) { return entry.second.empty(); });
  for (const WriterId& writer : writers) largest_[writer][reader] = largest;
}

std::optional<std::size_t> SampleLimits::of(const WriterId& writer) const {
  const std::lock_guard lock(mutex_);
  const auto found = largest_.find(writer);
  if (found == largest_.end()) return std::nullopt;
  return std::ranges::max_element(found->second, {}, [](const auto& entry) { return entry.second; })->second;
}

void SampleLimits::mark_too_large(std::span<std::byte> datagram) const {
  for (const SampleFragments& fragments : read_rtps_message(datagram).fragments) {
    constexpr std::byte kPad{1};
    const auto largest = of(std::bit_cast<WriterId>(fragments.writer));
    if (!largest || fragments.sample_bytes <= *largest) continue;
    const auto submessage = datagram.subspan(fragments.at);
    if (fragments.first_fragment == 1)
      std::ranges::fill(submessage.subspan(SampleFragments::kSizeBehind, 4), std::byte{0xff});
    else
      submessage[0] = kPad;
  }
}

CycloneReader::CycloneReader(std::shared_ptr<Participant> participant, const SampleType& type, const std::string& topic,
                             Qos qos, Handlers handlers)
    : participant_(std::move(participant)),
      largest_(type.largest_bytes),
      on_sample_(std::move(handlers.on_sample)),
      on_gap_(std::move(handlers.on_gap)),
      status_(std::move(handlers.status), thread_),
      thread_([this] { return handle_one(); }) {
  const VendorTopic vendor = participant_->topic(topic, type);
  set_type_hash(*qos, type.name);
  participant_->set_reader_partition(topic, *qos);
  const Listener listener = reader_listener(status_);
  dds_lset_data_available_arg(
      listener.get(), [](dds_entity_t, void* self) { static_cast<CycloneReader*>(self)->thread_.wake(); }, this, true);
  dds_lset_subscription_matched_arg(
      listener.get(),
      [](dds_entity_t, dds_subscription_matched_status_t matched, void* self) {
        static_cast<CycloneReader*>(self)->note_matched(static_cast<int>(matched.current_count));
      },
      this, true);
  const dds_entity_t reader = dds_create_reader(participant_->handle(), vendor.handle, qos.get(), listener.get());
  if (reader < 0) throw BusError("Cyclone DDS refused a reader on topic " + topic + ": " + dds_strretcode(reader));
  reader_ = reader;
  entry_.emplace(participant_->node_endpoints(), topic, guid_of(reader), NodeEndpoints::Direction::kReads);
  if (status_.callbacks().on_type_mismatch) types_.emplace(participant_->types(), topic, type.name, status_);
  thread_.wake();                            // a sample may have come before reader_ was known
  thread_.post([this] { note_writers(); });  // so may a match
}

CycloneReader::~CycloneReader() {
  entry_.reset();
  types_.reset();
  dds_set_listener(reader_, nullptr);  // waits for a running one
  thread_.stop();                      // waits for a running callback; only now nothing takes from the reader
  SampleLimits::of_process().note(this, {}, largest_);
  dds_delete(reader_);
}

/// In a listener, where Cyclone must not be asked.
void CycloneReader::note_matched(int writers) {
  status_.report_matched(writers);
  thread_.post([this] { note_writers(); });
}

/// Cyclone names a writer by a handle that means nothing once the writer is gone, so the present ones are compared.
void CycloneReader::note_writers() {
  const dds_entity_t reader = reader_;
  if (reader == 0) return;
  const std::set<WriterId> now = matched_writers(reader);
  SampleLimits::of_process().note(this, now, largest_);
  const auto& on_writer = status_.callbacks().on_writer;
  if (!on_writer) return;
  for (const WriterId& writer : writers_)
    if (!now.contains(writer)) on_writer(writer, false);
  for (const WriterId& writer : now)
    if (!writers_.contains(writer)) on_writer(writer, true);
  writers_ = now;
}

bool CycloneReader::handle_one() {
  const dds_entity_t reader = reader_;
  if (reader == 0) return false;
  const std::optional<TakenSample> sample = take_sample(reader);
  if (!sample) return false;
  // Cyclone does not report samples that a writer sent and that will not come; their numbers show them. Samples of
  // this process have none.
  if (sample->origin.sequence > 0) {
    if (const auto gap = gaps_.next(sample->origin.writer, sample->origin.sequence)) {
      missing_ += gap->count;
      if (on_gap_) on_gap_(*gap);
      report_lost();
    }
  }
  if (sample->bytes && !on_sample_(*sample)) {
    ++unusable_;
    report_lost();
  }
  return true;
}

void CycloneReader::report_lost() {
  constexpr std::uint64_t kMax = std::numeric_limits<int>::max();
  const auto& on_samples_lost = status_.callbacks().on_samples_lost;
  if (on_samples_lost) on_samples_lost(static_cast<int>(std::min(missing_ + unusable_, kMax)));
}

CycloneWriter::CycloneWriter(std::shared_ptr<Participant> participant, const SampleType& type, const std::string& topic,
                             Qos qos, StatusCallbacks callbacks)
    : participant_(std::move(participant)), topic_(participant_->topic(topic, type)), status_(std::move(callbacks)) {
  set_type_hash(*qos, type.name);
  participant_->set_writer_partition(topic, *qos);
  const Listener listener = writer_listener(status_);
  writer_ = dds_create_writer(participant_->handle(), topic_.handle, qos.get(), listener.get());
  if (writer_ < 0) throw BusError("Cyclone DDS refused a writer on topic " + topic + ": " + dds_strretcode(writer_));
  last_.writer = guid_of(writer_);
  entry_.emplace(participant_->node_endpoints(), topic, last_.writer, NodeEndpoints::Direction::kWrites);
  if (status_.callbacks().on_type_mismatch) types_.emplace(participant_->types(), topic, type.name, status_);
}

CycloneWriter::~CycloneWriter() {
  entry_.reset();
  types_.reset();
  dds_set_listener(writer_, nullptr);  // waits for a running one
  dds_delete(writer_);
}

bool CycloneWriter::write(std::shared_ptr<ByteBlock> bytes, std::int64_t source_ns) {
  const std::lock_guard lock(mutex_);
  SampleOrigin next = last_;
  ++next.sequence;
  if (!write_sample(writer_, topic_.type, std::move(bytes), next, source_ns)) return false;
  last_ = next;
  return true;
}

bool CycloneWriter::wait_acknowledged(int timeout_ms) {
  return dds_wait_for_acks(writer_, DDS_MSECS(timeout_ms)) == DDS_RETCODE_OK;
}

TypedWriter::TypedWriter(std::shared_ptr<Participant> participant, MessageId id, const std::string& topic, Qos qos,
                         StatusCallbacks callbacks)
    : id_(id),
      largest_(sample_type(id).largest_bytes),
      writer_(std::move(participant), sample_type(id), topic, std::move(qos), std::move(callbacks)) {}

bool TypedWriter::write(const void* message) {
  std::shared_ptr<ByteBlock> sample = encode(id_, writer_.type(), message);
  if (sample->view().size() <= largest_) return writer_.write(std::move(sample));
  writer_.report_too_large();
  return false;
}

void* TypedWriter::loan() {
  std::shared_ptr<ByteBlock> block = plain_block(id_, writer_.type());
  void* const slot = block->bytes().data() + ByteBlock::kCdrHeaderBytes;
  loans_.emplace(slot, std::move(block));
  return slot;
}

bool TypedWriter::write_loaned(void* slot) {
  auto node = loans_.extract(slot);
  return !node.empty() && writer_.write(std::move(node.mapped()));
}

}  // namespace rtd::bus::cyclonedds

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace {

/// By the names that Cyclone gives its threads.
bool receives_for_cyclone() {
  static thread_local const bool receives = [] {
    char name[16] = {};
    pthread_getname_np(pthread_self(), name, sizeof(name));
    return std::string_view(name).starts_with("recv");
  }();
  return receives;
}

}  // namespace

/// Stands before the function of the C library.
extern "C" ssize_t recvmsg(int socket, msghdr* message, int flags) {
  static const auto original = reinterpret_cast<ssize_t (*)(int, msghdr*, int)>(dlsym(RTLD_NEXT, "recvmsg"));
  const ssize_t received = original(socket, message, flags);
  if (received > 0 && message->msg_iovlen == 1 && receives_for_cyclone()) {
    const std::span buffer(static_cast<std::byte*>(message->msg_iov->iov_base), message->msg_iov->iov_len);
    const auto size = std::min(buffer.size(), static_cast<std::size_t>(received));
    rtd::bus::cyclonedds::SampleLimits::of_process().mark_too_large(buffer.first(size));
  }
  return received;
}
#endif
