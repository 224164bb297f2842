// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace rtd::bus::fastdds {

/// Pairs the fields of a plain struct with the accessors of its generated vendor type, once for both directions:
///   template <> struct FieldMap<msg::X> { using Vendor = X_;
///     static void pair(auto& plain, auto& vendor, auto copy) { copy(plain.a, vendor.a()); ... } };
/// `copy` assigns in the direction of the conversion.
template <class Plain>
struct FieldMap;

template <class T>
concept Mapped = requires {
  typename FieldMap<T>::Vendor;
};

template <Mapped Plain>
using VendorOf = typename FieldMap<Plain>::Vendor;

/// Copies one field in either direction; structs by their FieldMap, vectors element by element where need be.
struct ToVendor {
  template <class Plain, class Vendor>
  void operator()(const Plain& plain, Vendor& vendor) const {
    if constexpr (Mapped<Plain>) {
      FieldMap<Plain>::pair(plain, vendor, *this);
    } else if constexpr (std::is_enum_v<Plain>) {
      vendor = static_cast<Vendor>(plain);
    } else {
      vendor = plain;
    }
  }
  template <Mapped Plain, class Vendor>
  void operator()(const std::vector<Plain>& plain, std::vector<Vendor>& vendor) const {
    vendor.resize(plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) (*this)(plain[i], vendor[i]);
  }
};

struct FromVendor {
  template <class Plain, class Vendor>
  void operator()(Plain& plain, const Vendor& vendor) const {
    if constexpr (Mapped<Plain>) {
      FieldMap<Plain>::pair(plain, vendor, *this);
    } else if constexpr (std::is_enum_v<Plain>) {
      plain = static_cast<Plain>(vendor);
    } else {
      plain = vendor;
    }
  }
  template <Mapped Plain, class Vendor>
  void operator()(std::vector<Plain>& plain, const std::vector<Vendor>& vendor) const {
    plain.resize(vendor.size());
    for (std::size_t i = 0; i < vendor.size(); ++i) (*this)(plain[i], vendor[i]);
  }
};

}  // namespace rtd::bus::fastdds
