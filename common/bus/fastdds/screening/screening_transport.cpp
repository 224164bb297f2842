// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening/screening_transport.hpp"

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastrtps/utils/IPLocator.h>

#include <atomic>
#include <mutex>
#include <span>
#include <utility>

#include "common/bus/fastdds/screening/rtps_screen.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace transports = eprosima::fastdds::rtps;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::LocatorsIterator;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;

using OnProblem = std::function<void(const std::string&)>;

class ScreeningDescriptor : public transports::ChainingTransportDescriptor {
 public:
  ScreeningDescriptor(std::shared_ptr<transports::TransportDescriptorInterface> transport, std::uint32_t largest_sent,
                      OnProblem problem)
      : ChainingTransportDescriptor(std::move(transport)), on_problem(std::move(problem)) {
    maxMessageSize = largest_sent;
  }
  std::uint32_t max_message_size() const override { return maxMessageSize; }
  transports::TransportInterface* create_transport() const override;

  const OnProblem on_problem;
};

class ScreeningTransport : public transports::ChainingTransport {
 public:
  explicit ScreeningTransport(const ScreeningDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  transports::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  bool send(SenderResource* sender, const octet* data, std::uint32_t size, LocatorsIterator* begin,
            LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    return sender->send(data, size, begin, end, timeout);
  }
  void receive(transports::TransportReceiverInterface* next, const octet* data, std::uint32_t size,
               const Locator_t& local, const Locator_t& remote) override {
    std::unique_lock one_at_a_time(mutex_);
    if (screen_.passes(std::as_bytes(std::span(data, size)))) return next->OnDataReceived(data, size, local, remote);
    one_at_a_time.unlock();
    if (descriptor_.on_problem && !told_.exchange(true))
      descriptor_.on_problem("malformed RTPS datagrams come from " + IPLocator::toIPv4string(remote) +
                             " and are dropped");
  }

 private:
  ScreeningDescriptor descriptor_;
  RtpsScreen screen_;
  std::atomic<bool> told_{false};
  std::mutex mutex_;
};

transports::TransportInterface* ScreeningDescriptor::create_transport() const {
  return new ScreeningTransport(*this);
}

}  // namespace

std::shared_ptr<transports::TransportDescriptorInterface> screened(
    std::shared_ptr<transports::TransportDescriptorInterface> transport, std::uint32_t largest_sent,
    OnProblem on_problem) {
  return std::make_shared<ScreeningDescriptor>(std::move(transport), largest_sent, std::move(on_problem));
}

}  // namespace rtd::bus::fastdds
