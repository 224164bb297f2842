// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/screening_transport.hpp"

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastrtps/utils/IPLocator.h>

#include <atomic>
#include <mutex>
#include <span>
#include <utility>

#include "common/bus/rtps_screen.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace rtps = eprosima::fastdds::rtps;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::LocatorsIterator;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;

using OnProblem = std::function<void(const std::string&)>;

class ScreeningTransport : public rtps::ChainingTransport {
 public:
  ScreeningTransport(const rtps::ChainingTransportDescriptor& descriptor, OnProblem on_problem)
      : ChainingTransport(descriptor), descriptor_(descriptor), on_problem_(std::move(on_problem)) {}

  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  bool send(SenderResource* sender, const octet* data, std::uint32_t size, LocatorsIterator* begin,
            LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    return sender->send(data, size, begin, end, timeout);
  }
  void receive(rtps::TransportReceiverInterface* next, const octet* data, std::uint32_t size, const Locator_t& local,
               const Locator_t& remote) override {
    if (screen_.passes(std::as_bytes(std::span(data, size)))) {
      const std::lock_guard one_at_a_time(mutex_);
      return next->OnDataReceived(data, size, local, remote);
    }
    if (on_problem_ && !told_.exchange(true))
      on_problem_("malformed RTPS datagrams come from " + IPLocator::toIPv4string(remote) + " and are dropped");
  }

 private:
  struct Configuration : rtps::ChainingTransportDescriptor {
    using ChainingTransportDescriptor::ChainingTransportDescriptor;
    explicit Configuration(const rtps::ChainingTransportDescriptor& other) : ChainingTransportDescriptor(other) {}
    rtps::TransportInterface* create_transport() const override { return nullptr; }
  } descriptor_;
  const OnProblem on_problem_;
  RtpsScreen screen_;
  std::atomic<bool> told_{false};
  std::mutex mutex_;
};

class ScreeningDescriptor : public rtps::ChainingTransportDescriptor {
 public:
  ScreeningDescriptor(std::shared_ptr<rtps::TransportDescriptorInterface> transport, OnProblem on_problem)
      : ChainingTransportDescriptor(std::move(transport)), on_problem_(std::move(on_problem)) {}
  rtps::TransportInterface* create_transport() const override { return new ScreeningTransport(*this, on_problem_); }

 private:
  const OnProblem on_problem_;
};

}  // namespace

std::shared_ptr<rtps::TransportDescriptorInterface> screened(
    std::shared_ptr<rtps::TransportDescriptorInterface> transport, OnProblem on_problem) {
  return std::make_shared<ScreeningDescriptor>(std::move(transport), std::move(on_problem));
}

}  // namespace rtd::bus::fastdds
